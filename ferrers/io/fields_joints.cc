#include "ferrers/io/field_tables.h"
#include "ferrers/model/joints/joint_type.h"

namespace ferrers {
namespace {

using K = ValueKind;

FieldInfo place_field() {
  return required(field("at", K::kPlace, kOfLength,
                        "Point of the joint as drawn; or where it sits on each body: {crank: [...], rod: [...]}"));
}

/// The keys that place a joint, by the rule of its type.
std::vector<FieldInfo> placement_fields(PlacementRule rule) {
  const FieldInfo axis = field("axis", K::kAxis, kOfPureNumber, "Direction of the axis, fixed to the first body");
  switch (rule) {
    case PlacementRule::kPoint:
      return {place_field()};
    case PlacementRule::kPointAxis:
      return {place_field(), required(axis)};
    case PlacementRule::kPointTwoAxes:
      return {
          place_field(),
          required(field("axes", K::kAxisPair, kOfPureNumber,
                         "First axis, fixed to the first body; second, fixed to the second; perpendicular as drawn"))};
    case PlacementRule::kPointNormal:
      return {place_field(),
              required(field("normal", K::kAxis, kOfPureNumber, "Normal of the plane, fixed to the first body"))};
    case PlacementRule::kTwoPoints:
      return {required(field("points", K::kPoints, kOfLength, "End on the first body, end on the second")),
              field("length", K::kNumber, kOfLength, "Distance of the ends", "as drawn")};
    case PlacementRule::kMesh: {
      FieldInfo mesh_axis = axis;
      mesh_axis.doc = "Direction of the two gears' axes";
      mesh_axis.default_text = "that of the bodies' revolute joints";
      return {place_field(),
              required(field("line_of_action", K::kDirection, kOfPureNumber, "Along it the teeth press on each other")),
              mesh_axis,
              field("centers", K::kPointPair, kOfLength, "Centre of the first gear and of the second, as drawn",
                    "the points of the bodies' revolute joints")};
    }
    case PlacementRule::kNone:
      break;
  }
  FieldInfo at = place_field();
  at.required = false;
  at.doc = "Point of the second body whose motion the coordinates are";
  at.default_text = "the second body's mass centre, else the origin of its pose";
  return {at};
}

/// The keys of `placement_fields` in words.
std::string placement_words(PlacementRule rule) {
  std::string words;
  for (const FieldInfo& one : placement_fields(rule)) {
    words += (words.empty() ? "`" : ", `") + std::string(one.key) + "`";
  }
  return words;
}

/// What a reader of the results must know of a type beyond its counts.
std::string joint_remark(JointType type) {
  if (type != JointType::kGearMesh) return {};
  return " The joint's frame has x along the line of action as drawn and turns with the first body: in joint axes the "
         "tooth force has both x and y once that body has turned.";
}

std::string joint_doc(const JointTypeInfo& info) {
  std::string coordinates;
  for (const CoordinateInfo& coordinate : info.coordinates) {
    coordinates += (coordinates.empty() ? "" : ", ") + std::string("`") + std::string(coordinate.name) + "`";
  }
  return "Freedoms " + std::to_string(info.freedoms()) + ", constraint rows " + std::to_string(info.row_count()) +
         (coordinates.empty() ? ", no coordinates." : "; coordinates: " + coordinates + ".") + joint_remark(info.type);
}

ObjectType joint_type(const JointTypeInfo& info) {
  const bool vowel = std::string_view("aeiou").find(info.name.front()) != std::string_view::npos;
  ObjectType type{info.name, (vowel ? "an " : "a ") + std::string(info.name) + " joint", joint_doc(info), {}};
  type.fields.push_back(required(field("bodies", K::kNamePair, {}, "First and second body")));
  const bool by_frames = info.placement != PlacementRule::kTwoPoints && info.placement != PlacementRule::kMesh;
  for (FieldInfo& placement : placement_fields(info.placement)) {
    type.fields.push_back(by_frames ? unless("frames", std::move(placement)) : std::move(placement));
  }
  if (by_frames) {
    type.fields.push_back(object_field("frames", K::kObject, Family::kJointFrames,
                                       "The joint's frame on each body, instead of " + placement_words(info.placement),
                                       "none"));
  }
  if (info.type == JointType::kWeld) {
    type.fields.push_back(field("merge", K::kBoolean, {},
                                "Whether its bodies are one rigid group: the weld then bears no reactions", "false"));
  }
  if (info.type == JointType::kScrew) {
    type.fields.push_back(
        required(field("lead", K::kNumber, kOfLength, "Advance of the second body per turn, right-handed")));
  }
  const bool x_is_open = info.placement == PlacementRule::kPointAxis || info.placement == PlacementRule::kPointNormal ||
                         info.placement == PlacementRule::kTwoPoints;
  if (x_is_open) {
    FieldInfo x = field("x", K::kDirection, kOfPureNumber,
                        "Direction of the x axis of the joint's frame, made perpendicular to z",
                        "the world axis least aligned with z");
    type.fields.push_back(by_frames ? unless("frames", std::move(x)) : std::move(x));
  }
  type.fields.push_back(object_field("stiffness", K::kObject, Family::kJointStiffness,
                                     "Stiffness by which reactions that statics leaves open are divided", "rigid"));
  type.fields.push_back(object_field("misalignment", K::kObject, Family::kMisalignment,
                                     "Where the second body's seat lies off its drawn place", "none"));
  if (info.coordinates.size() == 1) {
    type.fields.push_back(
        field("limits", K::kNumberPair, kOfCoordinate, "Least and greatest value of the coordinate", "none"));
  }
  if (info.freedoms() > 0) {
    type.fields.push_back(object_field("friction", K::kObject, Family::kFriction, "Friction in the joint", "none"));
  }
  return type;
}

ObjectFamily joint_family() {
  ObjectFamily family{
      Family::kJoint,
      "joint",
      "a joint",
      "type",
      false,
      {},
      "Joins two bodies. As drawn, every joint coordinate is zero. A coordinate is the motion of the second "
      "body relative to the first.",
      {}};
  for (const JointTypeInfo* info : all_joint_types()) family.types.push_back(joint_type(*info));
  return family;
}

ObjectFamily single(Family id, std::string_view name, std::string_view title, std::string doc,
                    std::vector<FieldInfo> fields) {
  ObjectFamily family{id, name, title, {}, false, {}, std::move(doc), {}};
  family.types.push_back({{}, std::string(title), {}, std::move(fields)});
  return family;
}

ObjectFamily constraint_family() {
  ObjectFamily family{
      Family::kConstraint,
      "constraint",
      "a constraint",
      {},
      false,
      "position",
      "A formula that is zero. It reads joint coordinates (`main.position`, `ball_screw.angle`), "
      "generalized coordinates (`theta`), recorded points in world axes (`P.x`), parameters and `t`. It "
      "is one row among the others, named after itself, in every verdict on redundancy.",
      {}};
  family.types = {
      {"position",
       "a constraint on positions",
       "A point on a curve, a cam, a cable of given length, equal angles, a prescribed distance.",
       {required(field("position", K::kExpression, {}, "The formula of positions and time"))}},
      {"velocity",
       "a constraint on velocities",
       "Rolling and other conditions that are linear in the velocities (`theta.velocity`, `P.x.velocity`).",
       {required(field("velocity", K::kExpression, {}, "The formula, linear in velocities"))}},
  };
  return family;
}

ObjectFamily general_coordinate_family() {
  ObjectFamily family{Family::kGeneralCoordinate,
                      "general_coordinate",
                      "a generalized coordinate",
                      {},
                      false,
                      "unit",
                      "Formulas read its value by its name and its rate as `name.velocity`; drives, couplings, initial "
                      "values and forces on joints take it like a joint.",
                      {}};
  family.types.push_back({{},
                          "a generalized coordinate",
                          {},
                          {required(field("unit", K::kText, {}, "Of its SI value: `rad`, `m`, `1`, `m^2`")),
                           field("guess", K::kNumber, kOfAny, "Where the assembly starts", "0"),
                           field("limits", K::kNumberPair, kOfAny, "Lowest and highest value", "none")}});
  return family;
}

ObjectFamily lagrangian_family() {
  ObjectFamily family{Family::kLagrangian,
                      "lagrangian",
                      "a Lagrangian system",
                      {},
                      false,
                      {},
                      "Generalized coordinates q, and T, V and forces over q, v, the parameters and t: motion by "
                      "d/dt(∂T/∂v) − ∂T/∂q = −∂V/∂q − ∂R/∂v + Q + Gᵀ lambda. Beside bodies the formulas may read joint "
                      "coordinates and points too, and add to what the bodies give.",
                      {}};
  family.types.push_back(
      {{},
       "a Lagrangian system",
       {},
       {object_field("coordinates", K::kNamedObjects, Family::kGeneralCoordinate, "Generalized coordinates", "none"),
        field("kinetic_energy", K::kExpression, {}, "T [J], of coordinates, velocities and time", "0"),
        field("mass_matrix", K::kFormulaMatrix, {}, "Instead of T: M(q), T = ½ vᵀ M v, in the order of the coordinates",
              "none"),
        field("potential_energy", K::kExpression, {}, "V [J], of coordinates and time", "0"),
        field("dissipation", K::kExpression, {}, "Rayleigh's function R [W]: forces −∂R/∂v", "0"),
        field("forces", K::kCoordinateFormulas, {}, "Generalized forces Q along coordinates [J per unit]", "none"),
        object_field("constraints", K::kNamedObjects, Family::kConstraint,
                     "As `constraints` of the model: these come first", "none")}});
  return family;
}

ObjectFamily coupling_family() {
  ObjectFamily family{Family::kCoupling,
                      "coupling",
                      "a coupling",
                      "type",
                      false,
                      {},
                      "Joins joint coordinates; holds as drawn, where all are zero.",
                      {}};
  family.types = {
      {"gear",
       "a gear coupling",
       "With `joints: [a, b]`: b = ratio · a.",
       {required(field("joints", K::kCoordinateList, {}, "Two joints, or joint.coordinate")),
        required(field("ratio", K::kNumber, kOfAny,
                       "Second coordinate per first; rad per m and the like where they differ"))}},
      {"linear",
       "a linear coupling",
       "Σ coefficient · coordinate = 0.",
       {required(field("joints", K::kCoordinateList, {}, "Joints, or joint.coordinate")),
        required(field("coefficients", K::kNumberList, kOfAny, "One per joint"))}},
  };
  return family;
}

}  // namespace

std::vector<ObjectFamily> make_joint_families() {
  return {
      joint_family(),
      single(Family::kJointStiffness, "joint_stiffness", "a joint's stiffness",
             "In the joint's frame (of a gear mesh: x along its line of action, however its gears have turned); one "
             "number stands for three, the word "
             "`rigid` for a component that does not give.",
             {field("force", K::kStiffness3, kOfStiffness, "Along x, y, z", "rigid"),
              field("moment", K::kStiffness3, kOfTorsionStiffness, "About x, y, z", "rigid")}),
      single(Family::kMisalignment, "misalignment", "a misalignment",
             "Displacement of the second body's seat from its drawn place, in the joint's frame.",
             {field("translation", K::kVector3, kOfLength, "Along x, y, z", "[0, 0, 0]"),
              field("rotation", K::kVector3, kOfAngle, "About x, y, z (a small rotation vector)", "[0, 0, 0]")}),
      single(
          Family::kJointFrames, "joint_frames", "a joint's frames",
          "Where the joint sits on its two bodies, each in that body's own frame (its `pose`; of ground and of a body "
          "without a pose: the world). z is the axis or normal; the first axis of a universal joint is z of the first "
          "frame, its second axis x of the second. Coordinates are zero where the two frames coincide. A loop of "
          "such joints need not close as drawn: it is assembled.",
          {required(object_field("first", K::kObject, Family::kPose, "On the first body")),
           required(object_field("second", K::kObject, Family::kPose, "On the second body"))}),
      single(
          Family::kFriction, "friction", "a joint's friction",
          "Friction along the joint's freedoms. `coulomb` is for revolute, prismatic, cylindrical, planar, spherical, "
          "point_on_line and point_on_plane joints; dynamics refuses it in the others. It brakes with "
          "coulomb · N · tanh(speed / s0), N the force of the reaction, plus its moment / `radius` where the joint "
          "slides and has a `radius`; s0 is 1 mm/s, or 0.001 rad/s in a joint that only turns. So nothing quite "
          "sticks: what pushes with the part p of the greatest friction makes the joint creep at s0 · artanh(p). "
          "A revolute or spherical joint needs the `radius`; a cylindrical or planar one without it slides with "
          "friction and turns without; point_on_line and point_on_plane do not use it.",
          {field("viscous", K::kNumber, kOfCoordinateDamping,
                 "Effort per speed, for each coordinate; without coordinates: moment per relative angular velocity, "
                 "force per sliding velocity (not in distance and gear_mesh)",
                 "0"),
           field("coulomb", K::kNumber, kOfPureNumber,
                 "Dry friction: this times the force that presses the joint's parts together", "0"),
           field("radius", K::kNumber, kOfLength,
                 "Where the parts touch: lever of dry friction in what turns, of moments in what slides; revolute "
                 "and spherical joints with `coulomb` need it",
                 "0")}),
      coupling_family(),
      constraint_family(),
      lagrangian_family(),
      general_coordinate_family(),
  };
}

}  // namespace ferrers
