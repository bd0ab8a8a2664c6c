#include "ferrers/dynamics/inverse.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <optional>

#include "ferrers/dynamics/free_motions.h"
#include "ferrers/dynamics/least_effort.h"
#include "ferrers/math/maximum.h"
#include "ferrers/redundancy/rank_notice.h"
#include "ferrers/redundancy/selection.h"

namespace ferrers {
namespace {

// Of the way to positions that are walked to: how small a first piece may be, so that the walk ends, and how small one
// may become where the mechanism does not follow.
constexpr double kLeastFirstPiece = 1e-7, kLeastPiece = 1e-5;

constexpr double kRollError = 1e-11;  // rad, m: per step along constraints on velocities

std::string quoted(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    text += (i == 0 ? "'" : i + 1 == names.size() ? " and '" : ", '") + names[i] + "'";
  }
  return text;
}

}  // namespace

struct PrescribedMotion::Impl {
  std::shared_ptr<const DynamicsModel> model;
  const System& system;
  Scaling scaling;
  Equations eq;
  Selection selection;
  FrictionSolver friction;
  std::vector<int> prescribed;  // drive components with a motion law
  std::vector<int> acting;      // drive components whose effort is sought: those, then helpers
  bool others_act = false;      // than those whose motion is prescribed
  std::vector<int> chosen;      // of `prescribed`: the laws followed; the others are watched
  PrescribedResult current;     // last instant solved
  bool started = false;
  bool rates_known = false;
  bool singular_here = false;  // at the last instant
  Selection reported;          // there: what is independent at that pose
  std::vector<std::string> notices;
  bool told_singular = false;     // whether a doubtful rank at a singular pose is among them
  std::vector<Law::Motion> laws;  // of `prescribed`, at the instant that is solved

  // Rows [G_r; D_chosen] of the square system; D, values and biases of all laws.
  RowMatrixXd D;
  VectorXd drive_scale, drive_value, drive_bias;
  MatrixXd A;
  Eigen::PartialPivLU<MatrixXd> lu;

  Impl(std::shared_ptr<const DynamicsModel> m, State start, const DistributionOptions& options)
      : model(std::move(m)),
        system(*model->system),
        scaling(system.scaling),
        eq(make_equations(*model)),
        friction(model, options) {
    for (int i = 0; i < model->nu(); ++i) {
      if (model->drives[i].motion) prescribed.push_back(i);
    }
    for (const int i : prescribed) {
      if (model->drives[i].acts) acting.push_back(i);
    }
    others_act = acting.size() != prescribed.size();
    for (int i = 0; i < model->nu(); ++i) {
      if (!model->drives[i].motion && model->drives[i].effort_is_sought()) acting.push_back(i);
    }
    const long k = static_cast<long>(prescribed.size());
    D = RowMatrixXd::Zero(k, system.nv);
    drive_value = drive_bias = VectorXd::Zero(k);
    drive_scale = VectorXd::Ones(k);
    for (long i = 0; i < k; ++i) {
      if (model->drives[prescribed[i]].rotary) drive_scale[i] = scaling.length_m;
    }
    current.state = std::move(start);
    current.vdot = VectorXd::Zero(system.nv);
    current.lambda = VectorXd::Zero(system.m);
    current.u = VectorXd::Zero(model->nu());
    current.effort_is_shared.assign(static_cast<std::size_t>(model->nu()), false);
    evaluate(current.state);
    RankDecision decision;
    selection = select_independent(system, scaling, eq.constraints, &decision);
    if (!decision.confident) notices.push_back(doubtful_rank_notice(current.state.t, decision));
    choose_laws();
    judge_start();
  }

  int kept_rows() const { return static_cast<int>(selection.rows.size()); }
  int watched() const { return static_cast<int>(prescribed.size() - chosen.size()); }

  // Constraints and drives at a state.
  void evaluate(const State& state) {
    compute_kinematics(*model, state, eq);
    D.setZero();
    for (std::size_t i = 0; i < prescribed.size(); ++i) {
      const DriveComponent& drive = model->drives[prescribed[i]];
      const Jet jet = measure_drive(*model, drive, state, eq.pos, eq.vel, eq.drive_work);
      drive_value[static_cast<long>(i)] = jet.value;
      drive_bias[static_cast<long>(i)] = jet.bias;
      add_drive_row(*model, drive, eq.pos, jet, eq.drive_work, D.row(static_cast<long>(i)));
    }
  }

  MatrixXd scaled_drive_rows() const { return drive_scale.asDiagonal() * D * scaling.columns.asDiagonal(); }

  // Admissible motions of the constraints alone, orthonormal in scaled units: nv × w.
  MatrixXd admissible_motions() const {
    const auto w = static_cast<long>(selection.independent.size());
    MatrixXd N = MatrixXd::Zero(system.nv, w);
    for (long k = 0; k < w; ++k) N(selection.independent[k], k) = 1;
    if (!selection.rows.empty()) {
      const MatrixXd G_i = eq.constraints.G(selection.rows, selection.independent);
      N(selection.dependent, Eigen::all) = -DependentBlock(selection, eq.constraints.G).solve(G_i);
    }
    const Eigen::HouseholderQR<MatrixXd> qr(scaling.columns.cwiseInverse().asDiagonal() * N);
    return qr.householderQ() * MatrixXd::Identity(system.nv, w);
  }

  // As many laws as there are motions, those that move them best. With as many laws as motions there is no choice.
  void choose_laws() {
    const int k = static_cast<int>(prescribed.size()), w = system.nv - kept_rows();
    if (k <= w) {
      chosen.resize(static_cast<std::size_t>(k));
      for (int i = 0; i < k; ++i) chosen[static_cast<std::size_t>(i)] = i;
      return;
    }
    chosen = choose_independent_rows(scaled_drive_rows() * admissible_motions(), w);
  }

  void factor() {
    const int r = kept_rows();
    A.resize(r + static_cast<long>(chosen.size()), system.nv);
    A.topRows(r) = eq.constraints.G.dense_rows(selection.rows);
    A.bottomRows(static_cast<long>(chosen.size())) = D(chosen, Eigen::all);
    lu.compute(A);
  }

  // One instant's positions: Newton from `state` towards the targets of the chosen laws, or of all of them, which keeps
  // its accuracy at poses where the chosen ones are singular.
  bool solve_positions(State& state, const VectorXd& target, bool by_all = false) {
    const int r = kept_rows();
    const std::vector<int> followed = by_all ? all_laws() : chosen;
    VectorXd residual(r + static_cast<long>(followed.size()));
    double before = INFINITY;
    for (int i = 0; i < 30; ++i) {
      evaluate(state);
      double size = 0;
      for (int k = 0; k < r; ++k) {
        const int row = selection.rows[k];
        residual[k] = eq.constraints.phi[row];
        size = max_keeping_nan(size, std::abs(residual[k]) * scaling.rows[row]);
      }
      for (std::size_t k = 0; k < followed.size(); ++k) {
        const double off = drive_value[followed[k]] - target[followed[k]];
        residual[r + static_cast<long>(k)] = off;
        size = max_keeping_nan(size, std::abs(off) * drive_scale[followed[k]]);
      }
      if (!std::isfinite(size)) return false;
      const bool settled = size <= closed_tolerance(scaling) && size > 0.1 * before;
      if (settled || size == 0) return all_rows_hold();
      before = size;
      VectorXd step = by_all ? solve_all_rows(-residual).x : newton_step(residual);
      const double length = largest_magnitude(step.cwiseQuotient(scaling.columns)) / scaling.length_m;
      if (!std::isfinite(length)) return false;
      if (length > 0.5) step *= 0.5 / length;
      displace(system, step, state.q);
    }
    return before <= closed_tolerance(scaling) && all_rows_hold();
  }

  VectorXd newton_step(const VectorXd& residual) {
    factor();
    return lu.solve(-residual);
  }

  std::vector<int> all_laws() const {
    std::vector<int> all(prescribed.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<int>(i);
    return all;
  }

  // [G_r; D] x = rhs with the rows of all laws, as well as can be; `residual` of the result is scaled.
  LeastNormResult solve_all_rows(const VectorXd& rhs) const {
    VectorXd scales(rhs.size());
    scales << scaling.rows(selection.rows), drive_scale;
    MatrixXd all(rhs.size(), system.nv);
    all << eq.constraints.G.dense_rows(selection.rows), D;
    LeastNormResult result =
        solve_least_norm(scales.asDiagonal() * all * scaling.columns.asDiagonal(), scales.cwiseProduct(rhs));
    result.x = scaling.columns.cwiseProduct(result.x);
    return result;
  }

  bool all_rows_hold() const {
    return largest_magnitude(eq.constraints.phi.cwiseProduct(scaling.rows)) <= 1e3 * closed_tolerance(scaling);
  }

  // Evaluates the laws; returns what is not finite, in words, or nothing.
  std::string read_laws(double t) {
    laws.clear();
    for (const int i : prescribed) {
      const DriveComponent& drive = model->drives[i];
      const Law::Motion& law = laws.emplace_back(drive.motion->motion(t));
      const char* what = !std::isfinite(law.value)          ? "value"
                         : !std::isfinite(law.rate)         ? "rate"
                         : !std::isfinite(law.acceleration) ? "acceleration"
                                                            : nullptr;
      if (what == nullptr) continue;
      return fmt::format("the motion of drive '{}' has no finite {} at t = {:.9g} s", drive.name, what, t);
    }
    return "";
  }

  VectorXd targets() const {
    VectorXd target(static_cast<long>(laws.size()));
    for (long i = 0; i < target.size(); ++i) target[i] = laws[static_cast<std::size_t>(i)].value;
    return target;
  }

  // How far the chosen laws go between two sets of targets, in rad or characteristic lengths.
  double distance(const VectorXd& a, const VectorXd& b) const {
    double most = 0;
    for (const int i : chosen) most = max_keeping_nan(most, std::abs(a[i] - b[i]) * drive_scale[i]);
    return most / scaling.length_m;
  }

  // Walks from where the mechanism is to `target`, in pieces small enough to stay on the branch. Where the laws chosen
  // get stuck and others are to be had, it goes on with them.
  bool walk(State& state, const VectorXd& target) {
    for (int attempt = 0; attempt <= watched(); ++attempt) {
      evaluate(state);
      if (watched() > 0) choose_laws();
      const std::vector<int> followed = chosen;
      if (walk_along_chosen(state, target)) return true;
      evaluate(state);
      choose_laws();
      if (chosen == followed) return false;
    }
    return false;
  }

  bool walk_along_chosen(State& state, const VectorXd& target) {
    const VectorXd from = drive_value;
    double done = 0, piece = 1 / std::max(1.0, std::ceil(distance(from, target) / 0.1));
    if (!(piece >= kLeastFirstPiece)) return false;  // as far away as that, or nowhere
    while (done < 1) {
      const double next = std::min(1.0, done + piece);
      State trial = state;
      if (solve_positions(trial, from + next * (target - from))) {
        accept_winding(system, eq.pos, trial);
        state = trial;
        done = next;
        refresh_selection();
        continue;
      }
      piece /= 4;
      if (piece < kLeastPiece) return false;
    }
    return true;
  }

  // The rows kept must stay well conditioned along the motion; their number does not change here.
  void refresh_selection() { selection = reselect(system, scaling, eq.constraints, selection); }

  bool solve_rates() {
    const int r = kept_rows();
    const auto k = static_cast<long>(prescribed.size());
    State& state = current.state;
    VectorXd rates(k), accelerations(k), gamma(r);
    for (long i = 0; i < k; ++i) {
      rates[i] = laws[static_cast<std::size_t>(i)].rate;
      accelerations[i] = laws[static_cast<std::size_t>(i)].acceleration;
    }
    state.v.setZero();
    evaluate(state);
    factor();
    singular_here = !is_regular();
    if (singular_here) report_singular_pose();
    if (!solve_rows(eq.constraints.nu(selection.rows), rates, 0, state.v)) return false;
    evaluate(state);
    const double turning = state.v.cwiseQuotient(scaling.columns).norm() / scaling.length_m;
    for (int i = 0; i < r; ++i) gamma[i] = eq.constraints.gamma[selection.rows[i]];
    return solve_rows(gamma, accelerations - drive_bias, turning * turning * scaling.length_m, current.vdot);
  }

  void report_singular_pose() {
    RankDecision decision;
    reported = select_independent(system, scaling, eq.constraints, &decision);
    if (decision.confident || told_singular) return;
    told_singular = true;
    notices.push_back(doubtful_rank_notice(current.state.t, decision));
  }

  // G_r x = top, D x = wanted, by the chosen laws. At a singular pose by all of them, the least solution in scaled
  // units, where the equations do not contradict each other: motions that are free there for an instant (an idle spin)
  // are taken to rest.
  // `size`: of what both sides were made of, scaled.
  bool solve_rows(const VectorXd& top, const VectorXd& wanted, double size, VectorXd& x) const {
    if (!singular_here) {
      VectorXd rhs(system.nv);
      rhs << top, wanted(chosen);
      x = lu.solve(rhs);
      return x.allFinite();
    }
    VectorXd rhs(top.size() + wanted.size()), scaled(rhs.size());
    rhs << top, wanted;
    scaled << scaling.rows(selection.rows).cwiseProduct(top), drive_scale.cwiseProduct(wanted);
    const LeastNormResult least = solve_all_rows(rhs);
    x = least.x;
    return is_negligible(least.residual, std::max({scaled.norm(), size, 1e-300}));
  }

  bool is_regular() const {
    const MatrixXd scaled = row_scales().asDiagonal() * A * scaling.columns.asDiagonal();
    return decide_rank(compute_singular_values(scaled), 1.0).rank == system.nv;
  }

  VectorXd row_scales() const {
    const int r = kept_rows();
    VectorXd scales(r + static_cast<long>(chosen.size()));
    for (int k = 0; k < r; ++k) scales[k] = scaling.rows[selection.rows[k]];
    for (std::size_t k = 0; k < chosen.size(); ++k) scales[r + static_cast<long>(k)] = drive_scale[chosen[k]];
    return scales;
  }

  // ---- laws that are given twice -----------------------------------------------------------------------------

  // A row left out whose rate does not follow from those kept: constraints on velocities, or constraints that move.
  std::string broken_rate(double t) const {
    if (system.velocity_rows.empty() && !system.knows_time) return "";
    const ConstraintKinematics& c = eq.constraints;
    for (int row = 0; row < system.m; ++row) {
      const double off = c.G.row(row).dot(current.state.v) - c.nu[row];
      const double size = c.G.row(row).cwiseAbs().dot(current.state.v.cwiseAbs()) + std::abs(c.nu[row]);
      // not a rank decision: whether a constraint holds
      if (std::abs(off) <= kLawAgreement[1] * size) continue;
      return fmt::format("the prescribed motions break the constraint '{}' at t = {:.9g} s: its rate is off by {:.3g}",
                         system.row_names[static_cast<std::size_t>(row)], t, std::abs(off));
    }
    return "";
  }

  // What laws ask for beside what they get; the first that differs is told.
  std::string contradiction(double t) const {
    if (watched() == 0) return "";
    const VectorXd rates = D * current.state.v, accelerations = D * current.vdot + drive_bias;
    const double rate = drive_scale.cwiseProduct(rates).cwiseAbs().maxCoeff();
    const double acceleration =
        std::max(drive_scale.cwiseProduct(accelerations).cwiseAbs().maxCoeff(), rate * rate / scaling.length_m);
    for (long i = 0; i < static_cast<long>(prescribed.size()); ++i) {
      const DriveComponent& drive = model->drives[prescribed[i]];
      const Law::Motion& law = laws[static_cast<std::size_t>(i)];
      const char* unit = drive.rotary ? "rad" : "m";
      // not a rank decision: whether given laws agree
      const auto differs = [&](double asked, double got, double size, double agreement) {
        return std::abs(asked - got) * drive_scale[i] > agreement * std::max(size, std::abs(asked) * drive_scale[i]);
      };
      const auto tell = [&](const char* what, double asked, double got, const char* per) {
        return fmt::format(
            "the prescribed motions {} contradict each other at t = {:.9g} s: '{}' asks for {} {:.9g} {}{}, the "
            "others make it {:.9g} {}{}, a difference of {:.3g} {}{}",
            quoted(partners(i)), t, drive.name, what, asked, unit, per, got, unit, per, std::abs(asked - got), unit,
            per);
      };
      if (differs(law.value, drive_value[i], scaling.length_m, kLawAgreement[0])) {
        return tell("the position", law.value, drive_value[i], "");
      }
      if (differs(law.rate, rates[i], rate, kLawAgreement[1])) return tell("the rate", law.rate, rates[i], "/s");
      if (differs(law.acceleration, accelerations[i], acceleration, kLawAgreement[2])) {
        return tell("the acceleration", law.acceleration, accelerations[i], "/s²");
      }
    }
    return "";
  }

  // Names of a law and of those that depend on it: what the left null space ties together.
  std::vector<std::string> partners(long law) const {
    const MatrixXd null = analyze_rank(scaled_drive_rows() * admissible_motions(), 1.0).left_null;
    const VectorXd ties = null * null.row(law).transpose();
    std::vector<std::string> names;
    for (long i = 0; i < ties.size(); ++i) {
      if (i == law || !is_negligible(ties[i], 1.0)) names.push_back(drive_name(static_cast<int>(i)));
    }
    return names;
  }
  const std::string& drive_name(int law) const { return model->drives[prescribed[law]].name; }

  // ---- what moves freely --------------------------------------------------------------------------------------

  void judge_start() {
    const int r = kept_rows();
    MatrixXd all(r + D.rows(), system.nv);
    const VectorXd row_scales = scaling.rows(selection.rows);
    all.topRows(r) =
        row_scales.asDiagonal() * eq.constraints.G.dense_rows(selection.rows) * scaling.columns.asDiagonal();
    all.bottomRows(D.rows()) = scaled_drive_rows();
    const RankAnalysis analysis = analyze_rank(all, 1.0);
    if (analysis.decision.rank == system.nv) return;
    current.status = PrescribedStatus::kUndriven;
    FreeMotions found = find_free_motions(system, scaling, current.state, eq.pos, eq.vel, analysis.right_null);
    current.to_drive = std::move(found.to_drive);
    current.message = std::move(found.message);
  }

  // ---- efforts --------------------------------------------------------------------------------------------------

  LeastEffort make_least_effort() const {
    const auto k = static_cast<long>(acting.size());
    LeastEffort::Rows rows;
    rows.G = eq.constraints.G.dense_rows(selection.rows);
    rows.G_scale = scaling.rows(selection.rows);
    rows.E = eq.B_transposed(acting, Eigen::all);
    rows.E_scale = rows.weights = VectorXd::Ones(k);
    for (long i = 0; i < k; ++i) {
      const DriveComponent& drive = model->drives[acting[i]];
      if (drive.rotary) rows.E_scale[i] = scaling.length_m;
      rows.weights[i] = drive.weight;
    }
    rows.columns = scaling.columns;
    // Drives that do not act along the prescribed motions may be any: what they can do is found by singular values.
    return LeastEffort(std::move(rows), singular_here || others_act ? std::vector<int>() : chosen);
  }

  // Multipliers and sought efforts in their places among all.
  bool solve_forces(const LeastEffort& least, const VectorXd& rhs, Eigen::Ref<VectorXd> lambda,
                    Eigen::Ref<VectorXd> u) const {
    VectorXd kept, efforts;
    if (!least.solve(rhs, kept, efforts)) return false;
    for (std::size_t k = 0; k < selection.rows.size(); ++k) lambda[selection.rows[k]] = kept[static_cast<long>(k)];
    for (std::size_t k = 0; k < acting.size(); ++k) u[acting[k]] = efforts[static_cast<long>(k)];
    return true;
  }

  PrescribedStatus solve_efforts(const Selection& reactions) {
    compute_mass_and_bias(*model, eq);
    compute_applied_forces(*model, current.state, eq);
    for (const int i : acting) eq.u[i] = 0;
    VectorXd rhs = eq.M * current.vdot + eq.h - eq.tau;
    rhs.noalias() -= eq.B_transposed.transpose() * eq.u;
    const LeastEffort least = make_least_effort();
    tell_idle(least);
    current.u = eq.u;
    current.lambda.setZero();
    if (!solve_forces(least, rhs, current.lambda, current.u)) return PrescribedStatus::kSingular;
    if (!friction.any()) return PrescribedStatus::kSolved;
    const MatrixXd C = friction.slip_rows(eq);
    const long nf = C.rows();
    MotionCases changes{MatrixXd::Zero(system.nv, nf), MatrixXd::Zero(system.m, nf), MatrixXd::Zero(model->nu(), nf)};
    for (long k = 0; k < nf; ++k) {
      if (!solve_forces(least, -C.row(k).transpose(), changes.lambda.col(k), changes.u.col(k))) {
        return PrescribedStatus::kSingular;
      }
    }
    const MotionCases base{current.vdot, current.lambda, current.u};
    const FrictionStatus status = friction.solve(current.state, eq, reactions, base, changes);
    if (status == FrictionStatus::kUndetermined) return PrescribedStatus::kUndeterminedFriction;
    if (status == FrictionStatus::kJammed) return PrescribedStatus::kJammed;
    rhs.noalias() -= C.transpose() * eq.friction;
    return solve_forces(least, rhs, current.lambda, current.u) ? PrescribedStatus::kSolved
                                                               : PrescribedStatus::kSingular;
  }

  void tell_idle(const LeastEffort& least) {
    const auto d = least.idle_efforts().cols();
    eq.idle_efforts = MatrixXd::Zero(model->nu(), d);
    eq.idle_lambda = MatrixXd::Zero(system.m, d);
    const std::vector<bool> shared = least.shared();
    for (std::size_t k = 0; k < acting.size(); ++k) {
      eq.idle_efforts.row(acting[k]) = least.idle_efforts().row(static_cast<long>(k));
      current.effort_is_shared[static_cast<std::size_t>(acting[k])] = shared[k];
    }
    for (std::size_t k = 0; k < selection.rows.size(); ++k) {
      eq.idle_lambda.row(selection.rows[k]) = least.idle_lambda().row(static_cast<long>(k));
    }
  }

  // ---- one instant ------------------------------------------------------------------------------------------------

  // Newton from a state near by; where laws are given twice first by all of them, then by those chosen, which may
  // contradict the others.
  bool settle_positions(State& state, const VectorXd& target) {
    State trial = state;
    bool settled = watched() > 0 && solve_positions(trial, target, true);
    if (!settled) {
      trial = state;
      settled = solve_positions(trial, target);
    }
    if (!settled) return false;
    accept_winding(system, eq.pos, trial);
    refresh_selection();
    state = trial;
    return true;
  }

  // Velocities that the laws and all constraints tell at positions of some time.
  bool rates_at(double t, const State& at, VectorXd& v) {
    State state = at;
    state.t = t;
    state.v.setZero();
    if (!read_laws(t).empty()) return false;
    evaluate(state);
    factor();
    VectorXd rates(static_cast<long>(prescribed.size()));
    for (std::size_t i = 0; i < prescribed.size(); ++i) rates[static_cast<long>(i)] = laws[i].rate;
    v = VectorXd::Zero(system.nv);
    singular_here = false;
    return solve_rows(eq.constraints.nu(selection.rows), rates, 0, v);
  }

  // One step of the classical fourth-order rule along these velocities.
  bool roll_step(State& state, double h) {
    VectorXd k[4];
    State stage = state;
    for (int i = 0; i < 4; ++i) {
      if (i > 0) {
        stage.q = state.q;
        displace(system, (i == 3 ? h : 0.5 * h) * k[i - 1], stage.q);
      }
      if (!rates_at(state.t + (i == 0 ? 0 : i == 3 ? h : 0.5 * h), stage, k[i])) return false;
    }
    displace(system, h / 6 * (k[0] + 2 * k[1] + 2 * k[2] + k[3]), state.q);
    state.t += h;
    return true;
  }

  // Constraints on velocities (rolling) leave positions to the way that was taken: integrates it from the last instant,
  // each step against two of half its length.
  bool roll(State& state, double t) {
    const double begin = state.t;
    double h = t - begin;
    while (state.t < t) {
      h = std::min(h, t - state.t);
      State whole = state, halves = state;
      if (!roll_step(whole, h) || !roll_step(halves, 0.5 * h) || !roll_step(halves, 0.5 * h)) return false;
      const VectorXd apart = halves.q - whole.q;
      const double error = largest_magnitude(apart) / std::max(1.0, scaling.length_m);
      if (!std::isfinite(error)) return false;
      if (error <= kRollError) {
        halves.q += apart / 15;
        normalize_quaternions(system, halves.q);
        halves.t = h == t - state.t ? t : state.t + h;
        state = halves;
      } else if (h < kLeastPiece * (t - begin)) {
        return false;
      }
      h *= std::clamp(0.9 * std::pow(kRollError / std::max(error, 1e-300), 0.2), 0.2, 4.0);
    }
    return true;
  }

  bool reach(double t) {
    State state = current.state;
    if (started && !system.velocity_rows.empty()) {  // the way counts
      if (!roll(state, t)) return false;
      read_laws(t);
    } else if (started && rates_known) {  // predict, then correct
      const double dt = t - state.t;
      const VectorXd step = dt * state.v + 0.5 * dt * dt * current.vdot;
      const double size = largest_magnitude(step.cwiseQuotient(scaling.columns)) / scaling.length_m;
      if (size < 0.3) displace(system, step, state.q);
    }
    if (watched() > 0) {
      evaluate(state);
      choose_laws();
    }
    const VectorXd target = targets();
    State walked = current.state;
    state.t = walked.t = t;
    if (!started || !settle_positions(state, target)) {
      if (!walk(walked, target)) return false;
      state = walked;
      if (watched() > 0) settle_positions(state, target);
    }
    state.t = t;
    current.state = state;
    started = true;
    return true;
  }

  const PrescribedResult& fail(PrescribedStatus status, std::string message) {
    current.status = status;
    current.message = std::move(message);
    return current;
  }

  const PrescribedResult& solve(double t, bool with_efforts) {
    if (current.status == PrescribedStatus::kUndriven) return current;
    if (std::string reason = read_laws(t); !reason.empty()) {
      return fail(PrescribedStatus::kUndefined, std::move(reason));
    }
    if (!reach(t)) {
      return fail(PrescribedStatus::kNotReached,
                  fmt::format("the prescribed positions cannot be reached at t = {:.9g} s", t));
    }
    rates_known = solve_rates();
    if (!rates_known) {
      return fail(PrescribedStatus::kSingular,
                  fmt::format("the driven mechanism is at a singular pose (a dead point) at t = {:.9g} s", t));
    }
    current.status = PrescribedStatus::kSolved;
    if (std::string broken = broken_rate(t); !broken.empty()) {
      return fail(PrescribedStatus::kContradictory, std::move(broken));
    }
    if (std::string clash = contradiction(t); !clash.empty()) {
      return fail(PrescribedStatus::kContradictory, std::move(clash));
    }
    if (!with_efforts) return current;
    current.status = solve_efforts(singular_here ? reported : selection);
    if (current.status == PrescribedStatus::kSingular) {
      current.message =
          singular_here
              ? fmt::format("no finite efforts hold the motion through the singular pose at t = {:.9g} s", t)
              : fmt::format("the drives that act cannot bring about the prescribed motions at t = {:.9g} s", t);
    } else if (current.status != PrescribedStatus::kSolved) {
      current.message = fmt::format("at t = {:.9g} s {}", t, friction.message());
    }
    return current;
  }
};

PrescribedMotion::PrescribedMotion(std::shared_ptr<const DynamicsModel> model, State start,
                                   const DistributionOptions& options)
    : impl_(std::make_unique<Impl>(std::move(model), std::move(start), options)) {}
PrescribedMotion::~PrescribedMotion() = default;
PrescribedMotion::PrescribedMotion(PrescribedMotion&&) noexcept = default;

PrescribedResult PrescribedMotion::check() const { return impl_->current; }

PrescribedResult PrescribedMotion::solve(double t, bool with_efforts) { return impl_->solve(t, with_efforts); }

const Equations& PrescribedMotion::equations() const { return impl_->eq; }
const std::vector<std::string>& PrescribedMotion::notices() const { return impl_->notices; }
const Selection& PrescribedMotion::selection() const {
  return impl_->singular_here ? impl_->reported : impl_->selection;
}

}  // namespace ferrers
