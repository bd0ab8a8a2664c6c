#include "ferrers/kinematics/constraint_blocks.h"

#include <gtest/gtest.h>

#include "ferrers/testing/random_mechanism.h"
#include "ferrers/testing/zoo.h"

namespace ferrers {
namespace {

void expect_same_as_whole(const ModelSpec& spec, double push) {
  const auto system = make_system(*build_model(spec).model);
  State state = make_drawn_state(*system);
  VectorXd away(system->nv);
  for (int v = 0; v < system->nv; ++v) away[v] = push * std::cos(2.1 * v);
  displace(*system, away, state.q);  // G is exact off the constraints too
  PositionKinematics pos = make_position_kinematics(*system);
  compute_positions(*system, state.q, pos);
  ConstraintKinematics whole = make_constraint_kinematics(*system);
  compute_constraints(*system, state, pos, make_velocity_kinematics(*system), whole);
  const ConstraintBlocks computed = compute_constraint_blocks(*system, state), cut = cut_into_blocks(*system, whole);
  for (const ConstraintBlocks* blocks : {&computed, &cut}) {
    EXPECT_TRUE(blocks->phi.isApprox(whole.phi, 1e-14) || whole.phi.norm() < 1e-14);
    MatrixXd G = MatrixXd::Zero(system->m, system->nv);
    for (const ConstraintBlock& block : blocks->blocks) {
      for (std::size_t k = 0; k < block.columns.size(); ++k) {
        G.col(block.columns[k]).segment(block.row, block.G.rows()) = block.G.col(static_cast<long>(k));
      }
    }
    EXPECT_LE((G - MatrixXd(whole.G)).cwiseAbs().maxCoeff(), 1e-14) << spec.name << ": nothing lies outside the blocks";
  }
}

TEST(ConstraintBlocksTest, BlocksHoldAllOfTheJacobianOfTheZoo) {
  for (const witness::ZooEntry& entry : witness::zoo()) {
    if (make_system(*build_model(entry.spec).model)->m > 0) expect_same_as_whole(entry.spec, 0.05);
  }
}

TEST(ConstraintBlocksTest, BlocksHoldAllOfTheJacobianOfRandomMechanisms) {
  for (unsigned seed = 1; seed <= 60; ++seed) expect_same_as_whole(witness::make_random_mechanism(seed).spec, 0.02);
}

TEST(ConstraintBlocksTest, FillingAgainForgetsTheLastPose) {
  const auto system = make_system(*build_model(witness::make_planetary(2)).model);
  State state = make_drawn_state(*system);
  PositionKinematics pos = make_position_kinematics(*system);
  ConstraintBlocks blocks = make_constraint_blocks(*system);
  for (int i = 0; i < 2; ++i) {
    compute_positions(*system, state.q, pos);
    compute_constraint_blocks(*system, state, pos, blocks);
    const ConstraintBlocks fresh = compute_constraint_blocks(*system, state);
    EXPECT_EQ(blocks.phi, fresh.phi);
    for (std::size_t b = 0; b < fresh.blocks.size(); ++b) EXPECT_EQ(blocks.blocks[b].G, fresh.blocks[b].G);
    displace(*system, VectorXd::Constant(system->nv, 0.1), state.q);
  }
}

}  // namespace
}  // namespace ferrers
