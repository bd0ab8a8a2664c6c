#pragma once

#include <array>
#include <memory>
#include <mutex>
#include <vector>

#include "ferrers/dynamics/forward_kkt.h"
#include "ferrers/dynamics/traced_equations.h"
#include "ferrers/math/kernel.h"

/// Problem: the accelerations of one mechanism with its multipliers, as fast as its structure and constants allow.
///
/// Given: a model of bodies, joints and forces that enter as numbers, and the order in which its equations are
/// eliminated. Wanted: q, v → vdot, lambda as one piece of native code (math/kernel.h): equations, factors and
/// solution, without the matrices in between. Method: the same templates that evaluate numbers run once on traced
/// numbers (math/traced.h). Watched as ever: the pivots.
namespace ferrers {

class ForwardProgram {
 public:
  enum class Extent {
    kAccelerations,  ///< vdot, lambda.
    kClosure         ///< Also phi and rate of all rows, and what brings q and v onto the constraints.
  };

  /// What stands between a state and the constraints, and the nearest ways there in the mass metric [stepanyan, eq.
  /// (9)] with other right sides: G Δq = −phi, G Δv = −rate.
  struct Closure {
    VectorXd phi, rate;                     ///< m.
    VectorXd dq, dv;                        ///< nv.
    double place = 0, speed = 0, turn = 0;  ///< Largest |p|², |v|² and |ω|² of the bodies' nodes: m², m²/s², 1/s².
  };

  /// Whether the model is made of parts that this program knows: no couplings, formulas or coordinates of their own.
  static bool knows(const DynamicsModel& model);
  /// Whether straight code is short enough to be faster than loops over matrices: a tangle of a hundred bodies is not.
  static bool pays(const SparseKkt& kkt);
  /// Whether all angles are near enough to be turned by polynomials (math/traced.h).
  static bool reaches(const State& state);

  /// Cost: some hundred nanoseconds per operation. `states`: 1, or a multiple of four for as many independent states at
  /// once (forward_batch.h).
  ForwardProgram(const DynamicsModel& model, const SparseKkt& kkt, Extent extent, int states = 1);

  bool is_native() const { return kernel_.is_native(); }
  int states() const { return states_; }
  std::size_t code_bytes() const { return kernel_.code_bytes(); }
  double shared_part() const { return kernel_.shared_part(); }
  Kernel::Board make_board() const { return kernel_.make_board(); }

  struct Watched {
    double smallest_pivot = 1;
    double power = 0;  ///< Of the forces that are not among `applied`, gravity's left out, W.
  };

  /// `applied`: tau + B u of what `ForceElements::kUntraced` says, nv; not read unless `wants_applied()`. `out.lambda`:
  /// only the chosen rows are written. `closure`: for kClosure. Where the status is not kSolved, the parts may still
  /// know an answer. Allocates nothing.
  ForwardStatus evaluate(const State& state, const VectorXd& applied, Kernel::Board& board, ForwardResult& out,
                         Watched& watched, Closure* closure = nullptr) const;
  bool wants_applied() const { return wants_applied_; }

  /// Where things stand on the board: as a place of the kernel's, with `states()` numbers each.
  struct Input {
    int place, index;
  };
  struct Layout {
    std::array<std::vector<Input>, 4> inputs;  ///< What is wanted of q, v, winding and applied.
    std::vector<int> vdot, lambda;             ///< Places; of lambda those of `rows`.
    std::vector<int> rows;
    std::vector<int> pivots;         ///< Numbers whose smallest size is `Watched::smallest_pivot`.
    std::vector<int> masses, began;  ///< Pivots of the mass matrix, and what they are left of.
    int power = 0;
    std::vector<int> phi, rate, dq, dv;  ///< kClosure; of phi and rate those of the following rows.
    std::vector<int> phi_rows, rate_rows;
    std::vector<int> places, speeds, turns;  ///< Squares, of the bodies' nodes.
  };
  const Layout& layout() const { return layout_; }
  void run(Kernel::Board& board) const { kernel_.run(board); }

 private:
  int states_;
  bool wants_applied_;
  Kernel kernel_;
  Layout layout_;
};

/// What `ForwardProgram::evaluate` wants as `applied`. Fills `eq.u`, `eq.tau`, and poses where they are read. Allocates
/// nothing.
void compute_untraced_forces(const DynamicsModel& model, const State& state, Equations& eq, VectorXd& applied);

/// The programs of one model, made when first asked for. Safe with several threads.
class ForwardPrograms {
 public:
  std::shared_ptr<const ForwardProgram> find_or_make(const DynamicsModel& model, const SparseKkt& kkt,
                                                     ForwardProgram::Extent extent, int states = 1);

 private:
  struct Known {
    std::vector<int> signature;
    ForwardProgram::Extent extent;
    std::shared_ptr<const ForwardProgram> program;
  };
  std::mutex mutex_;
  std::vector<Known> known_;  ///< The latest last; a few.
};

}  // namespace ferrers
