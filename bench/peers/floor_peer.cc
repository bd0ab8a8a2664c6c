// The least that the planar four-bars can cost: `floor_peer scene.json SECONDS`, for four_bar and a02_nN only.
//
// Written by hand for these mechanisms: one coordinate (the first crank's angle), the others by the closure of the
// quadrilateral or, for parallelograms, equal; the acceleration from the energy's one equation; then, from Newton and
// Euler, the two force components of every joint. The four-bar's are unique. A chain of N parallelograms that stay
// parallel has N - 1 redundant rows even in the plane: the forces along the couplers divide in some way, and here the
// last crank takes what no one needs.

#include <stdexcept>

#include "bench/peers/scene.h"

namespace {

using peers::json;

struct Vec {
  double x = 0, y = 0;
};
Vec operator+(Vec a, Vec b) { return {a.x + b.x, a.y + b.y}; }
Vec operator-(Vec a, Vec b) { return {a.x - b.x, a.y - b.y}; }
Vec operator*(double s, Vec a) { return {s * a.x, s * a.y}; }
double dot(Vec a, Vec b) { return a.x * b.x + a.y * b.y; }
double cross(Vec a, Vec b) { return a.x * b.y - a.y * b.x; }
Vec left(Vec a) { return {-a.y, a.x}; }

/// A bar from its first joint to its second, uniform.
struct Bar {
  Vec drawn;
  double length = 0, mass = 0, inertia = 0;
};

/// Bars 0 (crank), 1 (coupler), 2 (rocker, from the coupler's end to ground). Angles of turn since the drawing.
struct FourBar {
  Bar bars[3];
  Vec feet;  ///< From the crank's pivot to the rocker's.
  double gravity = 0;
  double acceleration[3] = {};
  double unbalanced = 0;  ///< Moment of the crank about its pivot, which the other equations imply.
  Vec forces[4];  ///< On the bar after each joint: crank's pivot, crank-coupler, coupler-rocker, rocker's pivot.

  // Law of cosines for the poses; then rates and the acceleration of the single freedom.
  void evaluate(double turn, double rate) {
    const double c = std::cos(turn), s = std::sin(turn);
    const Vec a{c * bars[0].drawn.x - s * bars[0].drawn.y, s * bars[0].drawn.x + c * bars[0].drawn.y};
    const Vec to_foot = feet - a;
    const double l1 = bars[1].length, l2 = bars[2].length, d2 = dot(to_foot, to_foot);
    const double along = (l1 * l1 - l2 * l2 + d2) / (2 * d2), off = std::sqrt(l1 * l1 / d2 - along * along);
    const Vec b = along * to_foot + off * left(to_foot), r = to_foot - b;  // coupler and rocker
    // Rates: w0 × a + w1 × b + w2 × r = 0.
    const double closing = cross(b, r);
    const double u1 = -cross(a, r) / closing, u2 = -cross(b, a) / closing;
    const double w0 = rate, w1 = u1 * rate, w2 = u2 * rate;
    // Accelerations: α_k left(·) − w² (·) sum to zero: α1 = u1 α0 + g1, α2 = u2 α0 + g2.
    const Vec inward = (w0 * w0) * a + (w1 * w1) * b + (w2 * w2) * r;
    const double g1 = dot(inward, r) / closing, g2 = -dot(inward, b) / closing;
    const double u[3] = {1, u1, u2}, g[3] = {0, g1, g2}, w[3] = {w0, w1, w2};
    const Vec way[3] = {a, b, r};
    Vec unit[3], bias[3];  // of the mass centres: c = α0 unit + bias
    Vec unit_end, bias_end;
    double mass = 0, force = 0;
    for (int k = 0; k < 3; ++k) {
      const Vec unit_step = u[k] * left(way[k]), bias_step = g[k] * left(way[k]) - (w[k] * w[k]) * way[k];
      unit[k] = unit_end + 0.5 * unit_step;
      bias[k] = bias_end + 0.5 * bias_step;
      unit_end = unit_end + unit_step;
      bias_end = bias_end + bias_step;
      mass += bars[k].mass * dot(unit[k], unit[k]) + bars[k].inertia * u[k] * u[k];
      force += bars[k].mass * (gravity * unit[k].y - dot(unit[k], bias[k])) - bars[k].inertia * u[k] * g[k];
    }
    const double first = force / mass;
    Vec push[3];  // m (c'' − gravity)
    double torque[3];
    for (int k = 0; k < 3; ++k) {
      acceleration[k] = u[k] * first + g[k];
      push[k] = bars[k].mass * (first * unit[k] + bias[k] - Vec{0, gravity});
      torque[k] = bars[k].inertia * acceleration[k];
    }
    // The force between coupler and rocker, on the rocker: moments of the rocker about its pivot and of the coupler
    // about its first joint.
    const double about_foot = torque[2] + cross(-0.5 * r, push[2]), about_joint = torque[1] + cross(0.5 * b, push[1]);
    // cross(−r, f) = about_foot, cross(b, −f) = about_joint.
    const Vec f = (1 / closing) * (about_foot * b - about_joint * r);
    forces[2] = f;
    forces[1] = push[1] + f;
    forces[0] = push[0] + forces[1];
    forces[3] = push[2] - f;
    unbalanced = torque[0] + cross(0.5 * a, push[0]) + cross(a, forces[1]);
  }
};

struct Chain {
  int loops = 0;
  double gravity = 0, acceleration = 0;
  std::vector<Vec> pivots, lefts, rights;  ///< Forces on cranks from ground, on couplers from cranks at either end.

  explicit Chain(int n, double g)
      : loops(n),
        gravity(g),
        pivots(static_cast<std::size_t>(n) + 1),
        lefts(static_cast<std::size_t>(n)),
        rights(static_cast<std::size_t>(n)) {}

  // Unit bars of 1 kg; theta clockwise from upright.
  void evaluate(double theta, double rate) {
    const double s = std::sin(theta), c = std::cos(theta);
    const double inertia = (loops + 1) / 3.0 + loops, weight = -gravity * ((loops + 1) / 2.0 + loops);
    acceleration = weight / inertia * s;
    const Vec crank{s, c}, across{c, -s};
    const Vec tip = acceleration * across - (rate * rate) * crank;
    const Vec coupler = tip - Vec{0, gravity}, half = 0.5 * tip - Vec{0, gravity};
    // Moment of a crank about its pivot: I α − moment of its weight = −crank × load, both clockwise positive; the load
    // is what it gives to couplers. So the part of the load across the crank is known.
    const double needed = -(acceleration / 3.0 + gravity * 0.5 * s);
    double carried = 0;  // along x, from the couplers before
    const double half_y = coupler.y / 2;
    for (int i = 0; i <= loops; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const double y = (i > 0 ? half_y : 0) + (i < loops ? half_y : 0);
      // across · load = needed, where the crank is not in line with the couplers.
      const double x = (needed + across.y * -y) / across.x;
      const Vec load{x, y};
      if (i < loops) {
        lefts[k] = {x - carried, half_y};
        rights[k] = {coupler.x - lefts[k].x, half_y};
        carried = rights[k].x;
      }
      pivots[k] = half + load;
    }
  }
};

Bar bar(const peers::Body& body, const peers::Joint& from, const peers::Joint& to) {
  Bar b;
  b.drawn = {to.at[0] - from.at[0], to.at[1] - from.at[1]};
  b.length = std::hypot(b.drawn.x, b.drawn.y);
  b.mass = body.mass;
  b.inertia = body.inertia[8];
  return b;
}

void measure_four_bar(const peers::Scene& scene, double seconds, json& out) {
  FourBar f;
  const auto& j = scene.joints;  // A, B, C, D
  f.bars[0] = bar(scene.bodies[0], j[0], j[1]);
  f.bars[1] = bar(scene.bodies[1], j[1], j[2]);
  f.bars[2] = bar(scene.bodies[2], j[2], j[3]);
  f.feet = {j[3].at[0] - j[0].at[0], j[3].at[1] - j[0].at[1]};
  f.gravity = scene.gravity[1];
  const auto evaluate = [&](std::size_t i) { f.evaluate(scene.states[i].q[0], scene.states[i].v[0]); };
  peers::ErrorMeter error;
  for (std::size_t i = 0; i < scene.states.size(); ++i) {
    evaluate(i);
    error.begin();
    error.add(f.acceleration[0], scene.states[i].a[0]);
    error.add(f.acceleration[1] - f.acceleration[0], scene.states[i].a[1]);
    error.add(f.acceleration[2], scene.states[i].a[3]);
    error.add(f.acceleration[0] + f.unbalanced, scene.states[i].a[0]);
    error.end();
  }
  out["error"] = error.worst();
  out["us"] = peers::least_microseconds(scene.states.size(), seconds, evaluate);
}

void measure_chain(const peers::Scene& scene, double seconds, json& out) {
  Chain chain(static_cast<int>(scene.bodies.size()) / 2, scene.gravity[1]);
  const auto evaluate = [&](std::size_t i) { chain.evaluate(scene.states[i].q[0], scene.states[i].v[0]); };
  peers::ErrorMeter error;
  double unbalanced = 0;
  for (std::size_t i = 0; i < scene.states.size(); ++i) {
    evaluate(i);
    error.begin();
    error.add(chain.acceleration, scene.states[i].a[0]);
    error.end();
    unbalanced = std::max(unbalanced, std::abs(chain.pivots.front().x));
  }
  out["error"] = error.worst();
  out["largest_pivot_force"] = unbalanced;
  out["us"] = peers::least_microseconds(scene.states.size(), seconds, evaluate);
}

}  // namespace

int main(int argc, char** argv) try {
  (void)argc;
  const peers::Scene scene = peers::read_scene(argv[1]);
  json out;
  if (scene.name == "four_bar") {
    measure_four_bar(scene, std::stod(argv[2]), out);
  } else if (scene.name.rfind("a02_n", 0) == 0) {
    measure_chain(scene, std::stod(argv[2]), out);
  } else {
    throw std::runtime_error("written by hand for the planar four-bars only");
  }
  peers::print(out);
  return 0;
} catch (const std::exception& problem) {
  peers::print({{"failed", problem.what()}});
  return 1;
}
