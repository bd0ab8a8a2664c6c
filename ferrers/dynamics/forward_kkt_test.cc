#include "ferrers/dynamics/forward_kkt.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <map>
#include <numeric>

#include "ferrers/redundancy/cluster_rank.h"
#include "ferrers/redundancy/selection.h"
#include "ferrers/testing/compare.h"
#include "ferrers/testing/engine_probe.h"
#include "ferrers/testing/random_source.h"
#include "ferrers/testing/zoo.h"

namespace ferrers::witness {
namespace {

/// Random matrices with a given share of entries.
struct RandomKkt {
  KktStructure structure;
  std::vector<int> rows;
  MatrixXd M;
  RowMatrixXd G;

  RandomKkt(RandomSource& random, int r, int n, double share) {
    G = RowMatrixXd::Zero(r, n);
    M = MatrixXd::Zero(n, n);
    structure.rows.resize(r);
    structure.mass.resize(n);
    for (int i = 0; i < r; ++i) {
      rows.push_back(r - 1 - i);  // any order of rows
      for (int j = 0; j < n; ++j) {
        if (j == i || random.chance(share)) structure.rows[i].push_back(j);
      }
    }
    for (int p = 0; p < n; ++p) {
      for (int q = 0; q < p; ++q) {
        if (!random.chance(share)) continue;
        structure.mass[p].push_back(q);
        structure.mass[q].push_back(p);
      }
    }
    fill(random);
  }

  void fill(RandomSource& random) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
      // Square blocks stay regular: what an order of pivots can be kept for.
      for (const int j : structure.rows[i]) {
        G(rows[i], j) = (j == static_cast<int>(i) ? 3 : 0) + random.between(-1, 1) / (j % 3 + 1);
      }
    }
    const auto n = static_cast<int>(M.rows());
    for (int p = 0; p < n; ++p) {
      M(p, p) = n + random.between(0, 1);  // positive definite by its diagonal
      for (const int q : structure.mass[p]) {
        if (q < p) M(p, q) = M(q, p) = random.between(-1, 1);
      }
    }
  }
};

// With an entry in every place.
PatternMatrix filled(const MatrixXd& dense) {
  std::vector<int> all(static_cast<std::size_t>(dense.cols()));
  std::iota(all.begin(), all.end(), 0);
  PatternMatrix out(std::vector<std::vector<int>>(static_cast<std::size_t>(dense.rows()), all),
                    static_cast<int>(dense.cols()));
  for (int i = 0; i < dense.rows(); ++i) {
    for (int k = 0; k < dense.cols(); ++k) out.entry(i, k) = dense(i, k);
  }
  return out;
}

SparseKkt ordered(KktStructure structure, const std::vector<int>& rows, const VectorXd& scale, const PatternMatrix& G) {
  take_values(rows, G, structure);
  return {structure, rows, scale};
}

TEST(SparseKktTest, SolvesWhatADenseFactorizationSolves) {
  RandomSource random(1);
  for (int trial = 0; trial < 200; ++trial) {
    const int n = 1 + trial % 25, r = trial % (n + 1);
    RandomKkt kkt(random, r, n, 0.05 + 0.15 * (trial % 5));
    SparseKkt sparse = ordered(kkt.structure, kkt.rows, VectorXd::Ones(n), filled(kkt.G));
    for (int again = 0; again < 3; ++again) {
      ASSERT_EQ(sparse.factor(filled(kkt.M), filled(kkt.G)), ForwardStatus::kSolved);
      VectorXd force(n), gamma(r), v(n), lambda(r);
      for (double& x : force) x = random.between(-1, 1);
      for (double& x : gamma) x = random.between(-1, 1);
      sparse.solve(force, gamma, v, lambda);
      const double size = 1 + v.cwiseAbs().maxCoeff() + (r > 0 ? lambda.cwiseAbs().maxCoeff() : 0);
      EXPECT_LT((kkt.M * v - kkt.G.transpose() * lambda - force).cwiseAbs().maxCoeff(), 1e-10 * n * size) << trial;
      if (r > 0) {
        EXPECT_LT((kkt.G * v - gamma).cwiseAbs().maxCoeff(), 1e-10 * size) << trial;
      }
      kkt.fill(random);  // other numbers in the same places, with the order chosen before
    }
  }
}

TEST(SparseKktTest, RowsThatNothingCanSatisfyAndMotionsWithoutMassAreSaid) {
  KktStructure structure;
  structure.rows = {{0}, {0}};
  structure.mass = {{}, {}};
  RowMatrixXd G = RowMatrixXd::Zero(2, 2);
  G.col(0).setOnes();
  const MatrixXd M = MatrixXd::Identity(2, 2);
  SparseKkt twice = ordered(structure, {0, 1}, VectorXd::Ones(2), filled(G));
  EXPECT_EQ(twice.factor(filled(M), filled(G)), ForwardStatus::kWornSelection);
  structure.rows.pop_back();
  SparseKkt once = ordered(structure, {0}, VectorXd::Ones(2), filled(G));
  EXPECT_EQ(once.factor(filled(M), filled(G)), ForwardStatus::kSolved);
  EXPECT_EQ(once.factor(filled(MatrixXd::Zero(2, 2)), filled(G)), ForwardStatus::kSingularMass);
}

TEST(SparseKktTest, TheSmallestPivotIsAPureNumber) {
  RandomSource random(4);
  RandomKkt kkt(random, 6, 9, 0.4);
  SparseKkt plain = ordered(kkt.structure, kkt.rows, VectorXd::Ones(9), filled(kkt.G));
  plain.factor(filled(kkt.M), filled(kkt.G));
  VectorXd unit = VectorXd::Ones(9);
  unit.head(4).setConstant(1e-3);  // the first coordinates in millimetres
  const RowMatrixXd G = kkt.G * unit.asDiagonal();
  SparseKkt other = ordered(kkt.structure, kkt.rows, unit.cwiseInverse(), filled(G));
  other.factor(filled(unit.asDiagonal() * kkt.M * unit.asDiagonal()), filled(G));
  EXPECT_NEAR(other.smallest_pivot() / plain.smallest_pivot(), 1, 1e-10);
}

/// The size of a mechanism's factorization, with rows chosen in linear time.
struct Size {
  long operations = 0, stored = 0;
  explicit Size(const ModelSpec& spec) {
    const EngineProbe engine(spec);
    const State state = make_drawn_state(*engine.system);
    const ConstraintBlocks blocks = compute_constraint_blocks(*engine.system, state);
    const Selection selection =
        select_rows_and_coordinates(*engine.system, decide_clusters(*engine.system, engine.scaling, blocks));
    Equations eq = make_equations(*engine.dynamics);
    compute_equations(*engine.dynamics, state, eq);
    const SparseKkt kkt = ordered(make_kkt_structure(*engine.system, selection.rows), selection.rows,
                                  engine.scaling.columns, eq.constraints.G);
    operations = kkt.operations();
    stored = kkt.stored();
  }
};

TEST(SparseKktTest, WorkAndStorageGrowWithTheNumberOfLocalLoops) {
  const auto expect_linear = [](const auto& make) {
    const Size small(make(10)), medium(make(100)), large(make(300));
    EXPECT_NEAR(static_cast<double>(large.operations - medium.operations) / 200,
                static_cast<double>(medium.operations - small.operations) / 90,
                0.1 * static_cast<double>(medium.operations) / 100);
    EXPECT_LT(large.operations, 120 * 300);
    EXPECT_LT(large.stored, 60 * 300);
  };
  expect_linear([](int n) { return make_n_four_bar(n, 0.3); });
}

}  // namespace
}  // namespace ferrers::witness
