#include <gtest/gtest.h>

#include "ferrers/testing/allocation_guard.h"
#include "ferrers/testing/engine_probe.h"
#include "ferrers/testing/zoo.h"
#include "ferrers/testing/zoo_parts.h"

/// Evaluating forward dynamics with multipliers allocates nothing, whatever the mechanism carries.
namespace ferrers::witness {
namespace {

/// A coupling on joints in the tree and one that is cut, gear meshes, every kind of force element, drives of two kinds.
ModelSpec everything() {
  ModelSpec spec = make_planetary(3);
  spec.name = "everything";
  CouplingSpec coupling;
  coupling.name = "geared";
  coupling.coordinates = {CoordinateRef{NameRef("sun_bearing"), ""}, CoordinateRef{NameRef("carrier_bearing"), ""}};
  coupling.coefficients = {Number(1), Number(-4.4)};  // sun : carrier = 1 + ring/sun
  spec.couplings = {coupling};
  SpringSpec spring;
  spring.bodies = {NameRef("ground"), NameRef("carrier")};
  spring.points = {number3(3, 0, 0), number3(1, 0, -0.2)};
  spring.stiffness = Number(100);
  spring.damping = Number(2);
  TorsionSpringSpec torsion;
  torsion.coordinate = {NameRef("planet1_pin"), ""};
  torsion.stiffness = Number(3);
  JointDampingSpec damping;
  damping.coordinate = {NameRef("planet2_pin"), ""};
  damping.damping = Number(0.1);
  LoadSpec load;
  load.body = NameRef("planet3");
  load.is_torque = true;
  load.components = {law("0"), law("sin(t)"), law("0.1*carrier_bearing.velocity")};
  load.in_body_axes = true;
  BushingSpec bushing;
  bushing.bodies = {NameRef("ground"), NameRef("sun")};
  bushing.place.drawn = number3(0, 0, 0);
  bushing.axis.drawn = number3(0, 0, 1);
  bushing.force_stiffness = bushing.moment_stiffness = number3(10, 20, 30);
  bushing.force_damping = bushing.moment_damping = number3(0.1, 0.2, 0.3);
  const auto add = [&](const char* name, const auto& element) {
    ForceSpec force;
    force.name = name;
    force.element = element;
    spec.forces.push_back(force);
  };
  add("spring", spring);
  add("torsion", torsion);
  add("damping", damping);
  add("load", load);
  add("bushing", bushing);
  spec.drives = {coordinate_drive("motor", "sun_bearing", "", "2*t - sun_bearing.velocity")};
  return spec;
}

class AllocationTest : public ::testing::TestWithParam<ModelSpec> {};

TEST_P(AllocationTest, EvaluationWithMultipliersAllocatesNothing) {
  if (!AllocationGuard::available()) GTEST_SKIP() << "allocations are not counted in this build";
  for (const Formulation formulation : kFormulations) {
    EngineProbe engine(GetParam());
    State state = engine.wandered(1, 0.1);
    ForwardResult result = make_forward_result(*engine.system);
    const auto solver = make_forward_solver(formulation, *engine.system, engine.selection);
    solver->solve(engine.eq, result);  // warm
    ASSERT_EQ(result.status, ForwardStatus::kSolved);
    AllocationGuard guard;
    compute_equations(*engine.dynamics, state, engine.eq);
    const long in_equations = guard.count();
    solver->solve(engine.eq, result);
    const long in_all = guard.count();
    solver->resolve(engine.eq.force, engine.eq.constraints.gamma, result);
    const long with_resolution = guard.count();
    EXPECT_EQ(in_equations, 0) << GetParam().name;
    EXPECT_EQ(in_all - in_equations, 0) << GetParam().name << ", " << to_string(formulation);
    EXPECT_EQ(with_resolution - in_all, 0) << GetParam().name << ", " << to_string(formulation);
    EXPECT_EQ(result.status, ForwardStatus::kSolved);
  }
}

INSTANTIATE_TEST_SUITE_P(Mechanisms, AllocationTest,
                         ::testing::Values(make_pendulum(), make_bricard(BricardRods::kBricks),
                                           make_four_bar(FourBarJoints::kRevolute),
                                           make_four_bar(FourBarJoints::kTwoSpherical), make_flyball(), make_andrews(),
                                           make_planetary(3), make_n_four_bar(40, 0.3), everything()),
                         [](const auto& one) { return one.param.name; });

}  // namespace
}  // namespace ferrers::witness
