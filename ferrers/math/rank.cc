#include "ferrers/math/rank.h"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "ferrers/math/rank_pivot.h"

namespace ferrers {
namespace {

constexpr double kSurelyNonzero = 1e-5;
constexpr double kSurelyZero = 1e-10;
constexpr double kConfidentGap = 1e4;
constexpr double kLargestGap = 1e16;
constexpr double kWornPivot = 1e-3;
constexpr double kBlurred = 10;             // a misclosure ε hides singular values up to 10 ε/size
constexpr double kNoMisclosure = 1e-11;     // relative to size: hides nothing that is not zero already
constexpr double kSureMisclosure = 1e-8;    // too large to be the rounding of input in double precision
constexpr double kTraceOfMisclosure = .01;  // the least singular value, over ε/size, that may come from ε
constexpr double kHealthyPivot[kPivotRounds] = {0.1, 1e-2, 1e-3};

double gap_between(double upper, double lower) { return lower <= upper / kLargestGap ? kLargestGap : upper / lower; }

// Both null spaces and the decomposition they come from. Not by divide and conquer: Eigen 3.4's BDCSVD returns wrong
// singular values and vectors for some Jacobians with repeated singular values (errors of order one, not of rounding).
Eigen::JacobiSVD<Eigen::MatrixXd> decompose(const Eigen::MatrixXd& A) {
  return Eigen::JacobiSVD<Eigen::MatrixXd>(A, Eigen::ComputeFullU | Eigen::ComputeFullV);
}

}  // namespace

RankDecision decide_rank(Eigen::VectorXd singular_values, double scale, double blur) {
  RankDecision d;
  d.singular_values = std::move(singular_values);
  const Eigen::VectorXd& s = d.singular_values;
  const int n = static_cast<int>(s.size());
  if (scale <= 0) scale = n > 0 ? s[0] : 0;
  d.gap = kLargestGap;
  if (scale <= 0) {
    d.full = n == 0;
    return d;
  }
  const double hidden = kBlurred * blur;  // values below may be the misclosure's alone
  const auto count_above = [&](double bound) {
    int count = 0;
    while (count < n && s[count] > bound * scale) ++count;
    return count;
  };
  const int sure = count_above(std::max(kSurelyNonzero, kConfidentGap * hidden));
  const int possible = std::max(sure, count_above(std::max(kSurelyZero, blur)));
  // Cut where the ratio of neighbours is widest; the ends count against the bounds themselves.
  const auto value = [&](int i) {
    if (i < 0) return scale;
    return i < n ? std::max(s[i], scale / kLargestGap) : std::max(kSurelyZero, blur) * scale;
  };
  d.rank = sure;
  double widest = 0, second = 0;
  int runner_up = sure;
  for (int cut = sure; cut <= possible; ++cut) {
    const double ratio = value(cut - 1) / value(cut);
    if (ratio > widest) {
      second = widest;
      runner_up = d.rank;
      widest = ratio;
      d.rank = cut;
    } else if (ratio > second) {
      second = ratio;
      runner_up = cut;
    }
  }
  d.full = d.rank == n;
  if (!d.full) {
    const double lower = std::max(s[d.rank], hidden * scale);
    d.gap = gap_between(d.rank > 0 ? s[d.rank - 1] : std::max(scale, lower), lower);
  }
  const bool nothing_between = d.rank == sure && count_above(std::max(kSurelyZero, hidden)) <= sure;
  const bool trace = !d.full && judge_misclosure(blur) == Misclosure::kDoubtful;
  d.confident = nothing_between && d.gap >= kConfidentGap && !trace;
  d.other_rank = d.rank;
  if (d.confident) return d;
  if (runner_up != d.rank) {
    d.other_rank = runner_up;
  } else if (!d.full) {  // what seems zero is what the misclosure left of it
    d.other_rank = std::min(n, std::max(d.rank + 1, count_above(kTraceOfMisclosure * blur)));
  } else {
    d.other_rank = d.rank - 1;
  }
  return d;
}

Misclosure judge_misclosure(double blur) {
  if (!(blur > kNoMisclosure)) return Misclosure::kNone;
  return blur > kSureMisclosure ? Misclosure::kSure : Misclosure::kDoubtful;
}

Eigen::VectorXd compute_singular_values(const Eigen::MatrixXd& A) {
  if (A.size() == 0) return Eigen::VectorXd::Zero(0);
  return Eigen::JacobiSVD<Eigen::MatrixXd>(A).singularValues();
}

bool is_negligible(double value, double scale) {
  return std::abs(value) <= std::sqrt(kSurelyZero * kSurelyNonzero) * scale;
}

bool is_surely_zero(double value, double blur) { return std::abs(value) <= 0.1 * std::max(kSurelyZero, blur); }

bool is_healthy_pivot(double value, int round) { return std::abs(value) >= kHealthyPivot[round]; }

bool is_worn_pivot(double pivot, double healthy) { return !(std::abs(pivot) > kWornPivot * std::abs(healthy)); }

bool is_lost_pivot(double pivot, double diagonal) { return !(pivot > 0.1 * kSurelyZero * diagonal); }

RankAnalysis analyze_rank(const Eigen::MatrixXd& A, double scale, double blur) {
  const int m = static_cast<int>(A.rows()), n = static_cast<int>(A.cols());
  if (m == 0 || n == 0) {
    return {decide_rank(Eigen::VectorXd()), Eigen::MatrixXd::Identity(m, m), Eigen::MatrixXd::Identity(n, n)};
  }
  const auto svd = decompose(A);
  RankAnalysis out;
  out.decision = decide_rank(svd.singularValues(), scale, blur);
  const int r = out.decision.rank;
  out.left_null = svd.matrixU().rightCols(m - r);
  out.right_null = svd.matrixV().rightCols(n - r);
  return out;
}

std::vector<int> choose_independent_columns(const Eigen::MatrixXd& A, int rank) {
  std::vector<int> columns;
  if (rank > 0) {
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(A);
    for (int i = 0; i < rank; ++i) columns.push_back(static_cast<int>(qr.colsPermutation().indices()[i]));
  }
  std::sort(columns.begin(), columns.end());
  return columns;
}

std::vector<int> choose_independent_rows(const Eigen::MatrixXd& A, int rank) {
  return choose_independent_columns(A.transpose(), rank);
}

LeastNormResult solve_least_norm(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
  LeastNormResult out;
  out.x = Eigen::VectorXd::Zero(A.cols());
  if (A.rows() == 0 || A.cols() == 0) {
    out.residual = b.norm();
    return out;
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(A, Eigen::ComputeThinU | Eigen::ComputeThinV);
  out.decision = decide_rank(svd.singularValues());
  const int r = out.decision.rank;
  out.x = svd.matrixV().leftCols(r) *
          (svd.matrixU().leftCols(r).transpose() * b).cwiseQuotient(svd.singularValues().head(r));
  out.residual = (A * out.x - b).norm();
  return out;
}

}  // namespace ferrers
