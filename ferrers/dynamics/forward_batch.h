#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "ferrers/core/thread_team.h"
#include "ferrers/dynamics/forward_dynamics.h"

/// Problem: accelerations and multipliers of one mechanism at thousands of states: sampling, planning, learning.
///
/// Given: states, one per row. Wanted: vdot and lambda of each, as `ForwardDynamics` gives them. Four states go
/// through the same instructions at once, and threads share the columns; where there is no native code, one after
/// another.
namespace ferrers {

class ForwardBatch {
 public:
  /// `state`, `model`: as for `ForwardDynamics`. `threads` ≥ 1.
  ForwardBatch(std::shared_ptr<const DynamicsModel> model, const State& state, int threads = 1);

  struct States {
    MatrixXd q, v;  ///< n × nq, n × nv: assembled.
    double t = 0;   ///< Of all.
  };
  struct Results {
    MatrixXd vdot, lambda;  ///< n × nv; n × m, zero at the rows left out.
    VectorXd pivot_ratio;   ///< n: as of `ForwardDynamics`.
    std::vector<ForwardStatus> status;
  };
  /// `out` is made as large as needed; allocates nothing where it is, but as `ForwardDynamics` does. Throws
  /// std::invalid_argument for matrices of other sizes, and what effort laws throw.
  void evaluate(const States& states, Results& out);

  bool is_in_lanes() const { return program_ != nullptr; }
  const Selection& selection() const { return parts_.front().selection(); }

 private:
  static constexpr long kChunk = 64;  ///< States at once: they stay in the nearest cache.

  struct Work {  ///< Of a thread.
    Kernel::Board board;
    State state;
    std::optional<Equations> eq;  ///< Where forces want them.
    VectorXd applied;
    Eigen::ArrayXd wrong, farthest;
  };
  void evaluate_chunk(const States& states, long begin, long count, int part, Results& out);
  void evaluate_one(const States& states, long i, int part, Results& out);

  std::shared_ptr<const DynamicsModel> model_;
  std::vector<ForwardDynamics> parts_;  ///< Per thread.
  std::vector<Work> work_;
  std::shared_ptr<const ForwardProgram> program_;  ///< Null: one at a time.
  std::vector<int> excluded_;                      ///< Rows left out.
  double first_pivot_ = 1;
  ThreadTeam team_;
};

}  // namespace ferrers
