#include "ferrers/dynamics/reduced_motion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "ferrers/dynamics/linearization.h"
#include "ferrers/testing/engine_probe.h"
#include "ferrers/testing/finite_difference.h"
#include "ferrers/testing/random_mechanism.h"
#include "ferrers/testing/transforms.h"
#include "ferrers/testing/zoo.h"
#include "ferrers/testing/zoo_parts.h"

/// Reduced equations and what is derived from them, against the witness in absolute coordinates, and against other
/// descriptions of the same mechanism.
namespace ferrers {
namespace {

using namespace witness;  // NOLINT(google-build-using-namespace)

ReducedMotion reduced(EngineProbe& probe, const State& state) {
  probe.evaluate(state);
  return ReducedMotion(*probe.dynamics, probe.scaling, state, probe.selection);
}

TEST(ReducedMotionTest, AMoveKeepsEveryRowClosedAndGoesWhereItIsTold) {
  for (const ZooEntry& entry : zoo()) {
    EngineProbe probe(entry.spec);
    const State start = probe.start();
    ReducedMotion motion = reduced(probe, start);
    if (!compute_reduced_stiffness(motion, probe.scaling.length_m).valid) continue;  // a singular pose
    const VectorXd ds = VectorXd::Constant(motion.w(), 0.01), dv = VectorXd::Constant(motion.w(), 0.5);
    State next;
    ASSERT_TRUE(motion.move(ds, dv, next)) << entry.name;
    probe.evaluate(next);
    EXPECT_LE(probe.eq.constraints.phi.cwiseProduct(probe.scaling.rows).lpNorm<Eigen::Infinity>(),
              1e-11 * probe.scaling.length_m)
        << entry.name;
    EXPECT_LE(probe.eq.constraints.rate.lpNorm<Eigen::Infinity>(), 1e-9) << entry.name;
    for (int k = 0; k < motion.w(); ++k) {
      const int i = motion.selection().independent[k];
      EXPECT_NEAR(next.v[i], start.v[i] + 0.5, 1e-12);
    }
  }
}

TEST(ReducedMotionTest, ReducedAccelerationsAreThoseOfTheForwardSolver) {
  for (std::uint64_t seed = 1; seed <= 15; ++seed) {
    EngineProbe probe(make_random_mechanism(seed).spec);
    const State state = probe.wandered(seed);
    const ForwardResult forward = probe.forward(state);
    const ReducedMotion motion = reduced(probe, state);
    VectorXd z;
    ASSERT_TRUE(motion.accelerations(z));
    const VectorXd wanted = forward.vdot(motion.selection().independent);
    EXPECT_LE((z - wanted).norm(), 1e-9 * (1 + wanted.norm())) << seed;
  }
}

// --- Against the witness ---

/// The witness's accelerations of all bodies, stacked.
VectorXd witness_accelerations(const Model& model, const AbsoluteState& state, const std::vector<Vector6d>& wrenches) {
  const AbsoluteMotion motion = solve_absolute(model, state, wrenches);
  VectorXd all(6 * static_cast<long>(motion.accelerations.size()));
  for (std::size_t b = 0; b < motion.accelerations.size(); ++b) {
    all.segment<6>(6 * static_cast<long>(b)) = motion.accelerations[b];
  }
  return all;
}

/// The independent accelerations behind accelerations of the bodies: those are affine in vdot.
VectorXd independent_accelerations(EngineProbe& probe, const State& state, const std::vector<int>& independent,
                                   const VectorXd& bodies) {
  probe.evaluate(state);
  const auto stacked = [&](const VectorXd& vdot) {
    const std::vector<Vector6d> a = probe.body_accelerations(vdot);
    VectorXd all(6 * static_cast<long>(a.size()));
    for (std::size_t b = 0; b < a.size(); ++b) all.segment<6>(6 * static_cast<long>(b)) = a[b];
    return all;
  };
  const long nv = probe.system->nv;
  const VectorXd bias = stacked(VectorXd::Zero(nv));
  MatrixXd J(bias.size(), nv);
  for (long k = 0; k < nv; ++k) J.col(k) = stacked(VectorXd::Unit(nv, k)) - bias;
  const VectorXd vdot = J.householderQr().solve(bodies - bias);
  return vdot(independent);
}

ModelSpec with_forces(ModelSpec spec, std::uint64_t seed) {
  RandomSource random(seed + 17);
  for (std::size_t b = 0; b < spec.bodies.size(); ++b) {
    SpringSpec element;
    element.bodies = {NameRef("ground"), spec.bodies[b].name};
    const Point place = values(*spec.bodies[b].com) + 0.2 * Point(random.direction());
    element.points = {numbers(place + 0.8 * Point(random.direction())), numbers(place)};
    element.stiffness = Number(random.between(50, 300));
    element.damping = Number(random.between(0.5, 3));
    ForceSpec force;
    force.name = numbered("spring", static_cast<int>(b));
    force.element = element;
    spec.forces.push_back(force);
  }
  return spec;
}

TEST(LinearizationWitnessTest, AAndBAreThoseOfTheWitnessInAbsoluteCoordinates) {
  double worst = 0;
  for (const std::uint64_t seed : {1, 3, 5, 8, 12}) {
    ModelSpec spec = with_forces(make_random_mechanism(seed).spec, seed);
    EngineProbe probe(spec);
    const State base = probe.wandered(seed, 0.2, 0.5);
    const Linearization linear = linearize(*probe.dynamics, base);
    ASSERT_EQ(linear.status, LinearizationStatus::kDone) << seed << linear.message;
    const Model& model = probe.model();
    const std::vector<int>& independent = linear.selection.independent;
    const long w = static_cast<long>(independent.size());
    ReducedMotion motion = reduced(probe, base);
    const auto accelerations = [&](const VectorXd& ds, const VectorXd& dv) {
      State state;
      EXPECT_TRUE(motion.move(ds, dv, state));
      const AbsoluteState absolute = absolute_state(*probe.system, state);
      return independent_accelerations(probe, state, independent,
                                       witness_accelerations(model, absolute, applied_wrenches(model, absolute, 0)));
    };
    MatrixXd A21(w, w), A22(w, w);
    for (long k = 0; k < w; ++k) {
      const VectorXd unit = VectorXd::Unit(w, k), none = VectorXd::Zero(w);
      A21.col(k) = differentiate([&](double h) { return accelerations(h * unit, none); }, 0.0, 3e-3);
      A22.col(k) = differentiate([&](double h) { return accelerations(none, h * unit); }, 0.0, 3e-2);
    }
    const double error = std::max((linear.A.bottomLeftCorner(w, w) - A21).norm() / A21.norm(),
                                  (linear.A.bottomRightCorner(w, w) - A22).norm() / A22.norm());
    worst = std::max(worst, error);
    EXPECT_LE(error, 1e-8) << seed;
    EXPECT_LE(linear.relative_error, 1e-9) << seed;
  }
  RecordProperty("worst", std::to_string(1e12 * worst) + "e-12");
}

// --- The same mechanism, described otherwise ---

std::vector<std::complex<double>> eigenvalues(const ModelSpec& spec, const TopologyOptions& options = {}) {
  const EngineProbe probe(spec, options);
  const Linearization linear = linearize(*probe.dynamics, make_drawn_state(*probe.system));
  EXPECT_EQ(linear.status, LinearizationStatus::kDone) << linear.message;
  EXPECT_TRUE(linear.is_equilibrium);
  return linear.modal.eigenvalues;
}

// Each finds its own in the other list.
double difference(const std::vector<std::complex<double>>& a, std::vector<std::complex<double>> b) {
  if (a.size() != b.size()) return INFINITY;
  double largest = 0, size = 0;
  for (const auto& value : a) {
    size = std::max(size, std::abs(value));
    std::size_t best = 0;
    for (std::size_t i = 1; i < b.size(); ++i) {
      if (std::abs(b[i] - value) < std::abs(b[best] - value)) best = i;
    }
    largest = std::max(largest, std::abs(b[best] - value));
    b.erase(b.begin() + static_cast<long>(best));
  }
  return size > 0 ? largest / size : largest;
}

TEST(LinearizationInvarianceTest, FrequenciesDependOnNoDescription) {
  double worst = 0;
  int compared = 0;
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    ModelSpec spec = with_forces(make_random_mechanism(seed).spec, seed);
    spec.gravity = number3(0, 0, 0);  // springs as long as drawn: an equilibrium
    if (seed % 2 == 0) {
      for (ForceSpec& force : spec.forces) std::get<SpringSpec>(force.element).damping = Number(0.0);
    }
    const auto plain = eigenvalues(spec);
    RandomSource random(seed);
    TopologyOptions cuts;
    for (std::size_t j = 0; j < spec.joints.size(); ++j) cuts.cut.push_back(random.chance(0.5));
    for (const double other :
         {difference(plain, eigenvalues(rotated(spec, random.rotation()))),
          difference(plain, eigenvalues(scaled(spec, 1e3))), difference(plain, eigenvalues(scaled(spec, 1e-3))),
          difference(plain, eigenvalues(permuted(spec, seed))), difference(plain, eigenvalues(spec, cuts))}) {
      worst = std::max(worst, other);
      EXPECT_LE(other, 1e-8) << seed;
      ++compared;
    }
  }
  EXPECT_EQ(compared, 120);
  RecordProperty("worst", std::to_string(1e12 * worst) + "e-12");
}

}  // namespace
}  // namespace ferrers
