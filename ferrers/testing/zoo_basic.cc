#include "ferrers/testing/zoo.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers::witness {

ModelSpec make_pendulum() {
  ModelSpec spec;
  spec.name = "pendulum";
  spec.gravity = number3(0, -9.81, 0);
  BodySpec bob;
  bob.name = "bob";
  bob.mass = Number(1.0);
  bob.com = number3(1, 0, 0);
  spec.bodies = {bob};
  spec.joints = {joint(JointType::kRevolute, "pivot", "ground", "bob", {0, 0, 0})};
  spec.records = {record("P", "bob", {1, 0, 0})};
  return spec;
}

ModelSpec make_door(int hinges) {
  ModelSpec spec;
  spec.name = numbered("door", hinges);
  spec.bodies = {box_body("door", {0.45, 0, 0.85}, {0.9, 0.04, 2.0}, 20)};
  for (int i = 0; i < hinges; ++i) {
    const double z = hinges > 1 ? 1.7 * i / (hinges - 1) : 0.85;
    spec.joints.push_back(joint(JointType::kRevolute, numbered("hinge", i + 1), "ground", "door", {0, 0, z}));
  }
  return spec;
}

ModelSpec make_shaft_determinate() {
  ModelSpec spec;
  spec.name = "shaft_determinate";
  spec.bodies = {bar_body("shaft", {0, 0, -0.1}, {0, 0, 1.3}, 5, 0.03)};
  spec.joints = {joint(JointType::kSpherical, "fixed", "ground", "shaft", {0, 0, 0}),
                 joint(JointType::kPointOnLine, "floating", "ground", "shaft", {0, 0, 1})};
  return spec;
}

ModelSpec make_shaft_overconstrained() {
  ModelSpec spec;
  spec.name = "shaft_overconstrained";
  spec.bodies = {bar_body("shaft", {0, 0, -0.1}, {0, 0, 2.2}, 8, 0.03)};
  spec.joints = {joint(JointType::kRevolute, "fixed", "ground", "shaft", {0, 0, 0}),
                 joint(JointType::kCylindrical, "middle", "ground", "shaft", {0, 0, 1}),
                 joint(JointType::kCylindrical, "end", "ground", "shaft", {0, 0, 2})};
  return spec;
}

}  // namespace ferrers::witness
