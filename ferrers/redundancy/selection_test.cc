#include "ferrers/redundancy/selection.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "ferrers/testing/engine_probe.h"
#include "ferrers/testing/random_source.h"
#include "ferrers/testing/zoo.h"

namespace ferrers::witness {
namespace {

/// A chain with its rows chosen as in a run, G filled.
struct Chain {
  EngineProbe engine;
  Selection selection;

  explicit Chain(int loops) : engine(make_n_four_bar(loops, 0.3)) {
    const State state = make_drawn_state(*engine.system);
    const ConstraintBlocks blocks = compute_constraint_blocks(*engine.system, state);
    selection = select_rows_and_coordinates(*engine.system, decide_clusters(*engine.system, engine.scaling, blocks));
    compute_equations(*engine.dynamics, state, engine.eq);
  }
  const PatternMatrix& G() const { return engine.eq.constraints.G; }
};

TEST(DependentBlockTest, SolvesLikeADenseBlockHoweverLargeItIs) {
  for (const int loops : {10, 100}) {  // 20 rows and 200, on either side of where it becomes sparse
    const Chain chain(loops);
    const DependentBlock block(chain.selection, chain.G());
    const MatrixXd G_d = chain.G()(chain.selection.rows, chain.selection.dependent);
    RandomSource random(7);
    MatrixXd right(G_d.rows(), 3);
    for (long i = 0; i < right.size(); ++i) right.data()[i] = random.between(-1, 1);
    EXPECT_LT((G_d * block.solve(right) - right).cwiseAbs().maxCoeff(), 1e-9) << loops;
    EXPECT_LT((G_d.transpose() * block.solve_transposed(right) - right).cwiseAbs().maxCoeff(), 1e-9) << loops;
  }
}

TEST(DependentBlockTest, OfASingularBlockTheSolutionsAreNotFinite) {
  for (const int loops : {10, 100}) {
    Chain chain(loops);
    const MatrixXd right = MatrixXd::Ones(static_cast<long>(chain.selection.rows.size()), 1);
    PatternMatrix zero = chain.G(), one_row = chain.G();
    std::fill_n(zero.valuePtr(), zero.nonZeros(), 0.0);
    const int row = chain.selection.rows[5];
    for (const int v : chain.selection.dependent) {
      if (one_row(row, v) != 0) one_row.entry(row, v) = 0;
    }
    for (const PatternMatrix* G : {&zero, &one_row}) {
      const DependentBlock block(chain.selection, *G);
      EXPECT_FALSE(block.solve(right).allFinite()) << loops;
      EXPECT_FALSE(block.solve_transposed(right).allFinite()) << loops;
    }
  }
}

TEST(SelectionTest, NoFurtherRowsLeaveASelectionAsItIs) {
  const Chain chain(4);
  const ExtendedSelection same =
      extend_selection(chain.selection, chain.G(), chain.engine.system->m, VectorXd(0), chain.engine.scaling.columns);
  EXPECT_EQ(same.selection.rows, chain.selection.rows);
  EXPECT_EQ(same.selection.dependent, chain.selection.dependent);
  EXPECT_EQ(same.selection.independent, chain.selection.independent);
}

TEST(SelectionTest, ALargeMechanismThatWearsIsChosenAnewWithItsRank) {
  const Chain chain(100);
  const Selection anew =
      reselect(*chain.engine.system, chain.engine.scaling, chain.engine.eq.constraints, chain.selection);
  EXPECT_EQ(anew.rows.size(), chain.selection.rows.size());
  EXPECT_EQ(anew.independent.size(), 1u);
  EXPECT_TRUE(DependentBlock(anew, chain.G()).solve(MatrixXd::Ones(200, 1)).allFinite());
}

}  // namespace
}  // namespace ferrers::witness
