#include "ferrers/io/field_tables.h"

namespace ferrers {
namespace {

using K = ValueKind;

ObjectFamily model_family() {
  ObjectFamily family{Family::kModel, "model", "a model", {}, false, {}, "One file describes one mechanism.", {}};
  family.types.push_back(
      {{},
       "a model",
       {},
       {required(field("ferrers", K::kVersion, {}, "Version of this format")),
        field("name", K::kText, {}, "Name of the mechanism", "the name of the file"),
        field("doc", K::kText, {}, "What the mechanism is, for readers"),
        field("gravity", K::kVector3, kOfAcceleration, "Acceleration of free fall, world axes", "[0, 0, -9.81]"),
        object_field("parameters", K::kNamedObjects, Family::kParameter,
                     "Numbers that others are computed from; in any order, without cycles"),
        object_field("bodies", K::kNamedObjects, Family::kBody,
                     "Rigid bodies; `ground` always exists and is not written here. Needed where there is no "
                     "`lagrangian`"),
        object_field("joints", K::kNamedObjects, Family::kJoint, "Joints between two bodies each"),
        object_field("couplings", K::kNamedObjects, Family::kCoupling, "Linear relations between joint coordinates"),
        object_field("constraints", K::kNamedObjects, Family::kConstraint,
                     "Formulas of coordinates, points and time that are zero"),
        object_field("lagrangian", K::kObject, Family::kLagrangian,
                     "Generalized coordinates with energies and forces by formulas, instead of bodies or beside them"),
        object_field("forces", K::kNamedObjects, Family::kForceElement, "Springs, dampers and given forces"),
        object_field("drives", K::kNamedObjects, Family::kDrive, "Motors: given motions and given efforts"),
        law_field("motions", K::kCoordinateLaws, kOfCoordinate,
                  "Prescribed motions of coordinates that no drive sits on, for `inverse` and `kinematics`: the drives "
                  "without an effort law bring them about"),
        object_field("initial", K::kNamedLists, Family::kInitial,
                     "By joint: where it starts and how fast; a list of maps for several of its coordinates"),
        object_field("record", K::kNamedObjects, Family::kRecord,
                     "Points and formulas that are written with the results"),
        object_field("events", K::kNamedObjects, Family::kEvent, "What happens when a formula passes through zero")}});
  return family;
}

ObjectFamily parameter_family() {
  ObjectFamily family{Family::kParameter,
                      "parameter",
                      "a parameter",
                      {},
                      false,
                      "value",
                      "A number by name, which any other number may use after '='.",
                      {}};
  family.types.push_back(
      {{},
       "a parameter",
       {},
       {required(field("value", K::kNumber, kOfAny, "Its value; a unit here is the unit of the parameter")),
        field("min", K::kNumber, kOfAny, "Least value that makes sense", "no bound"),
        field("max", K::kNumber, kOfAny, "Greatest value that makes sense", "no bound"),
        field("tolerance", K::kNumber, kOfAny, "Manufacturing tolerance (half width)", "exact"),
        field("doc", K::kText, {}, "What it is, for readers")}});
  return family;
}

ObjectFamily body_family() {
  ObjectFamily family{Family::kBody,
                      "body",
                      "a body",
                      {},
                      false,
                      {},
                      "A rigid body, drawn in world coordinates, or in its own frame where it has a `pose`.",
                      {}};
  family.types.push_back(
      {{},
       "a body",
       {},
       {field("mass", K::kNumber, kOfMass, "Mass; `analyze` needs none", "not given"),
        field("com", K::kVector3, kOfLength, "Mass centre; needed with a mass unless the shape has end points",
              "the middle of the shape's end points"),
        object_field("inertia", K::kObject, Family::kBodyInertia, "Inertia about the mass centre", "a point mass"),
        object_field("pose", K::kObject, Family::kPose,
                     "Frame of the body in the world: its `com`, inertia and places given per body are in this frame",
                     "the world frame")}});
  return family;
}

ObjectFamily inertia_family() {
  const FieldInfo rotation =
      object_field("rotation", K::kObject, Family::kRotation, "Turns the axes of the tensor or shape", "none");
  ObjectFamily family{
      Family::kBodyInertia,
      "inertia",
      "an inertia",
      "shape",
      true,
      {},
      "Inertia about the mass centre: a tensor (no `shape`), or a solid and uniform shape with the body's "
      "mass.",
      {}};
  family.types = {
      {{},
       "an inertia tensor",
       "Thin rods (equality in the triangle inequality) and points are valid.",
       {required(field("moments", K::kVector3, kOfInertia, "Ixx, Iyy, Izz")),
        field("products", K::kVector3, kOfInertia, "Ixy, Ixz, Iyz: entries of the tensor (−∫xy dm)", "[0, 0, 0]"),
        field("unphysical", K::kBoolean, {},
              "Whether one principal moment may exceed the sum of the others, as in files of other programs", "false"),
        rotation}},
      {"point", "a point mass", "No moment about its centre.", {}},
      {"rod",
       "a rod",
       "A thin rod between two points.",
       {required(field("from", K::kVector3, kOfLength, "One end")),
        required(field("to", K::kVector3, kOfLength, "The other end"))}},
      {"box", "a box", {}, {required(field("size", K::kVector3, kOfLength, "Edge lengths along its axes")), rotation}},
      {"cylinder",
       "a cylinder",
       {},
       {required(field("from", K::kVector3, kOfLength, "Centre of one end face")),
        required(field("to", K::kVector3, kOfLength, "Centre of the other")),
        required(field("radius", K::kNumber, kOfLength, "Radius"))}},
      {"sphere", "a sphere", {}, {required(field("radius", K::kNumber, kOfLength, "Radius"))}},
  };
  return family;
}

ObjectFamily pose_family() {
  ObjectFamily family{Family::kPose,
                      "pose",
                      "a pose",
                      {},
                      false,
                      {},
                      "A frame: of a body in the world as drawn, or of a joint on its body.",
                      {}};
  family.types.push_back(
      {{},
       "a pose",
       {},
       {field("position", K::kVector3, kOfLength, "Its origin", "[0, 0, 0]"),
        object_field("rotation", K::kObject, Family::kRotation, "Its axes against those of the world, or of the body",
                     "none"),
        field("quaternion", K::kVector4, kOfPureNumber, "The same as a quaternion, instead of `rotation`", "none")}});
  return family;
}

ObjectFamily rotation_family() {
  ObjectFamily family{
      Family::kRotation, "rotation", "a rotation", {}, false, {}, "About an axis, or by a quaternion.", {}};
  family.types = {
      {"axis",
       "a rotation about an axis",
       {},
       {required(field("axis", K::kDirection, kOfPureNumber, "Direction of the axis; any length but zero")),
        required(field("angle", K::kNumber, kOfAngle, "Angle, right-handed"))}},
      {"quaternion",
       "a rotation by a quaternion",
       {},
       {required(field("quaternion", K::kVector4, kOfPureNumber, "w, x, y, z; made a unit quaternion"))}},
  };
  return family;
}

}  // namespace

std::vector<ObjectFamily> make_body_families() {
  return {model_family(), parameter_family(), body_family(), inertia_family(), pose_family(), rotation_family()};
}

}  // namespace ferrers
