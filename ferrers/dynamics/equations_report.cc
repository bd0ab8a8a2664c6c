#include "ferrers/dynamics/equations_report.h"

#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "ferrers/core/checks.h"
#include "ferrers/redundancy/rank_notice.h"
#include "ferrers/redundancy/selection.h"

namespace ferrers {
namespace {

bool is_angular(CoordinateKind kind) { return kind == CoordinateKind::kAngle || kind == CoordinateKind::kRotationRate; }

// Coordinates are named alike in q and v, but where a rotation in space is a quaternion.
std::vector<std::string> name_positions(const System& system) {
  std::vector<std::string> names;
  int q = 0, v = 0;
  for (const Node& node : system.nodes) {
    q = std::max(q, node.q + node.nq);
    v = std::max(v, node.v + node.nv);
  }
  names.assign(static_cast<std::size_t>(system.nq), "");
  for (std::size_t i = 1; i < system.nodes.size(); ++i) {
    const Node& node = system.nodes[i];
    for (int k = 0; k < node.nq; ++k) {
      std::string& name = names[static_cast<std::size_t>(node.q + k)];
      const std::string& rate = system.coordinate_names[static_cast<std::size_t>(node.v + std::min(k, node.nv - 1))];
      name =
          node.nq == node.nv ? rate : rate.substr(0, rate.rfind('.') + 1) + std::string(node.type->position_names[k]);
    }
  }
  for (; q < system.nq; ++q, ++v)
    names[static_cast<std::size_t>(q)] = system.coordinate_names[static_cast<std::size_t>(v)];
  return names;
}

std::vector<std::string> coordinate_units(const System& system) {
  std::vector<std::string> units(static_cast<std::size_t>(system.nv));
  for (const Node& node : system.nodes) {
    for (int k = 0; k < node.nv; ++k) {
      const auto v = static_cast<std::size_t>(node.v + k);
      if (node.type == &kOtherCoordinate) {
        const std::optional<JointId> coordinate = system.model->find_joint(system.coordinate_names[v]);
        if (coordinate) units[v] = to_string(system.model->joint(*coordinate).dimension);
      } else {
        units[v] = is_angular(node.type->coordinates[k].kind) ? "rad" : "m";
      }
    }
  }
  return units;
}

std::vector<std::string> row_units(const System& system) {
  std::vector<std::string> units(static_cast<std::size_t>(system.m));
  for (const CutJoint& cut : system.cuts) {
    for (int i = 0; i < cut.type->row_count(); ++i) {
      units[static_cast<std::size_t>(cut.row + i)] = cut.type->row_components[i] >= 3 ? "rad" : "m";
    }
  }
  return units;
}

// The largest |value| · scale of a group beside the largest sum of its terms.
class Gauge {
 public:
  Gauge(int equation, const char* unit) { out_.equation = equation, out_.unit = unit; }
  void see(double value, double size, double scale, const std::string& name) {
    const double magnitude = std::abs(value) * scale;
    const bool known = !std::isnan(out_.largest);  // what is no number stays
    if (known && !(magnitude <= out_.largest)) out_.largest = magnitude, out_.at = name;
    out_.size = std::max(out_.size, size * scale);
  }
  EquationResidual result() const { return out_; }

 private:
  EquationResidual out_;
};

EquationResidual measure_positions_residual(const System& system, const Scaling& scaling, const VectorXd& phi) {
  Gauge gauge(6, "m");
  for (int i = 0; i < system.m; ++i) {
    gauge.see(phi[i], 0, scaling.rows[i], system.row_names[static_cast<std::size_t>(i)]);
  }
  EquationResidual out = gauge.result();
  out.size = scaling.length_m;
  return out;
}

// G x = wanted.
EquationResidual measure_rows(const System& system, const Scaling& scaling, const PatternMatrix& G, const VectorXd& x,
                              const VectorXd& wanted, int equation, const char* unit) {
  Gauge gauge(equation, unit);
  for (int i = 0; i < system.m; ++i) {
    const double size = G.row(i).cwiseAbs().dot(x.cwiseAbs().transpose()) + std::abs(wanted[i]);
    gauge.see(G.row(i).dot(x) - wanted[i], size, scaling.rows[i], system.row_names[static_cast<std::size_t>(i)]);
  }
  return gauge.result();
}

EquationResidual measure_motion(const System& system, const Scaling& scaling, const Equations& eq, const VectorXd& vdot,
                                const VectorXd& lambda, const VectorXd& u) {
  const auto G = eq.constraints.G.topRows(system.m);
  const VectorXd left = eq.M * vdot + eq.h, right = eq.tau + eq.B_transposed.transpose() * u + G.transpose() * lambda;
  const VectorXd size = eq.M.cwiseAbs() * vdot.cwiseAbs() + eq.h.cwiseAbs() + eq.tau.cwiseAbs() +
                        eq.B_transposed.cwiseAbs().transpose() * u.cwiseAbs() +
                        G.cwiseAbs().transpose() * lambda.cwiseAbs();
  Gauge gauge(9, "N");
  for (int j = 0; j < system.nv; ++j) {
    gauge.see(left[j] - right[j], size[j], scaling.columns[j], system.coordinate_names[static_cast<std::size_t>(j)]);
  }
  return gauge.result();
}

void describe(const DynamicsModel& model, EquationsReport& report) {
  const System& system = *model.system;
  report.n = system.nv;
  report.m = system.m;
  report.position_names = name_positions(system);
  report.coordinate_names = system.coordinate_names;
  report.row_names = system.row_names;
  report.coordinate_units = coordinate_units(system);
  report.row_units = row_units(system);
  report.u = VectorXd::Zero(model.nu());
  report.effort_is_found.assign(static_cast<std::size_t>(model.nu()), false);
  report.effort_is_shared = report.effort_is_found;
}

void decide(const System& system, const State& state, EquationsReport& report) {
  const RedundancyReport redundancy = analyze_redundancy(system, state);
  report.selection = redundancy.selection;
  report.decision = redundancy.decision;
  report.exact_values = redundancy.exact_values;
  report.characteristic_length_m = redundancy.characteristic_length_m;
  report.r = static_cast<int>(report.selection.rows.size());
  report.w = static_cast<int>(report.selection.independent.size());
  report.excluded_rows = report.selection.excluded_rows(system.m);
  if (std::string doubt = doubtful_rank_notice(state.t, report.decision); !doubt.empty()) {
    report.notices.push_back(std::move(doubt));
  }
}

EquationsStatus equations_status(ForwardStatus status) {
  if (status == ForwardStatus::kSolved) return EquationsStatus::kSolved;
  return status == ForwardStatus::kSingularMass ? EquationsStatus::kSingularMass : EquationsStatus::kSingular;
}

EquationsStatus equations_status(PrescribedStatus status) {
  switch (status) {
    case PrescribedStatus::kSolved:
      return EquationsStatus::kSolved;
    case PrescribedStatus::kUndriven:
    case PrescribedStatus::kContradictory:
    case PrescribedStatus::kUndefined:
      return EquationsStatus::kBadMotion;
    case PrescribedStatus::kNotReached:
      return EquationsStatus::kNotReached;
    case PrescribedStatus::kUndeterminedFriction:
      return EquationsStatus::kUndeterminedFriction;
    case PrescribedStatus::kJammed:
      return EquationsStatus::kJammed;
    case PrescribedStatus::kSingular:
      break;
  }
  return EquationsStatus::kSingular;
}

void solve_forward(const std::shared_ptr<const DynamicsModel>& model, EquationsReport& report) {
  Equations& eq = report.equations;
  eq = make_equations(*model);
  compute_equations(*model, report.state, eq);
  report.has_equations = true;
  const auto solver = make_null_space_solver(*model->system, report.selection);
  ForwardResult result = make_forward_result(eq);
  solver->solve(eq, result);
  report.status = equations_status(result.status);
  if (report.status == EquationsStatus::kSingularMass) {
    report.message = "the mass matrix is singular on the motions that the joints leave: some motion has no inertia";
  } else if (report.status == EquationsStatus::kSingular) {
    report.message = "the chosen rows have no finite solution at this pose";
  }
  FrictionSolver friction(model);
  if (report.solved() && friction.any()) {
    const FrictionStatus status = friction.solve(report.state, eq, report.selection, *solver, result);
    if (status != FrictionStatus::kSolved) {
      report.status =
          status == FrictionStatus::kJammed ? EquationsStatus::kJammed : EquationsStatus::kUndeterminedFriction;
      report.message = friction.message();
    }
  }
  report.vdot = std::move(result.vdot);
  report.lambda_of_kept_rows = std::move(result.lambda);
  report.u = eq.u;
}

void solve_inverse(const std::shared_ptr<const DynamicsModel>& model, EquationsReport& report) {
  PrescribedMotion motion(model, report.state);
  PrescribedResult result = motion.check();
  if (result.status == PrescribedStatus::kSolved) result = motion.solve(report.state.t);
  report.status = equations_status(result.status);
  report.message = std::move(result.message);
  if (report.status == EquationsStatus::kBadMotion || report.status == EquationsStatus::kNotReached) return;
  // The equations are evaluated anew: where the solution failed not all of them were.
  Equations& eq = report.equations;
  report.state = result.state;
  eq = make_equations(*model);
  compute_equations(*model, report.state, eq);
  report.has_equations = true;
  if (report.solved()) {
    eq.tau = motion.equations().tau;  // with dry friction
    eq.friction = motion.equations().friction;
  }
  eq.idle_efforts = motion.equations().idle_efforts;
  eq.idle_lambda = motion.equations().idle_lambda;
  report.vdot = std::move(result.vdot);
  report.u = std::move(result.u);
  report.effort_is_shared = std::move(result.effort_is_shared);
  for (std::size_t i = 0; i < model->drives.size(); ++i)
    report.effort_is_found[i] = model->drives[i].effort_is_sought();
  eq.u = report.u;
  eq.force = eq.tau + eq.B_transposed.transpose() * eq.u - eq.h;
}

// G_dᵀ lambda_r = (M vdot − force)_d: what the rows kept here carry of a motion that is known with its efforts.
VectorXd multipliers_of(const Equations& eq, const Selection& s, const VectorXd& vdot, int m) {
  VectorXd lambda = VectorXd::Zero(m);
  if (s.rows.empty()) return lambda;
  const VectorXd carried = eq.M * vdot - eq.force;
  const VectorXd kept = DependentBlock(s, eq.constraints.G).solve_transposed(VectorXd(carried(s.dependent)));
  lambda(s.rows) = kept;
  return lambda;
}

// Rows left out follow from the others only as long as the redundancy lasts.
void judge_residuals(EquationsReport& report) {
  constexpr double kHolds = 1e-6;  // relative; not a rank decision: when to point the reader to a residual
  for (const EquationResidual& one : report.residuals) {
    if (one.relative() <= kHolds) continue;
    report.notices.push_back(fmt::format(
        "({}) does not hold at '{}': it is off by {:.3g} {}. Where that is a row left out, the rank is that of this "
        "pose only, and no motion goes on from it",
        one.equation, one.at, one.largest, one.unit));
  }
}

}  // namespace

std::vector<ReactionStatus> judge_multipliers(const DynamicsModel& model, const Equations& eq,
                                              const Selection& selection) {
  const System& system = *model.system;
  const Scaling& scaling = system.scaling;
  std::vector<ReactionStatus> out(static_cast<std::size_t>(system.m), ReactionStatus::kUnique);
  // Idle efforts are of unit size, their multipliers in proportion (dynamics/least_effort.h).
  for (int i = 0; i < system.m && eq.idle_lambda.cols() > 0; ++i) {
    if (is_negligible(eq.idle_lambda.row(i).norm() / scaling.rows[i], 1.0)) continue;
    out[static_cast<std::size_t>(i)] = ReactionStatus::kDistributed;
  }
  const MatrixXd Z = self_stresses_of_selection(system, selection, eq.constraints.G);
  if (Z.cols() == 0) return out;
  const Eigen::HouseholderQR<MatrixXd> qr(scaling.rows.cwiseInverse().asDiagonal() * Z);
  const MatrixXd basis = qr.householderQ() * MatrixXd::Identity(Z.rows(), Z.cols());
  for (int i = 0; i < system.m; ++i) {
    if (is_negligible(basis.row(i).norm(), 1.0)) continue;
    out[static_cast<std::size_t>(i)] = ReactionStatus::kUndetermined;
  }
  return out;
}

std::vector<EquationResidual> measure_residuals(const DynamicsModel& model, const Equations& eq, const VectorXd& v,
                                                const VectorXd& vdot, const VectorXd& lambda, const VectorXd& u) {
  const System& system = *model.system;
  require_size(v.size(), system.nv, "measure_residuals: v");
  const Scaling& scaling = system.scaling;
  const ConstraintKinematics& c = eq.constraints;
  std::vector<EquationResidual> out = {measure_positions_residual(system, scaling, c.phi),
                                       measure_rows(system, scaling, c.G, v, c.nu, 7, "m/s")};
  if (vdot.size() == 0 && lambda.size() == 0 && system.nv > 0) return out;
  require_size(vdot.size(), system.nv, "measure_residuals: vdot");
  require_size(lambda.size(), system.m, "measure_residuals: lambda");
  require_size(u.size(), model.nu(), "measure_residuals: u");
  out.push_back(measure_rows(system, scaling, c.G, vdot, c.gamma, 8, "m/s²"));
  out.push_back(measure_motion(system, scaling, eq, vdot, lambda, u));
  return out;
}

EquationsReport analyze_equations(const std::shared_ptr<const DynamicsModel>& model, const State& state,
                                  EquationsProblem problem) {
  require(model != nullptr, "analyze_equations: no model");
  const System& system = *model->system;
  require_size(state.q.size(), system.nq, "analyze_equations: q");
  require_size(state.v.size(), system.nv, "analyze_equations: v");
  EquationsReport report;
  report.problem = problem;
  report.state = state;
  describe(*model, report);
  if (problem == EquationsProblem::kInverse) {
    solve_inverse(model, report);
    decide(system, report.state, report);
    if (!report.has_equations) return report;
    if (report.solved()) {
      report.lambda_of_kept_rows = multipliers_of(report.equations, report.selection, report.vdot, system.m);
    }
  } else {
    decide(system, state, report);
    solve_forward(model, report);
  }
  const Equations& eq = report.equations;
  report.lambda_status = judge_multipliers(*model, eq, report.selection);
  if (!report.solved()) {
    report.vdot = report.lambda_of_kept_rows = VectorXd();
    report.residuals = measure_residuals(*model, eq, report.state.v, {}, {}, {});
    judge_residuals(report);
    return report;
  }
  report.residuals = measure_residuals(*model, eq, report.state.v, report.vdot, report.lambda_of_kept_rows, report.u);
  judge_residuals(report);
  return report;
}

}  // namespace ferrers
