#include "ferrers/testing/random_mechanism.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "ferrers/testing/random_source.h"
#include "ferrers/testing/transforms.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers::witness {
namespace {

constexpr JointType kR = JointType::kRevolute;
constexpr JointType kP = JointType::kPrismatic;

/// Grows a specification piece by piece.
class Grower {
 public:
  explicit Grower(std::uint64_t seed) : random_(seed) {}

  ModelSpec spec;
  std::string description;

  int loops() const { return static_cast<int>(spec.joints.size()) - static_cast<int>(spec.bodies.size()); }

  void grow() {
    spec.name = "random";
    spec.gravity = numbers(random_.direction() * 9.81);
    if (random_.chance(0.1)) {
      const std::string base = new_body(Point::Zero());
      add(joint(JointType::kFree, next_joint(), "ground", base, Point::Zero()));
      description = "free base";
    }
    const int pieces = 1 + random_.below(4);
    for (int i = 0; i < pieces && loops() < 5; ++i) add_piece();
    if (random_.chance(0.2)) hang_weld();
  }

 private:
  void add_piece() {
    base_ = random_body();
    frame_ = random_frame();
    struct Piece {
      const char* name;
      void (Grower::*make)();
      int loops;
    };
    static constexpr std::array<Piece, 15> kPieces = {{{"planar loop", &Grower::planar_loop, 1},
                                                       {"spherical loop", &Grower::spherical_loop, 1},
                                                       {"parallelogram", &Grower::parallelogram, 2},
                                                       {"bennett", &Grower::bennett, 1},
                                                       {"bricard", &Grower::bricard, 1},
                                                       {"double hinge", &Grower::double_hinge, 1},
                                                       {"double weld", &Grower::double_weld, 1},
                                                       {"geared and coupled", &Grower::geared_pair, 1},
                                                       {"slider", &Grower::slider, 1},
                                                       {"generic loop", &Grower::generic_loop, 1},
                                                       {"generic loop", &Grower::generic_loop, 1},
                                                       {"generic loop", &Grower::generic_loop, 1},
                                                       {"arm on rod", &Grower::arm_on_rod, 1},
                                                       {"arm on contact", &Grower::arm_on_contact, 1},
                                                       {"coupled hinges", &Grower::coupled_hinges, 0}}};
    const Piece& piece = kPieces[random_.below(static_cast<int>(kPieces.size()))];
    if (loops() + piece.loops > 5) return;
    description += (description.empty() ? "" : " + ") + std::string(piece.name);
    (this->*piece.make)();
  }

  // --- small things ---

  std::string next_joint() { return numbered("J", static_cast<int>(spec.joints.size()) + 1); }
  void add(JointSpec j) { spec.joints.push_back(std::move(j)); }

  std::string random_body() {
    const int i = random_.below(static_cast<int>(spec.bodies.size()) + 1);
    return i == 0 ? "ground" : spec.bodies[i - 1].name.name;
  }

  Eigen::Isometry3d random_frame() {
    Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
    frame.linear() = random_.rotation();
    frame.translation() = random_.vector(1.5);
    return frame;
  }

  /// A body with a full tensor, its mass centre near `near` (world).
  std::string new_body(const Point& near) {
    const std::string name = numbered("b", static_cast<int>(spec.bodies.size()) + 1);
    const Point half(random_.between(0.1, 0.5), random_.between(0.1, 0.5), random_.between(0.1, 0.5));
    const double mass = random_.between(0.5, 4);
    const Eigen::Matrix3d R = random_.rotation();
    const Point squares = half.cwiseProduct(half);
    const Point moments = mass * (squares.sum() * Point::Ones() - squares);
    spec.bodies.push_back(
        tensor_body(name, near + random_.vector(0.3), R * moments.asDiagonal() * R.transpose(), mass));
    return name;
  }

  Point at(double x, double y, double z) const { return frame_ * Point(x, y, z); }
  Point along(double x, double y, double z) const { return frame_.linear() * Point(x, y, z); }

  /// Closes base → new bodies → base over the given places: one body between neighbours.
  void close_loop(const std::vector<JointType>& types, const std::vector<Point>& places,
                  const std::vector<Point>& axes) {
    std::string last = base_;
    for (std::size_t i = 0; i < types.size(); ++i) {
      const bool closing = i + 1 == types.size();
      const std::string next = closing ? base_ : new_body(0.5 * (places[i] + places[i + 1]));
      add(make(types[i], last, next, places[i], axes[i]));
      last = next;
    }
  }

  JointSpec make(JointType type, const std::string& first, const std::string& second, const Point& place,
                 const Point& axis) {
    if (type == JointType::kUniversal) {
      const Point other = axis.cross(random_.direction()).normalized();
      return universal_joint(next_joint(), first, second, place, axis, other);
    }
    JointSpec j = joint(type, next_joint(), first, second, place, axis);
    if (type == JointType::kScrew) j.lead = Number(random_.between(0.05, 0.3));
    return j;
  }

  // --- redundant pieces ---

  void planar_loop() {
    const int n = 4 + random_.below(2);
    std::vector<JointType> types;
    std::vector<Point> places, axes;
    for (int i = 0; i < n; ++i) {
      const double turn = 2 * std::numbers::pi * (i + random_.between(-0.3, 0.3)) / n;
      const double radius = random_.between(0.6, 1.4);
      places.push_back(at(radius * std::cos(turn), radius * std::sin(turn), random_.between(-0.3, 0.3)));
      const bool slides = i == 1 && random_.chance(0.4);
      const double heading = random_.between(0, 6.28);
      types.push_back(slides ? kP : kR);
      axes.push_back(slides ? along(std::cos(heading), std::sin(heading), 0) : along(0, 0, 1));
    }
    close_loop(types, places, axes);
  }

  void spherical_loop() {
    const int n = 4 + random_.below(2);
    std::vector<Point> places, axes;
    for (int i = 0; i < n; ++i) {
      const double turn = 2 * std::numbers::pi * (i + random_.between(-0.25, 0.25)) / n;
      const double cone = random_.between(0.5, 1.1);
      axes.push_back(along(std::sin(cone) * std::cos(turn), std::sin(cone) * std::sin(turn), std::cos(cone)));
      places.push_back(at(0, 0, 0) + random_.between(0.5, 1.2) * axes.back());
    }
    close_loop(std::vector<JointType>(n, kR), places, axes);
  }

  void parallelogram() {
    const double turn = random_.between(0.4, 1.2) + (random_.chance(0.5) ? 1.2 : 0);
    const Point arm(std::cos(turn), std::sin(turn), 0);
    const int cranks = 2 + random_.below(2);
    std::vector<std::string> names;
    for (int i = 0; i < cranks; ++i) {
      names.push_back(new_body(frame_ * Point(1.2 * i, 0, 0)));
      add(joint(kR, next_joint(), base_, names.back(), at(1.2 * i, 0, 0.1 * i), along(0, 0, 1)));
    }
    const std::string platform = new_body(frame_ * arm);
    for (int i = 0; i < cranks; ++i) {
      add(joint(kR, next_joint(), names[i], platform, frame_ * (Point(1.2 * i, 0, 0.1 * i) + arm), along(0, 0, 1)));
    }
  }

  void bennett() {
    const double alpha = random_.between(0.6, 1.1), beta = random_.between(1.3, 2.2), a = random_.between(0.6, 1.2);
    const double b = a * std::sin(beta) / std::sin(alpha), turn = random_.between(0.5, 2.0);
    const double other =
        2 * std::atan(std::sin((beta + alpha) / 2) / (std::sin((beta - alpha) / 2) * std::tan(turn / 2)));
    const std::array<double, 3> turns = {turn, other, -turn}, sides = {a, b, a}, twists = {alpha, beta, alpha};
    Eigen::Isometry3d frame = frame_;
    std::vector<Point> places = {frame.translation()}, axes = {frame.linear().col(2)};
    for (int i = 0; i < 3; ++i) {
      frame = frame * Eigen::AngleAxisd(turns[i], Point::UnitZ()) * Eigen::Translation3d(sides[i], 0, 0) *
              Eigen::AngleAxisd(twists[i], Point::UnitX());
      places.push_back(frame.translation());
      axes.push_back(frame.linear().col(2));
    }
    close_loop(std::vector<JointType>(4, kR), places, axes);
  }

  void bricard() {
    close_loop(std::vector<JointType>(6, kR),
               {at(0, 0, 0), at(1, 0, 0), at(1, -1, 0), at(1, -1, 1), at(0, -1, 1), at(0, 0, 1)},
               {along(0, 1, 0), along(0, 0, 1), along(1, 0, 0), along(0, 1, 0), along(0, 0, 1), along(1, 0, 0)});
  }

  void double_hinge() {
    const std::string door = new_body(at(0.4, 0, 0));
    add(joint(kR, next_joint(), base_, door, at(0, 0, -0.6), along(0, 0, 1)));
    add(joint(random_.chance(0.5) ? kR : JointType::kCylindrical, next_joint(), base_, door, at(0, 0, 0.7),
              along(0, 0, 1)));
  }

  void double_weld() {
    const std::string bracket = new_body(at(0, 0, 0));
    add(joint(JointType::kWeld, next_joint(), base_, bracket, at(-0.3, 0, 0)));
    add(joint(JointType::kWeld, next_joint(), base_, bracket, at(0.4, 0.2, 0)));
  }

  void geared_pair() {
    const double r1 = random_.between(0.4, 1), r2 = random_.between(0.4, 1), pressure = 0.35;
    const std::string a = new_body(at(0, 0, 0)), b = new_body(at(r1 + r2, 0, 0));
    const std::string pin_a = next_joint();
    add(joint(kR, pin_a, base_, a, at(0, 0, 0), along(0, 0, 1)));
    const std::string pin_b = next_joint();
    add(joint(kR, pin_b, base_, b, at(r1 + r2, 0, 0), along(0, 0, 1)));
    add(mesh_joint(next_joint(), a, b, at(r1, 0, 0), along(std::sin(pressure), std::cos(pressure), 0), along(0, 0, 1),
                   at(0, 0, 0), at(r1 + r2, 0, 0)));
    if (random_.chance(0.6)) add_coupling(pin_a, r1, pin_b, r2);
  }

  /// R-R-R-P, or with the rod's ends spherical and universal: not redundant then.
  void slider() {
    const double turn = random_.between(0.4, 1.4), rod = random_.between(1.2, 1.8);
    const Point a(0.8 * std::cos(turn), 0.8 * std::sin(turn), 0);
    const Point b(a.x() + std::sqrt(rod * rod - a.y() * a.y()), 0, 0);
    std::vector<JointType> types = {kR, kR, kR, kP};
    if (random_.chance(0.4)) {
      types[1] = JointType::kSpherical;
      types[2] = JointType::kUniversal;
    }
    close_loop(types, {at(0, 0, 0), frame_ * a, frame_ * b, frame_ * b},
               {along(0, 0, 1), along(0, 0, 1), along(0, 0, 1), along(1, 0, 0)});
  }

  // --- pieces without redundancy ---

  void generic_loop() {
    static constexpr std::array<std::pair<JointType, int>, 9> kTypes = {{{kR, 1},
                                                                         {kR, 1},
                                                                         {kP, 1},
                                                                         {JointType::kScrew, 1},
                                                                         {JointType::kCylindrical, 2},
                                                                         {JointType::kUniversal, 2},
                                                                         {JointType::kSpherical, 3},
                                                                         {JointType::kPlanar, 3},
                                                                         {JointType::kPointOnLine, 4}}};
    std::vector<JointType> types;
    std::vector<Point> places, axes;
    int freedoms = 0;
    while (freedoms < 7 || types.size() < 3) {
      const auto& [type, f] = kTypes[random_.below(static_cast<int>(kTypes.size()))];
      types.push_back(type);
      freedoms += f;
      const double turn = 0.9 * static_cast<double>(types.size());
      places.push_back(at(std::cos(turn), std::sin(turn), 0) + random_.vector(0.4));
      axes.push_back(random_.direction());
    }
    close_loop(types, places, axes);
  }

  /// Two or three hinges and the tip's place.
  std::pair<std::string, Point> arm(int hinges) {
    std::string last = base_;
    Point place = at(0, 0, 0);
    for (int i = 0; i < hinges; ++i) {
      const std::string next = new_body(place);
      add(joint(kR, next_joint(), last, next, place, random_.direction()));
      place += random_.between(0.6, 1.1) * random_.direction();
      last = next;
    }
    return {last, place};
  }

  void arm_on_rod() {
    const auto [tip, place] = arm(2 + random_.below(2));
    add(distance_joint(next_joint(), base_, tip, place + random_.between(0.7, 1.2) * random_.direction(), place));
  }

  void arm_on_contact() {
    const bool line = random_.chance(0.5);
    const auto [tip, place] = arm(line ? 3 : 2);
    add(joint(line ? JointType::kPointOnLine : JointType::kPointOnPlane, next_joint(), base_, tip, place,
              random_.direction()));
  }

  void coupled_hinges() {
    const std::string a = new_body(at(0, 0, 0)), b = new_body(at(1, 0, 0));
    const std::string on_a = next_joint();
    add(joint(kR, on_a, base_, a, at(0, 0, 0), random_.direction()));
    const std::string on_b = next_joint();
    add(joint(random_.chance(0.5) ? kR : kP, on_b, a, b, at(1, 0, 0), random_.direction()));
    add_coupling(on_a, random_.between(0.5, 2), on_b, random_.between(-2, -0.5));
  }

  void hang_weld() {
    base_ = random_body();
    frame_ = random_frame();
    const std::string part = new_body(at(0, 0, 0));
    add(joint(JointType::kWeld, next_joint(), base_, part, at(0, 0, 0)));
    description += " + weld";
  }

  void add_coupling(const std::string& a, double coefficient_a, const std::string& b, double coefficient_b) {
    CouplingSpec coupling;
    coupling.name = numbered("C", static_cast<int>(spec.couplings.size()) + 1);
    coupling.coordinates = {CoordinateRef{NameRef(a), ""}, CoordinateRef{NameRef(b), ""}};
    coupling.coefficients = {Number(coefficient_a), Number(coefficient_b)};
    spec.couplings.push_back(coupling);
  }

  RandomSource random_;
  std::string base_ = "ground";
  Eigen::Isometry3d frame_ = Eigen::Isometry3d::Identity();
};

bool is_clear(const AbsoluteVerdict& v) {
  if (v.rank == 0) return true;
  const double largest = v.singular_values[0];
  const bool next_is_zero = v.rank == v.singular_values.size() || v.singular_values[v.rank] < 1e-12 * largest;
  return v.singular_values[v.rank - 1] > 1e-4 * largest && next_is_zero;
}

}  // namespace

RandomMechanism make_random_mechanism(std::uint64_t seed) {
  for (std::uint64_t attempt = 0; attempt < 200; ++attempt) {
    RandomSource source(seed * 1000003 + attempt);
    Grower grower(source.next());
    grower.grow();
    if (grower.spec.joints.empty()) continue;
    RandomMechanism out;
    out.seed = seed;
    out.description = grower.description;
    out.loops = grower.loops();
    out.spec = shifted(rotated(grower.spec, source.rotation()), source.vector(3));
    const ModelBuildResult built = build_model(out.spec);
    if (!built.model) {
      const auto& items = built.diagnostics.items();
      throw std::invalid_argument("make_random_mechanism: " + (items.empty() ? "no model" : items.front().message));
    }
    out.verdict = analyze_absolute(*built.model, drawn_state(*built.model).poses);
    if (out.verdict.mobility >= 1 && is_clear(out.verdict)) return out;
  }
  throw std::invalid_argument("make_random_mechanism: no mobile mechanism in 200 attempts");
}

AbsoluteState wandered(const Model& model, std::uint64_t seed, int steps, double step) {
  RandomSource source(seed);
  AbsoluteState state = drawn_state(model);
  const auto random_twist = [&]() {
    const Eigen::MatrixXd N = admissible_twists(model, state.poses);
    Eigen::VectorXd z(N.cols());
    for (Eigen::Index i = 0; i < z.size(); ++i) z[i] = source.between(-1, 1);
    return Eigen::VectorXd(N * z);
  };
  for (int i = 0; i < steps; ++i) {
    state.poses = displaced(model, state.poses, step * random_twist());
    project_poses(model, state.poses);
  }
  const Eigen::VectorXd V = random_twist();
  for (std::size_t i = 1; i < state.twists.size(); ++i) state.twists[i] = V.segment<6>(6 * (static_cast<long>(i) - 1));
  return state;
}

}  // namespace ferrers::witness
