// SDF files as sdformat's own parser resolves them, beside what Ferrers reads: poses of links, mass properties, places
// and axes of joints. Built only where sdformat 12 is installed.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sdf/Joint.hh>
#include <sdf/JointAxis.hh>
#include <sdf/Link.hh>
#include <sdf/Model.hh>
#include <sdf/Root.hh>
#include <sdf/World.hh>
#include <sdf/sdf.hh>
#include <sstream>
#include <string>

#include "ferrers/formats/sdf.h"

namespace ferrers {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kAgreement = 1e-12;
const std::filesystem::path kFolder = std::filesystem::path(FERRERS_SOURCE_DIR) / "tests/models/formats/sdf";

Vector3d vector_of(const ignition::math::Vector3d& v) { return {v.X(), v.Y(), v.Z()}; }
Vector3d vector_of(const Number3& n) { return {n[0].value, n[1].value, n[2].value}; }
Matrix3d rotation_of(const RotationSpec& spec) {
  const auto& q = *spec.quaternion;
  return Eigen::Quaterniond(q[0].value, q[1].value, q[2].value, q[3].value).toRotationMatrix();
}
Pose pose_of(const ignition::math::Pose3d& pose) {
  const ignition::math::Quaterniond& q = pose.Rot();
  return {Eigen::Quaterniond(q.W(), q.X(), q.Y(), q.Z()).normalized().toRotationMatrix(), vector_of(pose.Pos())};
}
Pose pose_of(const PoseSpec& spec) {
  return {spec.rotation ? rotation_of(*spec.rotation) : Matrix3d::Identity(), vector_of(spec.position)};
}

std::string text_of(const std::filesystem::path& path) {
  std::ifstream stream(path);
  std::stringstream text;
  text << stream.rdbuf();
  return stream ? text.str() : "";
}

class Comparison {
 public:
  explicit Comparison(const std::string& file) {
    const FileLoader load = [](const std::string& path) -> std::optional<std::string> {
      const std::string text = text_of(kFolder / path);
      return text.empty() ? std::nullopt : std::optional(text);
    };
    ours_ = read_sdf(text_of(kFolder / file), {options_, load, diagnostics_});
    for (const Diagnostic& one : diagnostics_.items()) EXPECT_NE(one.severity, Severity::kError) << one.message;
    sdf::setFindCallback([](const std::string& name) {
      const std::string path = name.rfind("model://", 0) == 0 ? name.substr(8) : name;
      return (kFolder / path).string();
    });
    for (const sdf::Error& error : root_.Load((kFolder / file).string())) ADD_FAILURE() << error.Message();
  }

  void run() {
    if (const sdf::World* world = root_.WorldByIndex(0)) {
      EXPECT_EQ(vector_of(world->Gravity()), vector_of(ours_.spec.gravity));
      for (std::uint64_t i = 0; i < world->ModelCount(); ++i) compare(*world->ModelByIndex(i), Pose(), "", false);
    } else {
      ASSERT_NE(root_.Model(), nullptr);
      compare(*root_.Model(), Pose(), "", false);
    }
    EXPECT_EQ(links_, ours_.spec.bodies.size());
  }

  std::size_t joints() const { return joints_; }

 private:
  /// In our names the outermost model that alone moves is left out, and a joint called as a link keeps its name, where
  /// sdformat adds "_joint" to it.
  std::string name_in_ours(const std::string& path, bool body) const {
    const std::string shorter = path.substr(path.find("::") + 2);
    const std::string own = shorter.ends_with("_joint") ? shorter.substr(0, shorter.size() - 6) : shorter;
    for (const std::string& candidate : {path, shorter, own}) {
      std::string name;
      for (std::size_t i = 0; i < candidate.size(); ++i) name += candidate[i] == ':' ? '_' : candidate[i];
      const auto same = [&](const auto& one) { return one.name.name == name; };
      const bool found = body ? std::any_of(ours_.spec.bodies.begin(), ours_.spec.bodies.end(), same)
                              : std::any_of(ours_.spec.joints.begin(), ours_.spec.joints.end(), same);
      if (found) return name;
    }
    ADD_FAILURE() << "no " << path;
    return {};
  }

  const BodySpec& body(const std::string& name) const {
    return *std::find_if(ours_.spec.bodies.begin(), ours_.spec.bodies.end(),
                         [&](const BodySpec& one) { return one.name.name == name; });
  }

  static Pose resolved(const sdf::SemanticPose& pose, const std::string& in) {
    ignition::math::Pose3d found;
    for (const sdf::Error& error : pose.Resolve(found, in)) ADD_FAILURE() << error.Message();
    return pose_of(found);
  }

  static void expect_same(const Pose& ours, const Pose& theirs, const std::string& what) {
    EXPECT_LT((ours.p - theirs.p).norm(), kAgreement) << what;
    EXPECT_LT((ours.R - theirs.R).norm(), kAgreement) << what;
  }

  void compare(const sdf::Model& model, const Pose& X_WP, const std::string& before, bool is_static) {
    const Pose X_WM = X_WP * resolved(model.SemanticPose(), "");
    const std::string path = before + model.Name() + "::";
    is_static = is_static || model.Static();
    for (std::uint64_t i = 0; i < model.LinkCount() && !is_static; ++i) compare(*model.LinkByIndex(i), X_WM, path);
    for (std::uint64_t i = 0; i < model.JointCount() && !is_static; ++i) compare(*model.JointByIndex(i), X_WM, path);
    for (std::uint64_t i = 0; i < model.ModelCount(); ++i) compare(*model.ModelByIndex(i), X_WM, path, is_static);
  }

  void compare(const sdf::Link& link, const Pose& X_WM, const std::string& before) {
    ++links_;
    const std::string name = name_in_ours(before + link.Name(), true);
    if (name.empty()) return;
    const BodySpec& ours = body(name);
    expect_same(pose_of(*ours.pose), X_WM * resolved(link.SemanticPose(), "__model__"), name);
    const auto& theirs = link.Inertial();
    EXPECT_EQ(ours.mass->value, theirs.MassMatrix().Mass()) << name;
    EXPECT_LT((vector_of(*ours.com) - vector_of(theirs.Pose().Pos())).norm(), kAgreement) << name;
    Matrix3d tensor = vector_of(ours.inertia.moments).asDiagonal();
    const Vector3d products = vector_of(ours.inertia.products);
    tensor(0, 1) = tensor(1, 0) = products[0];
    tensor(0, 2) = tensor(2, 0) = products[1];
    tensor(1, 2) = tensor(2, 1) = products[2];
    const Matrix3d turn = ours.inertia.rotation ? rotation_of(*ours.inertia.rotation) : Matrix3d::Identity();
    const Matrix3d in_link = turn * tensor * turn.transpose();
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) EXPECT_NEAR(in_link(i, j), theirs.Moi()(i, j), kAgreement) << name;
    }
  }

  void compare(const sdf::Joint& joint, const Pose& X_WM, const std::string& before) {
    const std::string name = name_in_ours(before + joint.Name(), false);
    if (name.empty()) return;
    ++joints_;
    const JointSpec& ours = *std::find_if(ours_.spec.joints.begin(), ours_.spec.joints.end(),
                                          [&](const JointSpec& one) { return one.name.name == name; });
    std::string theirs;
    EXPECT_TRUE(joint.ResolveChildLink(theirs).empty());
    EXPECT_EQ(ours.bodies[1].name, name_in_ours(before + theirs, true)) << name;
    EXPECT_TRUE(joint.ResolveParentLink(theirs).empty());
    EXPECT_EQ(ours.bodies[0].name, theirs == "world" ? "ground" : name_in_ours(before + theirs, true)) << name;
    const Pose X_WJ = X_WM * resolved(joint.SemanticPose(), "__model__");
    for (const std::size_t side : {0u, 1u}) {
      const std::string& on = ours.bodies[side].name;
      const Pose X_WB = on == "ground" ? Pose() : pose_of(*body(on).pose);
      const Pose X_WF = X_WB * pose_of((*ours.frames)[side]);
      EXPECT_LT((X_WF.p - X_WJ.p).norm(), kAgreement) << name;
      for (const unsigned which : {0u, 1u}) {
        const sdf::JointAxis* axis = joint.Axis(which);
        if (axis == nullptr) continue;
        ignition::math::Vector3d direction;
        EXPECT_TRUE(axis->ResolveXyz(direction, "__model__").empty()) << name;
        EXPECT_LT((X_WF.R.col(which == 0 ? 2 : 0) - X_WM.R * vector_of(direction)).norm(), kAgreement) << name;
      }
    }
  }

  ImportOptions options_;
  Diagnostics diagnostics_;
  ImportedModel ours_;
  sdf::Root root_;
  std::size_t links_ = 0, joints_ = 0;
};

TEST(SdformatTest, FramesInFramesAreWhereSdformatHasThem) {
  Comparison comparison("frames.sdf");
  comparison.run();
  EXPECT_EQ(comparison.joints(), 3u);
}

TEST(SdformatTest, NestedModelsAreWhereSdformatHasThem) {
  Comparison comparison("nested.sdf");
  comparison.run();
  EXPECT_EQ(comparison.joints(), 3u);
}

TEST(SdformatTest, OlderVersionsAreUnderstoodAsSdformatDoes) {
  for (const char* const file : {"older.sdf", "oldest.sdf"}) {
    Comparison comparison(file);
    comparison.run();
    EXPECT_EQ(comparison.joints(), 2u);
  }
}

TEST(SdformatTest, IncludedAndMergedModelsAreWhereSdformatHasThem) {
  Comparison comparison("included.sdf");
  comparison.run();
  EXPECT_EQ(comparison.joints(), 4u);
}

}  // namespace
}  // namespace ferrers
