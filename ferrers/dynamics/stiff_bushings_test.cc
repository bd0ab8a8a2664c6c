// Elastic joints that grow stiff: a mechanism whose joints are bushings, in equilibrium, and the reactions that the
// force method gives the same mechanism with rigid joints.

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "ferrers/dynamics/reactions.h"
#include "ferrers/testing/compare.h"
#include "ferrers/testing/elastic_joints.h"
#include "ferrers/testing/engine_probe.h"
#include "ferrers/testing/zoo.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers::witness {
namespace {

Number3 times(const Number3& n, double s) { return number3(n[0].value * s, n[1].value * s, n[2].value * s); }

/// The bushing of a revolute or weld: the joint's stiffness, nothing along its freedom.
ForceSpec bushing_of(const JointSpec& joint, double stiffer) {
  BushingSpec bushing;
  bushing.bodies = joint.bodies;
  bushing.place = joint.place;
  bushing.axis = joint.axis;
  if (!bushing.axis.drawn) bushing.axis.drawn = number3(0, 0, 1);
  if (!joint.axis.drawn) bushing.x = number3(1, 0, 0);
  bushing.force_stiffness = times(*joint.stiffness->force, stiffer);
  bushing.moment_stiffness = times(*joint.stiffness->moment, stiffer);
  if (joint.type == JointType::kRevolute) bushing.moment_stiffness[2] = Number(0);
  bushing.force_damping = bushing.moment_damping = number3(0, 0, 0);
  ForceSpec force;
  force.name = joint.name.name;
  force.element = bushing;
  return force;
}

/// The same bodies, free, held by `bushings` only.
ModelSpec on_bushings(const ModelSpec& spec, std::vector<ForceSpec> bushings) {
  ModelSpec out = spec;
  out.joints.clear();
  out.drives.clear();
  out.initial.clear();
  for (const BodySpec& body : spec.bodies) {
    JointSpec loose = joint(JointType::kFree, "free_" + body.name.name, "ground", body.name.name, {0, 0, 0});
    loose.place = PlaceSpec();
    loose.place.drawn = body.com;
    out.joints.push_back(loose);
  }
  out.forces = std::move(bushings);
  return out;
}

VectorXd generalized_force(EngineProbe& engine, const State& state) {
  compute_equations(*engine.dynamics, state, engine.eq);
  return engine.eq.force;
}

/// The pose at rest where nothing accelerates, by Newton from the drawn pose.
State equilibrium(EngineProbe& engine) {
  State state = make_drawn_state(*engine.system);
  const int n = engine.system->nv;
  for (int iteration = 0; iteration < 8; ++iteration) {
    const VectorXd force = generalized_force(engine, state);
    MatrixXd stiffness(n, n);
    constexpr double kStep = 1e-6;
    for (int i = 0; i < n; ++i) {
      const auto at = [&](double step) {
        State moved = state;
        displace(*engine.system, step * VectorXd::Unit(n, i), moved.q);
        return generalized_force(engine, moved);
      };
      stiffness.col(i) = (at(-kStep) - at(kStep)) / (2 * kStep);
    }
    displace(*engine.system, stiffness.partialPivLu().solve(force), state.q);
  }
  return state;
}

/// What each joint's bushing does to its second body at equilibrium: force then moment at the joint's place.
MatrixXd bushing_wrenches(const ModelSpec& spec, double stiffer) {
  std::vector<ForceSpec> all;
  for (const JointSpec& joint : spec.joints) all.push_back(bushing_of(joint, stiffer));
  EngineProbe engine(on_bushings(spec, all));
  const State state = equilibrium(engine);
  MatrixXd out(6, static_cast<long>(all.size()));
  for (std::size_t j = 0; j < all.size(); ++j) {
    EngineProbe alone(on_bushings(spec, {all[j]}));
    compute_kinematics(*alone.dynamics, state, alone.eq);
    std::vector<Wrenches> on_nodes(alone.system->nodes.size(), Wrenches::Zero(6, 1));
    VectorXd efforts = VectorXd::Zero(alone.system->nv);
    compute_force_elements(*alone.dynamics, state, alone.eq.pos, alone.eq.vel, on_nodes, efforts);
    const FramePair& frames = alone.dynamics->bushings[0].frames;
    const Vector3d p = point_position(alone.eq.pos, {frames.node_2, frames.X_2M.p});
    const VectorXd w = on_nodes[frames.node_2].col(0);
    const Vector3d force = w.tail<3>(), lever = alone.eq.pos.nodes[frames.node_2].p - p;
    out.col(static_cast<long>(j)) << force, Vector3d(w.head<3>()) + lever.cross(force);
  }
  return out;
}

MatrixXd distributed_wrenches(const ModelSpec& spec) {
  EngineProbe engine(spec);
  const State state = make_drawn_state(*engine.system);
  const auto reactions = engine.reactions(state, engine.forward(state));
  MatrixXd out(6, static_cast<long>(reactions.size()));
  for (std::size_t j = 0; j < reactions.size(); ++j) {
    for (int k = 0; k < 6; ++k) {
      EXPECT_NE(reactions[j].status[k], ReactionStatus::kUndetermined);
      out(k, static_cast<long>(j)) = reactions[j].value[k];
    }
  }
  return out;
}

/// The difference falls in proportion to the compliance, down to what rounding of positions leaves.
void expect_limit(const ModelSpec& spec) {
  const MatrixXd wanted = distributed_wrenches(spec);
  const double size = wanted.cwiseAbs().maxCoeff();
  std::vector<double> errors;
  for (const double stiffer : {1.0, 10.0, 100.0, 1000.0}) {
    errors.push_back((bushing_wrenches(spec, stiffer) - wanted).cwiseAbs().maxCoeff() / size);
  }
  for (std::size_t i = 1; i < errors.size(); ++i) EXPECT_NEAR(errors[i - 1] / errors[i], 10, 1) << errors[i];
  EXPECT_LT(errors.back(), 1e-6);
}

TEST(StiffBushingsTest, ADoorHeldShutGoesToItsDistribution) {
  ModelSpec spec = make_door(2);
  spec.joints[0].type = JointType::kWeld;  // held shut
  spec.joints[0].axis = PlaceSpec();
  spec.gravity = number3(2, 3, -9.81);
  set_stiffness(spec.joints[0], number3(2e6, 1e6, 1e6), number3(4e4, 2e4, 3e4));
  set_stiffness(spec.joints[1], number3(1e6, 3e6, 2e6), number3(1e4, 2e4, 1));
  expect_limit(spec);
}

// The crank is clamped, so that the linkage stands; gravity acts across its plane too.
TEST(StiffBushingsTest, AStandingFourBarGoesToItsDistribution) {
  ModelSpec spec = make_four_bar(FourBarJoints::kRevolute);
  spec.gravity = number3(1, -9.81, 6);
  for (std::size_t j = 0; j < spec.joints.size(); ++j) {
    const double s = 1 + 0.7 * static_cast<double>(j);
    set_stiffness(spec.joints[j], number3(2e6 * s, 3e6, 1e6 / s), number3(4e5, 2e5 * s, 3e5));
  }
  spec.joints[0].type = JointType::kWeld;
  spec.joints[0].axis = PlaceSpec();
  expect_limit(spec);
}

TEST(StiffBushingsTest, AStandingBricardLoopGoesToItsDistribution) {
  ModelSpec spec = make_bricard(BricardRods::kBricks);
  for (std::size_t j = 0; j < spec.joints.size(); ++j) {
    set_stiffness(spec.joints[j], 1e6 * (1.0 + static_cast<double>(j)), 1e5 * (7.0 - static_cast<double>(j)));
  }
  spec.joints[0].type = JointType::kWeld;
  spec.joints[0].axis = PlaceSpec();
  expect_limit(spec);
}

}  // namespace
}  // namespace ferrers::witness
