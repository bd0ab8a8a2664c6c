#include "ferrers/dynamics/stability.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "ferrers/math/rank.h"

namespace ferrers {
namespace {

// Beside forces F on a mechanism of size L, a stiffness well below F/L is still one: the scale of zero is as much
// lower.
constexpr double kScaleOfForces = 1e-2;
constexpr double kErrors = 20;  // estimates by which entries that should be equal may differ

// The rank decision on |κ|: which of them are zero.
void count_directions(double force_N, double length_m, StabilityVerdict& out) {
  VectorXd sizes = out.stiffness.cwiseAbs();
  std::sort(sizes.data(), sizes.data() + sizes.size(), std::greater<>());
  const double scale = std::max(sizes.size() > 0 ? sizes[0] : 0, kScaleOfForces * force_N / length_m);
  const RankDecision decision = decide_rank(sizes, scale);
  out.confident = decision.confident;
  const double smallest = decision.rank > 0 ? sizes[decision.rank - 1] : INFINITY;
  for (const double value : out.stiffness) {
    if (std::abs(value) < smallest) {
      ++out.neutral;
    } else {
      ++(value > 0 ? out.stable : out.unstable);
    }
  }
}

// Signs of the eigenvalues of M⁻¹ K, where they say more than those of the symmetric part.
void count_eigenvalues(const MatrixXd& K, const MatrixXd& weight, double force_N, double length_m,
                       StabilityVerdict& out) {
  const Eigen::EigenSolver<MatrixXd> solver(weight.llt().solve(K), false);
  double largest = solver.eigenvalues().cwiseAbs().maxCoeff();
  largest = std::max(largest, kScaleOfForces * force_N / length_m / weight.diagonal().maxCoeff());
  out.stable = out.unstable = out.neutral = 0;
  for (const std::complex<double>& value : solver.eigenvalues()) {
    if (is_negligible(std::abs(value), largest)) {
      ++out.neutral;
    } else {
      ++(value.real() > 0 && is_negligible(value.imag(), std::abs(value)) ? out.stable : out.unstable);
    }
  }
}

}  // namespace

std::string_view to_string(Stability stability) {
  switch (stability) {
    case Stability::kStable:
      return "stable";
    case Stability::kUnstable:
      return "unstable";
    case Stability::kNeutral:
      return "neutral";
    case Stability::kUnknown:
      break;
  }
  return "unknown";
}

bool is_symmetric(const EstimatedMatrix& K) {
  const double rounding = 1e-12 * (K.value.size() > 0 ? K.value.cwiseAbs().maxCoeff() : 0);
  const MatrixXd allowed = kErrors * (K.error + K.error.transpose());
  return ((K.value - K.value.transpose()).cwiseAbs().array() <= allowed.array() + rounding).all();
}

StabilityVerdict judge_stability(const EstimatedMatrix& K, const MatrixXd& X, const MatrixXd& M, double force_N,
                                 double length_m) {
  StabilityVerdict out;
  const long w = K.value.rows();
  out.conservative = is_symmetric(K);
  if (w > 0) {
    const MatrixXd symmetric = 0.5 * (K.value + K.value.transpose()), D = X.transpose() * X;
    const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> solver(symmetric, D);
    out.stiffness = solver.eigenvalues();
    out.directions = solver.eigenvectors();
    count_directions(force_N, length_m, out);
    if (!out.conservative) {
      const bool regular = Eigen::LLT<MatrixXd>(M).info() == Eigen::Success;
      count_eigenvalues(K.value, regular ? M : D, force_N, length_m, out);
    }
  }
  out.stability = out.unstable > 0 ? Stability::kUnstable : out.neutral > 0 ? Stability::kNeutral : Stability::kStable;
  return out;
}

}  // namespace ferrers
