#include "ferrers/io/field_tables.h"

namespace ferrers {
namespace {

using K = ValueKind;

FieldInfo bodies_field() { return required(field("bodies", K::kNamePair, {}, "First and second body")); }
FieldInfo points_field() {
  return required(field("points", K::kPoints, kOfLength,
                        "Point on the first body, point on the second; or a map from body to point"));
}
FieldInfo joint_field() {
  return required(field("joint", K::kCoordinate, {}, "The joint, or joint.coordinate where it has several"));
}
FieldInfo coordinate_field() {
  return field("coordinate", K::kName, {}, "Which coordinate of the joint", "its only one");
}
FieldInfo axes_field() { return choice_field("axes", {"world", "body"}, "Axes of the three components", "world"); }
FieldInfo weight_field() {
  return field(
      "weight", K::kNumber, kOfPureNumber,
      "Of its effort where more drives act than the motion needs: the sum of (weight · effort)², in N and N·m, "
      "is the least; with 1 / rated effort, that of the squared loads of the drives",
      "1");
}

ObjectFamily force_family() {
  ObjectFamily family{Family::kForceElement,
                      "force",
                      "a force",
                      "type",
                      false,
                      {},
                      "What acts on bodies besides gravity, joints and drives.",
                      {}};
  family.types = {
      {"spring",
       "a spring",
       "Pulls two points together along their line: stiffness · (length − free length) + damping · rate.",
       {bodies_field(), points_field(), required(field("stiffness", K::kNumber, kOfStiffness, "Force per length")),
        field("damping", K::kNumber, kOfDamping, "Force per speed", "0"),
        field("free_length", K::kNumber, kOfLength, "Length without force", "as drawn")}},
      {"torsion_spring",
       "a torsion spring",
       "Turns a joint coordinate towards its free angle.",
       {joint_field(), coordinate_field(),
        required(field("stiffness", K::kNumber, kOfTorsionStiffness, "Torque per angle")),
        field("damping", K::kNumber, kOfTorsionDamping, "Torque per angular speed", "0"),
        field("free_angle", K::kNumber, kOfAngle, "Angle without torque", "0, as drawn")}},
      {"joint_damping",
       "a joint damping",
       "Brakes a joint coordinate in proportion to its speed.",
       {joint_field(), coordinate_field(),
        required(field("damping", K::kNumber, kOfCoordinateDamping, "Effort per speed"))}},
      {"bushing",
       "a bushing",
       "A soft joint: stiffness and damping along and about three axes.",
       {bodies_field(), required(field("at", K::kPlace, kOfLength, "Its point as drawn, or on each body")),
        field("axis", K::kAxis, kOfPureNumber, "Direction of its z axis", "z"),
        field("x", K::kDirection, kOfPureNumber, "Direction of its x axis, made perpendicular to z",
              "the world axis least aligned with z"),
        required(
            object_field("stiffness", K::kObject, Family::kBushingStiffness, "Forces and moments per displacement")),
        object_field("damping", K::kObject, Family::kBushingDamping, "Forces and moments per speed", "none")}},
      {"force",
       "a force",
       "A given force at a point of a body.",
       {required(field("body", K::kName, {}, "On which body it acts")),
        required(field("at", K::kVector3, kOfLength, "Point of the body at which it acts, as drawn")),
        required(law_field("force", K::kLaw3, kOfForce, "Three components")), axes_field()}},
      {"torque",
       "a torque",
       "A given torque on a body.",
       {required(field("body", K::kName, {}, "On which body it acts")),
        required(law_field("torque", K::kLaw3, kOfTorque, "Three components")), axes_field()}},
  };
  return family;
}

ObjectFamily single(Family id, std::string_view name, std::string_view title, std::string doc,
                    std::vector<FieldInfo> fields) {
  ObjectFamily family{id, name, title, {}, false, {}, std::move(doc), {}};
  family.types.push_back({{}, std::string(title), {}, std::move(fields)});
  return family;
}

ObjectFamily record_family() {
  ObjectFamily family{Family::kRecord,
                      "record",
                      "a record",
                      {},
                      false,
                      "formula",
                      "What is written with the results. Formulas of the model read a recorded point as `P.x`, `P.y`, "
                      "`P.z`, world axes.",
                      {}};
  family.types = {
      {"formula",
       "a recorded formula",
       {},
       {required(field("formula", K::kExpression, {}, "Of time, coordinates, velocities and points"))}},
      {"body",
       "a recorded point",
       "A point fixed to a body.",
       {required(field("body", K::kName, {}, "The body that carries it")),
        required(field("at", K::kVector3, kOfLength, "The point, as drawn"))}},
  };
  return family;
}

ObjectFamily drive_family() {
  const std::string motion = "Given motion, for inverse dynamics, kinematics and driven simulation";
  const std::string effort = "Given effort, for simulation; positive drives the second body forward";
  ObjectFamily family{Family::kDrive,
                      "drive",
                      "a drive",
                      {},
                      false,
                      {},
                      "On a joint coordinate or generalized coordinate (`joint`), on the distance of two points "
                      "(`bodies`), on a recorded "
                      "point (`point`), on a `quantity` by a formula, or by its `map` d_j. Either law may be absent: "
                      "without a motion a drive acts by its effort, and without both it helps the "
                      "others in inverse dynamics and rests in simulation.",
                      {}};
  family.types = {
      {"joint",
       "a drive on a joint",
       {},
       {joint_field(), coordinate_field(), law_field("motion", K::kLaw, kOfCoordinate, motion, "none"),
        law_field("effort", K::kLaw, kOfCoordinateEffort, effort, "none"), weight_field()}},
      {"bodies",
       "a drive on a distance",
       {},
       {bodies_field(), points_field(), law_field("motion", K::kLaw, kOfLength, motion + ": the distance", "none"),
        law_field("effort", K::kLaw, kOfForce, effort + ": apart", "none"), weight_field()}},
      {"point",
       "a drive on a recorded point",
       {},
       {required(field("point", K::kName, {}, "Name of a recorded point")),
        law_field("motion", K::kLaw3, kOfLength, motion + ": the path, world axes", "none"),
        law_field("effort", K::kLaw3, kOfForce, effort + ", world axes", "none"), weight_field()}},
      {"quantity",
       "a drive on a quantity",
       {},
       {required(field("quantity", K::kExpression, {},
                       "A formula s of positions that the drive moves: it acts along d_j = ∂s/∂q_j")),
        law_field("motion", K::kLaw, kOfAny, motion + " of the quantity", "none"),
        law_field("effort", K::kLaw, kOfAny, effort + " [J per unit of the quantity]", "none"), weight_field()}},
      {"map",
       "a drive given by its map",
       {},
       {required(field("map", K::kCoordinateFormulas, {}, "d_j by coordinate: formulas of positions")),
        law_field("effort", K::kLaw, kOfAny, effort + ": the generalized forces are d_j times it", "none"),
        weight_field()}},
  };
  return family;
}

}  // namespace

std::vector<ObjectFamily> make_action_families() {
  return {
      force_family(),
      single(Family::kBushingStiffness, "bushing_stiffness", "a bushing's stiffness",
             "In the bushing's frame; one number stands for three.",
             {field("force", K::kVector3OrScalar, kOfStiffness, "Along x, y, z", "0"),
              field("moment", K::kVector3OrScalar, kOfTorsionStiffness, "About x, y, z", "0")}),
      single(Family::kBushingDamping, "bushing_damping", "a bushing's damping",
             "In the bushing's frame; one number stands for three.",
             {field("force", K::kVector3OrScalar, kOfDamping, "Along x, y, z", "0"),
              field("moment", K::kVector3OrScalar, kOfTorsionDamping, "About x, y, z", "0")}),
      drive_family(),
      single(
          Family::kInitial, "initial", "an initial value",
          "State of one joint at the start. A joint with several coordinates takes one map per coordinate, or all at "
          "once, in order. A `spherical` joint is given at once: position [qw, qx, qy, qz], a unit quaternion, "
          "velocity [omega_x, omega_y, omega_z]; so is a `free` joint: position [x, y, z, qw, qx, qy, qz], "
          "velocity [omega_x, omega_y, omega_z, v_x, v_y, v_z] (here the rotation comes first). All are relative to "
          "the first body, along axes that are the world's as drawn and turn with the first body. The quaternion is "
          "the rotation from the drawn pose, [1, 0, 0, 0] is as drawn; x, y, z is the way of the joint's point from "
          "its drawn place, and v_x, v_y, v_z its velocity.",
          {field("coordinate", K::kName, {}, "Which coordinate of the joint", "its only one, or all in order"),
           field("position", K::kNumberOrList, kOfCoordinate,
                 "Position, exact unless it is a guess; numbers without a unit are in rad and m", "found by assembly"),
           field("velocity", K::kNumberOrList, kOfCoordinateRate, "Velocity", "the least in the mass metric"),
           field("guess", K::kBoolean, {}, "Whether the position is only where the assembly starts", "false")}),
      record_family(),
      single(Family::kEvent, "event", "an event",
             "Acts when a formula passes through zero, in `simulate` only; `inverse` and `kinematics` say that they do "
             "not "
             "watch it.",
             {required(field("when", K::kExpression, {}, "The formula, of time and joint coordinates")),
              required(choice_field("do", {"stop", "record", "switch"},
                                    "End the run, write a row, or switch a drive off or on")),
              field("drive", K::kName, {}, "Which drive `switch` switches", "none")}),
      single(Family::kLawFile, "law_file", "a law from a file",
             "A law sampled in a CSV file; between the samples the natural cubic spline, beyond them its end tangents.",
             {required(field("file", K::kText, {}, "Path of the CSV file, from the model's folder and inside it")),
              field("column", K::kInteger, {}, "Column of the values, from 1; column 1 is the time in s", "2")}),
  };
}

}  // namespace ferrers
