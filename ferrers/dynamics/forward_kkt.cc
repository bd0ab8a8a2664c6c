#include "ferrers/dynamics/forward_kkt.h"

#include <algorithm>
#include <cmath>

#include "ferrers/math/rank_pivot.h"

namespace ferrers {

void SparseKkt::load(const MatrixXd& M, const RowMatrixXd& G) {
  std::fill(x_.begin(), x_.end(), 0.0);
  double* x = x_.data();
  for (const Move& move : mass_moves_) x[move.to] = M.data()[move.from];
  for (const Move& move : row_moves_) x[move.to] = G.data()[move.from];
}

void SparseKkt::eliminate(const Pair& pair) {
  double* x = x_.data();
  const double g = x[pair.pivot];
  smallest_pivot_ = std::min(smallest_pivot_, std::abs(g) * pair.weight);
  const double inverse = 1 / g;
  x[pair.pivot] = inverse;
  double* c = x + pair.pivot + 1;
  double* u = x + pair.diagonal + 1;
  const double half = 0.5 * x[pair.diagonal];
  for (int i = 0; i < pair.count; ++i) {
    c[i] *= inverse;
    u[i] -= half * c[i];
  }
  const Run* const runs = runs_.data();
  for (const Run* run = runs + pair.row_runs.begin; run != runs + pair.row_runs.end; ++run) {
    const double factor = x[run->p];
    for (int i = 0; i < run->length; ++i) x[run->target + i] -= factor * c[run->q + i];
  }
  for (const Run* run = runs + pair.full_runs.begin; run != runs + pair.full_runs.end; ++run) {
    const double c_p = c[run->p], u_p = u[run->p];
    for (int i = 0; i < run->length; ++i) x[run->target + i] -= c_p * u[run->q + i] + u_p * c[run->q + i];
  }
  for (const Run* run = runs + pair.c_runs.begin; run != runs + pair.c_runs.end; ++run) {
    const double u_p = u[run->p];
    for (int i = 0; i < run->length; ++i) x[run->target + i] -= u_p * c[run->q + i];
  }
}

bool SparseKkt::eliminate(const Single& single, double began) {
  double* x = x_.data();
  const double mass = x[single.diagonal];
  if (is_lost_pivot(mass, began)) return false;
  const double inverse = 1 / mass;
  x[single.diagonal] = inverse;
  const double* r = x + single.diagonal + 1;
  const Run* const runs = runs_.data();
  for (const Run* run = runs + single.runs.begin; run != runs + single.runs.end; ++run) {
    const double factor = r[run->p] * inverse;
    for (int i = 0; i < run->length; ++i) x[run->target + i] -= factor * r[run->q + i];
  }
  return true;
}

ForwardStatus SparseKkt::factor(const MatrixXd& M, const RowMatrixXd& G) {
  if (!complete_) return ForwardStatus::kWornSelection;
  load(M, G);
  smallest_pivot_ = pairs_.empty() ? 1 : INFINITY;
  for (const Pair& pair : pairs_) eliminate(pair);
  // What a motion without mass leaves of either is rounding: of its own mass, or of that with what follows it.
  for (std::size_t k = 0; k < singles_.size(); ++k) began_[k] = M.data()[singles_[k].mass] + x_[singles_[k].diagonal];
  for (std::size_t k = 0; k < singles_.size(); ++k) {
    if (!eliminate(singles_[k], began_[k])) return ForwardStatus::kSingularMass;
  }
  return ForwardStatus::kSolved;
}

void SparseKkt::solve(const VectorXd& force, const VectorXd& gamma, VectorXd& vdot, VectorXd& lambda) {
  const double* x = x_.data();
  double *f = f_.data(), *b = b_.data(), *l = lambda_.data();
  const int *columns = columns_.data(), *order = order_.data();
  for (std::size_t i = 0; i < order_.size(); ++i) f[i] = force[order[i]];
  for (std::size_t i = 0; i < pairs_.size(); ++i) b[i] = gamma[pairs_[i].row];
  // What the pairs say, put into the rest: b becomes v_d at v = 0.
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    const Pair& pair = pairs_[k];
    const double b_k = b[k] *= x[pair.pivot];
    const double force_d = f[pair.position] - 0.5 * x[pair.diagonal] * b_k;
    const double *c = x + pair.pivot + 1, *u = x + pair.diagonal + 1;
    const int* at = columns + pair.columns;
    for (int i = 0; i < pair.count; ++i) f[at[i]] -= c[i] * force_d + u[i] * b_k;
    for (int i = pair.multipliers.begin; i < pair.multipliers.end; ++i) {
      b[multipliers_[i].row] -= x[multipliers_[i].at] * b_k;
    }
  }
  for (const Single& single : singles_) {
    const double share = f[single.position] * x[single.diagonal];
    const double* r = x + single.diagonal + 1;
    const int* at = columns + single.columns;
    for (int i = 0; i < single.count; ++i) f[at[i]] -= r[i] * share;
  }
  // Backwards: f becomes vdot by position.
  for (std::size_t k = singles_.size(); k-- > 0;) {
    const Single& single = singles_[k];
    double sum = f[single.position];
    const double* r = x + single.diagonal + 1;
    const int* at = columns + single.columns;
    for (int i = 0; i < single.count; ++i) sum -= r[i] * f[at[i]];
    f[single.position] = sum * x[single.diagonal];
  }
  for (std::size_t k = pairs_.size(); k-- > 0;) {
    const Pair& pair = pairs_[k];
    const double *c = x + pair.pivot + 1, *u = x + pair.diagonal + 1;
    const int* at = columns + pair.columns;
    double v = b[k], rest = -f[pair.position];
    for (int i = 0; i < pair.count; ++i) {
      v -= c[i] * f[at[i]];
      rest += u[i] * f[at[i]];
    }
    rest += 0.5 * x[pair.diagonal] * (v + b[k]);
    for (int i = pair.multipliers.begin; i < pair.multipliers.end; ++i) {
      rest -= x[multipliers_[i].at] * l[multipliers_[i].row];
    }
    f[pair.position] = v;
    l[k] = rest * x[pair.pivot];
    lambda[pair.row] = l[k];
  }
  for (std::size_t i = 0; i < order_.size(); ++i) vdot[order[i]] = f[i];
}

}  // namespace ferrers
