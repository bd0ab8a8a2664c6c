#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ferrers/dynamics/reactions.h"
#include "ferrers/kinematics/floating_bodies.h"

namespace ferrers {

/// One row of output: everything that a run's files show at one time.
struct RunSample {
  double t = 0;
  std::vector<double> values;            ///< In the order of `Recorder::columns()`, which starts with "t".
  std::vector<JointReaction> reactions;  ///< Per joint, in file order; empty where none are known (kinematics).
  double energy = 0;                     ///< J.
  double elastic_energy = 0;             ///< J: the part of it in springs and bushings.
  double constraint_residual = 0;        ///< Largest |phi| over all rows, rotations times L; m.
};

/// The largest load of one joint over a run.
struct JointPeak {
  std::optional<double> force, moment;  ///< N, N·m: norms; empty while no sample had all three components determined.
  double force_t = 0, moment_t = 0;
  bool force_determined = true, moment_determined = true;      ///< False: some sample had undetermined components.
  bool force_distributed = false, moment_distributed = false;  ///< True: some component came from the distribution.
};

/// How a run's indeterminate reactions were divided.
struct DistributionSummary {
  bool used = false;  ///< False: nothing to divide, or nothing to divide by.
  DistributionBy by = DistributionBy::kJointStiffness;
  double length_m = 0;                         ///< Equal stiffness: k for forces is k·length² for moments.
  std::optional<StiffnessRange> range;         ///< Asked for.
  BoundsMethod bounds = BoundsMethod::kExact;  ///< Of the ranges: `kSearch` if only one of them came so.
  std::vector<std::string> notices;            ///< What the reader must know.
};

/// Turns states into rows of output: measures every joint coordinate, recorded point, effort and reaction.
class Recorder {
 public:
  explicit Recorder(std::shared_ptr<const DynamicsModel> model, ReactionAxes axes = ReactionAxes::kWorld,
                    const DistributionOptions& distribution = {});

  /// "t"; per joint coordinate JOINT.COORDINATE, .velocity, .acceleration, and the same of a free joint for each body
  /// that floats without one (kinematics/floating_bodies.h); DRIVE.effort; POINT.x .y .z; "energy".
  const std::vector<std::string>& columns() const { return columns_; }
  const DynamicsModel& model() const { return *model_; }

  /// `eq` filled at `state`; `with_reactions` false leaves reactions empty.
  const RunSample& record(const State& state, const Equations& eq, const Selection& selection, const VectorXd& vdot,
                          const VectorXd& lambda, const VectorXd& u, bool with_reactions);

  const std::vector<JointPeak>& peaks() const { return peaks_; }
  const DistributionSummary& distribution() const { return distribution_; }

 private:
  void follow_peaks();
  void follow_distribution(double t, const DistributionOutcome& outcome);

  std::shared_ptr<const DynamicsModel> model_;
  ReactionAxes axes_;
  DistributionOptions distribute_by_;
  std::optional<ReactionSolver> reactions_;  ///< Where any were asked for.
  Scaling scaling_;
  std::vector<FloatingBody> floating_;
  std::vector<std::string> columns_;
  std::vector<NodePoint> points_;
  VelocityKinematics accelerations_;
  RunSample sample_;
  std::vector<JointPeak> peaks_;
  DistributionSummary distribution_;
  bool doubt_told_ = false, contradiction_told_ = false, excess_told_ = false;
};

}  // namespace ferrers
