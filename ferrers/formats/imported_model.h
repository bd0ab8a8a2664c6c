#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "ferrers/core/diagnostics.h"
#include "ferrers/math/rotation.h"
#include "ferrers/model/spec.h"

/// What readers of other programs' files share: options, what they give, what they may ask for.
namespace ferrers {

enum class ImportBase {
  kAsInFile,  ///< URDF: the root link is fixed to ground; MJCF, SDF and ASMT: as the file says.
  kFixed,
  kFree,
};

struct ImportOptions {
  ImportBase base = ImportBase::kAsInFile;
  bool ignore_armature = false;  ///< Leaves out the inertias of rotors.
  bool ignore_springs = false;   ///< Leaves out springs of joints.
  bool ignore_damping = false;   ///< Leaves out damping and friction of joints.
  /// One joint for revolute joints in a row that stand for a spherical or universal one; absent: where the file closes
  /// loops, since these are assembled with it far better.
  std::optional<bool> merge_revolute_rows;
  bool keep_welds = false;  ///< Bodies that fixed joints hold together stay apart, and the joints bear reactions.
  /// URDF: the file of closed loops; absent: looked for beside the model.
  std::optional<std::filesystem::path> closures;
  bool closures_may_be_another_file = false;  ///< Found by their name: a file that holds no closures is let be.
};

/// A name that the native format does not allow, and what it became.
struct RenamedThing {
  std::string kind;  ///< "body", "joint", "drive", ...
  std::string original;
  std::string name;
};

/// What a body looks like, for viewers.
struct VisualShape {
  enum class Kind { kBox, kSphere, kCylinder, kCapsule, kEllipsoid, kMesh };
  std::string body;  ///< As in the specification; "ground" for what does not move.
  Kind kind = Kind::kMesh;
  /// kBox: edge lengths; kSphere: radius; kCylinder, kCapsule: radius, length along z; kEllipsoid: half axes;
  /// kMesh: scale.
  std::array<double, 3> size = {1, 1, 1};
  Pose X_BS;         ///< Of the shape in the body's drawing frame, m.
  std::string mesh;  ///< As written in the file.
  std::optional<std::array<double, 4>> rgba;
};

struct ImportedModel {
  ModelSpec spec;
  std::vector<RenamedThing> renamed;
  std::vector<VisualShape> visuals;
};

/// A fixed joint of a file makes one body of two, unless it holds them to the ground: what the base bears is asked for.
inline void mark_fixed(JointSpec& joint) {
  joint.merge = joint.bodies[0].name != "ground" && joint.bodies[1].name != "ground";
}

/// The text of a further file that a model names (an included one, a table), by its path as written; nothing where it
/// cannot be read. Readers touch no file themselves, so they can be tested and fuzzed on texts alone.
using FileLoader = std::function<std::optional<std::string>(const std::string& path)>;

/// What a reader works with. Its text outlives the call.
struct ImportContext {
  const ImportOptions& options;
  const FileLoader& load;
  Diagnostics& diagnostics;
};

}  // namespace ferrers
