#include "ferrers/testing/zoo_large.h"

#include <random>

#include "ferrers/testing/zoo_parts.h"

namespace ferrers::witness {
namespace {

// A tree of random shape and chords; `link` makes a joint between two bodies.
template <typename Link>
ModelSpec make_tangle(const std::string& name, int bodies, int loops, Link link) {
  ModelSpec spec;
  spec.name = name;
  std::mt19937 random(7);
  const auto body = [](int i) { return i == 0 ? std::string("ground") : numbered("body", i); };
  const auto pick = [&](int count) { return static_cast<int>(random() % static_cast<unsigned>(count)); };
  const auto point = [&] {
    const auto number = [&] { return pick(2001) / 1000.0 - 1; };
    const double x = number(), y = number();
    return Point(x, y, number());
  };
  for (int i = 1; i <= bodies; ++i) {
    spec.bodies.push_back(box_body(body(i), point(), {0.3, 0.2, 0.1}, 1));
    spec.joints.push_back(link(numbered("tree", i), body(pick(i)), body(i), point()));
  }
  for (int i = 1; i <= loops; ++i) {
    const int a = pick(bodies + 1), b = (a + 1 + pick(bodies)) % (bodies + 1);
    spec.joints.push_back(link(numbered("chord", i), body(a), body(b), point()));
  }
  return spec;
}

}  // namespace

ModelSpec make_ball_tangle(int bodies, int loops) {
  return make_tangle("ball_tangle", bodies, loops, [](auto name, auto first, auto second, const Point& at) {
    return joint(JointType::kSpherical, name, first, second, at);
  });
}

ModelSpec make_spherical_tangle(int bodies, int loops) {
  return make_tangle("spherical_tangle", bodies, loops, [](auto name, auto first, auto second, const Point& at) {
    return joint(JointType::kRevolute, name, first, second, at, at.normalized());
  });
}

ModelSpec make_lazy_tongs(int cells) {
  ModelSpec spec;
  spec.name = numbered("lazy_tongs", cells);
  const double c = 0.8, s = 0.6;  // half bars of 1 m
  for (int i = 0; i < cells; ++i) {
    const Point middle(2 * c * i + c, 0, 0), half(c, s, 0), other(c, -s, 0);
    const std::string up = numbered("up", i), down = numbered("down", i);
    spec.bodies.push_back(bar_body(up, middle - half, middle + half, 1, 0.02));
    spec.bodies.push_back(bar_body(down, middle - other, middle + other, 1, 0.02));
    spec.joints.push_back(joint(JointType::kRevolute, numbered("cross", i), up, down, middle));
    if (i == 0) {
      spec.joints.push_back(joint(JointType::kRevolute, "base", "ground", up, middle - half));
    } else {
      spec.joints.push_back(
          joint(JointType::kRevolute, numbered("low", i), numbered("down", i - 1), up, middle - half));
      spec.joints.push_back(
          joint(JointType::kRevolute, numbered("high", i), numbered("up", i - 1), down, middle - other));
    }
  }
  return spec;
}

}  // namespace ferrers::witness
