#include "ferrers/redundancy/reaction_bounds.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <random>

#include "ferrers/core/checks.h"

namespace ferrers {
namespace {

constexpr double kMostWork = 2e7;  // springs · k² · targets, per start and sweep
constexpr int kRandomStarts = 5;
constexpr int kMostSweeps = 50;
constexpr int kRefreshEvery = 64;

// The distribution in coordinates z with Σ aᵢ aᵢᵀ = 1 at the stiffness as given, where z = 0:
//   (Σ fᵢ aᵢ aᵢᵀ) z + Σ (fᵢ − 1) wᵢ aᵢ = 0,   target = value + slope · z,
// fᵢ the factor of compliance i, aᵢ and wᵢ its row of work and its load times the root of its compliance.
struct Corners {
  MatrixXd a;  // springs × k
  VectorXd w;
  MatrixXd slope;  // targets × k
  VectorXd value;
  double factors[2] = {1, 1};  // of a compliance: at the upper and at the lower end of its stiffness
};

Corners make_corners(const ForceMethod& method, const VectorXd& loads, const VectorXd& lambda, const MatrixXd& targets,
                     const StiffnessRange& range) {
  Corners corners;
  VectorXd root(static_cast<long>(method.springs.size()));
  for (long i = 0; i < root.size(); ++i) root[i] = std::sqrt(method.springs[static_cast<std::size_t>(i)].compliance);
  const long k = method.fixed.cols();
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(root.asDiagonal() * method.work);
  corners.a = qr.householderQ() * MatrixXd::Identity(root.size(), k);
  corners.w = root.cwiseProduct(loads);
  const MatrixXd slope = targets * method.fixed * qr.colsPermutation();
  const auto R = qr.matrixQR().topRows(k).triangularView<Eigen::Upper>();
  corners.slope = R.transpose().solve(slope.transpose()).transpose();
  corners.value = targets * lambda;
  corners.factors[0] = 1 / range.high;
  corners.factors[1] = 1 / range.low;
  return corners;
}

// One corner of the box, moved along edges.
class Corner {
 public:
  Corner(const Corners& corners, std::vector<bool> soft)
      : corners_(corners), soft_(std::move(soft)), u_(corners.a.cols()) {
    refresh();
  }

  const VectorXd& z() const { return z_; }
  bool soft(int i) const { return soft_[static_cast<std::size_t>(i)]; }

  /// Solves anew, free of the rounding of updates.
  void refresh() {
    const VectorXd f = factors();
    const MatrixXd H = corners_.a.transpose() * f.asDiagonal() * corners_.a;
    const Eigen::LLT<MatrixXd> llt(H);
    inverse_ = llt.solve(MatrixXd::Identity(H.rows(), H.cols()));
    z_ = -llt.solve(corners_.a.transpose() * ((f.array() - 1) * corners_.w.array()).matrix());
    updates_ = 0;
  }

  /// How z changes per unit when compliance i goes to its other end.
  double step(int i) {
    const double change = factor(!soft(i)) - factor(soft(i));
    u_.noalias() = inverse_ * corners_.a.row(i).transpose();
    const double load = corners_.w[i] + corners_.a.row(i).dot(z_);
    denominator_ = 1 + change * corners_.a.row(i).dot(u_);
    change_ = change;
    return -change * load / denominator_;
  }
  const VectorXd& direction() const { return u_; }  ///< Of the last `step`.

  /// Takes the last `step`, of spring i.
  void take(int i, double step) {
    z_.noalias() += step * u_;
    inverse_.noalias() -= (change_ / denominator_) * u_ * u_.transpose();
    soft_[static_cast<std::size_t>(i)] = !soft_[static_cast<std::size_t>(i)];
    if (++updates_ == kRefreshEvery) refresh();
  }

 private:
  double factor(bool soft) const { return corners_.factors[soft ? 1 : 0]; }
  VectorXd factors() const {
    VectorXd f(static_cast<long>(soft_.size()));
    for (long i = 0; i < f.size(); ++i) f[i] = factor(soft_[static_cast<std::size_t>(i)]);
    return f;
  }

  const Corners& corners_;
  std::vector<bool> soft_;
  MatrixXd inverse_;
  VectorXd z_, u_;
  double change_ = 0, denominator_ = 1;
  int updates_ = 0;
};

void visit_all_corners(const Corners& corners, ReactionBounds& out) {
  const int springs = static_cast<int>(corners.a.rows());
  Corner corner(corners, std::vector<bool>(static_cast<std::size_t>(springs), false));
  const auto note = [&] {
    const VectorXd values = corners.value + corners.slope * corner.z();
    out.low = out.low.cwiseMin(values);
    out.high = out.high.cwiseMax(values);
  };
  note();
  for (unsigned n = 1; n < (1U << static_cast<unsigned>(springs)); ++n) {
    int i = 0;  // Gray code: the lowest set bit of the counter
    while ((n >> static_cast<unsigned>(i) & 1U) == 0) ++i;
    corner.take(i, corner.step(i));
    note();
  }
}

// Climbs along edges from a corner until no edge leads up. Returns the value of slope · z there.
double climb(const Corners& corners, const VectorXd& slope, std::vector<bool> start) {
  Corner corner(corners, std::move(start));
  const int springs = static_cast<int>(corners.a.rows());
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    bool moved = false;
    for (int i = 0; i < springs; ++i) {
      const double step = corner.step(i);
      const double gain = step * slope.dot(corner.direction());
      if (gain <= 1e-12 * std::abs(slope.dot(corner.z()))) continue;
      corner.take(i, step);
      moved = true;
    }
    if (!moved) break;
  }
  corner.refresh();
  return slope.dot(corner.z());
}

// All stiff, all soft, each spring as its own influence at the given stiffness says, and some at random.
std::vector<std::vector<bool>> make_starts(const Corners& corners, const VectorXd& slope) {
  const std::size_t springs = static_cast<std::size_t>(corners.a.rows());
  std::vector<std::vector<bool>> starts = {std::vector<bool>(springs, false), std::vector<bool>(springs, true)};
  std::vector<bool> uphill(springs);
  const VectorXd influence = -(corners.a * slope).cwiseProduct(corners.w);
  for (std::size_t i = 0; i < springs; ++i) uphill[i] = influence[static_cast<long>(i)] > 0;
  starts.push_back(uphill);
  std::mt19937 random(1);
  for (int n = 0; n < kRandomStarts; ++n) {
    std::vector<bool>& start = starts.emplace_back(springs);
    for (std::size_t i = 0; i < springs; ++i) start[i] = (random() & 1U) != 0;
  }
  return starts;
}

double best_of_climbs(const Corners& corners, const VectorXd& slope, bool one_is_enough) {
  double best = -INFINITY;
  for (std::vector<bool>& start : make_starts(corners, slope)) {
    best = std::max(best, climb(corners, slope, std::move(start)));
    if (one_is_enough) break;
  }
  return best;
}

}  // namespace

std::string_view to_string(BoundsMethod method) {
  switch (method) {
    case BoundsMethod::kExact:
      return "exact";
    case BoundsMethod::kSearch:
      return "search";
    case BoundsMethod::kTooLarge:
      break;
  }
  return "too large";
}

ReactionBounds bound_reactions(const ForceMethod& method, const AllRows& rows, const std::vector<ComponentMap>& maps,
                               const VectorXd& lambda, const MatrixXd& targets, const StiffnessRange& range) {
  require(range.low > 0 && range.high >= range.low && std::isfinite(range.high),
          "bound_reactions: the range must be positive and in order");
  require_size(lambda.size(), rows.size(), "bound_reactions: lambda");
  require_size(targets.cols(), rows.size(), "bound_reactions: targets");
  const long k = method.fixed.cols(), springs = static_cast<long>(method.springs.size()), wanted = targets.rows();
  ReactionBounds out;
  out.low = out.high = targets * lambda;
  if (k == 0 || wanted == 0) return out;
  const bool enumerate = springs <= kMostEnumerated;
  if (!enumerate && static_cast<double>(springs) * static_cast<double>(k * k * wanted) > kMostWork) {
    out.method = BoundsMethod::kTooLarge;
    return out;
  }
  const Corners corners = make_corners(method, spring_loads(method, rows, maps, lambda), lambda, targets, range);
  if (enumerate) {
    out.low.setConstant(INFINITY);
    out.high.setConstant(-INFINITY);
    visit_all_corners(corners, out);
    return out;
  }
  if (k > 1) out.method = BoundsMethod::kSearch;
  for (long t = 0; t < wanted; ++t) {
    const VectorXd slope = corners.slope.row(t).transpose();
    out.high[t] = corners.value[t] + best_of_climbs(corners, slope, k == 1);
    out.low[t] = corners.value[t] - best_of_climbs(corners, -slope, k == 1);
  }
  return out;
}

}  // namespace ferrers
