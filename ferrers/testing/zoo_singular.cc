#include <array>
#include <cmath>
#include <numbers>

#include "ferrers/testing/zoo.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers::witness {
namespace {

constexpr JointType kR = JointType::kRevolute;

void add_hinge(ModelSpec& spec, const std::string& name, const std::string& first, const std::string& second,
               const Point& at) {
  spec.joints.push_back(joint(kR, name, first, second, at));
}

}  // namespace

ModelSpec make_unequal_legs(double second) {
  ModelSpec spec;
  spec.name = "unequal_legs";
  const std::array<double, 3> x = {0, 1, 2.2}, length = {1, second, 1.1};
  for (int i = 0; i < 3; ++i) {
    const Point foot(x[i], 0, 0), tip(x[i], length[i], 0);
    const std::string leg = numbered("leg", i + 1);
    spec.bodies.push_back(bar_body(leg, foot, tip, 1, 0.03));
    add_hinge(spec, numbered("foot", i + 1), "ground", leg, foot);
    add_hinge(spec, numbered("tip", i + 1), leg, "platform", tip);
  }
  spec.bodies.push_back(box_body("platform", {1.1, 1.1, 0}, {2.4, 0.1, 0.4}, 5));
  return spec;
}

ModelSpec make_two_bars(double off) {
  ModelSpec spec;
  spec.name = "two_bars";
  const Point left(0, 0, 0), middle(1, off, 0), right(2.5, 0, 0);
  spec.bodies = {bar_body("bar1", left, middle, 1, 0.03), bar_body("bar2", middle, right, 1.5, 0.03)};
  add_hinge(spec, "left", "ground", "bar1", left);
  add_hinge(spec, "middle", "bar1", "bar2", middle);
  add_hinge(spec, "right", "bar2", "ground", right);
  return spec;
}

ModelSpec make_six_legs(LegEnds ends) {
  ModelSpec spec;
  spec.name = "six_legs";
  constexpr double kLength = 1.5;
  spec.bodies.push_back(box_body("platform", {0, 0, kLength}, {1.6, 1.6, 0.1}, 10));
  for (int i = 0; i < 6; ++i) {
    const double angle = 0.2 + i * std::numbers::pi / 3;
    const Point foot(std::cos(angle), std::sin(angle), 0), top = foot + Point(0, 0, kLength);
    const std::string leg = numbered("leg", i + 1);
    if (ends == LegEnds::kRods) {
      spec.joints.push_back(distance_joint(leg, "ground", "platform", foot, top));
      continue;
    }
    spec.bodies.push_back(bar_body(leg, foot, top, 1, 0.03));
    spec.joints.push_back(joint(JointType::kSpherical, numbered("foot", i + 1), "ground", leg, foot));
    spec.joints.push_back(
        ends == LegEnds::kSphericalSpherical
            ? joint(JointType::kSpherical, numbered("top", i + 1), leg, "platform", top)
            : universal_joint(numbered("top", i + 1), leg, "platform", top, Point::UnitX(), Point::UnitY()));
  }
  return spec;
}

ModelSpec make_cusp() {
  ModelSpec spec;
  spec.name = "cusp";
  const Point left(-1, 0.4, 0), top(0, 0.4, 0), bottom(0, -0.4, 0), right(1, -0.4, 0), middle(0, 0, 0), end(1.2, 0, 0);
  spec.bodies = {bar_body("left_arm", left, top, 1, 0.03), bar_body("right_arm", bottom, right, 1, 0.03),
                 bar_body("link", top, bottom, 1, 0.03), bar_body("bar", middle, end, 1, 0.03),
                 box_body("slider", end, {0.1, 0.2, 0.1}, 1)};
  add_hinge(spec, "A", "ground", "left_arm", left);
  add_hinge(spec, "B", "left_arm", "link", top);
  add_hinge(spec, "C", "link", "right_arm", bottom);
  add_hinge(spec, "D", "right_arm", "ground", right);
  add_hinge(spec, "E", "link", "bar", middle);
  add_hinge(spec, "F", "bar", "slider", end);
  spec.joints.push_back(joint(JointType::kPrismatic, "guide", "ground", "slider", end, Point::UnitY()));
  return spec;
}

// Euler-Savary on the axis of symmetry: cranks from (±2, 0) to (±1, 1) meet at I = (0, 2), at distances √2 of the pins
// and 2√2 of the centres under 45 degrees, so the inflection point is 1/D = (1/√2 − 1/(2√2))/√2 = 1/4 below I.
ModelSpec make_touching(bool upwards) {
  ModelSpec spec;
  spec.name = "touching";
  const Point left(-2, 0, 0), right(2, 0, 0), a(-1, 1, 0), b(1, 1, 0), p(0, -2, 0), end(0, upwards ? -0.8 : -3.2, 0);
  spec.bodies = {bar_body("left_crank", left, a, 1, 0.03), bar_body("right_crank", right, b, 1, 0.03),
                 box_body("coupler", {0, 0, 0}, {2, 1, 0.1}, 3), bar_body("bar", p, end, 1, 0.03),
                 box_body("slider", end, {0.2, 0.1, 0.1}, 1)};
  add_hinge(spec, "A", "ground", "left_crank", left);
  add_hinge(spec, "B", "left_crank", "coupler", a);
  add_hinge(spec, "C", "coupler", "right_crank", b);
  add_hinge(spec, "D", "right_crank", "ground", right);
  add_hinge(spec, "E", "coupler", "bar", p);
  add_hinge(spec, "F", "bar", "slider", end);
  spec.joints.push_back(joint(JointType::kPrismatic, "guide", "ground", "slider", end, Point::UnitX()));
  return spec;
}

}  // namespace ferrers::witness
