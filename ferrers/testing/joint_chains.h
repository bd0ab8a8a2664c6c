#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "ferrers/kinematics/state.h"
#include "ferrers/testing/random_source.h"
#include "ferrers/testing/zoo_parts.h"

/// Mechanisms that hold every joint type in the tree, for tests of kinematics: two chains of tree joints from ground,
/// one `closing` joint of any type between their ends, cut.
namespace ferrers::witness {

inline constexpr JointType kTreeTypes[] = {JointType::kWeld,      JointType::kRevolute,    JointType::kPrismatic,
                                           JointType::kScrew,     JointType::kCylindrical, JointType::kUniversal,
                                           JointType::kSpherical, JointType::kPlanar,      JointType::kFree};

/// A joint of any type at a random place and in a random direction.
inline JointSpec random_joint(RandomSource& random, JointType type, const std::string& name, const std::string& first,
                              const std::string& second) {
  const Point at = random.vector(1), axis = random.direction();
  switch (type) {
    case JointType::kUniversal:
      return universal_joint(name, first, second, at, axis, axis.cross(random.direction()).normalized());
    case JointType::kDistance:
      return distance_joint(name, first, second, at, at + random.between(1, 2) * random.direction());
    case JointType::kGearMesh: {  // pitch radii 0.4 and 0.5, pressure angle 0.35
      const Point x = axis.cross(random.direction()).normalized(), y = axis.cross(x);
      return mesh_joint(name, first, second, at + 0.4 * x, std::sin(0.35) * x + std::cos(0.35) * y, axis, at,
                        at + 0.9 * x);
    }
    default: {
      JointSpec spec = joint(type, name, first, second, at, axis);
      if (type == JointType::kFree) {
        spec.place = PlaceSpec();
        spec.place.drawn = numbers(at);
      }
      if (type == JointType::kScrew) spec.lead = Number(random.between(0.1, 0.6));
      return spec;
    }
  }
}

/// Joints J1..Jn and, last, "closing". The closing joint's index is the number of bodies.
struct JointChains {
  ModelSpec spec;
  std::vector<bool> cut;  ///< For `TopologyOptions`: only the closing joint.
};

/// Two chains with every tree type once, shuffled between them; each joint forward or reversed at random.
inline JointChains make_joint_chains(std::uint64_t seed, JointType closing) {
  RandomSource random(seed);
  std::vector<JointType> types(std::begin(kTreeTypes), std::end(kTreeTypes));
  for (int i = static_cast<int>(types.size()) - 1; i > 0; --i) std::swap(types[i], types[random.below(i + 1)]);
  JointChains out;
  out.spec.name = "chains";
  std::string last[2] = {"ground", "ground"};
  const int half = 3 + random.below(3);
  for (int i = 0; i < static_cast<int>(types.size()); ++i) {
    std::string& end = last[i < half ? 0 : 1];
    BodySpec body;
    body.name = numbered("b", i + 1);
    out.spec.bodies.push_back(body);
    const bool reversed = random.chance(0.5);
    out.spec.joints.push_back(random_joint(random, types[i], numbered("J", i + 1), reversed ? body.name.name : end,
                                           reversed ? end : body.name.name));
    end = body.name.name;
  }
  const bool reversed = random.chance(0.5);
  out.spec.joints.push_back(random_joint(random, closing, "closing", last[reversed ? 1 : 0], last[reversed ? 0 : 1]));
  out.cut.assign(out.spec.joints.size(), false);
  out.cut.back() = true;
  return out;
}

/// Coordinates up to `size` from the drawn ones, velocities of order one.
inline State random_state(const System& system, RandomSource& random, double size) {
  State state = make_drawn_state(system);
  VectorXd step(system.nv);
  for (double& x : step) x = random.between(-size, size);
  displace(system, step, state.q);
  for (double& x : state.v) x = random.between(-1, 1);
  return state;
}

}  // namespace ferrers::witness
