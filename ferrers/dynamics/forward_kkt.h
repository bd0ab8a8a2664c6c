#pragma once

#include <cstddef>
#include <vector>

#include "ferrers/dynamics/forward.h"
#include "ferrers/kinematics/constraint_blocks.h"
#include "ferrers/math/traced.h"

/// Problem: the equations of motion of a mechanism with local loops are sparse, and always in the same places.
///
///   [M  −Gᵀ] [vdot  ]   [force]
///   [G   0 ] [lambda] = [gamma]          M: nv×nv, positive semidefinite; G: r×nv, independent rows
///
/// Given: where M and G can have entries. Wanted: vdot and lambda, at a cost that follows the entries.
///
/// Elimination in pairs (row i, coordinate d). With the pivot g = G_id, c = G_i/g and b = gamma_i/g, row i says
/// v_d = b − c·v; put into the other rows and into the kinetic energy that leaves
///   G_k ← G_k − G_kd c,   M ← M − c uᵀ − u cᵀ with u = M_d − ½ M_dd c,   both without d,
/// and after r pairs what is left is Nᵀ M N on the coordinates without a partner: the null-space form, but N is never
/// formed. Only those are eliminated by their mass, so M need be regular on the admissible motions only, and G M⁻¹ Gᵀ,
/// which squares the condition of G, does not appear.
///
/// The order of the pairs is chosen once, from the structure and from values (Markowitz' count [markowitz1957] among
/// pivots within a factor of ten of the largest of their row, so that |c| ≤ 10), and compiled into a list of runs:
/// short loops over consecutive numbers, without a search or a decision. Cost of one factorization: `operations()`,
/// linear in the number of loops where loops are local; O(n³) for a chain of n bodies or a tangle.
namespace ferrers {

/// Where entries can be. Indices of coordinates ascend; `rows` are those of the chosen rows of G, in their order.
struct KktStructure {
  std::vector<std::vector<int>> rows;  ///< Per chosen row: coordinates it can touch.
  std::vector<std::vector<int>> mass;  ///< Per coordinate: other coordinates that M couples it with.
  /// The entries of `rows` at the pose where the order of elimination is chosen.
  std::vector<std::vector<double>> values;
};

/// Of a system's own rows; those of prescribed motions (from system.m on) are left empty for the caller to fill.
KktStructure make_kkt_structure(const System& system, const std::vector<int>& rows);
/// Fills `values`: from G, or from its closures alone.
void take_values(const std::vector<int>& rows, const PatternMatrix& G, KktStructure& structure);
void take_values(const std::vector<int>& rows, const ConstraintBlocks& blocks, KktStructure& structure);

/// The factors, and the program that makes them.
class SparseKkt {
 public:
  SparseKkt() = default;
  /// Chooses the order from `structure.values`; `rows`: the chosen rows of G. `column_scale` (nv) makes the columns
  /// comparable; each row is compared with its own largest entry. Allocates.
  SparseKkt(const KktStructure& structure, const std::vector<int>& rows, const VectorXd& column_scale);

  /// kSingularMass where Nᵀ M N is not positive definite but for rounding, kWornSelection where some row has no
  /// coordinate to determine. M and G: symmetric, with all entries of the structure in their patterns, which must be
  /// those of the first call ever after. Allocates nothing.
  ForwardStatus factor(const PatternMatrix& M, const PatternMatrix& G);
  /// With the last factors. `gamma`, `lambda`: of all rows of G; only the chosen ones are read and written.
  void solve(const VectorXd& force, const VectorXd& gamma, VectorXd& vdot, VectorXd& lambda);

  /// Both written down on traced numbers (math/traced.h), for native code of a whole evaluation.
  struct TracedFactors {
    std::vector<Traced> x;
    std::vector<Traced> pivots;         ///< Weighted g of each pair: the smallest is what `smallest_pivot` tells.
    std::vector<Traced> masses, began;  ///< Of each coordinate that goes by its mass: pivot, and what it is left of.
  };
  struct TracedSolution {
    std::vector<Traced> vdot;    ///< nv.
    std::vector<Traced> lambda;  ///< Per pair, the multiplier of its row.
  };
  /// `M(i, j)`, `G(row, column)`: entries of the structure.
  template <class Mass, class Jacobian>
  TracedFactors trace(Mass M, Jacobian G) const;
  /// `force`: nv; `gamma`: of all rows of G.
  TracedSolution trace(const TracedFactors& factors, const std::vector<Traced>& force,
                       const std::vector<Traced>& gamma) const;
  std::vector<int> pair_rows() const;  ///< Per pair, its row of G.
  /// Equal for those that eliminate the same rows and coordinates in the same order, and weigh their pivots alike.
  std::vector<int> signature() const;
  bool is_complete() const { return complete_; }

  /// Smallest pivot |g| of the last factorization, each over its row's largest entry when the order was chosen, in
  /// scaled columns: a pure number. 1 without rows.
  double smallest_pivot() const { return smallest_pivot_; }
  /// Multiplications of one factorization, and numbers stored.
  long operations() const { return operations_; }
  long stored() const { return static_cast<long>(x_.size()); }

 private:
  friend class KktCompiler;
  /// x[target + i] −= x[p] x[q + i] + x[p'] x[q' + i] for i < length; the second product for masses of pairs only.
  struct Run {
    int target, p, q, length;
  };
  struct Range {
    int begin = 0, end = 0;
  };
  /// Row i and its coordinate d. Consecutive numbers: g, c (count of them); M_dd, u (count).
  struct Pair {
    int row = 0, position = 0;  ///< Of the row of G; of the coordinate in the order.
    int pivot = 0, diagonal = 0, count = 0;
    int columns = 0;          ///< Positions of c and u: columns_[columns], …
    Range multipliers;        ///< Other rows that hold d.
    Range row_runs;           ///< Offsets of q and p: from x.
    Range full_runs, c_runs;  ///< Rows of M with c and u, and with u only; p and q count from c and u.
    double weight = 1;
  };
  struct Multiplier {
    int at, row;  ///< The entry G_kd in x, and which pair's row k is.
  };
  struct Single {
    int position = 0, diagonal = 0, count = 0, columns = 0;
    Range runs;
    int mass = 0;  ///< Where its diagonal entry is in M.
  };
  struct Move {
    int to, row, column;
    int from;  ///< Among the values of M or G.
  };

  void find_places(const PatternMatrix& M, const PatternMatrix& G);
  void load(const PatternMatrix& M, const PatternMatrix& G);
  template <class T>
  void eliminate(const Pair& pair, T* x) const;
  template <class T>
  void eliminate(const Single& single, T* x) const;
  /// f: the forces, then vdot, by position; b: gamma, per pair.
  template <class T>
  void substitute(const T* x, T* f, T* b, T* lambda) const;

  std::vector<double> x_;  // all entries, in the order of elimination
  std::vector<Move> mass_moves_, row_moves_;
  std::vector<Pair> pairs_;
  std::vector<Single> singles_;
  std::vector<Multiplier> multipliers_;
  std::vector<Run> runs_;
  std::vector<int> columns_;            // positions of coordinates in the order
  std::vector<int> order_;              // coordinates by position
  std::vector<double> f_, b_, lambda_;  // by position; by pair
  std::vector<double> began_;           // per single: the masses that its pivot is left of
  bool complete_ = false, places_known_ = false;
  std::ptrdiff_t mass_places_ = 0, row_places_ = 0;  ///< Of the matrices whose places are known.
  double smallest_pivot_ = 0;
  long operations_ = 0;
};

// ---------------------------------------------------------------------------------------------------------------------

template <class Mass, class Jacobian>
SparseKkt::TracedFactors SparseKkt::trace(Mass M, Jacobian G) const {
  TracedFactors out;
  std::vector<Traced>& x = out.x;
  x.resize(x_.size());
  for (const Move& move : mass_moves_) x[move.to] = M(move.row, move.column);
  for (const Move& move : row_moves_) x[move.to] = G(move.row, move.column);
  for (const Pair& pair : pairs_) {
    out.pivots.push_back(x[pair.pivot] * Traced(pair.weight));
    eliminate(pair, x.data());
  }
  for (const Single& single : singles_) {
    const int own = order_[single.position];
    out.began.push_back(M(own, own) + x[single.diagonal]);
  }
  for (const Single& single : singles_) {
    out.masses.push_back(x[single.diagonal]);
    eliminate(single, x.data());
  }
  return out;
}

extern template void SparseKkt::eliminate(const Pair&, Traced*) const;
extern template void SparseKkt::eliminate(const Single&, Traced*) const;

}  // namespace ferrers
