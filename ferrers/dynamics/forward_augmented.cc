#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "ferrers/dynamics/forward.h"
#include "ferrers/kinematics/scaling.h"
#include "ferrers/math/rank_pivot.h"

/// Problem: the accelerations that constraints allow, from all rows as they are, independent or not.
///
/// Stationary values of ½ vdotᵀ M vdot − forceᵀ vdot − lambdaᵀ (G vdot − gamma) + ½ |G vdot − gamma|²_W, W = ρ D²: a
/// penalty that the multipliers make exact [bayo1988], which is a proximal iteration on lambda [carpentier2021]. In
/// increments, so that each pass also corrects the rounding of the one before:
///   (M + Gᵀ W G) δ = (force + Gᵀ lambda − M vdot) + Gᵀ W e,   e ← e − G δ,   vdot ← vdot + δ,   lambda ← lambda + W e,
/// from vdot = 0, lambda = 0, e = gamma. D scales each row to one in a characteristic length, ρ = largest scaled mass
/// over ε. M: nv×nv, positive definite on the motions that G allows; G: m×nv, any rank.
///
/// What comes out: vdot; and the multipliers of least norm |D⁻¹ lambda|, because each pass adds a vector of W G's range
/// and a last projection takes away what rounding and contradictory right sides leave outside of it. They start from
/// zero each time: a part that G cannot feel would never go away.
///
/// Limits: a pass reduces the error of a direction with scaled singular value σ by ε/(ε + σ²), so that directions below
/// √ε ≈ 3e-5 hardly converge (kNotConverged), and G's condition enters squared. Masses whose ratio exceeds ε/1e-16 make
/// the matrix indefinite in rounding (kSingularMass), as a truly singular one does.
/// Cost: O(n³ + Σ (entries of a row)²) once, O(n² + m n) a pass, usually three to five passes.
namespace ferrers {
namespace {

constexpr double kPenalty = 1e-9;  // ε
constexpr int kMostPasses = 60;
constexpr double kConverged = 1e-14;

class AugmentedSolver final : public ForwardSolver {
 public:
  AugmentedSolver(const System& system, int rank)
      : scaling_(system.scaling),
        rank_(rank),
        A_(system.nv, system.nv),
        llt_(system.nv),
        delta_(system.nv),
        rest_(system.nv),
        pivots_(static_cast<std::size_t>(system.nv)) {}

  void solve(const Equations& eq, ForwardResult& out) override {
    M_ = &eq.M;
    G_ = &eq.constraints.G;
    if (weight_.size() != G_->rows()) make_room();
    if (M_->rows() == 0) {  // nothing moves, and no load reaches a row
      smallest_pivot_ = 1;
      return resolve(eq.force, eq.constraints.gamma, out);
    }
    weigh_rows();
    assemble();
    llt_.compute(A_);
    if (llt_.info() != Eigen::Success || has_lost_pivot()) {
      out.status = ForwardStatus::kSingularMass;
      return;
    }
    find_smallest_pivot();
    resolve(eq.force, eq.constraints.gamma, out);
  }

  void resolve(const VectorXd& force, const VectorXd& gamma, ForwardResult& out) override {
    out.status = M_->rows() > 0 ? ForwardStatus::kNotConverged : ForwardStatus::kSolved;
    out.vdot.setZero();
    out.lambda.setZero();
    if (M_->rows() == 0) return;
    error_ = gamma;
    double smallest = INFINITY;
    for (int pass = 0; pass < kMostPasses; ++pass) {
      rest_ = force;
      rest_.noalias() -= *M_ * out.vdot;
      weighted_ = out.lambda + weight_.cwiseProduct(error_);
      rest_.noalias() += G_->transpose() * weighted_;
      delta_ = rest_;
      llt_.solveInPlace(delta_);
      out.vdot += delta_;
      error_.noalias() -= *G_ * delta_;
      out.lambda += weight_.cwiseProduct(error_);
      // Rounding comes with the forces that balance, not with what is left of them.
      const double loads = force.cwiseProduct(scaling_.columns).norm() + out.lambda.cwiseProduct(size_).norm();
      const double change = scaled_size(delta_), size = scaled_size(out.vdot) + loads / (penalty_ * kPenalty);
      if (!std::isfinite(change)) {
        out.status = ForwardStatus::kSingularMass;
        return;
      }
      if (change <= kConverged * size) {
        out.status = ForwardStatus::kSolved;
        break;
      }
      // Rounding: the steps do not get smaller any more.
      if (pass > 2 && change > 0.5 * smallest && change <= 1e-11 * size) {
        out.status = ForwardStatus::kSolved;
        break;
      }
      smallest = std::min(smallest, change);
    }
    project_multipliers(out.lambda);
  }

  double smallest_pivot() const override { return smallest_pivot_; }

 private:
  void make_room() {
    const long m = G_->rows();
    weight_ = size_ = error_ = weighted_ = kept_ = VectorXd::Zero(m);
  }
  // W = ρ D²: rows of mechanisms by the characteristic length, prescribed motions by their own size.
  void weigh_rows() {
    const VectorXd& columns = scaling_.columns;
    double heaviest = 0;
    for (long k = 0; k < columns.size(); ++k) heaviest = std::max(heaviest, (*M_)(k, k) * columns[k] * columns[k]);
    penalty_ = heaviest / kPenalty;
    const long m = scaling_.rows.size();
    for (long i = 0; i < weight_.size(); ++i) {
      size_[i] = i < m ? 1 / scaling_.rows[i] : scaled_row_size(i);
      weight_[i] = size_[i] > 0 ? penalty_ / (size_[i] * size_[i]) : 0;
    }
  }

  double scaled_row_size(long row) const {
    double sum = 0;
    for (PatternMatrix::InnerIterator it(*G_, row); it; ++it) {
      const double entry = it.value() * scaling_.columns[it.col()];
      sum += entry * entry;
    }
    return std::sqrt(sum);
  }

  // The lower half of M + Gᵀ W G; the upper half is not read.
  void assemble() {
    A_ = *M_;
    for (long i = 0; i < weight_.size(); ++i) {
      for (PatternMatrix::InnerIterator a(*G_, i); a; ++a) {
        const double weighted = weight_[i] * a.value();
        for (PatternMatrix::InnerIterator b = a; b; ++b) A_(b.col(), a.col()) += weighted * b.value();
      }
    }
  }

  // A motion without mass: beside its own mass, or beside what the penalty rounds off.
  bool has_lost_pivot() const {
    constexpr double kRounding = 16 * std::numeric_limits<double>::epsilon();
    for (long k = 0; k < A_.rows(); ++k) {
      const double root = llt_.matrixLLT()(k, k);
      if (is_lost_pivot(root * root, (*M_)(k, k)) || !(root * root > kRounding * A_(k, k))) return true;
    }
    return false;
  }

  // The factor's diagonal over √ρ is that of the scaled G's own triangular factor where constraints act, and about √ε
  // where they do not: the rank tells how many of the first kind there are.
  void find_smallest_pivot() {
    smallest_pivot_ = 1;
    if (rank_ <= 0 || rank_ > static_cast<int>(pivots_.size())) return;
    for (std::size_t k = 0; k < pivots_.size(); ++k) {
      const long i = static_cast<long>(k);
      pivots_[k] = llt_.matrixLLT()(i, i) * scaling_.columns[i];
    }
    const auto at = pivots_.begin() + rank_ - 1;
    std::nth_element(pivots_.begin(), at, pivots_.end(), std::greater<>());
    smallest_pivot_ = *at / std::sqrt(penalty_);
  }

  double scaled_size(const VectorXd& v) const { return v.cwiseQuotient(scaling_.columns).norm(); }

  // lambda without its part outside the range of W G: W G (M + Gᵀ W G)⁻¹ Gᵀ projects up to ε, and again on what is
  // left.
  void project_multipliers(VectorXd& lambda) {
    kept_.setZero();
    double before = INFINITY;
    for (int pass = 0; pass < kMostPasses; ++pass) {
      weighted_ = lambda - kept_;
      delta_.noalias() = G_->transpose() * weighted_;
      const double left = delta_.cwiseProduct(scaling_.columns).norm();
      if (!(left < 0.5 * before)) break;
      before = left;
      llt_.solveInPlace(delta_);
      weighted_.noalias() = *G_ * delta_;
      kept_ += weight_.cwiseProduct(weighted_);
    }
    lambda = kept_;
  }

  Scaling scaling_;
  int rank_;
  const PatternMatrix* M_ = nullptr;  // of the equations solved last
  const PatternMatrix* G_ = nullptr;
  MatrixXd A_;
  Eigen::LLT<MatrixXd> llt_;
  VectorXd delta_, rest_, weight_, size_, error_, weighted_, kept_;
  std::vector<double> pivots_;
  double penalty_ = 0, smallest_pivot_ = 0;
};

}  // namespace

std::unique_ptr<ForwardSolver> make_augmented_solver(const System& system, const Selection& selection) {
  return std::make_unique<AugmentedSolver>(system, static_cast<int>(selection.rows.size()));
}

}  // namespace ferrers
