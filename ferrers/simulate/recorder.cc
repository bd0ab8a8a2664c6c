#include "ferrers/simulate/recorder.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ferrers {

Recorder::Recorder(std::shared_ptr<const DynamicsModel> model, ReactionAxes axes,
                   const DistributionOptions& distribution)
    : model_(std::move(model)),
      axes_(axes),
      distribute_by_(distribution),
      scaling_(model_->system->scaling),
      floating_(find_floating_bodies(*model_->system)),
      accelerations_(make_velocity_kinematics(*model_->system)) {
  const System& system = *model_->system;
  columns_.emplace_back("t");
  for (const Joint& joint : system.model->joints()) {
    const JointTypeInfo& type = joint_type_info(joint.type);
    for (int i = 0; i < type.nq; ++i) columns_.push_back(coordinate_label(joint, type.position_names[i]));
    for (const std::string suffix : {".velocity", ".acceleration"}) {
      for (int i = 0; i < type.nv; ++i) columns_.push_back(coordinate_label(joint, type.coordinates[i].name) + suffix);
    }
  }
  for (const FloatingBody& body : floating_) {
    for (const std::string_view name : kFreeJoint.position_names)
      columns_.push_back(body.name + "." + std::string(name));
    for (const std::string suffix : {".velocity", ".acceleration"}) {
      for (const CoordinateInfo& info : kFreeJoint.coordinates)
        columns_.push_back(body.name + "." + std::string(info.name) + suffix);
    }
  }
  for (const DriveComponent& drive : model_->drives) {
    if (drive.acts) columns_.push_back(drive.name + ".effort");
  }
  for (const RecordedPoint& point : system.model->records()) {
    points_.push_back(system.point(point.body, point.point_m));
    for (const char* axis : {".x", ".y", ".z"}) columns_.push_back(point.name + axis);
  }
  for (const RecordedFormula& formula : system.model->recorded_formulas()) columns_.push_back(formula.name);
  columns_.emplace_back("energy");
  sample_.values.resize(columns_.size());
  peaks_.resize(system.model->coordinates_begin());
  distribution_.by = distribution.by;
  distribution_.range = distribution.range;
  if (distribution.by != DistributionBy::kEqualStiffness) return;
  distribution_.length_m = scaling_.length_m;
  const auto& joints = system.model->joints();
  if (std::any_of(joints.begin(), joints.end(), [](const Joint& j) { return j.misalignment.has_value(); })) {
    distribution_.notices.emplace_back("misalignment is not used: equal stiffness has ratios but no size");
  }
}

const RunSample& Recorder::record(const State& state, const Equations& eq, const Selection& selection,
                                  const VectorXd& vdot, const VectorXd& lambda, const VectorXd& u,
                                  bool with_reactions) {
  const System& system = *model_->system;
  sample_.t = state.t;
  sample_.reactions.clear();
  compute_accelerations(system, eq.pos, eq.vel, vdot, accelerations_);
  auto out = sample_.values.begin();
  *out++ = state.t;
  for (std::size_t j = 0; j < system.model->joints().size(); ++j) {
    const JointTypeInfo& type = joint_type_info(system.model->joints()[j].type);
    const JointMotion motion = measure_joint(system, JointId(j), state, vdot, eq.pos, accelerations_);
    out = std::copy_n(motion.q, type.nq, out);
    out = std::copy_n(motion.v, type.nv, out);
    out = std::copy_n(motion.vdot, type.nv, out);
  }
  for (const FloatingBody& body : floating_) {
    const Node& node = system.nodes[static_cast<std::size_t>(body.node)];
    out = std::copy_n(state.q.data() + node.q, node.nq, out);
    out = std::copy_n(state.v.data() + node.v, node.nv, out);
    out = std::copy_n(vdot.data() + node.v, node.nv, out);
  }
  for (int i = 0; i < model_->nu(); ++i) {
    if (model_->drives[i].acts) *out++ = u[i];
  }
  for (const NodePoint& point : points_) {
    const Vector3d p = point_position(eq.pos, point);
    out = std::copy_n(p.data(), 3, out);
  }
  for (const BoundLaw& law : model_->recorded) *out++ = law.evaluate(system, state, eq.pos, eq.vel);
  const Energy energy = compute_energy(*model_, state, eq.pos, eq.vel);
  sample_.energy = energy.total();
  sample_.elastic_energy = energy.elastic;
  *out = sample_.energy;
  sample_.constraint_residual =
      system.m > 0 ? eq.constraints.phi.head(system.m).cwiseProduct(scaling_.rows).cwiseAbs().maxCoeff() : 0.0;
  if (with_reactions) {
    DistributionOutcome outcome;
    if (!reactions_) reactions_.emplace(model_, distribute_by_);
    sample_.reactions = reactions_->solve(state, eq, selection, vdot, lambda, u, axes_, &outcome);
    follow_distribution(state.t, outcome);
    follow_peaks();
  }
  return sample_;
}

void Recorder::follow_distribution(double t, const DistributionOutcome& outcome) {
  if (outcome.too_many > 0 && !std::exchange(excess_told_, true)) {
    distribution_.notices.push_back(
        "there are " + std::to_string(outcome.too_many) + " self-stresses: stiffness divides up to " +
        std::to_string(ReactionSolver::kMostDistributed) +
        ", and which reactions are unique is judged in mechanisms of up to 10000 closure rows; what is beyond is "
        "undetermined");
  }
  if (!outcome.used) return;
  distribution_.used = true;
  distribution_.bounds = std::max(distribution_.bounds, outcome.bounds);
  if (!outcome.confident && !std::exchange(doubt_told_, true)) {
    distribution_.notices.push_back("which reactions the stiffness determines is in doubt at t = " + std::to_string(t) +
                                    " s");
  }
  if (outcome.contradictory.empty() || std::exchange(contradiction_told_, true)) return;
  std::string names;
  for (const std::string& name : outcome.contradictory) names += (names.empty() ? "'" : ", '") + name + "'";
  distribution_.notices.push_back("from t = " + std::to_string(t) +
                                  " s on, the misalignment contradicts rigid joints (" + names +
                                  "): their reactions are not distributed; give stiffness to what must give way");
}

void Recorder::follow_peaks() {
  const auto follow = [&](const JointReaction& r, int first, std::optional<double>& peak, double& at, bool& determined,
                          bool& distributed) {
    double square = 0;
    for (int k = first; k < first + 3; ++k) {
      if (r.status[k] == ReactionStatus::kUndetermined) {
        determined = false;
        return;
      }
      square += r.value[k] * r.value[k];
    }
    for (int k = first; k < first + 3; ++k) distributed |= r.status[k] == ReactionStatus::kDistributed;
    const double norm = std::sqrt(square);
    if (peak && norm <= *peak) return;
    peak = norm;
    at = sample_.t;
  };
  for (std::size_t j = 0; j < peaks_.size(); ++j) {
    JointPeak& p = peaks_[j];
    follow(sample_.reactions[j], 0, p.force, p.force_t, p.force_determined, p.force_distributed);
    follow(sample_.reactions[j], 3, p.moment, p.moment_t, p.moment_determined, p.moment_distributed);
  }
}

}  // namespace ferrers
