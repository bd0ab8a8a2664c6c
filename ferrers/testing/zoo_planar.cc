#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>

#include "ferrers/testing/zoo.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers::witness {
namespace {

constexpr JointType kR = JointType::kRevolute;
constexpr JointType kP = JointType::kPrismatic;
constexpr JointType kC = JointType::kCylindrical;
constexpr JointType kS = JointType::kSpherical;

ModelSpec planar_spec(const std::string& name) {
  ModelSpec spec;
  spec.name = name;
  spec.gravity = number3(0, -9.81, 0);
  return spec;
}

}  // namespace

ModelSpec make_four_bar(FourBarJoints joints) {
  const Point o(0, 0, 0), a(0.3, 0.9, 0), b(2, 1.5, 0), c(1.8, 0, 0);
  JointType at_a = kR, at_b = kR;
  ModelSpec spec = planar_spec("four_bar_rrrr");
  if (joints == FourBarJoints::kSphericalCylindrical) {
    spec.name = "four_bar_rscr";
    at_a = kS;
    at_b = kC;
  } else if (joints == FourBarJoints::kTwoSpherical) {
    spec.name = "four_bar_rssr";
    at_a = at_b = kS;
  }
  spec.bodies = {bar_body("crank", o, a, 1.2, 0.03), bar_body("coupler", a, b, 2.0, 0.03),
                 bar_body("rocker", b, c, 1.6, 0.03)};
  spec.joints = {joint(kR, "O", "ground", "crank", o), joint(at_a, "A", "crank", "coupler", a),
                 joint(at_b, "B", "coupler", "rocker", b), joint(kR, "C", "rocker", "ground", c)};
  return spec;
}

// C is the upper intersection of the circles of radius 2 about A (1, 0) and √13 about B (4, 0):
// x = 1 + d, d = (9 + 4 − 13) / (2·3) = 0, so C = (1, 2).
ModelSpec make_driven_four_bar() {
  const Point o(0, 0, 0), a(1, 0, 0), c(1, 2, 0), b(4, 0, 0);
  ModelSpec spec = planar_spec("driven_four_bar");
  spec.bodies = {rod_body("crank", o, a, 1), rod_body("coupler", a, c, 2), rod_body("rocker", c, b, 4)};
  spec.joints = {joint(kR, "O", "ground", "crank", o), joint(kR, "A", "crank", "coupler", a),
                 joint(kR, "C", "coupler", "rocker", c), joint(kR, "B", "ground", "rocker", b)};
  spec.drives = {coordinate_drive("motor", "O", "1.2*(1 - cos(2*t))")};
  return spec;
}

ModelSpec make_parallel_cranks(double crank_angle_rad) {
  const Point arm(std::cos(crank_angle_rad), std::sin(crank_angle_rad), 0);
  ModelSpec spec = planar_spec("parallel_cranks");
  for (int i = 0; i < 3; ++i) {
    const Point foot(1.3 * i, 0, 0);
    const std::string crank = numbered("crank", i + 1);
    spec.bodies.push_back(bar_body(crank, foot, foot + arm, 1, 0.03));
    spec.joints.push_back(joint(kR, numbered("foot", i + 1), "ground", crank, foot));
    spec.joints.push_back(joint(kR, numbered("tip", i + 1), crank, "platform", foot + arm));
  }
  spec.bodies.push_back(box_body("platform", Point(1.3, 0, 0) + arm, {2.8, 0.1, 0.4}, 6));
  return spec;
}

// Published as benchmark A02 of the IFToMM multibody library; on its parallelogram branch all cranks turn alike.
ModelSpec make_n_four_bar(int loops, double crank_angle_rad, double crank_speed) {
  const Point arm(std::sin(crank_angle_rad), std::cos(crank_angle_rad), 0);
  ModelSpec spec = planar_spec(numbered("n_four_bar", loops));
  for (int i = 0; i <= loops; ++i) {
    const Point foot(i, 0, 0);
    spec.bodies.push_back(rod_body(numbered("crank", i), foot, foot + arm, 1));
    spec.joints.push_back(joint(kR, numbered("foot", i), "ground", numbered("crank", i), foot));
  }
  for (int i = 1; i <= loops; ++i) {
    const Point left = Point(i - 1, 0, 0) + arm, right = Point(i, 0, 0) + arm;
    spec.bodies.push_back(rod_body(numbered("coupler", i), left, right, 1));
    spec.joints.push_back(joint(kR, numbered("left", i), numbered("crank", i - 1), numbered("coupler", i), left));
    spec.joints.push_back(joint(kR, numbered("right", i), numbered("crank", i), numbered("coupler", i), right));
  }
  if (crank_speed != 0) spec.initial = {initial_velocity("foot0", -crank_speed)};
  spec.records = {record("B0", "crank0", arm)};
  return spec;
}

ModelSpec make_slider_crank(SliderCrankJoints joints, double crank_angle_rad) {
  constexpr double kCrank = 0.2, kRod = 0.5;
  const bool determinate = joints == SliderCrankJoints::kSphericalCylindrical;
  const Point o(0, 0, 0), a(kCrank * std::cos(crank_angle_rad), kCrank * std::sin(crank_angle_rad), 0);
  const Point b(a.x() + std::sqrt(kRod * kRod - a.y() * a.y()), 0, 0);
  ModelSpec spec = planar_spec(determinate ? "slider_crank_rsrc" : "slider_crank_rrrp");
  spec.bodies = {rod_body("crank", o, a, 2), rod_body("rod", a, b, 3), box_body("slider", b, {0.1, 0.08, 0.08}, 4)};
  spec.joints = {joint(kR, "O", "ground", "crank", o), joint(determinate ? kS : kR, "A", "crank", "rod", a),
                 joint(kR, "B", "rod", "slider", b),
                 joint(determinate ? kC : kP, "guide", "ground", "slider", b, Point::UnitX())};
  spec.drives = {coordinate_drive("motor", "O", "30*t")};
  spec.initial = {initial_velocity("O", 30)};
  return spec;
}

// All in one plane z = 0. The planet pushes back on both flanks with the same tangential force, so the lines of action
// lean outwards at the sun and inwards at the ring. The planets' radial pin forces balance between the two meshes and
// are unique; no planet is drawn along an axis of its pin, where one component alone would be that radial force.
ModelSpec make_planetary(int planets) {
  constexpr double kSun = 1, kPlanet = 0.7, kArm = kSun + kPlanet, kRing = kArm + kPlanet;
  const double pressure = 20 * std::numbers::pi / 180;
  ModelSpec spec = planar_spec(numbered("planetary", planets));
  const Point o(0, 0, 0), z = Point::UnitZ();
  spec.bodies = {bar_body("sun", {0, 0, -0.1}, {0, 0, 0.1}, 6, kSun),
                 bar_body("carrier", {0, 0, -0.25}, {0, 0, -0.15}, 4, kArm)};
  spec.joints = {joint(kR, "sun_bearing", "ground", "sun", o), joint(kR, "carrier_bearing", "ground", "carrier", o)};
  for (int i = 0; i < planets; ++i) {
    const double direction = 0.3 + 2 * std::numbers::pi * i / planets;
    const Point e(std::cos(direction), std::sin(direction), 0), tangent = z.cross(e);
    const std::string planet = numbered("planet", i + 1);
    const Point half(0, 0, 0.1), centre = kArm * e;
    spec.bodies.push_back(bar_body(planet, centre - half, centre + half, 2, kPlanet));
    spec.joints.push_back(joint(kR, planet + "_pin", "carrier", planet, centre));
    spec.joints.push_back(mesh_joint(planet + "_sun", "sun", planet, kSun * e,
                                     std::cos(pressure) * tangent + std::sin(pressure) * e, z, o, centre));
    spec.joints.push_back(mesh_joint(planet + "_ring", "ground", planet, kRing * e,
                                     std::cos(pressure) * tangent - std::sin(pressure) * e, z, o, centre));
  }
  return spec;
}

ModelSpec make_scissor_lift(int stages) {
  const double width = 2 * std::cos(0.5), rise = 2 * std::sin(0.5);
  ModelSpec spec = planar_spec(numbered("scissor_lift", stages));
  const auto left = [&](int level) { return Point(0, level * rise, 0); };
  const auto right = [&](int level) { return Point(width, level * rise, 0); };
  for (int i = 1; i <= stages; ++i) {
    const std::string a = numbered("bar_a", i), b = numbered("bar_b", i);
    spec.bodies.push_back(bar_body(a, left(i - 1), right(i), 4, 0.03));
    spec.bodies.push_back(bar_body(b, right(i - 1), left(i), 4, 0.03));
    spec.joints.push_back(joint(kR, numbered("middle", i), a, b, 0.5 * (left(i - 1) + right(i))));
    if (i == 1) {
      spec.joints.push_back(joint(kR, "bottom_pin", "ground", a, left(0)));
      spec.joints.push_back(joint(kR, "bottom_axle", b, "bottom_roller", right(0)));
      spec.joints.push_back(joint(kP, "bottom_track", "ground", "bottom_roller", right(0), Point::UnitX()));
    } else {
      spec.joints.push_back(joint(kR, numbered("left", i - 1), numbered("bar_b", i - 1), a, left(i - 1)));
      spec.joints.push_back(joint(kR, numbered("right", i - 1), numbered("bar_a", i - 1), b, right(i - 1)));
    }
  }
  const Point small(0.1, 0.1, 0.1), middle = 0.5 * (left(stages) + right(stages));
  spec.bodies.push_back(box_body("bottom_roller", right(0), small, 0.5));
  spec.bodies.push_back(box_body("top_roller", right(stages), small, 0.5));
  spec.bodies.push_back(box_body("platform", middle, {width + 0.2, 0.1, 1}, 30));
  spec.joints.push_back(joint(kR, "top_pin", "platform", numbered("bar_b", stages), left(stages)));
  spec.joints.push_back(joint(kR, "top_axle", numbered("bar_a", stages), "top_roller", right(stages)));
  spec.joints.push_back(joint(kP, "top_track", "platform", "top_roller", right(stages), Point::UnitX()));
  return spec;
}

namespace {

/// Hydraulic cylinder between two pins along y: barrel on `from`, rod on `to`.
void add_cylinder(ModelSpec& spec, const std::string& name, const std::string& from, const Point& foot,
                  const std::string& to, const Point& head) {
  const Point axis = (head - foot).normalized(), y = Point::UnitY();
  const double length = (head - foot).norm();
  const std::string barrel = name + "_barrel", rod = name + "_rod";
  spec.bodies.push_back(bar_body(barrel, foot, foot + 0.6 * length * axis, 60, 0.08));
  spec.bodies.push_back(bar_body(rod, foot + 0.4 * length * axis, head, 40, 0.05));
  spec.joints.push_back(joint(kR, name + "_foot", from, barrel, foot, y));
  spec.joints.push_back(joint(kP, name + "_stroke", barrel, rod, 0.5 * (foot + head), axis));
  spec.joints.push_back(joint(kR, name + "_head", rod, to, head, y));
}

}  // namespace

ModelSpec make_excavator() {
  const Point y = Point::UnitY();
  const Point boom_foot(0, 0, 0), boom_tip(4.6, 0, 2.4), bucket_pin(6.2, 0, 0.3), rocker_pin(5.9, 0, 0.75);
  const Point rocker_end(6.35, 0, 0.95), link_end(6.6, 0, 0.4);
  ModelSpec spec;
  spec.name = "excavator";
  spec.bodies = {bar_body("boom", boom_foot, boom_tip, 900, 0.2), bar_body("arm", {4.2, 0, 2.9}, bucket_pin, 450, 0.15),
                 box_body("bucket", {6.5, 0, -0.2}, {0.8, 1.0, 0.8}, 350),
                 bar_body("rocker", rocker_pin, rocker_end, 30, 0.05),
                 bar_body("link", rocker_end, link_end, 25, 0.05)};
  spec.joints = {
      joint(kR, "boom_pin", "ground", "boom", boom_foot, y),    joint(kR, "arm_pin", "boom", "arm", boom_tip, y),
      joint(kR, "bucket_pin", "arm", "bucket", bucket_pin, y),  joint(kR, "rocker_pin", "arm", "rocker", rocker_pin, y),
      joint(kR, "rocker_end", "rocker", "link", rocker_end, y), joint(kR, "link_end", "link", "bucket", link_end, y)};
  add_cylinder(spec, "boom_cylinder", "ground", {0.7, 0, -0.4}, "boom", {2.5, 0, 1.7});
  add_cylinder(spec, "arm_cylinder", "boom", {2.4, 0, 2.0}, "arm", {4.2, 0, 2.9});
  add_cylinder(spec, "bucket_cylinder", "arm", {4.6, 0, 2.75}, "rocker", {6.2, 0, 1.0});
  return spec;
}

namespace {

struct AndrewsPoints {
  Point O, F, E, A, B, C, G, H, D;
  std::array<Point, 7> centre;
};

// Geometry and constants from the IVP test set (the seven-body mechanism), at the published consistent start.
AndrewsPoints andrews_points() {
  constexpr double kBeta = -0.0617138900142764496, kTheta = 0, kGamma = 0.455279819163070380;
  constexpr double kPhi = 0.222668390165885885, kDelta = 0.487364979543842550, kOmega = -0.222668390165885885;
  constexpr double kEpsilon = 1.23054744454982120;
  constexpr double kD = 0.028, kDa = 0.0115, kE = 0.02, kEa = 0.01421, kRr = 0.007, kRa = 0.00092, kSa = 0.01874,
                   kSb = 0.01043, kSc = 0.018, kSd = 0.02, kTa = 0.02308, kTb = 0.00916, kU = 0.04, kUa = 0.01228,
                   kUb = 0.00449, kZf = 0.02, kZt = 0.04, kFa = 0.01421;
  const auto ray = [](double angle) { return Point(std::cos(angle), std::sin(angle), 0); };
  const auto left_of = [](const Point& p) { return Point(-p.y(), p.x(), 0); };
  AndrewsPoints p;
  p.O = Point::Zero();
  p.A = Point(-0.06934, -0.00227, 0);
  p.B = Point(-0.03635, 0.03273, 0);
  p.C = Point(0.014, 0.072, 0);
  const Point crank = ray(kBeta), second = ray(kBeta + kTheta), third = ray(kGamma);
  p.F = kRr * crank;
  p.E = p.F - kD * second;
  p.G = p.A + kZt * ray(kDelta);
  p.H = p.A - kU * left_of(ray(kEpsilon));
  p.D = p.B + kSd * third - kSc * left_of(third);
  p.centre[0] = kRa * crank;
  p.centre[1] = p.F - kDa * second;
  p.centre[2] = p.B + kSb * third - kSa * left_of(third);
  p.centre[3] = p.G - (kE - kEa) * left_of(ray(kPhi + kDelta));
  p.centre[4] = p.A + kTa * ray(kDelta) + kTb * left_of(ray(kDelta));
  p.centre[5] = p.H + (kZf - kFa) * ray(kOmega + kEpsilon);
  p.centre[6] = p.A - kUb * ray(kEpsilon) - kUa * left_of(ray(kEpsilon));
  return p;
}

}  // namespace

ModelSpec make_andrews() {
  constexpr std::array<double, 7> kMass = {.04325, .00365, .02373, .00706, .07050, .00706, .05498};
  constexpr std::array<double, 7> kInertia = {2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5};
  const AndrewsPoints p = andrews_points();
  ModelSpec spec;
  spec.name = "andrews";
  spec.gravity = number3(0, 0, 0);
  for (int i = 0; i < 7; ++i) {  // flat bodies: only the inertia about z is given, and only it matters
    const Eigen::Matrix3d I = Eigen::Vector3d(0.5, 0.5, 1).asDiagonal() * kInertia[i];
    spec.bodies.push_back(tensor_body(numbered("K", i + 1), p.centre[i], I, kMass[i]));
  }
  spec.joints = {joint(kR, "O", "ground", "K1", p.O),  joint(kR, "F", "K1", "K2", p.F),
                 joint(kR, "E3", "K2", "K3", p.E),     joint(kR, "E4", "K2", "K4", p.E),
                 joint(kR, "E6", "K2", "K6", p.E),     joint(kR, "B", "ground", "K3", p.B),
                 joint(kR, "A5", "ground", "K5", p.A), joint(kR, "A7", "ground", "K7", p.A),
                 joint(kR, "G", "K4", "K5", p.G),      joint(kR, "H", "K6", "K7", p.H)};
  SpringSpec spring;
  spring.bodies = {NameRef("ground"), NameRef("K3")};
  spring.points = {numbers(p.C), numbers(p.D)};
  spring.stiffness = 4530;
  spring.free_length = Number(0.07785);
  ForceSpec force;
  force.name = "spring";
  force.element = spring;
  spec.forces = {force};
  spec.drives = {coordinate_drive("motor", "O", "", "0.033")};
  return spec;
}

}  // namespace ferrers::witness
