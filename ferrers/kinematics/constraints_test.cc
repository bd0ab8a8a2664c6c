#include "ferrers/kinematics/constraints.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "ferrers/kinematics/coordinates.h"
#include "ferrers/testing/allocation_guard.h"
#include "ferrers/testing/compare.h"
#include "ferrers/testing/finite_difference.h"
#include "ferrers/testing/joint_chains.h"
#include "ferrers/testing/zoo.h"

namespace ferrers {
namespace {

using witness::difference_jacobian;
using witness::differentiate;
using witness::JointChains;
using witness::make_joint_chains;
using witness::matrices_near;
using witness::numbered;
using witness::RandomSource;

constexpr double kTwoPi = 2 * std::numbers::pi;

std::shared_ptr<const System> built(const ModelSpec& spec, const std::vector<bool>& cut = {}) {
  return make_system(*build_model(spec).model, {.cut = cut});
}

/// Constraints at q and v, windings near those of `state`.
ConstraintKinematics constraints_at(const System& system, State state, const VectorXd& q, const VectorXd& v) {
  state.q = q;
  state.v = v;
  PositionKinematics pos = make_position_kinematics(system);
  VelocityKinematics vel = make_velocity_kinematics(system);
  ConstraintKinematics out = make_constraint_kinematics(system);
  compute_positions(system, q, pos);
  compute_velocities(system, pos, q, v, vel);
  compute_constraints(system, state, pos, vel, out);
  return out;
}

VectorXd moved(const System& system, const VectorXd& q, const VectorXd& step) {
  VectorXd out = q;
  displace(system, step, out);
  return out;
}

/// G and gamma against differences of phi and G v at any state (its windings taken from its pose).
void expect_exact_derivatives(const System& system, State state, const std::string& what, double h = 1e-3) {
  PositionKinematics pos = make_position_kinematics(system);
  compute_positions(system, state.q, pos);
  accept_winding(system, pos, state);
  const ConstraintKinematics c = constraints_at(system, state, state.q, state.v);
  const auto phi = [&](const VectorXd& step) {
    return VectorXd(constraints_at(system, state, moved(system, state.q, step), state.v).phi);
  };
  EXPECT_TRUE(matrices_near(c.G, difference_jacobian(phi, VectorXd::Zero(system.nv), h), 3e-9, what + " G"));
  EXPECT_TRUE(matrices_near(c.rate, c.G * state.v, 1e-12, what + " rate"));
  const auto rows = [&](double t) {
    return VectorXd(constraints_at(system, state, moved(system, state.q, t * state.v), state.v).G * state.v);
  };
  EXPECT_TRUE(matrices_near(c.gamma, -differentiate(rows, 0.0, h), 1e-8, what + " gamma"));
}

class ClosingJointTest : public ::testing::TestWithParam<JointType> {};

TEST_P(ClosingJointTest, JacobianAndGammaAreExactOffTheManifoldToo) {
  for (int seed = 0; seed < 12; ++seed) {
    const JointChains chains = make_joint_chains(seed, GetParam());
    const auto system = built(chains.spec, chains.cut);
    ASSERT_EQ(system->cuts.size(), 1u);
    RandomSource random(seed);
    // Gear meshes end where the centres are as near as the base circles, 55 mm inside: stay near the drawing.
    const bool narrow = GetParam() == JointType::kGearMesh;
    expect_exact_derivatives(*system, random_state(*system, random, narrow ? 0.01 : 0.4), numbered("seed ", seed),
                             narrow ? 1e-4 : 1e-3);
  }
}

TEST_P(ClosingJointTest, RowsVanishAsDrawn) {
  for (int seed = 0; seed < 12; ++seed) {
    const JointChains chains = make_joint_chains(seed, GetParam());
    const auto system = built(chains.spec, chains.cut);
    const State drawn = make_drawn_state(*system);
    const VectorXd phi = constraints_at(*system, drawn, drawn.q, drawn.v).phi;
    EXPECT_TRUE(matrices_near(phi, VectorXd::Zero(system->m), 1e-14));
  }
}

// The same pose through another tree: a joint that is cut here is in the tree there.
TEST_P(ClosingJointTest, ACutJointMeasuresTheCoordinatesThatItHasInATree) {
  const JointTypeInfo& type = joint_type_info(GetParam());
  if (!type.can_be_tree || type.nv == 0) GTEST_SKIP() << "has no coordinates";
  for (int seed = 0; seed < 6; ++seed) {
    for (const bool reversed : {false, true}) {
      RandomSource random(seed);
      ModelSpec spec;
      spec.name = "pair";
      BodySpec a, b;
      a.name = "a";
      b.name = "b";
      spec.bodies = {a, b};
      spec.joints = {
          random_joint(random, JointType::kFree, "to_a", "ground", "a"),
          random_joint(random, GetParam(), "J", reversed ? "b" : "a", reversed ? "a" : "b"),
          random_joint(random, JointType::kFree, "to_b", reversed ? "b" : "ground", reversed ? "ground" : "b")};
      const auto tree = built(spec, {false, false, true}), cut = built(spec, {false, true, false});
      const State there = random_state(*tree, random, 1.0);
      // Take the cut tree's coordinates from the other's measured free joint, step by step to keep the turns.
      PositionKinematics pos = make_position_kinematics(*tree);
      VelocityKinematics vel = make_velocity_kinematics(*tree), acc = vel;
      compute_positions(*tree, there.q, pos);
      compute_velocities(*tree, pos, there.q, there.v, vel);
      VectorXd vdot(tree->nv);
      for (double& x : vdot) x = random.between(-1, 1);
      compute_accelerations(*tree, pos, vel, vdot, acc);
      State here = make_drawn_state(*cut);
      VectorXd vdot_here = VectorXd::Zero(cut->nv);
      for (const int j : {0, 2}) {
        const JointMotion m = measure_joint(*tree, JointId(j), there, vdot, pos, acc);
        const Node& node = cut->nodes[cut->topology->node_of_joint[j]];
        for (int i = 0; i < 7; ++i) here.q[node.q + i] = m.q[i];
        for (int i = 0; i < 6; ++i) {
          here.v[node.v + i] = m.v[i];
          vdot_here[node.v + i] = m.vdot[i];
        }
      }
      PositionKinematics pos_cut = make_position_kinematics(*cut);
      VelocityKinematics vel_cut = make_velocity_kinematics(*cut), acc_cut = vel_cut;
      compute_positions(*cut, here.q, pos_cut);
      compute_velocities(*cut, pos_cut, here.q, here.v, vel_cut);
      compute_accelerations(*cut, pos_cut, vel_cut, vdot_here, acc_cut);
      accept_winding(*cut, pos_cut, here);
      const JointMotion wanted = measure_joint(*tree, JointId(1), there, vdot, pos, acc);
      const JointMotion got = measure_joint(*cut, JointId(1), here, vdot_here, pos_cut, acc_cut);
      const double sign =
          type.quaternion_at >= 0 && wanted.q[type.quaternion_at] * got.q[type.quaternion_at] < 0 ? -1 : 1;
      for (int i = 0; i < type.nq; ++i) {
        const bool quaternion = type.quaternion_at >= 0 && i >= type.quaternion_at;
        EXPECT_NEAR(got.q[i], (quaternion ? sign : 1) * wanted.q[i], 1e-12) << "seed " << seed << " q " << i;
      }
      for (int i = 0; i < type.nv; ++i) {
        EXPECT_NEAR(got.v[i], wanted.v[i], 1e-11) << "seed " << seed << " v " << i;
        EXPECT_NEAR(got.vdot[i], wanted.vdot[i], 1e-10) << "seed " << seed << " vdot " << i;
      }
      if (type.row_count() == 0) continue;
      const ConstraintKinematics closed = constraints_at(*cut, here, here.q, here.v);
      EXPECT_LT(closed.phi.cwiseAbs().maxCoeff() + closed.rate.cwiseAbs().maxCoeff(), 1e-11)
          << "the rows of " << type.name << " do not vanish on its own motion";
      EXPECT_TRUE(matrices_near(closed.G * vdot_here, closed.gamma, 1e-10));
    }
  }
}

std::string type_name(const ::testing::TestParamInfo<JointType>& info) {
  return std::string(joint_type_info(info.param).name);
}
std::vector<JointType> closing_types() {
  std::vector<JointType> types;
  for (const JointTypeInfo* info : all_joint_types()) {
    if (info->row_count() > 0 || info->type == JointType::kFree) types.push_back(info->type);
  }
  return types;
}
INSTANTIATE_TEST_SUITE_P(Types, ClosingJointTest, ::testing::ValuesIn(closing_types()), type_name);

/// Couples every scalar coordinate of the chains, tree and cut.
void couple_everything(ModelSpec& spec, RandomSource& random) {
  CouplingSpec coupling;
  coupling.name = "all";
  for (const JointSpec& joint : spec.joints) {
    const JointTypeInfo& type = joint_type_info(joint.type);
    if (!type.coordinate_jets) continue;
    for (const CoordinateInfo& info : type.coordinates) {
      coupling.coordinates.push_back({joint.name, std::string(info.name)});
      coupling.coefficients.emplace_back(random.between(0.5, 2));
    }
  }
  spec.couplings.push_back(coupling);
}

TEST(CouplingRowTest, JacobianAndGammaAreExactForTreeAndCutCoordinates) {
  for (const JointType closing : {JointType::kRevolute, JointType::kPrismatic, JointType::kScrew,
                                  JointType::kCylindrical, JointType::kUniversal, JointType::kPlanar}) {
    for (int seed = 0; seed < 5; ++seed) {
      RandomSource random(40 + seed);
      JointChains chains = make_joint_chains(seed, closing);
      couple_everything(chains.spec, random);
      const auto result = build_model(chains.spec);
      ASSERT_TRUE(result.model) << result.diagnostics.items().front().message;
      const auto system = make_system(*result.model, {.cut = chains.cut});
      expect_exact_derivatives(*system, random_state(*system, random, 0.3), numbered("seed ", seed));
    }
  }
}

TEST(CouplingRowTest, TheRowIsTheSumOfCoefficientsTimesCoordinates) {
  RandomSource random(3);
  ModelSpec spec = witness::make_joint_chains(1, JointType::kPointOnPlane).spec;
  couple_everything(spec, random);
  const auto system = built(spec);
  const State state = random_state(*system, random, 2.0);
  const ConstraintKinematics c = constraints_at(*system, state, state.q, state.v);
  double phi = 0, rate = 0;
  const Coupling& coupling = system->model->couplings()[0];
  for (std::size_t i = 0; i < coupling.scalars.size(); ++i) {
    const CoordinateAccess access = system->scalar_access(coupling.scalars[i]);
    ASSERT_TRUE(access.in_tree);
    phi += coupling.coefficients[i] * state.q[access.q];
    rate += coupling.coefficients[i] * state.v[access.v];
  }
  EXPECT_NEAR(c.phi[system->m - 1], phi, 1e-13);
  EXPECT_NEAR(c.rate[system->m - 1], rate, 1e-13);
}

/// Ground, a hinged arm and a part on it that turns against ground by a cut joint of `type` on the same axis: its angle
/// is the sum of the two hinges' (and a slide follows).
std::shared_ptr<const System> turntable(JointType type) {
  const Eigen::Vector3d z(0, 0, 1), o(0, 0, 0);
  ModelSpec spec;
  spec.name = "turntable";
  BodySpec a, b;
  a.name = "a";
  b.name = "b";
  spec.bodies = {a, b};
  spec.joints = {witness::joint(JointType::kRevolute, "A", "ground", "a", o, z),
                 witness::joint(JointType::kCylindrical, "B", "a", "b", o, z),
                 witness::joint(type, "C", "ground", "b", o, z)};
  if (type == JointType::kScrew) spec.joints[2].lead = Number(0.25);
  return built(spec, {false, false, true});
}

TEST(WindingTest, CutAnglesAreContinuedOverManyTurns) {
  for (const JointType type : {JointType::kRevolute, JointType::kScrew, JointType::kCylindrical, JointType::kPlanar}) {
    const auto system = turntable(type);
    const JointTypeInfo& info = joint_type_info(type);
    State state = make_drawn_state(*system);
    PositionKinematics pos = make_position_kinematics(*system);
    const VelocityKinematics rest = make_velocity_kinematics(*system);
    const int angle_index = type == JointType::kPlanar ? 2 : 0;
    for (int i = 1; i <= 200; ++i) {
      const double turn = 0.2 * i;  // 40 rad, then back
      const double angle = i <= 150 ? turn : 0.2 * (300 - i);
      const int v_b = system->nodes[system->topology->node_of_joint[1]].q;
      state.q[system->nodes[system->topology->node_of_joint[0]].q] = 0.4 * angle;
      state.q[v_b] = 0.6 * angle;
      state.q[v_b + 1] = type == JointType::kScrew ? 0.25 * angle / kTwoPi : 0;
      compute_positions(*system, state.q, pos);
      accept_winding(*system, pos, state);
      const Jet jet = measure_coordinate(*system, system->access({JointId(2), angle_index}), state, pos, rest);
      ASSERT_NEAR(jet.value, angle, 1e-12) << info.name << " step " << i;
      const ConstraintKinematics c = constraints_at(*system, state, state.q, state.v);
      ASSERT_LT(c.phi.cwiseAbs().maxCoeff(), 1e-12) << info.name << " step " << i;
    }
  }
}

TEST(TreeJointRowsTest, RowsOfTreeJointsVanishWithTheirRatesAtAnyState) {
  for (int seed = 0; seed < 10; ++seed) {
    const JointChains chains = make_joint_chains(seed, JointType::kPointOnPlane);
    const auto system = built(chains.spec, chains.cut);
    RandomSource random(seed);
    const State state = random_state(*system, random, 2.0);
    PositionKinematics pos = make_position_kinematics(*system);
    VelocityKinematics vel = make_velocity_kinematics(*system), acc = vel;
    compute_positions(*system, state.q, pos);
    compute_velocities(*system, pos, state.q, state.v, vel);
    VectorXd vdot(system->nv);
    for (double& x : vdot) x = random.between(-1, 1);
    compute_accelerations(*system, pos, vel, vdot, acc);
    for (std::size_t j = 0; j + 1 < system->model->joints().size(); ++j) {
      RelativeMotion motion;
      Jet rows[6];
      compute_joint_rows(*system, JointId(j), state, pos, acc, motion, rows);
      for (int i = 0; i < joint_type_info(system->model->joints()[j].type).row_count(); ++i) {
        EXPECT_NEAR(rows[i].value, 0, 1e-12);
        EXPECT_NEAR(rows[i].rate, 0, 1e-11);
        EXPECT_NEAR(rows[i].bias, 0, 1e-10) << joint_type_info(system->model->joints()[j].type).name;
      }
    }
  }
}

TEST(ConstraintsTest, EvaluationAllocatesNothing) {
  if (!witness::AllocationGuard::available()) GTEST_SKIP() << "allocations cannot be counted here";
  RandomSource random(9);
  for (const witness::ZooEntry& entry : witness::zoo()) {
    const auto system = built(entry.spec);
    const State state = random_state(*system, random, 0.01);
    PositionKinematics pos = make_position_kinematics(*system);
    VelocityKinematics vel = make_velocity_kinematics(*system), acc = vel;
    ConstraintKinematics c = make_constraint_kinematics(*system);
    const witness::AllocationGuard guard;
    compute_positions(*system, state.q, pos);
    compute_velocities(*system, pos, state.q, state.v, vel);
    compute_accelerations(*system, pos, vel, state.v, acc);
    compute_constraints(*system, state, pos, vel, c);
    EXPECT_EQ(guard.count(), 0) << entry.name;
  }
}

}  // namespace
}  // namespace ferrers
