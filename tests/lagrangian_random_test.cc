// Random systems by formulas: what the engine makes of them against the same functions evaluated here, whose
// derivatives are taken by differences; forward and inverse dynamics against each other; the order of names does not
// matter.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "ferrers/dynamics/inverse.h"
#include "ferrers/io/model_reader.h"
#include "ferrers/kinematics/assembly.h"
#include "ferrers/testing/compare.h"
#include "ferrers/testing/engine_probe.h"
#include "ferrers/testing/finite_difference.h"

namespace ferrers::witness {
namespace {

/// A system as numbers: everything below is made of c·sin(q_i + p) and squares.
struct RandomSystem {
  int n = 0, w = 0;
  struct Wave {
    int i;
    double c, p;
    double at(const VectorXd& q) const { return c * std::sin(q[i] + p); }
    std::string text() const { return fmt::format("({:.17g})*sin(x{} + ({:.17g}))", c, i, p); }
  };
  VectorXd masses, damping, stiffness;
  std::vector<std::vector<Wave>> parts;  ///< T = ½ Σ m v² + ½ Σ_k (Σ_j wave_kj v_j)².
  std::vector<Wave> hills;               ///< V = ½ Σ k q² + Σ wave.
  struct Row {
    std::vector<Wave> waves;
    VectorXd slopes;
    double offset = 0;  ///< Value at the start, so that the row is zero there.
  };
  std::vector<Row> rows;  ///< Σ wave + slopes·q − offset.
  struct Duplicate {
    int a, b;
    double alpha, beta;  ///< (alpha + x0²)·phi_a + beta·phi_b.
  };
  std::vector<Duplicate> duplicates;
  VectorXd q0;

  double kinetic(const VectorXd& q, const VectorXd& v) const {
    double T = 0.5 * masses.dot(v.cwiseAbs2());
    for (const auto& part : parts) {
      double sum = 0;
      for (int j = 0; j < n; ++j) sum += part[j].at(q) * v[j];
      T += 0.5 * sum * sum;
    }
    return T;
  }
  double potential(const VectorXd& q) const {
    double V = 0.5 * stiffness.dot(q.cwiseAbs2());
    for (const Wave& hill : hills) V += hill.at(q);
    return V;
  }
  VectorXd residual(const VectorXd& q) const {
    VectorXd phi(rows.size() + duplicates.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
      phi[i] = rows[i].slopes.dot(q) - rows[i].offset;
      for (const Wave& wave : rows[i].waves) phi[i] += wave.at(q);
    }
    for (std::size_t i = 0; i < duplicates.size(); ++i) {
      const Duplicate& d = duplicates[i];
      phi[rows.size() + i] = (d.alpha + q[0] * q[0]) * phi[d.a] + d.beta * phi[d.b];
    }
    return phi;
  }

  explicit RandomSystem(std::uint64_t seed) {
    RandomSource random(seed);
    n = 2 + random.below(5);
    const int m = random.below(std::min(4, n));
    const auto vector = [&](double low, double high) {
      VectorXd out(n);
      for (double& x : out) x = random.between(low, high);
      return out;
    };
    const auto wave = [&](int i, double size) { return Wave{i, random.between(-size, size), random.between(-3, 3)}; };
    masses = vector(0.5, 3);
    damping = vector(0, 0.5);
    stiffness = vector(0, 4);
    q0 = vector(-1, 1);
    for (int k = 0; k < 2; ++k) {
      parts.emplace_back();
      for (int j = 0; j < n; ++j) parts.back().push_back(wave(random.below(n), 1));
    }
    for (int k = 0; k < n; ++k) hills.push_back(wave(k, 3));
    for (int k = 0; k < m; ++k) {
      Row row{{wave(random.below(n), 1), wave(random.below(n), 1)}, vector(-2, 2), 0};
      rows.push_back(row);
      rows.back().offset = residual(q0)[k];
    }
    if (m > 0 && random.chance(0.5)) {
      duplicates.push_back({random.below(m), random.below(m), random.between(0.5, 2), random.between(-1, 1)});
    }
    w = n - m;
  }

  std::string row_text(const Row& row) const {
    std::string text = fmt::format("-({:.17g})", row.offset);
    for (int j = 0; j < n; ++j) text += fmt::format(" + ({:.17g})*x{}", row.slopes[j], j);
    for (const Wave& one : row.waves) text += " + " + one.text();
    return text;
  }

  /// The model file; `order` permutes coordinates and constraints.
  ModelSpec spec(const std::string& drives, bool backwards = false) const {
    std::string T, V, R, coordinates, constraints, initial;
    for (int i = 0; i < n; ++i) {
      T += fmt::format("{}({:.17g})/2*x{}.velocity^2", i ? " + " : "", masses[i], i);
      V += fmt::format("{}({:.17g})/2*x{}^2", i ? " + " : "", stiffness[i], i);
      R += fmt::format("{}({:.17g})/2*x{}.velocity^2", i ? " + " : "", damping[i], i);
      const int k = backwards ? n - 1 - i : i;
      coordinates += fmt::format("    x{}: {{unit: m, guess: {:.17g}}}\n", k, q0[k]);
    }
    for (const auto& part : parts) {
      std::string sum;
      for (int j = 0; j < n; ++j) sum += fmt::format("{}{}*x{}.velocity", j ? " + " : "", part[j].text(), j);
      T += " + 1/2*(" + sum + ")^2";
    }
    for (const Wave& hill : hills) V += " + " + hill.text();
    std::vector<std::string> lines;
    for (std::size_t i = 0; i < rows.size(); ++i)
      lines.push_back(fmt::format("  r{}: \"= {}\"\n", i, row_text(rows[i])));
    for (const Duplicate& d : duplicates) {
      lines.push_back(fmt::format("  more: \"= (({:.17g}) + x0^2)*({}) + ({:.17g})*({})\"\n", d.alpha,
                                  row_text(rows[d.a]), d.beta, row_text(rows[d.b])));
    }
    if (backwards) std::reverse(lines.begin(), lines.end());
    for (const std::string& line : lines) constraints += line;
    const std::string text = "ferrers: 1\ngravity: [0, 0, 0]\nbodies: {}\nlagrangian:\n  coordinates:\n" + coordinates +
                             "  kinetic_energy: \"= " + T + "\"\n  potential_energy: \"= " + V +
                             "\"\n  dissipation: \"= " + R + "\"\n" +
                             (lines.empty() ? "" : "constraints:\n" + constraints) + drives;
    const ModelReadResult read = read_model_text(text, "random.yaml");
    if (!read.model) throw std::runtime_error(read.diagnostics.items().front().message + "\n" + text);
    return read.spec;
  }
};

State state_at(const EngineProbe& engine, const RandomSystem& system, const VectorXd& v) {
  State state = make_drawn_state(*engine.system);
  for (int k = 0; k < system.n; ++k) {
    const JointCoordinate x{*engine.model().find_joint(fmt::format("x{}", k)), 0};
    const CoordinateAccess access = engine.system->access(x);
    state.q[access.q] = system.q0[k];
    state.v[access.v] = v[k];
  }
  return state;
}

class RandomLagrangianTest : public ::testing::TestWithParam<int> {};

TEST_P(RandomLagrangianTest, ForwardAndInverseDynamicsAreThoseOfTheFunctions) {
  constexpr int kSystems = 20;
  int checked = 0, redundant = 0;
  for (std::uint64_t seed = 1000 * GetParam(); checked < kSystems; ++seed) {
    ASSERT_LT(seed, 1000 * GetParam() + 3 * kSystems) << "too many systems are not clear";
    SCOPED_TRACE(seed);
    const RandomSystem random(seed);
    const int n = random.n;
    // The rows and their rank, from functions alone.
    const MatrixXd G = difference_jacobian([&](const VectorXd& q) { return random.residual(q); }, random.q0);
    int rank = 0;
    VectorXd v = VectorXd::LinSpaced(n, -1, 1.3);
    if (G.rows() > 0) {
      const Eigen::JacobiSVD<MatrixXd> svd(G, Eigen::ComputeFullU | Eigen::ComputeFullV);
      rank = static_cast<int>((svd.singularValues().array() > 1e-7 * svd.singularValues()[0]).count());
      const MatrixXd N = svd.matrixV().rightCols(n - rank);
      if (svd.singularValues()[rank - 1] < 1e-2 * svd.singularValues()[0]) continue;  // no clear system
      v = N * (N.transpose() * v);
    }

    ++checked;
    redundant += G.rows() > rank ? 1 : 0;
    EngineProbe plain(random.spec(""));
    plain.evaluate(state_at(plain, random, v));
    EXPECT_EQ(static_cast<int>(plain.selection.rows.size()), rank);
    ASSERT_EQ(static_cast<int>(plain.selection.independent.size()), n - rank);

    // Efforts along independent coordinates give accelerations and multipliers.
    std::string efforts, motions;
    VectorXd along = VectorXd::Zero(n);
    std::vector<int> driven;
    for (const int i : plain.selection.independent) driven.push_back(i);
    for (const int i : driven) {
      along[i] = 2 - 0.7 * i;
      efforts += fmt::format("  d{}: {{joint: x{}, effort: {:.17g}}}\n", i, i, along[i]);
    }
    EngineProbe engine(random.spec(driven.empty() ? "" : "drives:\n" + efforts));
    const State state = state_at(engine, random, v);
    const ForwardResult forward = engine.forward(state);
    ASSERT_EQ(forward.status, ForwardStatus::kSolved);

    // The equations of motion of the functions: M by polarization, exact; the rest by differences.
    MatrixXd M(n, n);
    const auto kinetic = [&](const VectorXd& u) { return random.kinetic(random.q0, u); };
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) {
        const VectorXd a = VectorXd::Unit(n, i), b = VectorXd::Unit(n, j);
        M(i, j) = kinetic(a + b) - kinetic(a) - kinetic(b);
      }
    }
    EXPECT_TRUE(matrices_near(engine.eq.M, M, 1e-12, "M"));
    const VectorXd momentum_rate = differentiate(
        [&](double s) {
          VectorXd p(n);
          const VectorXd q = random.q0 + s * v;
          for (int i = 0; i < n; ++i) {
            const VectorXd e = VectorXd::Unit(n, i);
            p[i] = 0.5 * (random.kinetic(q, v + e) - random.kinetic(q, v - e));
          }
          return p;
        },
        0.0);
    VectorXd h = momentum_rate;
    for (int i = 0; i < n; ++i) {
      h[i] -= differentiate(
          [&](double s) {
            const VectorXd q = random.q0 + s * VectorXd::Unit(n, i);
            return random.kinetic(q, v) - random.potential(q);
          },
          0.0);
    }
    const VectorXd Q = -random.damping.cwiseProduct(v);
    VectorXd right = Q + along;
    if (G.rows() > 0) right += G.transpose() * forward.lambda;
    EXPECT_TRUE(matrices_near(M * forward.vdot + h, right, 1e-9, "equations of motion"));

    // The power of the efforts and the dissipation is the rate of the energy.
    const VectorXd& vdot = forward.vdot;
    const double rate = differentiate(
        [&](double s) {
          const VectorXd q = random.q0 + s * v + 0.5 * s * s * vdot;
          return random.kinetic(q, v + s * vdot) + random.potential(q);
        },
        0.0);
    EXPECT_NEAR(rate, (along + Q).dot(v), 1e-8 * (1 + std::abs(rate)));

    // Prescribing these accelerations wants the same efforts.
    if (!driven.empty()) {
      for (const int i : driven) {
        motions += fmt::format("  d{}: {{joint: x{}, motion: \"= ({:.17g}) + ({:.17g})*t + ({:.17g})/2*t^2\"}}\n", i, i,
                               random.q0[i], v[i], vdot[i]);
      }
      EngineProbe inverse(random.spec("drives:\n" + motions));
      PrescribedMotion motion(inverse.dynamics, state);
      const PrescribedResult result = motion.solve(0);
      ASSERT_EQ(result.status, PrescribedStatus::kSolved) << result.message;
      for (std::size_t d = 0; d < driven.size(); ++d) {
        EXPECT_NEAR(result.u[d], along[driven[d]], 1e-9 * (10 + right.norm() + h.norm())) << "effort " << d;
      }
      EXPECT_TRUE(matrices_near(result.vdot, vdot, 1e-9, "accelerations"));
      if (G.rows() > 0) {
        EXPECT_TRUE(
            matrices_near(G.transpose() * result.lambda, G.transpose() * forward.lambda, 1e-8, "constraint forces"));
      }
    }

    // Other orders of the same names.
    EngineProbe turned(random.spec(driven.empty() ? "" : "drives:\n" + efforts, true));
    const ForwardResult again = turned.forward(state_at(turned, random, v));
    ASSERT_EQ(again.status, ForwardStatus::kSolved);
    EXPECT_TRUE(matrices_near(again.vdot.reverse(), vdot, 1e-9, "accelerations in another order"));
  }
  EXPECT_GE(redundant, kSystems / 5);
  EXPECT_GE(kSystems - redundant, kSystems / 5);
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomLagrangianTest, ::testing::Range(0, 10));

}  // namespace
}  // namespace ferrers::witness
