#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "ferrers/dynamics/initial_state.h"
#include "ferrers/dynamics/joint_limits.h"
#include "ferrers/simulate/recorder.h"

namespace ferrers {

enum class Integrator {
  kDormandPrince8,       ///< "dormand-prince-8": order 8 with error estimates and dense output. The default.
  kDormandPrince5,       ///< "dormand-prince-5": order 5 with an error estimate of order 4.
  kRungeKutta4,          ///< "runge-kutta-4": order 4 with projection; fixed step, or step doubling to a tolerance.
  kGeneralizedAlpha,     ///< "generalized-alpha": implicit, order 2, for stiff springs and bushings.
  kConstantAcceleration  ///< "constant-acceleration": the paper's, independent accelerations held over a step.
};
std::string_view to_string(Integrator integrator);
std::optional<Integrator> find_integrator(std::string_view name);
std::vector<std::string> integrator_names();

struct OutputGrid {
  double t_end = 10;    ///< s.
  double every = 0.01;  ///< s; rows at exactly k·every, and one at the end (within 1e-9·every it is on the grid).
  std::vector<double> times() const;
};

/// Work of forces, J; or their power, W.
struct Work {
  double drives = 0;
  double others = 0;  ///< Springs, dampers, friction, loads; not gravity.
};

/// Watching a long run: called with the time reached; `stop` set from outside ends it after the current step.
struct RunControl {
  std::function<void(const RunSample&)> on_sample;  ///< Called once per row, in order, as soon as it is known.
  std::function<void(double t)> on_progress;
  const std::atomic<bool>* stop = nullptr;
};

/// Whether a run makes native code of its mechanism (dynamics/forward_program.h), or uses what another run of the same
/// model has made: from the first step, or once it has evaluated so often that making it would have paid.
enum class NativeCode { kAlways, kWhenItPays, kNever };

struct SimulationOptions {
  OutputGrid grid;
  std::optional<Integrator> integrator;  ///< Else the engine chooses and says so (`RunSummary::method`).
  std::optional<double> step;            ///< s: fixed step, shortened to meet the output grid and to follow turns.
  /// What positions may be off by at the end, relative to the characteristic length L, and rad. Steps are chosen so
  /// that the local errors stay a thousandth of it per unit of motion; default 1e-9.
  std::optional<double> tolerance;
  std::optional<Formulation> formulation;  ///< Else `recommended_formulation`.
  NativeCode native_code = NativeCode::kWhenItPays;
  bool with_reactions = true;
  ReactionAxes axes = ReactionAxes::kWorld;
  DistributionOptions distribution;
  bool driven = false;         ///< Drives with a motion law follow it; the others act by their effort laws.
  std::optional<State> start;  ///< Goes on from here; else the model's initial state at t = 0.
  /// Beside `start`, by name: drives that events have switched off, and events that acted at that very time.
  std::vector<std::string> drives_off, events_acted;
  bool find_singular_poses = true;  ///< Locate them in time (costs a rank decision each).
  /// Run a companion with ten times the local tolerance beside, and compare: `RunSummary::error_estimate`.
  bool estimate_error = false;
};

/// What `options` ask for, else what the engine takes.
Integrator integrator_of(const SimulationOptions& options);

enum class RunStatus {
  kFinished,
  kStopped,       ///< By `RunControl::stop` or a `stop` event; what was computed is valid.
  kNotAssembled,  ///< No initial state; see `message`.
  kInconsistentVelocities,
  kSingularMass,
  kStepTooSmall,     ///< The error cannot be kept with any step: a singular pose, or forces that are not smooth.
  kRedundancyEnded,  ///< Rows left out as dependent no longer hold: they were dependent at that pose only.
  kBadMotion,        ///< Prescribed motion not determined or not reachable; see `message`.
  kUnsupported,      ///< The model asks for something that this version cannot do; see `message`.
  kStoppedByEvent,   ///< By an event of the model; everything is valid.
};

/// A decision about rows and coordinates, and when it was taken.
struct DecisionRecord {
  double t = 0;
  int rank = 0, mobility = 0;
  std::vector<std::string> excluded_rows, independent_coordinates;
  std::string reason;
};

/// A pose that the motion went across where the closure rank is lower than before and after.
struct SingularPose {
  double t = 0;
  int rank = 0, rank_around = 0;          ///< Of the closure rows, there and on either side.
  int mobility = 0, redundant = 0;        ///< There.
  int all_rank = 0, all_rank_around = 0;  ///< Of all joints' rows on body velocities, as `analyze` counts.
};

/// What an event of the model did, and when.
struct EventRecord {
  std::string name;
  double t = 0;
  EventSpec::Action action = EventSpec::Action::kRecord;
  std::string message;  ///< "drive 'motor' off"
};

/// Momentum about the world's origin over a run.
struct MomentumSummary {
  Vector3d linear_start = Vector3d::Zero(), linear_end = Vector3d::Zero();    ///< kg·m/s.
  Vector3d angular_start = Vector3d::Zero(), angular_end = Vector3d::Zero();  ///< kg·m²/s.
  /// Largest change of each component from the start, and the largest magnitudes met, by which to judge it.
  Vector3d linear_change = Vector3d::Zero(), angular_change = Vector3d::Zero();
  double linear_scale = 0, angular_scale = 0;
};

struct RunSummary {
  RunStatus status = RunStatus::kFinished;
  std::string message;
  std::string method;  ///< What was chosen, in words: integrator, step or tolerance, formulation.
  double t_reached = 0;
  long steps = 0, rejected_steps = 0, evaluations = 0;
  double smallest_step = 0, largest_step = 0;                               ///< s.
  double wall_time_s = 0;                                                   ///< Of the integration with its output.
  double max_constraint_residual = 0;                                       ///< m.
  bool has_energy = true;                                                   ///< False: masses were not needed.
  double energy_start = 0, energy_end = 0, energy_min = 0, energy_max = 0;  ///< J.
  /// Work of the drives; and of dampers, friction and loads (springs are part of the energy). What they leave
  /// unexplained of the change of energy is the error of the balance.
  std::optional<Work> work;
  double balance_error = 0;                 ///< J: energy_end − energy_start − work.
  std::optional<MomentumSummary> momentum;  ///< Of simulations.
  std::vector<EventRecord> events;
  std::vector<std::string> drives_off;   ///< Drives that events have switched off, at `t_reached`.
  std::vector<LimitCrossing> limits;     ///< Joint limits that were crossed.
  std::optional<double> error_estimate;  ///< Of positions, in rad and characteristic lengths.
  std::vector<DecisionRecord> decisions;
  std::vector<SingularPose> singular_poses;
  /// Inverse dynamics, per drive component: not unique, the share of the least weighted effort. Else empty.
  std::vector<bool> effort_is_shared;
  std::vector<std::string> notices;
  std::vector<JointPeak> peaks;  ///< Per joint.
  DistributionSummary distribution;
};

/// What a range of reactions that takes too long to compute is refused with; empty: not too long.
std::string refused_range(const DistributionSummary& distribution);

/// Forward simulation (the paper's inverse problem). Samples go to `control.on_sample`.
RunSummary simulate(std::shared_ptr<const DynamicsModel> model, const SimulationOptions& options,
                    const RunControl& control);

struct PrescribedOptions {
  OutputGrid grid;
  bool with_efforts = true;  ///< False: kinematics only, masses not needed.
  ReactionAxes axes = ReactionAxes::kWorld;
  DistributionOptions distribution;
};

/// Inverse dynamics or kinematics on the output grid (the paper's direct problem).
RunSummary run_prescribed(std::shared_ptr<const DynamicsModel> model, const PrescribedOptions& options,
                          const RunControl& control);

/// The rows that every run writes: names of `result.csv`'s columns.
std::vector<std::string> run_columns(const DynamicsModel& model);

}  // namespace ferrers
