#include "ferrers/dynamics/forward_kkt.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>

#include "ferrers/math/rank_pivot.h"

namespace ferrers {

void SparseKkt::find_places(const PatternMatrix& M, const PatternMatrix& G) {
  for (Move& move : mass_moves_) move.from = M.place(move.row, move.column);
  for (Move& move : row_moves_) move.from = G.place(move.row, move.column);
  for (Single& single : singles_) single.mass = M.place(order_[single.position], order_[single.position]);
  mass_places_ = M.nonZeros();
  row_places_ = G.nonZeros();
  places_known_ = true;
}

void SparseKkt::load(const PatternMatrix& M, const PatternMatrix& G) {
  std::fill(x_.begin(), x_.end(), 0.0);
  double* x = x_.data();
  for (const Move& move : mass_moves_) x[move.to] = M.valuePtr()[move.from];
  for (const Move& move : row_moves_) x[move.to] = G.valuePtr()[move.from];
}

template <class T>
void SparseKkt::eliminate(const Pair& pair, T* x) const {
  const T inverse = T(1) / x[pair.pivot];
  x[pair.pivot] = inverse;
  T* c = x + pair.pivot + 1;
  T* u = x + pair.diagonal + 1;
  const T half = T(0.5) * x[pair.diagonal];
  for (int i = 0; i < pair.count; ++i) {
    c[i] *= inverse;
    u[i] -= half * c[i];
  }
  const Run* const runs = runs_.data();
  for (const Run* run = runs + pair.row_runs.begin; run != runs + pair.row_runs.end; ++run) {
    const T factor = x[run->p];
    for (int i = 0; i < run->length; ++i) x[run->target + i] -= factor * c[run->q + i];
  }
  for (const Run* run = runs + pair.full_runs.begin; run != runs + pair.full_runs.end; ++run) {
    const T c_p = c[run->p], u_p = u[run->p];
    for (int i = 0; i < run->length; ++i) x[run->target + i] -= c_p * u[run->q + i] + u_p * c[run->q + i];
  }
  for (const Run* run = runs + pair.c_runs.begin; run != runs + pair.c_runs.end; ++run) {
    const T u_p = u[run->p];
    for (int i = 0; i < run->length; ++i) x[run->target + i] -= u_p * c[run->q + i];
  }
}

template <class T>
void SparseKkt::eliminate(const Single& single, T* x) const {
  const T inverse = T(1) / x[single.diagonal];
  x[single.diagonal] = inverse;
  const T* r = x + single.diagonal + 1;
  const Run* const runs = runs_.data();
  for (const Run* run = runs + single.runs.begin; run != runs + single.runs.end; ++run) {
    const T factor = r[run->p] * inverse;
    for (int i = 0; i < run->length; ++i) x[run->target + i] -= factor * r[run->q + i];
  }
}

template void SparseKkt::eliminate(const Pair&, Traced*) const;
template void SparseKkt::eliminate(const Single&, Traced*) const;

ForwardStatus SparseKkt::factor(const PatternMatrix& M, const PatternMatrix& G) {
  if (!complete_) return ForwardStatus::kWornSelection;
  if (!places_known_) find_places(M, G);
  assert(M.nonZeros() == mass_places_ && G.nonZeros() == row_places_);
  load(M, G);
  smallest_pivot_ = pairs_.empty() ? 1 : INFINITY;
  for (const Pair& pair : pairs_) {
    smallest_pivot_ = std::min(smallest_pivot_, std::abs(x_[pair.pivot]) * pair.weight);
    eliminate(pair, x_.data());
  }
  // What a motion without mass leaves of either is rounding: of its own mass, or of that with what follows it.
  for (std::size_t k = 0; k < singles_.size(); ++k)
    began_[k] = M.valuePtr()[singles_[k].mass] + x_[singles_[k].diagonal];
  for (std::size_t k = 0; k < singles_.size(); ++k) {
    if (is_lost_pivot(x_[singles_[k].diagonal], began_[k])) return ForwardStatus::kSingularMass;
    eliminate(singles_[k], x_.data());
  }
  return ForwardStatus::kSolved;
}

void SparseKkt::solve(const VectorXd& force, const VectorXd& gamma, VectorXd& vdot, VectorXd& lambda) {
  const int* const order = order_.data();
  for (std::size_t i = 0; i < order_.size(); ++i) f_[i] = force[order[i]];
  for (std::size_t i = 0; i < pairs_.size(); ++i) b_[i] = gamma[pairs_[i].row];
  substitute(x_.data(), f_.data(), b_.data(), lambda_.data());
  for (std::size_t i = 0; i < pairs_.size(); ++i) lambda[pairs_[i].row] = lambda_[i];
  for (std::size_t i = 0; i < order_.size(); ++i) vdot[order[i]] = f_[i];
}

template <class T>
void SparseKkt::substitute(const T* x, T* f, T* b, T* l) const {
  const int* const columns = columns_.data();
  // What the pairs say, put into the rest: b becomes v_d at v = 0.
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    const Pair& pair = pairs_[k];
    const T b_k = b[k] *= x[pair.pivot];
    const T force_d = f[pair.position] - T(0.5) * x[pair.diagonal] * b_k;
    const T *c = x + pair.pivot + 1, *u = x + pair.diagonal + 1;
    const int* at = columns + pair.columns;
    for (int i = 0; i < pair.count; ++i) f[at[i]] -= c[i] * force_d + u[i] * b_k;
    for (int i = pair.multipliers.begin; i < pair.multipliers.end; ++i) {
      b[multipliers_[i].row] -= x[multipliers_[i].at] * b_k;
    }
  }
  for (const Single& single : singles_) {
    const T share = f[single.position] * x[single.diagonal];
    const T* r = x + single.diagonal + 1;
    const int* at = columns + single.columns;
    for (int i = 0; i < single.count; ++i) f[at[i]] -= r[i] * share;
  }
  // Backwards: f becomes vdot by position.
  for (std::size_t k = singles_.size(); k-- > 0;) {
    const Single& single = singles_[k];
    T sum = f[single.position];
    const T* r = x + single.diagonal + 1;
    const int* at = columns + single.columns;
    for (int i = 0; i < single.count; ++i) sum -= r[i] * f[at[i]];
    f[single.position] = sum * x[single.diagonal];
  }
  for (std::size_t k = pairs_.size(); k-- > 0;) {
    const Pair& pair = pairs_[k];
    const T *c = x + pair.pivot + 1, *u = x + pair.diagonal + 1;
    const int* at = columns + pair.columns;
    T v = b[k], rest = -f[pair.position];
    for (int i = 0; i < pair.count; ++i) {
      v -= c[i] * f[at[i]];
      rest += u[i] * f[at[i]];
    }
    rest += T(0.5) * x[pair.diagonal] * (v + b[k]);
    for (int i = pair.multipliers.begin; i < pair.multipliers.end; ++i) {
      rest -= x[multipliers_[i].at] * l[multipliers_[i].row];
    }
    f[pair.position] = v;
    l[k] = rest * x[pair.pivot];
  }
}

SparseKkt::TracedSolution SparseKkt::trace(const TracedFactors& factors, const std::vector<Traced>& force,
                                           const std::vector<Traced>& gamma) const {
  std::vector<Traced> f(order_.size()), b(pairs_.size());
  TracedSolution out;
  out.vdot.resize(order_.size());
  out.lambda.resize(pairs_.size());
  for (std::size_t i = 0; i < order_.size(); ++i) f[i] = force[order_[i]];
  for (std::size_t i = 0; i < pairs_.size(); ++i) b[i] = gamma[pairs_[i].row];
  substitute(factors.x.data(), f.data(), b.data(), out.lambda.data());
  for (std::size_t i = 0; i < order_.size(); ++i) out.vdot[order_[i]] = f[i];
  return out;
}

std::vector<int> SparseKkt::pair_rows() const {
  std::vector<int> rows;
  for (const Pair& pair : pairs_) rows.push_back(pair.row);
  return rows;
}

std::vector<int> SparseKkt::signature() const {
  std::vector<int> out = pair_rows();
  out.push_back(-1);
  out.insert(out.end(), order_.begin(), order_.end());
  for (const Pair& pair : pairs_) {
    const auto bits = std::bit_cast<std::uint64_t>(pair.weight);
    out.push_back(static_cast<int>(bits >> 32));
    out.push_back(static_cast<int>(bits & 0xFFFFFFFF));
  }
  return out;
}

}  // namespace ferrers
