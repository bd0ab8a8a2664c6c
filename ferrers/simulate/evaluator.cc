#include "ferrers/simulate/evaluator.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "ferrers/dynamics/lagrangian_terms.h"
#include "ferrers/redundancy/rank_notice.h"
#include "ferrers/redundancy/selection.h"
#include "ferrers/simulate/prescribed_laws.h"

namespace ferrers {

namespace {

// Driven rows compare like the coordinates they prescribe: angles times L.
VectorXd make_row_scale(const DynamicsModel& model, const Scaling& scaling, const std::vector<int>& driven) {
  VectorXd out(scaling.rows.size() + static_cast<long>(driven.size()));
  out.head(scaling.rows.size()) = scaling.rows;
  for (std::size_t i = 0; i < driven.size(); ++i) {
    const DriveComponent& drive = model.drives[driven[i]];
    out[scaling.rows.size() + static_cast<long>(i)] = drive.rotary ? scaling.length_m : 1;
  }
  return out;
}

// Of the coordinates that count turns; those of quaternions do not.
double largest_angle(const System& system, const VectorXd& q) {
  double largest = 0;
  for (const Node& node : system.nodes) {
    for (int k = 0; k < node.nv && node.nq == node.nv; ++k) {
      if (node.type->coordinates[k].is_angular()) largest = std::max(largest, std::abs(q[node.q + k]));
    }
  }
  return largest;
}

}  // namespace

Evaluator::Evaluator(std::shared_ptr<const DynamicsModel> model, Formulation formulation, std::vector<int> driven,
                     const DistributionOptions& distribution)
    : model_(std::move(model)),
      formulation_(formulation),
      scaling_(model_->system->scaling),
      eq_(make_equations(*model_, std::move(driven))),
      result_(make_forward_result(eq_)),
      energy_pos_(make_position_kinematics(*model_->system)),
      energy_vel_(make_velocity_kinematics(*model_->system)),
      row_scale_(make_row_scale(*model_, scaling_, eq_.driven)),
      no_force_(VectorXd::Zero(model_->system->nv)),
      residual_rhs_(VectorXd::Zero(row_scale_.size())),
      efforts_(VectorXd::Zero(model_->nu())),
      applied_(no_force_),
      closure_{VectorXd::Zero(model_->system->m), VectorXd::Zero(model_->system->m), no_force_, no_force_},
      last_(make_drawn_state(*model_->system)),
      correction_(result_),
      friction_(model_, distribution) {}

void Evaluator::set_drives(std::vector<int> driven, std::vector<bool> off) {
  off_ = std::move(off);
  motion_problem_.clear();
  eq_ = make_equations(*model_, std::move(driven));
  result_ = correction_ = make_forward_result(eq_);
  row_scale_ = make_row_scale(*model_, scaling_, eq_.driven);
  residual_rhs_ = VectorXd::Zero(row_scale_.size());
}

void Evaluator::use(Selection joints) {
  joint_selection_ = std::move(joints);
  selection_ = joint_selection_;
  driven_conflict_.clear();
  implied_drives_.clear();
  implied_rows_.clear();
  if (!eq_.driven.empty()) {
    const long k = static_cast<long>(eq_.driven.size());
    ExtendedSelection extended =
        extend_selection(joint_selection_, eq_.constraints.G, system().m, row_scale_.tail(k), scaling_.columns);
    selection_ = std::move(extended.selection);
    implied_rows_ = extended.implied;
    for (const int row : extended.implied) implied_drives_.push_back(eq_.driven[row]);
    for (const int row : extended.conflicting) {
      driven_conflict_ += (driven_conflict_.empty() ? "" : ", ") + model_->drives[eq_.driven[row]].name;
    }
  }
  solver_ = make_forward_solver(formulation_, system(), selection_);
  stage_program_ = closure_program_ = nullptr;
  programs_sought_ = false;
  latest_ = before_latest_ = Watched();  // other pivots
  result_.lambda.setZero();
  correction_.lambda.setZero();
  pivot_known_ = false;
}

void Evaluator::record(double t, const std::string& reason, RunSummary& summary) const {
  DecisionRecord record;
  record.t = t;
  record.rank = static_cast<int>(selection_.rows.size());
  record.mobility = static_cast<int>(selection_.independent.size());
  record.reason = reason;
  for (const int row : joint_selection_.excluded_rows(system().m))
    record.excluded_rows.push_back(system().row_names[row]);
  for (const int v : selection_.independent) record.independent_coordinates.push_back(system().coordinate_names[v]);
  summary.decisions.push_back(std::move(record));
}

void Evaluator::decide(const State& state, const std::string& reason, RunSummary& summary) {
  poses_stale_ = equations_stale_ = false;
  compute_kinematics(*model_, state, eq_);
  RankDecision decision;
  use(select_independent(system(), scaling_, eq_.constraints, &decision));
  if (std::string doubt = doubtful_rank_notice(state.t, decision); !doubt.empty()) {
    summary.notices.push_back(std::move(doubt));
  }
  record(state.t, reason, summary);
}

ForwardStatus Evaluator::choose_again(const State& state, RunSummary& summary) {
  const Selection previous = joint_selection_;
  const double healthy = healthy_pivot_;
  use(reselect(system(), scaling_, equations().constraints, previous));
  ForwardStatus status = evaluate(state);
  if (status == ForwardStatus::kSolved && !is_worn_pivot(pivot_, best_pivot_)) {
    record(state.t, "the coordinates chosen before became ill-conditioned", summary);
    return status;
  }
  use(previous);  // all choices are bad here: the pose is nearly singular
  status = evaluate(state);
  healthy_pivot_ = healthy;
  return status;
}

ForwardStatus Evaluator::evaluate(const State& state) {
  ++evaluations_;
  equations_stale_ = false;
  compute_equations(*model_, state, eq_);
  poses_stale_ = false;
  double place = 0, speed = 0, turn = 0;
  for (int i = 1; i < system().body_nodes; ++i) {
    place = std::max(place, eq_.pos.nodes[i].p.squaredNorm());
    speed = std::max(speed, eq_.vel.nodes[i].v.squaredNorm());
    turn = std::max(turn, eq_.vel.nodes[i].w.squaredNorm());
  }
  note_sizes(place, speed, turn);
  coordinate_size_ = coordinate_speed_ = 0;
  for (std::size_t i = static_cast<std::size_t>(system().body_nodes); i < system().nodes.size(); ++i) {
    const Node& node = system().nodes[i];
    coordinate_size_ = std::max(coordinate_size_, std::abs(state.q[node.q]) / scaling_.columns[node.v]);
    coordinate_speed_ = std::max(coordinate_speed_, std::abs(state.v[node.v]) / scaling_.columns[node.v]);
  }
  if (std::string problem = find_law_without_value(*model_, eq_, state.t); !problem.empty()) {
    note_motion_problem(state.t, std::move(problem));
    return ForwardStatus::kWornSelection;
  }
  if (state.t >= motion_problem_t_) motion_problem_.clear();
  switch_off(eq_.force);
  solver_->solve(eq_, result_);
  has_factors_ = result_.status == ForwardStatus::kSolved;
  if (result_.status != ForwardStatus::kSolved) return result_.status;
  friction_problem_.clear();
  if (friction_.any() && friction_.solve(state, eq_, joint_selection_, *solver_, result_) != FrictionStatus::kSolved) {
    friction_problem_ = friction_.message();
    return ForwardStatus::kWornSelection;
  }
  note_pivot(state.t, solver_->smallest_pivot());
  return result_.status;
}

void Evaluator::note_pivot(double t, double pivot) {
  pivot_ = pivot;
  if (!pivot_known_) healthy_pivot_ = pivot;
  pivot_known_ = true;
  best_pivot_ = std::max(best_pivot_, pivot);
  watch(t, pivot);
}

// ---- native code ----

bool Evaluator::finds_programs() {
  if (programs_sought_) return stage_program_ != nullptr;
  if (native_from_ < 0 || evaluations_ < native_from_) return false;
  const SparseKkt* const order = solver_->order();
  if (order == nullptr) return false;  // nothing was solved yet, or another formulation
  programs_sought_ = true;
  if (!eq_.driven.empty() || friction_.any() || !ForwardProgram::knows(*model_) || !ForwardProgram::pays(*order)) {
    return false;
  }
  const auto find = [&](ForwardProgram::Extent extent) {
    return model_->programs->find_or_make(*model_, *order, extent);
  };
  stage_program_ = find(ForwardProgram::Extent::kAccelerations);
  closure_program_ = find(ForwardProgram::Extent::kClosure);
  if (!stage_program_->is_native() || !closure_program_->is_native()) {
    stage_program_ = closure_program_ = nullptr;
    return false;
  }
  stage_board_ = stage_program_->make_board();
  closure_board_ = closure_program_->make_board();
  return true;
}

// Drives that do not act.
void Evaluator::switch_off(VectorXd& force) {
  for (std::size_t i = 0; i < off_.size(); ++i) {
    if (!off_[i]) continue;
    force -= eq_.u[static_cast<long>(i)] * eq_.B_transposed.row(static_cast<long>(i)).transpose();
    eq_.u[static_cast<long>(i)] = 0;
  }
}

bool Evaluator::evaluate_natively(const State& state, const ForwardProgram& program, Kernel::Board& board,
                                  ForwardProgram::Closure* closure) {
  last_ = state;
  poses_stale_ = equations_stale_ = true;
  if (program.wants_applied()) {
    compute_untraced_forces(*model_, state, eq_, applied_);
    switch_off(applied_);
  }
  ForwardProgram::Watched watched;
  if (program.evaluate(state, applied_, board, result_, watched, closure) != ForwardStatus::kSolved) return false;
  ++evaluations_;
  other_power_ = watched.power;
  if (closure != nullptr) {
    note_sizes(closure->place, closure->speed, closure->turn);
    eq_.constraints.phi = closure->phi;
    eq_.constraints.rate = closure->rate;
  }
  note_pivot(state.t, watched.smallest_pivot);
  return true;
}

const PositionKinematics& Evaluator::positions() {
  if (!std::exchange(poses_stale_, false)) return eq_.pos;
  compute_positions(system(), last_.q, eq_.pos);
  compute_velocities(system(), eq_.pos, last_.q, last_.v, eq_.vel);
  return eq_.pos;
}

const VelocityKinematics& Evaluator::velocities() {
  positions();
  return eq_.vel;
}

const Equations& Evaluator::equations() {
  if (!equations_stale_) return eq_;
  poses_stale_ = equations_stale_ = false;
  compute_equations(*model_, last_, eq_);
  switch_off(eq_.force);
  solver_->solve(eq_, correction_);
  has_factors_ = correction_.status == ForwardStatus::kSolved;
  return eq_;
}

void Evaluator::reset_watch() {
  smallest_pivot_ = std::numeric_limits<double>::infinity();
  latest_ = before_latest_ = Watched();
}

// The stages of a step come in any order, some at the same time.
void Evaluator::watch(double t, double pivot) {
  smallest_pivot_ = std::min(smallest_pivot_, pivot);
  if (!std::isfinite(latest_.t)) watch_start_ = t;
  const double same = 1e-3 * (latest_.t - watch_start_);
  if (std::abs(t - latest_.t) <= same) {
    latest_ = {t, pivot};
  } else if (t > latest_.t) {
    before_latest_ = latest_;
    latest_ = {t, pivot};
  } else if (t > before_latest_.t) {
    before_latest_ = {t, pivot};
  }
}

double Evaluator::longest_followed_turn() {
  constexpr double kFarthest = 2;  // rad; from π on the count is lost
  if (system().winding_count == 0) return std::numeric_limits<double>::infinity();
  return kFarthest / fastest_turn(system(), positions(), velocities());
}

// The earliest one ahead is kept: a step that met it is tried again, shorter.
void Evaluator::note_motion_problem(double t, std::string problem) {
  if (!motion_problem_.empty() && motion_problem_t_ <= t) return;
  motion_problem_ = std::move(problem);
  motion_problem_t_ = t;
}

// Whether drives that have no say in the motion prescribe what it is; at a state on the constraints.
bool Evaluator::laws_agree(double t) {
  std::string problem = find_law_against_constraints(*model_, scaling_, eq_, implied_rows_, result_.vdot, t);
  if (problem.empty()) return true;
  note_motion_problem(t, std::move(problem));
  return false;
}

// Squares.
void Evaluator::note_sizes(double place, double speed, double turn) {
  place_ = std::sqrt(place);
  speed_ = std::sqrt(speed);
  turn_ = std::sqrt(turn);
}

double Evaluator::rounding_of_positions() const {
  return std::max(rounding_of_places(), 2 * std::numeric_limits<double>::epsilon() * scaling_.length_m * angle_);
}

double Evaluator::rounding_of_places() const {
  return 2 * std::numeric_limits<double>::epsilon() * std::max({scaling_.length_m, place_, coordinate_size_});
}

// What it leaves in G v, m/s.
double Evaluator::rounding_of_velocities() const {
  const double turned = std::max(1.0, angle_);
  return 2 * std::numeric_limits<double>::epsilon() * turned * (speed_ + scaling_.length_m * turn_ + coordinate_speed_);
}

const VectorXd& Evaluator::resolve(const VectorXd& right) {
  solver_->resolve(no_force_, right, correction_);
  return correction_.vdot;
}

double Evaluator::settle(State& state, const VectorXd* offset) {
  normalize_quaternions(system(), state.q);
  angle_ = largest_angle(system(), state.q);
  bool natively = offset == nullptr && finds_programs() && ForwardProgram::reaches(state);
  double before = INFINITY, rate_before = INFINITY, gap = 0;
  for (int i = 0; i < 8; ++i) {
    natively = natively && evaluate_natively(state, *closure_program_, closure_board_, &closure_);
    if (!natively && evaluate(state) != ForwardStatus::kSolved) return INFINITY;  // the parts know some poses more
    gap = 0;
    double rate_gap = 0;
    const ConstraintKinematics& c = eq_.constraints;
    for (const int row : selection_.rows) {
      gap = std::max(gap, std::abs(c.phi[row] - (offset ? (*offset)[row] : 0)) * row_scale_[row]);
      rate_gap = std::max(rate_gap, std::abs(c.rate[row] - c.nu[row]) * row_scale_[row]);
    }
    if (!std::isfinite(gap) || !std::isfinite(rate_gap)) return INFINITY;
    const double slack = settles_stages_ ? 1 : std::max(1.0, close_enough_ / rounding_of_positions());
    const bool closed = gap <= slack * rounding_of_positions() || (i > 1 && gap > 0.5 * before);
    const bool calm = rate_gap <= slack * rounding_of_velocities() || (i > 1 && closed && rate_gap > 0.5 * rate_before);
    if (closed && calm) return offset != nullptr || laws_agree(state.t) ? gap : INFINITY;
    before = gap;
    rate_before = rate_gap;
    if (!calm) {
      residual_rhs_ = c.nu - c.rate;
      state.v += natively ? closure_.dv : resolve(residual_rhs_);
    }
    if (!closed) {
      residual_rhs_ = -c.phi;
      if (offset) residual_rhs_ += *offset;
      displace(system(), natively ? closure_.dq : resolve(residual_rhs_), state.q);
    }
  }
  return gap;
}

bool Evaluator::evaluate_stage(State& state) {
  if (!settles_stages_ && finds_programs() && ForwardProgram::reaches(state)) {
    if (evaluate_natively(state, *stage_program_, stage_board_, nullptr)) return true;
    return evaluate(state) == ForwardStatus::kSolved;  // the parts know some poses more
  }
  return settles_stages_ ? std::isfinite(settle(state)) : evaluate(state) == ForwardStatus::kSolved;
}

void Evaluator::keep_admissible(VectorXd& dv) {
  residual_rhs_.noalias() = -equations().constraints.G * dv;
  if (!has_factors_) return;  // where even native code hardly had them
  dv += resolve(residual_rhs_);
}

void Evaluator::restore_energy(const State& from, const Work& work, State& to) {
  if (!eq_.driven.empty() || system().knows_time) return;
  const auto energy_at = [&](const State& state) {
    compute_positions(system(), state.q, energy_pos_);
    compute_velocities(system(), energy_pos_, state.q, state.v, energy_vel_);
    return compute_energy(*model_, state, energy_pos_, energy_vel_);
  };
  const Energy before = energy_at(from), after = energy_at(to);
  const double wrong = after.kinetic + after.gravity - before.kinetic - before.gravity - work.drives - work.others;
  if (!(std::abs(wrong) < 1e-6 * after.kinetic)) return;
  to.v *= std::sqrt(1 - wrong / after.kinetic);
  evaluate(to);
}

Work Evaluator::power(const State& state) const {
  Work out;
  const bool formulas = model_->lagrangian.power_of_time || system().knows_time;
  if (!model_->has_forces && model_->nu() == 0 && !friction_.any() && !formulas) return out;
  for (int i = 0; i < model_->nu(); ++i) {
    if (eq_.u[i] != 0) out.drives += eq_.u[i] * eq_.B_transposed.row(i).dot(state.v);
  }
  out.others = (equations_stale_ ? state.v.dot(applied_) + other_power_ : state.v.dot(eq_.force + eq_.h)) - out.drives;
  if (model_->lagrangian.power_of_time) {
    out.others += compute_lagrangian_energy(*model_, state, eq_.pos, eq_.vel).power_of_time;
  }
  if (system().knows_time) out.others += result_.lambda.head(system().m).dot(eq_.constraints.nu.head(system().m));
  for (std::size_t i = 0; i < eq_.driven.size(); ++i) {
    const long row = system().m + static_cast<long>(i);
    out.drives += result_.lambda[row] * eq_.constraints.rate[row];
  }
  return out;
}

const VectorXd& Evaluator::efforts() {
  if (!implied_rows_.empty()) compute_idle_drives(system(), joint_selection_, implied_rows_, eq_);
  efforts_ = eq_.u;
  for (std::size_t i = 0; i < eq_.driven.size(); ++i) {
    efforts_[eq_.driven[i]] = result_.lambda[system().m + static_cast<long>(i)];
  }
  return efforts_;
}

bool Evaluator::is_worn() const { return pivot_known_ && is_worn_pivot(pivot_, healthy_pivot_); }

double Evaluator::left_out_residual() const {
  const ConstraintKinematics& c = eq_.constraints;
  double largest = row_scale_.size() > 0 ? c.phi.cwiseProduct(row_scale_).cwiseAbs().maxCoeff() : 0.0;
  // A row on velocities has no place to be off from: how far it is off on the way of one characteristic length.
  const double speed = speed_ + scaling_.length_m * turn_ + coordinate_speed_;
  for (const int row : system().velocity_rows) {
    const double off = std::abs(c.rate[row] - c.nu[row]) * row_scale_[row];
    if (off > 0) largest = std::max(largest, off * scaling_.length_m / std::max(speed, off));
  }
  return largest;
}

}  // namespace ferrers
