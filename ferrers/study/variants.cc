#include "ferrers/study/variants.h"

#include <condition_variable>
#include <map>
#include <mutex>
#include <utility>

#include "ferrers/core/checks.h"
#include "ferrers/core/thread_team.h"

namespace ferrers {
namespace {

// Results that may wait for an earlier one, per thread: enough for variants that differ a thousandfold in cost.
constexpr std::size_t kMostWaiting = 1024;

std::string first_error(const Diagnostics& diagnostics) {
  for (const Diagnostic& one : diagnostics.items()) {
    if (one.severity == Severity::kError) return one.message;
  }
  return "";
}

/// Hands out rows and puts the results in order.
class Queue {
 public:
  Queue(std::size_t first, std::size_t end, std::size_t most_waiting, const VariantsControl& control)
      : control_(control), next_(first), due_(first), end_(end), most_waiting_(most_waiting) {}

  /// The next row; none when there is nothing more to do. Waits where too much is ahead of the row that is due.
  std::optional<std::size_t> take() {
    std::unique_lock lock(mutex_);
    room_.wait(lock, [this] { return ended_ || next_ < due_ + most_waiting_ || next_ >= end_; });
    if (ended_ || next_ >= end_ || is_stopped()) return std::nullopt;
    return next_++;
  }

  void put(VariantResult result) {
    const std::lock_guard lock(mutex_);
    if (broken_) return;
    waiting_.emplace(result.index, std::move(result));
    for (auto it = waiting_.begin(); it != waiting_.end() && it->first == due_; it = waiting_.erase(it), ++due_) {
      if (control_.on_result) control_.on_result(it->second);
    }
    room_.notify_all();
  }

  /// Nothing is handed out any more; with `broken`, nothing is told either. A row that was taken may stay undone.
  void end(bool broken = false) {
    const std::lock_guard lock(mutex_);
    ended_ = true;
    broken_ = broken_ || broken;
    room_.notify_all();
  }

  bool is_stopped() const { return control_.stop != nullptr && control_.stop->load(std::memory_order_relaxed); }
  std::size_t due() const { return due_; }

 private:
  const VariantsControl& control_;
  std::mutex mutex_;
  std::condition_variable room_;
  std::map<std::size_t, VariantResult> waiting_;  ///< By row; not that which is due.
  std::size_t next_, due_;                        ///< To be handed out; to be told.
  std::size_t end_, most_waiting_;
  bool ended_ = false, broken_ = false;
};

}  // namespace

VariantResult simulate_variant(const Model& model, std::span<const std::string> names, std::span<const double> values,
                               const SimulationOptions& simulation, const std::atomic<bool>* stop) {
  require_size(static_cast<long>(values.size()), static_cast<long>(names.size()), "simulate_variant: values");
  std::map<std::string, double> parameters;
  for (std::size_t i = 0; i < names.size(); ++i) parameters[names[i]] = values[i];
  VariantResult result;
  ModelBuildResult built = model.with_parameters(parameters);
  if (!built.model || built.diagnostics.has_errors()) {
    result.message = first_error(built.diagnostics);
    return result;
  }
  RunControl control;
  control.stop = stop;
  control.on_sample = [&result](const RunSample& sample) { result.values = sample.values; };
  RunSummary summary = simulate(make_dynamics_model(make_system(std::move(*built.model))), simulation, control);
  result.run = summary.status;
  result.message = std::move(summary.message);
  if (!summary.decisions.empty()) {
    const DecisionRecord& first = summary.decisions.front();
    result.decision = {first.rank, first.mobility, static_cast<int>(first.excluded_rows.size())};
  }
  result.energy_start = summary.energy_start;
  result.energy_end = summary.energy_end;
  result.balance_error = summary.balance_error;
  result.steps = summary.steps;
  result.evaluations = summary.evaluations;
  result.notices = std::move(summary.notices);
  return result;
}

std::size_t simulate_variants(const Model& model, const ParameterTable& table, const VariantsOptions& options,
                              const VariantsControl& control) {
  require(options.threads >= 1, "simulate_variants: at least one thread");
  require(options.first <= table.rows(), "simulate_variants: the first row is beyond the table");
  SimulationOptions simulation = options.simulation;
  simulation.with_reactions = false;
  simulation.estimate_error = false;
  Queue queue(options.first, table.rows(), kMostWaiting * static_cast<std::size_t>(options.threads), control);
  const auto work = [&](int) {
    try {
      while (const auto row = queue.take()) {
        VariantResult result = simulate_variant(model, table.names, table.row(*row), simulation, control.stop);
        if (result.run == RunStatus::kStopped) return queue.end();  // others may wait for this very row
        result.index = *row;
        queue.put(std::move(result));
      }
    } catch (...) {
      queue.end(/*broken=*/true);
      throw;
    }
  };
  ThreadTeam(options.threads).run(work);
  return queue.due() - options.first;
}

OutputGrid last_row_grid(const SimulationOptions& simulation, const OutputGrid& usual) {
  OutputGrid grid = usual;
  const bool adapts = !simulation.step && integrator_of(simulation) != Integrator::kConstantAcceleration;
  if (adapts && grid.t_end > 0) grid.every = grid.t_end;
  return grid;
}

}  // namespace ferrers
