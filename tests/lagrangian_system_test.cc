// Systems that C++ users give by functions, or as templates, against the same systems by formulas of a model file.

#include "ferrers/model/lagrangian_system.h"

#include <gtest/gtest.h>

#include <random>

#include "ferrers/io/model_reader.h"
#include "ferrers/model/lagrangian_template.h"
#include "ferrers/testing/allocation_guard.h"
#include "ferrers/testing/andrews_formulas.h"
#include "ferrers/testing/run_probe.h"

namespace ferrers {
namespace {

using witness::EngineProbe;

ModelSpec example(const std::string& name) {
  ModelReadResult read = read_model_file(std::string(FERRERS_SOURCE_DIR) + "/examples/" + name + "/model.yaml");
  if (!read.model) throw std::runtime_error("cannot read " + name);
  return read.spec;
}

class HandWrittenAndrews final : public LagrangianSystem {
 public:
  int coordinates() const override { return 7; }
  int constraints() const override { return 6; }
  void compute_constraints(EquationsOfMotion& eq) const override {
    const Numbers numbers = compute(eq);
    for (int i = 0; i < 6; ++i) {
      eq.phi[i] = numbers[35 + i];
      for (int j = 0; j < 7; ++j) eq.G(i, j) = numbers[41 + 7 * i + j];
      eq.gamma[i] = numbers[83 + i];
    }
  }
  void compute_inertia(EquationsOfMotion& eq) const override {
    const Numbers numbers = compute(eq);
    int next = 0;
    for (int i = 0; i < 7; ++i) {
      for (int j = i; j < 7; ++j) eq.M(i, j) = eq.M(j, i) = numbers[next++];
    }
    for (int i = 0; i < 7; ++i) eq.h[i] = -numbers[28 + i];
  }
  Eigen::Vector2d compute_energy(const EquationsOfMotion&) const override { return {0, 0}; }

 private:
  using Numbers = std::array<double, witness::kAndrewsOutputs>;
  static Numbers compute(const EquationsOfMotion& eq) {
    std::array<double, 14> inputs;
    for (int i = 0; i < 7; ++i) {
      inputs[i] = eq.q[i];
      inputs[7 + i] = eq.v[i];
    }
    Numbers numbers;
    witness::compute_andrews_by_hand(inputs.data(), numbers.data());
    return numbers;
  }
};

// The four-bar of examples/four-bar-points, T, V and phi only.
struct FourBarPoints {
  static constexpr int kCoordinates = 4, kConstraints = 4;
  double g = 9.81, rho = 2, xc = 1.8, a = std::hypot(0.3, 0.9), b = std::hypot(1.7, 0.6), c = std::hypot(0.2, 1.5);

  template <class S>
  S kinetic_energy(const std::array<S, 4>&, const std::array<S, 4>& v) const {
    const S one = v[0] * v[0] + v[1] * v[1], two = v[2] * v[2] + v[3] * v[3], both = v[0] * v[2] + v[1] * v[3];
    return rho * a / 6 * one + rho * c / 6 * two + rho * b / 6 * (one + both + two);
  }
  template <class S>
  S potential_energy(const std::array<S, 4>& q) const {
    return g * rho * (a * q[1] / 2 + b * (q[1] + q[3]) / 2 + c * q[3] / 2);
  }
  template <class S>
  std::array<S, 4> constraints(const std::array<S, 4>& q) const {
    using std::pow;
    const S one = q[0] * q[0] + q[1] * q[1], two = q[2] * q[2] + q[3] * q[3];
    return {one - a * a, pow(q[2] - q[0], 2) + pow(q[3] - q[1], 2) - b * b, pow(q[2] - xc, 2) + q[3] * q[3] - c * c,
            two - 2.0 * (q[0] * q[2] + q[1] * q[3]) + a * a - b * b};
  }
};

/// The specification with its formulas taken out and these functions put in.
ModelSpec with_functions(ModelSpec spec, std::shared_ptr<const LagrangianSystem> system) {
  LagrangianSpec& lagrangian = spec.lagrangian;
  lagrangian.kinetic_energy = lagrangian.potential_energy = std::nullopt;
  lagrangian.mass_matrix.clear();
  for (const ConstraintSpec& constraint : spec.constraints)
    lagrangian.function_constraints.push_back({constraint.name});
  spec.constraints.clear();
  lagrangian.system = std::move(system);
  return spec;
}

/// Both at the same random states, on the constraints or not.
void expect_same_equations(const ModelSpec& formulas, const ModelSpec& functions, bool with_forces) {
  EngineProbe a(formulas), b(functions);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-2, 2);
  for (int trial = 0; trial < 50; ++trial) {
    State state = make_drawn_state(*a.system);
    for (double& q : state.q) q = uniform(random);
    for (double& v : state.v) v = 3 * uniform(random);
    a.evaluate(state);
    b.evaluate(state);
    const auto near = [](const MatrixXd& x, const MatrixXd& y, const char* what) {
      ASSERT_EQ(x.rows(), y.rows());
      EXPECT_LE((x - y).norm(), 1e-12 * (1e-6 + x.norm())) << what;
    };
    near(a.eq.constraints.phi, b.eq.constraints.phi, "phi");
    near(a.eq.constraints.G, b.eq.constraints.G, "G");
    near(a.eq.constraints.gamma, b.eq.constraints.gamma, "gamma");
    near(a.eq.M, b.eq.M, "M");
    if (with_forces) near(a.eq.force, b.eq.force, "forces");
    if (!with_forces) near(a.eq.h, b.eq.h, "h");
  }
}

TEST(LagrangianSystemTest, DerivativesOfFormulasAreThoseWrittenByHand) {
  ModelSpec functions = with_functions(example("andrews-angles"), std::make_shared<HandWrittenAndrews>());
  functions.drives.clear();  // the torque is in the hand-written forces
  expect_same_equations(example("andrews-angles"), functions, true);
}

TEST(LagrangianSystemTest, DerivativesOfTemplatesAreThoseOfFormulas) {
  const ModelSpec formulas = example("four-bar-points");
  expect_same_equations(formulas, with_functions(formulas, make_lagrangian_system(FourBarPoints())), false);
}

TEST(LagrangianSystemTest, ASystemByTemplatesIsAnalyzedAndSimulatedLikeAnyOther) {
  ModelSpec formulas = example("four-bar-points");
  formulas.records.clear();
  const ModelSpec functions = with_functions(formulas, make_lagrangian_system(FourBarPoints()));
  const EngineProbe engine(functions);
  const RedundancyReport report = analyze_redundancy(*engine.system, engine.start());
  EXPECT_EQ(report.mobility, 1);
  EXPECT_EQ(report.redundant, 1);
  EXPECT_EQ(report.reactions.size(), 8U);  // four coordinates without rows, four constraints
  const auto a = witness::probe_run(formulas, witness::plain_run(2, 0.5));
  const auto b = witness::probe_run(functions, witness::plain_run(2, 0.5));
  ASSERT_EQ(b.summary.status, RunStatus::kFinished);
  for (const double t : {0.5, 1.0, 2.0}) {
    for (const char* name : {"x1", "y1", "x2", "y2"}) EXPECT_NEAR(a.at(t, name), b.at(t, name), 1e-9) << name << t;
    EXPECT_NEAR(a.at(t, "energy"), b.at(t, "energy"), 1e-8);
  }
}

TEST(LagrangianSystemTest, AnEvaluationOfTemplatesAllocatesNothing) {
  EngineProbe engine(with_functions(example("four-bar-points"), make_lagrangian_system(FourBarPoints())));
  const State state = engine.start();
  compute_equations(*engine.dynamics, state, engine.eq);
  const witness::AllocationGuard guard;
  compute_equations(*engine.dynamics, state, engine.eq);
  EXPECT_EQ(guard.count(), 0);
}

// A spring whose stiffness is a parameter of the model.
class SpringOfParameter final : public LagrangianSystem {
 public:
  int coordinates() const override { return 1; }
  int constraints() const override { return 0; }
  void compute_constraints(EquationsOfMotion&) const override {}
  void compute_inertia(EquationsOfMotion& eq) const override { eq.M(0, 0) = 2; }
  void compute_forces(EquationsOfMotion& eq) const override { eq.tau[0] = -eq.parameters[0] * eq.q[0]; }
  Eigen::Vector2d compute_energy(const EquationsOfMotion& eq) const override {
    return {eq.v[0] * eq.v[0], 0.5 * eq.parameters[0] * eq.q[0] * eq.q[0]};
  }
};

TEST(LagrangianSystemTest, FunctionsSeeTheParametersThatAreSet) {
  ModelSpec spec;
  spec.parameters.push_back({"k", Number(8.0), {}, {}, {}, {}, ""});
  spec.lagrangian.coordinates.push_back({"x", kLength, {}, {}});
  spec.lagrangian.system = std::make_shared<SpringOfParameter>();
  const Model model = *build_model(spec).model;
  for (const double k : {8.0, 18.0}) {
    const auto dynamics = make_dynamics_model(make_system(*model.with_parameters({{"k", k}}).model));
    Equations eq = make_equations(*dynamics);
    State state = make_drawn_state(*dynamics->system);
    state.q[0] = 0.5;
    compute_equations(*dynamics, state, eq);
    EXPECT_DOUBLE_EQ(eq.M(0, 0), 2);
    EXPECT_DOUBLE_EQ(eq.force[0], -0.5 * k);
  }
}

TEST(LagrangianSystemTest, NamesMustBeAsManyAsTheFunctionsFill) {
  const ModelSpec right = with_functions(example("four-bar-points"), make_lagrangian_system(FourBarPoints()));
  EXPECT_TRUE(build_model(right).model);
  for (const int coordinates : {3, 4, 5}) {
    for (const int constraints : {0, 3, 4, 5}) {
      if (coordinates == 4 && constraints == 4) continue;
      ModelSpec spec = right;
      spec.lagrangian.coordinates.resize(static_cast<std::size_t>(coordinates), {"extra", kLength, {}, {}});
      spec.lagrangian.function_constraints.resize(static_cast<std::size_t>(constraints), {"more"});
      spec.records.clear();
      spec.initial.clear();
      spec.drives.clear();
      const ModelBuildResult built = build_model(spec);
      EXPECT_FALSE(built.model);
      ASSERT_FALSE(built.diagnostics.items().empty());
      EXPECT_EQ(built.diagnostics.items().front().code, "F337");
    }
  }
}

TEST(LagrangianSystemTest, FunctionsAndFormulasForTheSameAreRefused) {
  ModelSpec spec = with_functions(example("four-bar-points"), make_lagrangian_system(FourBarPoints()));
  spec.lagrangian.potential_energy = Expression::variable("x1");
  const ModelBuildResult built = build_model(spec);
  ASSERT_FALSE(built.model);
  EXPECT_EQ(built.diagnostics.items().front().code, "F211");
}

}  // namespace
}  // namespace ferrers
