#pragma once

#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

#include "ferrers/math/rotation.h"

/// Small ASMT files for tests, laid out as OndselSolver does.
namespace ferrers::witness {

/// Records of a joint, motion or limit beside its name: key, value.
using AsmtEntries = std::vector<std::pair<std::string, std::string>>;

/// An assembly 'A', lengths in the file's unit. Markers are '/A/NAME' and '/A/PART/NAME'.
class AsmtText {
 public:
  std::string header = "OndselSolver";
  std::string gravity = "0\t0\t-9810";
  std::string after;  ///< What follows the assembly, such as results.

  void marker(const std::string& name, const Pose& pose = {}) { markers_ += ref_point(2, name, pose); }

  void part(const std::string& name, const Pose& pose = {}, double mass = 2, const std::string& moments = "8\t9\t10") {
    parts_.push_back({name, frame(3, pose), mass, moments, {}});
  }

  void part_marker(const std::string& part, const std::string& name, const Pose& pose = {}) {
    for (Part& one : parts_) {
      if (one.name == part) one.markers += ref_point(4, name, pose);
    }
  }

  /// Joins I, a marker's path below '/A/', with J.
  void joint(const std::string& kind, const std::string& name, const std::string& I, const std::string& J,
             const AsmtEntries& more = {}) {
    joints_ += thing(kind, name, {{"MarkerI", "/A/" + I}, {"MarkerJ", "/A/" + J}}) + entries(4, more);
  }

  void motion(const std::string& kind, const std::string& name, const AsmtEntries& more) {
    motions_ += thing(kind, name, more);
  }
  void limit(const std::string& kind, const std::string& name, const AsmtEntries& more) {
    limits_ += thing(kind, name, more);
  }

  std::string text() const {
    std::string text = header + "\nAssembly\n" + entries(1, {{"Notes", ""}, {"Name", "A"}}) + frame(1, {}) +
                       "\tRefPoints\n" + markers_ + "\tRefCurves\n\tRefSurfaces\n\tParts\n";
    for (const Part& one : parts_) {
      text += "\t\tPart\n" + entries(3, {{"Name", one.name}}) + one.frame + "\t\t\tPrincipalMassMarker\n" +
              entries(4, {{"Name", "MassMarker"}}) + frame(4, {}) +
              entries(4, {{"Mass", fmt::format("{}", one.mass)}, {"MomentOfInertias", one.moments}, {"Density", "1"}}) +
              "\t\t\tRefPoints\n" + one.markers + "\t\t\tRefCurves\n\t\t\tRefSurfaces\n";
    }
    text += "\tKinematicIJs\n\tConstraintSets\n\t\tJoints\n" + joints_ + "\t\tMotions\n" + motions_;
    if (!limits_.empty()) text += "\t\tLimits\n" + limits_;
    return text + "\t\tGeneralConstraintSets\n\tForceTorques\n" + entries(1, {{"ConstantGravity", gravity}}) + after;
  }

 private:
  struct Part {
    std::string name, frame;
    double mass;
    std::string moments, markers;
  };

  static std::string tabs(int depth) { return std::string(static_cast<std::size_t>(depth), '\t'); }

  static std::string entries(int depth, const AsmtEntries& all) {
    std::string text;
    for (const auto& [key, value] : all) text += tabs(depth) + key + "\n" + tabs(depth + 1) + value + "\n";
    return text;
  }

  static std::string frame(int depth, const Pose& pose) {
    const Eigen::Matrix3d& R = pose.R;
    std::string text =
        entries(depth, {{"Position3D", fmt::format("{}\t{}\t{}\t", pose.p.x(), pose.p.y(), pose.p.z())}}) +
        tabs(depth) + "RotationMatrix\n";
    for (int i = 0; i < 3; ++i) text += fmt::format("{}{}\t{}\t{}\t\n", tabs(depth + 1), R(i, 0), R(i, 1), R(i, 2));
    return text;
  }

  static std::string ref_point(int depth, const std::string& name, const Pose& pose) {
    return tabs(depth) + "RefPoint\n" + frame(depth + 1, {}) + tabs(depth + 1) + "Markers\n" + tabs(depth + 2) +
           "Marker\n" + entries(depth + 3, {{"Name", name}}) + frame(depth + 3, pose);
  }

  static std::string thing(const std::string& kind, const std::string& name, const AsmtEntries& more) {
    return tabs(3) + kind + "\n" + entries(4, {{"Name", name}}) + entries(4, more);
  }

  std::string markers_, joints_, motions_, limits_;
  std::vector<Part> parts_;
};

}  // namespace ferrers::witness
