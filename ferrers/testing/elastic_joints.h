#pragma once

#include <limits>
#include <stdexcept>
#include <string>

#include "ferrers/model/spec.h"
#include "ferrers/testing/random_source.h"

/// Stiffness and misalignment for the joints of a specification.
namespace ferrers::witness {

inline constexpr double kRigid = std::numeric_limits<double>::infinity();

inline JointSpec& joint_of(ModelSpec& spec, const std::string& name) {
  for (JointSpec& joint : spec.joints) {
    if (joint.name.name == name) return joint;
  }
  throw std::invalid_argument("joint_of: no joint '" + name + "'");
}

/// Stiffness along the joint's frame, N/m and N·m/rad; `kRigid` where it does not give way.
inline void set_stiffness(JointSpec& joint, const Number3& force, const Number3& moment) {
  joint.stiffness = StiffnessSpec{force, moment, {}};
}
inline void set_stiffness(JointSpec& joint, double force, double moment) {
  set_stiffness(joint, number3(force, force, force), number3(moment, moment, moment));
}

inline void set_misalignment(JointSpec& joint, const Number3& translation, const Number3& rotation) {
  joint.misalignment = MisalignmentSpec{translation, rotation, {}};
}

/// Every joint the same in all directions, its size drawn between 10^low and 10^high.
inline void set_random_stiffness(ModelSpec& spec, std::uint64_t seed, double low, double high) {
  RandomSource random(seed);
  for (JointSpec& joint : spec.joints) {
    const double force = std::pow(10.0, random.between(low, high)), moment = std::pow(10.0, random.between(low, high));
    set_stiffness(joint, force, moment);
  }
}

}  // namespace ferrers::witness
