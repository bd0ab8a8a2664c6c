#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ferrers/io/parameter_table.h"
#include "ferrers/simulate/simulation.h"

/// Problem: the same simulation for thousands of sets of parameter values.
///
/// Given: a model, a table of parameter values, what to simulate. Wanted: of every variant where its motion ends, with
/// energies, rank and what the run has to say. Variants do not know of each other: threads take the next one as soon as
/// they are free, and the results are the same to the bit whatever the number of threads.
namespace ferrers {

struct VariantResult {
  std::size_t index = 0;  ///< Row of the table, from 0.
  /// None: there is no such model (a negative mass, say); `message` tells why.
  std::optional<RunStatus> run;
  std::string message;

  /// Of the first decision: rank of the closure rows (prescribed drives' rows too), mobility, and rows left out.
  struct Decision {
    int rank = 0, mobility = 0, redundant = 0;
    bool operator==(const Decision&) const = default;
  };
  std::optional<Decision> decision;  ///< None: it did not get so far.

  std::vector<double> values;  ///< The last row, in the order of `run_columns`; empty: there is none.
  double energy_start = 0, energy_end = 0, balance_error = 0;  ///< J; known where there are `values`.
  long steps = 0, evaluations = 0;
  std::vector<std::string> notices;

  /// It went to its end, or to a `stop` event of the model.
  bool is_finished() const { return run == RunStatus::kFinished || run == RunStatus::kStoppedByEvent; }
};

struct VariantsOptions {
  /// Also `grid`, which says for which times rows are made: only the last one is kept. Reactions and error estimates
  /// are left out whatever stands here. `start` goes for all variants.
  SimulationOptions simulation;
  int threads = 1;
  std::size_t first = 0;  ///< Row to begin with.
};

struct VariantsControl {
  /// Called once per variant in the order of the rows, by one thread at a time.
  std::function<void(const VariantResult&)> on_result;
  const std::atomic<bool>* stop = nullptr;  ///< Set from outside: what runs ends after its step and is not told.
};

/// Simulates the variants `options.first` … of `table`. Returns how many were told: all, if nothing stopped it.
///
/// Each is the simulation of `model.with_parameters` of its row. A user's own functions (`LagrangianSystem`) are called
/// by several threads at once. Throws std::invalid_argument for fewer threads than one or rows that the table lacks,
/// and what a callback or a user's own functions throw, when all threads have ended. Cost: that of building and
/// simulating the models, shared by the threads; results that wait for an earlier one are kept, a thousand per thread
/// at most.
std::size_t simulate_variants(const Model& model, const ParameterTable& table, const VariantsOptions& options,
                              const VariantsControl& control);

/// One of them. `values`: in the order of `names`, SI.
VariantResult simulate_variant(const Model& model, std::span<const std::string> names, std::span<const double> values,
                               const SimulationOptions& simulation, const std::atomic<bool>* stop = nullptr);

/// The rows that a simulation needs where only the last one is wanted: at the start and at `t_end`. Steps of equal
/// length are shaped by the spacing of the rows (`SimulationOptions::step`): for those it stays that of `usual`.
OutputGrid last_row_grid(const SimulationOptions& simulation, const OutputGrid& usual);

}  // namespace ferrers
