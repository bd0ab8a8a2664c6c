#include "ferrers/dynamics/lagrangian_terms.h"

#include <gtest/gtest.h>

#include "ferrers/testing/allocation_guard.h"
#include "ferrers/testing/build_checks.h"
#include "ferrers/testing/compare.h"
#include "ferrers/testing/engine_probe.h"
#include "ferrers/testing/zoo.h"
#include "ferrers/testing/zoo_parts.h"

/// Energies by formulas over points and cut joints do what the same inertia does as a part of a body.
namespace ferrers::witness {
namespace {

/// A four-bar whose coupler carries two more point masses: as force-free bodies' energies by formulas, or welded on.
ModelSpec four_bar_with(bool by_formulas) {
  ModelSpec spec = make_four_bar(FourBarJoints::kRevolute);
  const std::string coupler = spec.bodies[1].name.name;
  const Point at(0.9, 1.3, 0.2);
  if (!by_formulas) {
    BodySpec lump;
    lump.name = "lump";
    lump.mass = Number(0.7);
    lump.com = numbers(at);
    spec.bodies.push_back(lump);
    spec.joints.push_back(joint(JointType::kWeld, "glue", coupler, "lump", at));
    return spec;
  }
  spec.records.push_back(record("L", coupler, at));
  spec.lagrangian.kinetic_energy = formula("0.7/2*(L.x.velocity^2 + L.y.velocity^2 + L.z.velocity^2)").expression;
  std::string potential = "0";
  for (int k = 0; k < 3; ++k) {
    potential += " - 0.7*(" + std::to_string(spec.gravity[k].value) + ")*L." + std::string(1, "xyz"[k]);
  }
  spec.lagrangian.potential_energy = formula(potential).expression;
  return spec;
}

TEST(LagrangianTermsTest, AMassOnAPointByFormulasIsAWeldedMass) {
  EngineProbe bodies(four_bar_with(false)), formulas(four_bar_with(true));
  for (std::uint64_t seed = 1; seed < 6; ++seed) {
    const State state = bodies.wandered(seed);
    const ForwardResult a = bodies.forward(state);
    State same = make_drawn_state(*formulas.system);
    ASSERT_EQ(same.q.size(), state.q.size());
    same.q = state.q;
    same.v = state.v;
    same.winding = state.winding;
    const ForwardResult b = formulas.forward(same);
    ASSERT_EQ(a.status, ForwardStatus::kSolved);
    ASSERT_EQ(b.status, ForwardStatus::kSolved);
    EXPECT_TRUE(matrices_near(formulas.eq.M, bodies.eq.M, 1e-12, "M"));
    EXPECT_TRUE(matrices_near(formulas.eq.force, bodies.eq.force, 1e-10, "forces"));
    EXPECT_TRUE(matrices_near(b.vdot, a.vdot, 1e-10, "accelerations"));
    const Energy e = compute_energy(*bodies.dynamics, state, bodies.eq.pos, bodies.eq.vel);
    const Energy f = compute_energy(*formulas.dynamics, same, formulas.eq.pos, formulas.eq.vel);
    EXPECT_NEAR(f.kinetic, e.kinetic, 1e-12 * (1 + e.kinetic));
    EXPECT_NEAR(f.total(), e.total(), 1e-11 * (1 + std::abs(e.total())));
  }
}

TEST(LagrangianTermsTest, AnEvaluationAllocatesNothing) {
  if (!AllocationGuard::available()) GTEST_SKIP() << "allocations are not counted in this build";
  EngineProbe engine(four_bar_with(true));
  const State state = engine.wandered(1, 0.1);
  compute_equations(*engine.dynamics, state, engine.eq);  // warm
  const AllocationGuard guard;
  compute_equations(*engine.dynamics, state, engine.eq);
  EXPECT_EQ(guard.count(), 0);
}

}  // namespace
}  // namespace ferrers::witness
