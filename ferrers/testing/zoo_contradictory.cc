#include "ferrers/testing/zoo_contradictory.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>

#include "ferrers/testing/zoo_parts.h"

namespace ferrers::witness {
namespace {

PoseSpec pose_spec(const Eigen::Isometry3d& frame) {
  PoseSpec pose;
  pose.position = numbers(frame.translation());
  const Eigen::Quaterniond u(frame.linear());
  RotationSpec rotation;
  rotation.quaternion = std::array<Number, 4>{Number(u.w()), Number(u.x()), Number(u.y()), Number(u.z())};
  pose.rotation = rotation;
  return pose;
}

BodySpec posed_body(const std::string& name, const Eigen::Isometry3d& frame) {
  BodySpec body;
  body.name = name;
  body.pose = pose_spec(frame);
  return body;
}

/// A joint given on each body by itself.
JointSpec body_fixed(JointType type, const std::string& name, const std::string& first, const Eigen::Isometry3d& on_1,
                     const std::string& second, const Eigen::Isometry3d& on_2) {
  JointSpec j;
  j.type = type;
  j.name = name;
  j.bodies = {NameRef(first), NameRef(second)};
  j.place.on_body = {{first, numbers(on_1.translation())}, {second, numbers(on_2.translation())}};
  j.axis.on_body = {{first, numbers(on_1.linear().col(2))}, {second, numbers(on_2.linear().col(2))}};
  return j;
}

}  // namespace

ModelSpec make_bennett_links(double error_m) {
  const double alpha = 50 * std::numbers::pi / 180, beta = 110 * std::numbers::pi / 180;
  const double a = 1, b = a * std::sin(beta) / std::sin(alpha), turn = 0.9;
  const double other =
      2 * std::atan(std::sin((beta + alpha) / 2) / (std::sin((beta - alpha) / 2) * std::tan(turn / 2)));
  const std::array<double, 4> turns = {turn, other, -turn, -other}, twists = {alpha, beta, alpha, beta};
  const std::array<double, 4> sides = {a, b, a, b}, made = {a, b + error_m, a, b};
  // From a joint's frame to the next one's: along the common normal x by the side, turned about it by the twist.
  const auto link = [&](double side, int i) {
    return Eigen::Isometry3d(Eigen::Translation3d(side, 0, 0) * Eigen::AngleAxisd(twists[i], Point::UnitX()));
  };
  ModelSpec spec;
  spec.name = "bennett_links";
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  for (int i = 0; i < 4; ++i) {  // ground is the fourth link: J1 at its origin, J4 behind it
    const std::string last = i == 0 ? "ground" : numbered("link", i),
                      next = i == 3 ? "ground" : numbered("link", i + 1);
    const Eigen::Isometry3d on_last = i == 0 ? Eigen::Isometry3d::Identity() : link(made[i - 1], i - 1);
    const Eigen::Isometry3d on_next = i == 3 ? link(b, 3).inverse() : Eigen::Isometry3d::Identity();
    spec.joints.push_back(body_fixed(JointType::kRevolute, numbered("J", i + 1), last, on_last, next, on_next));
    frame = frame * Eigen::AngleAxisd(turns[i], Point::UnitZ());
    if (i < 3) spec.bodies.push_back(posed_body(next, frame));
    frame = frame * link(sides[i], i);
  }
  return spec;
}

ModelSpec make_arm_on_rods(const std::vector<std::array<double, 3>>& feet, const std::vector<double>& lengths_m) {
  ModelSpec spec;
  spec.name = "arm_on_rods";
  spec.bodies = {rod_body("arm", {0, 0, 0}, {1, 0, 0}, 1)};
  spec.joints = {joint(JointType::kRevolute, "pin", "ground", "arm", {0, 0, 0})};
  for (std::size_t i = 0; i < feet.size(); ++i) {
    const Point foot(feet[i][0], feet[i][1], feet[i][2]);
    spec.joints.push_back(distance_joint(numbered("rod", static_cast<int>(i)), "ground", "arm", foot, {1, 0, 0}));
    spec.joints.back().length = Number(lengths_m[i]);
  }
  return spec;
}

ModelSpec make_door_with_odd_hinge(double offset_m, double tilt_rad) {
  ModelSpec spec;
  spec.name = "odd_door";
  const Eigen::Isometry3d origin = Eigen::Isometry3d::Identity();
  const Eigen::Isometry3d upper(Eigen::Translation3d(0, 0, 1.7));
  const Eigen::Isometry3d odd = Eigen::Translation3d(offset_m, 0, 1.7) * Eigen::AngleAxisd(tilt_rad, Point::UnitX());
  spec.bodies = {posed_body("leaf", origin)};
  spec.joints = {body_fixed(JointType::kRevolute, "lower", "ground", origin, "leaf", origin),
                 body_fixed(JointType::kRevolute, "upper", "ground", upper, "leaf", odd)};
  return spec;
}

ModelSpec make_plate_on_skew_guides(double turn_rad) {
  ModelSpec spec;
  spec.name = "skew_guides";
  Eigen::Isometry3d along = Eigen::Isometry3d::Identity();  // z along the guide
  along.linear().col(2) = Point::UnitX();
  const Eigen::Isometry3d turned = Eigen::AngleAxisd(turn_rad, Point::UnitZ()) * along;
  spec.bodies = {posed_body("plate", Eigen::Isometry3d::Identity())};
  spec.joints = {body_fixed(JointType::kPrismatic, "left", "ground", along, "plate", along),
                 body_fixed(JointType::kPrismatic, "right", "ground", along, "plate", turned)};
  return spec;
}

void set_stiffness(ModelSpec& spec, double force, double moment) {
  for (JointSpec& j : spec.joints) {
    StiffnessSpec stiffness;
    stiffness.force = number3(force, force, force);
    stiffness.moment = number3(moment, moment, moment);
    j.stiffness = stiffness;
  }
}

}  // namespace ferrers::witness
