#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ferrers/formats/imported_model.h"
#include "ferrers/formats/name_map.h"
#include "ferrers/formats/urdf_tree.h"
#include "ferrers/formats/xml_document.h"

/// The parts of a URDF file, each read into one import by a function of its own. They are called in this order.
namespace ferrers {

/// Something that occurs many times and is told once.
struct UrdfTally {
  SourceRange first;
  int count = 0;
  void add(SourceRange at) {
    if (count++ == 0) first = at;
  }
};

struct UrdfImport {
  const ImportContext& context;
  XmlElement robot;
  UrdfTree tree;
  NameMap names;
  ImportedModel model;
  UrdfTally dry_friction, reductions, empty_limits;

  Diagnostics& diagnostics() const { return context.diagnostics; }
  ModelSpec& spec() { return model.spec; }
  const UrdfLink& link(int index) const { return tree.links[static_cast<std::size_t>(index)]; }
  const UrdfJoint& joint(int index) const { return tree.joints[static_cast<std::size_t>(index)]; }
  /// A drive on the joint, unless it has one; not on a joint without a single coordinate, which is told as F604.
  void add_drive(int joint, std::string_view name, SourceRange at);
};

/// Bodies of the links, and what they look like; the root link stands or floats as the options say.
void import_urdf_links(UrdfImport& import);
/// Boxes, cylinders, spheres, capsules and meshes of the links.
void import_urdf_visuals(UrdfImport& import);
/// How the root link stands: welded to ground, or floating. Nothing where it is the ground.
void import_urdf_base(UrdfImport& import);
/// Joints with limits, damping, mimic couplings.
void import_urdf_joints(UrdfImport& import);
/// `<loop>` and `<coupling>`.
void import_urdf_loops(UrdfImport& import);
/// `<transmission>`: drives and inertias of rotors.
void import_urdf_transmissions(UrdfImport& import);

/// A file of closures: which frames coincide, which joints are of another type, which carry motors.
struct UrdfClosures {
  struct Loop {
    std::string first, second;  ///< Links or joints.
    bool whole_frame = true;    ///< Else the origins only.
    std::string place;          ///< "robot.yaml:1:14", for messages.
  };
  struct Named {
    std::string name, type;
    std::string place;
  };
  std::vector<Loop> loops;
  std::vector<Named> joint_types, motors;
  std::string file;
};

/// Reads the file of closures that the options name; nothing where there is none or it has errors, which are told with
/// its name, line and column.
std::optional<UrdfClosures> read_urdf_closures(const ImportContext& context);
/// Puts the types of `joint_types` in the place of those of the file; before the joints are imported.
void replace_urdf_joint_types(UrdfImport& import, const UrdfClosures& closures);
/// Adds closing joints and motors; after the joints are imported.
void import_urdf_closures(UrdfImport& import, const UrdfClosures& closures);

}  // namespace ferrers
