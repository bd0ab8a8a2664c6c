#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>

#include "ferrers/formats/mjcf_import.h"

/// Problem: a joint says the time constant T and damping ratio d of its spring instead of stiffness and damping. MuJoCo
/// makes of it, with what the mechanism as drawn, without constraints, weighs along the joint,
///
///   w = n / Σ (M⁻¹)_kk over the joint's n velocities,   stiffness = w / (T d)²,   damping = 2 w / T.
namespace ferrers::mjcf {
namespace {

constexpr int kMostVelocities = 1000;  // M is inverted as a whole

/// A velocity as drawn: the twist that it gives everything beyond its joint, at the world's origin.
struct Twist {
  Vector3d turn = Vector3d::Zero(), move = Vector3d::Zero();
};

struct Velocity {
  int body = 0;
  Twist twist;
  double armature = 0;
};

/// In the world: about the mass centre, world axes.
MassProperties in_world(const TreeBody& body) {
  MassProperties mass = body.mass.value_or(MassProperties());
  mass.com = body.X_WB * mass.com;
  mass.inertia = body.X_WB.R * mass.inertia * body.X_WB.R.transpose();
  return mass;
}

MassProperties joined(const MassProperties& a, const MassProperties& b) {
  MassProperties sum;
  sum.mass = a.mass + b.mass;
  if (sum.mass <= 0) return {};
  sum.com = (a.mass * a.com + b.mass * b.com) / sum.mass;
  for (const MassProperties* part : {&a, &b}) {
    const Vector3d way = part->com - sum.com;
    sum.inertia += part->inertia + part->mass * (way.squaredNorm() * Matrix3d::Identity() - way * way.transpose());
  }
  return sum;
}

std::vector<Twist> twists_of(const TreeBody& body, const TreeJoint& joint) {
  const Vector3d at = body.X_WB * joint.pos;
  const auto about = [&](const Vector3d& axis) { return Twist{axis, at.cross(axis)}; };
  const Vector3d axis = body.X_WB.R * joint.axis;
  if (joint.replaced) return {};
  if (joint.kind == JointKind::kHinge) return {about(axis)};
  if (joint.kind == JointKind::kSlide) return {{Vector3d::Zero(), axis}};
  std::vector<Twist> all;
  for (int k = 0; k < 3; ++k) all.push_back(about(Vector3d::Unit(k)));
  for (int k = 0; k < 3 && joint.kind == JointKind::kFree; ++k) all.push_back({Vector3d::Zero(), Vector3d::Unit(k)});
  return all;
}

/// Momentum and angular momentum about the world's origin.
Twist momentum_of(const MassProperties& mass, const Twist& twist) {
  const Vector3d p = mass.mass * (twist.move + twist.turn.cross(mass.com));
  return {mass.inertia * twist.turn + mass.com.cross(p), p};
}

class ReferenceInertia {
 public:
  explicit ReferenceInertia(const std::vector<TreeBody>& bodies) : bodies_(bodies) {
    for (const TreeBody& body : bodies) beyond_.push_back(in_world(body));
    for (std::size_t i = bodies.size() - 1; i >= 1; --i) {
      MassProperties& parent = beyond_[static_cast<std::size_t>(bodies[i].parent)];
      parent = joined(parent, beyond_[i]);
    }
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      first_.push_back(static_cast<int>(velocities_.size()));
      for (const TreeJoint& joint : bodies[i].joints) {
        for (const Twist& twist : twists_of(bodies[i], joint)) {
          velocities_.push_back({static_cast<int>(i), twist, joint.armature});
        }
      }
    }
    first_.push_back(static_cast<int>(velocities_.size()));
  }

  int size() const { return static_cast<int>(velocities_.size()); }
  int first_of(std::size_t body) const { return first_[body]; }

  Eigen::MatrixXd mass_matrix() const {
    Eigen::MatrixXd M = Eigen::MatrixXd::Zero(size(), size());
    for (int i = 0; i < size(); ++i) {
      const Velocity& own = velocities_[static_cast<std::size_t>(i)];
      const Twist momentum = momentum_of(beyond_[static_cast<std::size_t>(own.body)], own.twist);
      for (int body = own.body; body >= 0; body = bodies_[static_cast<std::size_t>(body)].parent) {
        for (int j = first_of(static_cast<std::size_t>(body)); j < first_of(static_cast<std::size_t>(body) + 1); ++j) {
          const Twist& other = velocities_[static_cast<std::size_t>(j)].twist;
          M(i, j) = M(j, i) = other.turn.dot(momentum.turn) + other.move.dot(momentum.move);
        }
      }
      M(i, i) += own.armature;
    }
    return M;
  }

 private:
  const std::vector<TreeBody>& bodies_;
  std::vector<MassProperties> beyond_;  ///< Per body, with all that hangs on it.
  std::vector<Velocity> velocities_;
  std::vector<int> first_;  ///< Per body, and one more.
};

/// Every joint that asks for it, or a message for the first where M cannot be inverted.
void resolve(std::vector<TreeBody>& bodies, const TreeJoint& first) {
  const auto refuse = [&](std::string_view why) {
    first.element.diagnostics().error("F602", first.element.at(),
                                      fmt::format("the 'springdamper' of '{}' cannot be followed: {}", first.name, why),
                                      "--ignore springs,damping leaves such springs out");
  };
  const bool known = std::all_of(bodies.begin(), bodies.end(),
                                 [](const TreeBody& body) { return body.mass.has_value() || !body.moves; });
  if (!known) return refuse("it depends on masses, of which some are not known");
  const ReferenceInertia reference(bodies);
  if (reference.size() > kMostVelocities) return refuse("there are too many coordinates");
  const Eigen::LLT<Eigen::MatrixXd> M(reference.mass_matrix());
  if (M.info() != Eigen::Success) return refuse("something that moves has no mass");
  const Eigen::VectorXd mobility = M.solve(Eigen::MatrixXd::Identity(reference.size(), reference.size())).diagonal();
  for (std::size_t i = 1; i < bodies.size(); ++i) {
    int at = reference.first_of(i);
    for (TreeJoint& joint : bodies[i].joints) {
      const auto count = static_cast<int>(twists_of(bodies[i], joint).size());
      if (joint.springdamper && count > 0) {
        const auto [time, ratio] = *joint.springdamper;
        const double weight = count / mobility.segment(at, count).sum();
        joint.stiffness = {weight / (time * time * ratio * ratio), 0, 0};
        joint.damping = {2 * weight / time, 0, 0};
      }
      at += count;
    }
  }
}

}  // namespace

void resolve_springdampers(Import& import) {
  if (import.options.ignore_springs && import.options.ignore_damping) return;
  for (const TreeBody& body : import.tree.bodies) {
    for (const TreeJoint& joint : body.joints) {
      if (joint.springdamper) return resolve(import.tree.bodies, joint);
    }
  }
}

}  // namespace ferrers::mjcf
