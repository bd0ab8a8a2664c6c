#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "ferrers/testing/zoo.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers::witness {

// Six revolutes whose axes follow the edges of a cube; published as benchmark A04 of the IFToMM multibody library.
ModelSpec make_bricard(BricardRods rods) {
  const std::array<Point, 6> at = {Point(0, 0, 0),  Point(1, 0, 0),  Point(1, -1, 0),
                                   Point(1, -1, 1), Point(0, -1, 1), Point(0, 0, 1)};
  const std::array<Point, 6> axis = {Point::UnitY(), Point::UnitZ(), Point::UnitX(),
                                     Point::UnitY(), Point::UnitZ(), Point::UnitX()};
  ModelSpec spec;
  spec.name = rods == BricardRods::kBricks ? "bricard" : "bricard_thin";
  spec.gravity = number3(0, -9.81, 0);
  for (int i = 0; i < 5; ++i) {
    const Point along = at[i + 1] - at[i];
    const Point size = along.cwiseAbs() + 0.1 * (Point::Ones() - along.cwiseAbs());
    spec.bodies.push_back(rods == BricardRods::kBricks ? box_body(numbered("rod", i + 1), at[i] + 0.5 * along, size, 1)
                                                       : rod_body(numbered("rod", i + 1), at[i], at[i + 1], 1));
  }
  for (int i = 0; i < 6; ++i) {
    const std::string first = i == 0 ? "ground" : numbered("rod", i);
    const std::string second = i == 5 ? "ground" : numbered("rod", i + 1);
    spec.joints.push_back(joint(JointType::kRevolute, numbered("J", i + 1), first, second, at[i], axis[i]));
  }
  spec.records = {record("P3", "rod2", at[2])};
  return spec;
}

// Each chain of parallel axes alone lets the platform move in its plane; together they leave the vertical, and both
// forbid the rotation about it: one redundant row.
ModelSpec make_sarrus(double angle_rad) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  ModelSpec spec;
  spec.name = "sarrus";
  const auto add_leg = [&](const std::string& leg, const Point& out, const Point& axis) {
    const Point foot = out, knee = out * (1 + c) + Point(0, 0, s), top = out + Point(0, 0, 2 * s);
    spec.bodies.push_back(bar_body(leg + "_lower", foot, knee, 1.0, 0.04));
    spec.bodies.push_back(bar_body(leg + "_upper", knee, top, 0.8, 0.04));
    spec.joints.push_back(joint(JointType::kRevolute, leg + "_foot", "ground", leg + "_lower", foot, axis));
    spec.joints.push_back(joint(JointType::kRevolute, leg + "_knee", leg + "_lower", leg + "_upper", knee, axis));
    spec.joints.push_back(joint(JointType::kRevolute, leg + "_top", leg + "_upper", "platform", top, axis));
  };
  add_leg("a", Point::UnitX(), Point::UnitY());
  add_leg("b", Point::UnitY(), Point::UnitX());
  spec.bodies.push_back(box_body("platform", {0.4, 0.4, 2 * s}, {1.2, 1.2, 0.05}, 3));
  return spec;
}

// G. T. Bennett (1903): equal opposite sides a, b and twists α, β with a sin β = b sin α. Closed form; here a = 1.
// Going round, each axis and point follows from the last by a turn θ about z, the side along x and the twist about x,
// with tan(θ₁/2) tan(θ₂/2) = sin((β + α)/2) / sin((β − α)/2).
ModelSpec make_bennett() {
  const double alpha = 50 * std::numbers::pi / 180, beta = 110 * std::numbers::pi / 180;
  const double a = 1, b = a * std::sin(beta) / std::sin(alpha);
  const double theta_1 = 0.9;
  const double theta_2 =
      2 * std::atan(std::sin((beta + alpha) / 2) / (std::sin((beta - alpha) / 2) * std::tan(theta_1 / 2)));
  const std::array<double, 3> turn = {theta_1, theta_2, -theta_1}, side = {a, b, a}, twist = {alpha, beta, alpha};
  std::array<Point, 4> at, axis;
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  at[0] = Point::Zero();
  axis[0] = Point::UnitZ();
  for (int i = 0; i < 3; ++i) {
    frame = frame * Eigen::AngleAxisd(turn[i], Point::UnitZ()) * Eigen::Translation3d(side[i], 0, 0) *
            Eigen::AngleAxisd(twist[i], Point::UnitX());
    at[i + 1] = frame.translation();
    axis[i + 1] = frame.linear().col(2);
  }
  ModelSpec spec;
  spec.name = "bennett";
  for (int i = 0; i < 3; ++i)
    spec.bodies.push_back(bar_body(numbered("link", i + 1), at[i], at[i + 1], 1 + 0.2 * i, 0.03));
  for (int i = 0; i < 4; ++i) {
    const std::string first = i == 0 ? "ground" : numbered("link", i);
    const std::string second = i == 3 ? "ground" : numbered("link", i + 1);
    spec.joints.push_back(joint(JointType::kRevolute, numbered("J", i + 1), first, second, at[i], axis[i]));
  }
  return spec;
}

namespace {

/// Rod with square section and a point mass at its tip, as one body.
BodySpec flyball_arm(const std::string& name, const Point& hinge, const Point& direction) {
  constexpr double kRodMass = 0.3, kBallMass = 5, kWidth = 0.01, kLength = 1;
  const Point middle = hinge + 0.5 * kLength * direction, tip = hinge + kLength * direction;
  const double mass = kRodMass + kBallMass;
  const Point centre = (kRodMass * middle + kBallMass * tip) / mass;
  const Eigen::Matrix3d along = direction * direction.transpose();
  const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - along;
  const auto of_point = [&](double m, const Point& p) -> Eigen::Matrix3d {
    const Point r = p - centre;
    return m * (r.squaredNorm() * Eigen::Matrix3d::Identity() - r * r.transpose());
  };
  const Eigen::Matrix3d rod =
      kRodMass / 12 * (2 * kWidth * kWidth * along + (kLength * kLength + kWidth * kWidth) * across);
  return tensor_body(name, centre, rod + of_point(kRodMass, middle) + of_point(kBallMass, tip), mass);
}

}  // namespace

// Benchmark A05 of the IFToMM multibody library. Four joints in a tree: 20 rows, all independent.
ModelSpec make_flyball() {
  const double cosine = std::cos(std::numbers::pi / 6), sine = 0.5, s = 0.5;
  ModelSpec spec;
  spec.name = "flyball";
  spec.bodies.push_back(box_body("shaft", {0, 0, 0.5}, {0.01, 0.01, 1}, 0.3));
  spec.joints.push_back(joint(JointType::kRevolute, "spin", "ground", "shaft", {0, 0, 0}));
  for (const double side : {1.0, -1.0}) {
    const std::string mark = side > 0 ? "right" : "left";
    const Point hinge(0.05 * side, 0, 1), direction(cosine * side, 0, -sine);
    spec.bodies.push_back(flyball_arm("arm_" + mark, hinge, direction));
    spec.joints.push_back(joint(JointType::kRevolute, "hinge_" + mark, "shaft", "arm_" + mark, hinge, Point::UnitY()));
    SpringSpec spring;
    spring.bodies = {NameRef("arm_" + mark), NameRef("slider")};
    spring.points = {numbers(hinge + 0.5 * direction), number3(0.05 * side, 0, s)};
    spring.stiffness = 8e5;
    spring.damping = 4e4;
    spring.free_length = Number(0.5);
    ForceSpec force;
    force.name = "spring_" + mark;
    force.element = spring;
    spec.forces.push_back(force);
  }
  spec.bodies.push_back(box_body("slider", {0, 0, s}, {0.1, 0.1, 0.1}, 3));
  spec.joints.push_back(joint(JointType::kPrismatic, "slide", "shaft", "slider", {0, 0, s}));
  spec.initial = {initial_velocity("spin", 2 * std::numbers::pi), initial_velocity("hinge_right", 0),
                  initial_velocity("hinge_left", 0), initial_velocity("slide", 0)};
  spec.records = {record("S", "slider", {0, 0, s})};
  return spec;
}

}  // namespace ferrers::witness
