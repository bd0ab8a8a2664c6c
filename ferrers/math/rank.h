#pragma once

#include <Eigen/Core>
#include <vector>

/// The one place that compares a number with a rank tolerance.
///
/// Given: a matrix whose rows and columns were scaled to comparable units by the caller. Wanted: its rank, with what
/// certainty, and what follows (independent rows and columns, null spaces).
/// Decision: with σ_1 ≥ σ_2 ≥ …, values above 1e-5·scale are surely nonzero and values below 1e-10·scale surely zero;
/// the rank is cut in the widest gap of what lies between. It is *confident* when nothing lies between and the gap
/// σ_r/σ_{r+1} is at least 1e4. The scale is σ_1 unless the caller knows a better one.
/// Off the manifold by ε a redundant row shows a singular value of about ε. Where geometry does not close exactly, that
/// is told as the `blur` β = ε/size: values up to 10 β·scale then say nothing, and the gap must be as wide above them.
/// A misclosure between 1e-11 and 1e-8 of the size may be meant (contradictory geometry, hence rigid) or the trace of
/// rounded input (a redundancy): there no zero is confident.
namespace ferrers {

struct RankDecision {
  int rank = 0;
  Eigen::VectorXd singular_values;  ///< Descending.
  double gap = 0;                   ///< σ_r/σ_{r+1}, at most 1e16; 1e16 also where there is no σ_r or no σ_{r+1}.
  bool full = true;                 ///< No singular value was judged zero.
  bool confident = true;
  int other_rank = 0;  ///< The second reading where not confident, else `rank`.
};

/// Decides from singular values alone (descending). `scale` ≤ 0: the largest of them.
/// `blur` ≥ 0: residual of the closure divided by the model's size, where the matrix was taken.
RankDecision decide_rank(Eigen::VectorXd singular_values, double scale = 0, double blur = 0);

/// How a misclosure that no displacement removes is to be read, given relative to the model's size.
enum class Misclosure {
  kNone,      ///< Rounding: the geometry closes.
  kDoubtful,  ///< Either closed but for rounded input, or contradictory.
  kSure,      ///< Contradictory.
};
Misclosure judge_misclosure(double blur);

/// All singular values, descending. Cost: O(m n min(m, n)).
Eigen::VectorXd compute_singular_values(const Eigen::MatrixXd& A);

/// True when |value| is zero beside `scale`, by the rule that rank decisions use.
bool is_negligible(double value, double scale);

/// For eliminations that decide what is clear and leave the rest: zero by the rule of `decide_rank` with a margin of
/// ten, in a matrix scaled to one.
bool is_surely_zero(double value, double blur = 0);
/// Far enough from zero to be divided by. The first of `kPivotRounds` rounds is choosy, so that errors do not grow
/// where there is a choice; the last takes whatever is surely nonzero with a margin.
constexpr int kPivotRounds = 3;
bool is_healthy_pivot(double value, int round);

/// True when a pivot that was healthy when rows and columns were chosen has become too small to go on with that choice.
bool is_worn_pivot(double pivot, double healthy);

/// Rank with both null spaces, by singular value decomposition. Cost: O(m n min(m, n)).
struct RankAnalysis {
  RankDecision decision;
  Eigen::MatrixXd left_null;   ///< m × (m − r), orthonormal: A^T left_null = 0.
  Eigen::MatrixXd right_null;  ///< n × (n − r), orthonormal: A right_null = 0.
};
RankAnalysis analyze_rank(const Eigen::MatrixXd& A, double scale = 0, double blur = 0);

/// `rank` rows (columns) that span all, best conditioned first, by column-pivoted QR; ascending indices.
std::vector<int> choose_independent_rows(const Eigen::MatrixXd& A, int rank);
std::vector<int> choose_independent_columns(const Eigen::MatrixXd& A, int rank);

/// The least-norm x that minimizes |A x − b|, its rank decided as above.
struct LeastNormResult {
  Eigen::VectorXd x;
  RankDecision decision;
  double residual = 0;  ///< |A x − b|.
};
LeastNormResult solve_least_norm(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);

}  // namespace ferrers
