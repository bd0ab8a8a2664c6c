#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "ferrers/formats/mjcf_tree.h"
#include "ferrers/formats/name_map.h"
#include "ferrers/model/pose_spec.h"

/// How the parts of an MJCF file become parts of a specification.
namespace ferrers::mjcf {

/// What the parts share while a specification is filled.
struct Import {
  Element root;
  Settings settings;
  Defaults defaults;
  Tree tree;
  const ImportOptions& options;
  ImportedModel result;
  NameMap names;

  ModelSpec& spec() { return result.spec; }
  const TreeBody& body(int index) const { return tree.bodies[static_cast<std::size_t>(index)]; }
};

/// A fixed tendon: a weighted sum of joint coordinates.
struct FixedTendon {
  std::vector<std::pair<std::pair<int, int>, double>> terms;  ///< Body and joint; coefficient.
  Element element;
};
using FixedTendons = std::map<std::string, FixedTendon, std::less<>>;

Number3 vector_spec(const Vector3d& v);
Expression position_of(const TreeJoint& joint);  ///< As formulas read it.

/// A joint by its name in the file, or nothing after a message (F604). `scalar`: hinges and slides only.
const TreeJoint* find_joint(const Import& import, const Element& element, std::string_view attribute, bool scalar);
/// A body by its name in the file: its index, or -1 after a message (F604).
int find_body(const Import& import, const Element& element, std::string_view attribute);

void apply_base(Import& import);        ///< `ImportOptions::base`.
void add_bodies(Import& import);        ///< With their masses (mjcf_bodies.cc).
void add_joints(Import& import);        ///< With massless bodies between several joints of a body.
void add_joint_forces(Import& import);  ///< Springs, dampers, rotors, compensated weight (mjcf_forces.cc).
/// Stiffness and damping of joints that have a time constant and a damping ratio (mjcf_springdamper.cc).
void resolve_springdampers(Import& import);
void add_visuals(Import& import);                                  ///< What the geoms look like (mjcf_visuals.cc).
FixedTendons read_tendons(Import& import);                         ///< (mjcf_tendons.cc)
void add_equalities(Import& import, const FixedTendons& tendons);  ///< (mjcf_equality.cc)
void add_drives(Import& import, const FixedTendons& tendons);      ///< (mjcf_actuators.cc)
void add_initial_state(Import& import);                            ///< The first key (mjcf_keyframe.cc).

}  // namespace ferrers::mjcf
