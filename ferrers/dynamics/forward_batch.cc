#include "ferrers/dynamics/forward_batch.h"

#include <algorithm>
#include <functional>
#include <utility>

#include "ferrers/core/checks.h"
#include "ferrers/math/rank_pivot.h"

namespace ferrers {

ForwardBatch::ForwardBatch(std::shared_ptr<const DynamicsModel> model, const State& state, int threads)
    : model_(std::move(model)), team_(threads) {
  parts_.assign(static_cast<std::size_t>(threads), ForwardDynamics(model_, state));
  first_pivot_ = parts_.front().first_pivot();
  excluded_ = selection().excluded_rows(model_->system->m);
  program_ = parts_.front().of_states(kChunk);
  for (int i = 0; i < threads; ++i) {
    Work& work = work_.emplace_back();
    work.state = state;
    work.applied = VectorXd::Zero(model_->system->nv);
    if (program_ == nullptr) continue;
    work.board = program_->make_board();
    work.wrong = work.farthest = Eigen::ArrayXd::Zero(kChunk);
    if (program_->wants_applied()) work.eq = make_equations(*model_);
  }
}

void ForwardBatch::evaluate(const States& states, Results& out) {
  const System& system = *model_->system;
  const long n = states.q.rows();
  require(states.q.cols() == system.nq && states.v.cols() == system.nv && states.v.rows() == n,
          "ForwardBatch: q is n × nq and v n × nv");
  out.vdot.resize(n, system.nv);
  out.lambda.resize(n, system.m);
  out.pivot_ratio.resize(n);
  out.status.resize(static_cast<std::size_t>(n));
  for (const int row : excluded_) out.lambda.col(row).setZero();
  const auto share = [&](int part) {
    const long chunks = (n + kChunk - 1) / kChunk;
    const auto first = [&](int i) { return std::min(n, chunks * i / team_.count() * kChunk); };
    for (long at = first(part), end = first(part + 1); at < end; at += kChunk) {
      const long count = std::min(kChunk, end - at);
      if (program_ != nullptr) {
        evaluate_chunk(states, at, count, part, out);
      } else {
        for (long i = at; i < at + count; ++i) evaluate_one(states, i, part, out);
      }
    }
  };
  team_.run(std::ref(share));  // a reference needs no memory
}

void ForwardBatch::evaluate_one(const States& states, long i, int part, Results& out) {
  ForwardDynamics& one = parts_[static_cast<std::size_t>(part)];
  State& state = work_[static_cast<std::size_t>(part)].state;
  state.t = states.t;
  state.q = states.q.row(i);
  state.v = states.v.row(i);
  out.status[static_cast<std::size_t>(i)] = one.evaluate(state);
  out.vdot.row(i) = one.result().vdot;
  out.lambda.row(i) = one.result().lambda;
  out.pivot_ratio[i] = one.pivot_ratio();
}

// Everything by columns: one number of all states of the chunk, side by side in the matrices and on the board.
void ForwardBatch::evaluate_chunk(const States& states, long begin, long count, int part, Results& out) {
  const ForwardProgram::Layout& layout = program_->layout();
  Work& work = work_[static_cast<std::size_t>(part)];
  const auto row = [&](int place) { return Eigen::Map<Eigen::ArrayXd>(work.board.data() + place * kChunk, count); };
  for (const auto& input : layout.inputs[0]) row(input.place) = states.q.col(input.index).segment(begin, count);
  for (const auto& input : layout.inputs[1]) row(input.place) = states.v.col(input.index).segment(begin, count);
  if (program_->wants_applied()) {
    work.state.t = states.t;
    for (long i = 0; i < count; ++i) {
      work.state.q = states.q.row(begin + i);
      work.state.v = states.v.row(begin + i);
      compute_untraced_forces(*model_, work.state, *work.eq, work.applied);
      for (const auto& input : layout.inputs[3]) row(input.place)[i] = work.applied[input.index];
    }
  }
  program_->run(work.board);

  auto pivot = out.pivot_ratio.segment(begin, count).array();
  auto wrong = work.wrong.head(count);
  pivot.setConstant(layout.pivots.empty() ? 1 : INFINITY);
  wrong.setZero();
  auto farthest = work.farthest.head(count);
  farthest.setZero();
  for (const auto& input : layout.inputs[0]) farthest = farthest.max(row(input.place).abs());
  for (const int place : layout.pivots) pivot = pivot.min(row(place).abs());
  for (std::size_t k = 0; k < layout.vdot.size(); ++k) {
    const auto vdot = row(layout.vdot[k]);
    out.vdot.col(static_cast<long>(k)).segment(begin, count) = vdot;
    wrong += vdot - vdot;  // 0, or no number
  }
  for (std::size_t k = 0; k < layout.lambda.size(); ++k) {
    const auto lambda = row(layout.lambda[k]);
    out.lambda.col(layout.rows[k]).segment(begin, count) = lambda;
    wrong += lambda - lambda;
  }
  if (first_pivot_ > 0) pivot /= first_pivot_;
  for (long i = 0; i < count; ++i) {
    bool solved = wrong[i] == 0 && !(work.farthest[i] > kFarthestAngle);
    for (std::size_t k = 0; k < layout.masses.size(); ++k) {
      solved = solved && !is_lost_pivot(row(layout.masses[k])[i], row(layout.began[k])[i]);
    }
    out.status[static_cast<std::size_t>(begin + i)] = ForwardStatus::kSolved;
    if (!solved) evaluate_one(states, begin + i, part, out);  // the parts may know an answer
  }
}

}  // namespace ferrers
