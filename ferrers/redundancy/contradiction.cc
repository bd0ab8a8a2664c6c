#include "ferrers/redundancy/contradiction.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "ferrers/kinematics/initial_values.h"
#include "ferrers/redundancy/best_fit.h"
#include "ferrers/redundancy/cluster_rank.h"

namespace ferrers {
namespace {

constexpr double kNearClosing = 0.25;  ///< Of L: a larger gap is none of a contradiction but of missing links.
constexpr double kStationary = 0.05;   ///< Largest slope of a best fit; coarse misclosures converge slowly.
constexpr double kWorthAFit = 1e-12;   ///< Of L: below, a residual is rounding.
constexpr std::size_t kMostNames = 6;

// A cluster with its fits.
struct OpenCluster {
  ClusterRows rows;
  BestFit alike, elastic;
  bool takes_up = false;  ///< Joints with stiffness close it.
};

VectorXd phi_at(const System& system, const State& state) { return compute_constraint_blocks(system, state).phi; }

double scaled_norm(const Scaling& scaling, const ClusterRows& cluster, const VectorXd& phi) {
  double sum = 0;
  for (const int row : cluster.rows) sum += std::pow(phi[row] * scaling.rows[row], 2);
  return std::sqrt(sum);
}

std::string quoted(const std::vector<JointGap>& joints) {
  std::string text;
  const std::size_t shown = std::min(joints.size(), kMostNames);
  for (std::size_t i = 0; i < shown; ++i) {
    const bool last = i + 1 == shown && shown == joints.size();
    text += (i == 0 ? "'" : last ? " and '" : ", '") + joints[i].joint + "'";
  }
  if (shown < joints.size()) text += fmt::format(" and {} more", joints.size() - shown);
  return text;
}

// The joints' loads in a self-stress that was found with equal compliance k = 1 N/m, L² N·m/rad: force and moment.
std::pair<double, double> load_of(const Vector6d& gap, double length) {
  return {gap.head<3>().norm(), gap.tail<3>().norm() * length * length};
}

// The joints' gaps in an elastic fit, without the trace that rigid components are given there.
std::vector<Vector6d> elastic_gaps(const System& system, double length, const BestFit& fit) {
  const JointSprings springs = make_joint_springs(system, DistributionBy::kJointStiffness, length);
  std::vector<Vector6d> gaps = fit.gaps;
  for (std::size_t j = 0; j < gaps.size(); ++j) {
    gaps[j] = (springs.compliance[j].array() > 0).select(gaps[j], Vector6d::Zero());
  }
  return gaps;
}

Contradiction describe(const System& system, const AllRows& rows, double length, const OpenCluster& cluster) {
  const BestFit& fit = cluster.alike;
  Contradiction out;
  out.residual_m = fit.residual;
  double force = 0, moment = 0;
  for (const Vector6d& gap : fit.gaps) {
    const auto [f, m] = load_of(gap, length);
    force = std::max(force, f);
    moment = std::max(moment, m);
  }
  const std::size_t joints = fit.gaps.size();
  double coupled = 0, coupled_scaled = 0;  // largest multiplier of couplings and constraints
  for (std::size_t c = joints; c < rows.first.size(); ++c) {
    const double stress = std::abs(fit.joint_stress[rows.first[c]]);
    coupled = std::max(coupled, stress);
    coupled_scaled = std::max(coupled_scaled, stress / rows.scale[rows.first[c]]);
  }
  const double of_joints = std::max(force, moment / length);
  out.has_joints = coupled == 0 || !is_negligible(of_joints, coupled_scaled);
  out.angular = out.has_joints && is_negligible(force, moment / length);
  const double unit = !out.has_joints ? coupled : out.angular ? moment : force;
  const double largest = std::max(of_joints, coupled_scaled);
  const auto is_loaded = [&](double load) {  // more than the rounding of phi can do
    return !is_negligible(load, largest) && std::abs(load) * fit.residual > kWorthAFit * length * largest;
  };
  if (unit > 0) {
    out.misclosure = fit.residual * fit.residual / unit;  // yᵀ phi = f
    out.self_stress = fit.joint_stress / unit;
  }
  const std::vector<Vector6d> gaps = cluster.takes_up ? elastic_gaps(system, length, cluster.elastic) : fit.gaps;
  for (std::size_t j = 0; j < gaps.size(); ++j) {
    const auto [f, m] = load_of(fit.gaps[j], length);
    if (!is_loaded(std::max(f, m / length))) continue;
    out.joints.push_back({system.model->joints()[j].name, gaps[j].head<3>().norm(), gaps[j].tail<3>().norm()});
  }
  for (std::size_t c = joints; c < rows.first.size(); ++c) {
    const double load = fit.joint_stress[rows.first[c]] / rows.scale[rows.first[c]];
    if (!is_loaded(load)) continue;
    out.joints.push_back({system.model->couplings()[c - joints].name, 0, 0});
  }
  return out;
}

// How far components without stiffness would have to give in an elastic fit, m.
double rigid_gap(const System& system, const AllRows& rows, const Scaling& scaling, const Compliance& compliance,
                 const BestFit& fit) {
  const JointSprings springs = make_joint_springs(system, DistributionBy::kJointStiffness, scaling.length_m);
  double sum = 0;
  for (std::size_t j = 0; j < fit.gaps.size(); ++j) {
    for (int k = 0; k < 6; ++k) {
      if (springs.compliance[j][k] > 0) continue;
      sum += std::pow(fit.gaps[j][k] * (k < 3 ? 1 : scaling.length_m), 2);
    }
  }
  for (std::size_t c = fit.gaps.size(); c < rows.first.size(); ++c) {
    sum += std::pow(compliance.couplings * fit.joint_stress[rows.first[c]] / rows.scale[rows.first[c]], 2);
  }
  return std::sqrt(sum);
}

// Largest distance of a joint's place from where its body was drawn, and largest turn of a body.
LargestMove measure_moves(const System& system, const State& state) {
  LargestMove out;
  const Model& model = *system.model;
  PositionKinematics pos = make_position_kinematics(system);
  compute_positions(system, state.q, pos);
  const auto move = [&](BodyId id, const Vector3d& place) {
    const Pose now = body_pose(system, pos, id), drawn = model.body(id).X_WB;
    const double distance = (now * place - drawn * place).norm();
    const double angle = Eigen::AngleAxisd(Matrix3d(now.R * drawn.R.transpose())).angle();
    if (distance > out.distance_m) out.distance_m = distance, out.body = model.body(id).name;
    if (angle > out.angle_rad) out.angle_rad = angle, out.turned_body = model.body(id).name;
  };
  for (const Joint& joint : model.joints()) {
    move(joint.first, joint.X_1F.p);
    move(joint.second, joint.X_2M.p);
  }
  return out;
}

std::string reading_if_closed(const ContradictionReport& report) {
  return fmt::format("mobility {} and {} redundant constraints", report.mobility_if_closed, report.redundant_if_closed);
}

void write_text(ContradictionReport& report) {
  if (report.contradictions.empty() || (report.verdict == ClosureVerdict::kCloses && report.confident)) return;
  const Contradiction& worst = report.contradictions.front();
  const std::string size = !worst.has_joints ? fmt::format("{:.3g}", worst.misclosure)
                           : worst.angular   ? angle_text(worst.misclosure)
                                             : length_text(worst.misclosure);
  std::string others;
  if (report.contradictions.size() > 1) {
    const std::size_t more = report.contradictions.size() - 1;
    others = fmt::format(", {} more {} too", more, more == 1 ? "loop does" : "loops do");
  }
  const std::string joints =
      (worst.has_joints ? "the loop through joints " : "the constraints ") + quoted(worst.joints);
  const char* misses = worst.has_joints ? "misses closing by" : "miss each other by";
  const char* subject = worst.has_joints ? "the geometry contradicts itself" : "the constraints contradict each other";
  if (report.verdict == ClosureVerdict::kElastic) {
    report.text = fmt::format("{} {} {}{}; the joints' stiffness takes it up", joints, misses, size, others);
    return;
  }
  if (report.verdict == ClosureVerdict::kCloses) {
    report.text = fmt::format("{} {} {}{}: taken as rounding, {} {}; taken as meant, {}", joints,
                              worst.has_joints ? "closes but for" : "agree but for", size, others,
                              worst.has_joints ? "it has" : "there is", reading_if_closed(report), subject);
  } else if (report.confident) {
    report.text = fmt::format("{}: {} {} {} in the best pose{}", subject, joints, misses, size, others);
    if (report.if_closed.confident) report.text += "; if it closed it would have " + reading_if_closed(report);
  } else {
    report.text =
        fmt::format("{}, or its numbers are rounded: {} {} {} in the best pose{}; closed exactly it would have {}",
                    subject, joints, misses, size, others, reading_if_closed(report));
  }
  if (!worst.has_joints) {
    report.hint = "let them agree, or leave one of them out";
    return;
  }
  report.hint = report.confident ? "make the dimensions round the loop agree, or free one of these joints"
                                 : "give the dimensions with more digits, or compute them from parameters";
  report.hint += report.stiffness_in_vain
                     ? "; the joints' 'stiffness' does not help: none is in the way of the misclosure"
                     : "; joints with 'stiffness' would take it up";
}

void set_reading_if_closed(const System& system, const Scaling& scaling, ContradictionReport& report) {
  report.if_closed =
      decide_clusters(system, scaling, compute_constraint_blocks(system, report.state), report.blur).decision;
  report.mobility_if_closed = system.nv - report.if_closed.rank;
  report.redundant_if_closed = system.m - report.if_closed.rank;
}

// What stays of phi when every open cluster is fitted as well as it can be, from `state` on, all joints giving alike.
// False where that is no small misclosure at a best fit.
bool fit_open_clusters(const System& system, const Scaling& scaling, std::vector<OpenCluster>& open, State& state,
                       ContradictionReport& report) {
  const double length = scaling.length_m;
  const Compliance alike = equal_compliance(system, length);
  double squares = 0;
  bool near = true;
  for (ClusterRows& cluster : cluster_rows(system, read_initial_values(system).held)) {
    const double residual = scaled_norm(scaling, cluster, report.misfit);
    if (residual <= kWorthAFit * length) {
      squares += residual * residual;
      continue;
    }
    OpenCluster& one = open.emplace_back();
    one.rows = std::move(cluster);
    one.alike = find_best_fit(system, scaling, one.rows, alike, state);
    state = one.alike.state;
    squares += std::pow(one.alike.residual, 2);
    near = near && one.alike.slope <= kStationary && one.alike.residual <= kNearClosing * length;
  }
  report.residual_m = std::sqrt(squares);
  report.blur = report.residual_m / length;
  return near;
}

// Fits with the joints' own stiffness; true when every cluster is taken up by it.
bool assemble_elastically(const System& system, const Scaling& scaling, const AllRows& rows,
                          std::vector<OpenCluster>& open, State& state, bool& any) {
  const Compliance compliance = model_compliance(system, scaling.length_m, any);
  if (!any) return false;
  State trial = state;
  for (OpenCluster& cluster : open) {
    cluster.elastic = find_best_fit(system, scaling, cluster.rows, compliance, trial);
    trial = cluster.elastic.state;
    cluster.takes_up = rigid_gap(system, rows, scaling, compliance, cluster.elastic) <= closed_tolerance(scaling);
  }
  if (!std::all_of(open.begin(), open.end(), [](const OpenCluster& c) { return c.takes_up; })) {
    for (OpenCluster& cluster : open) cluster.takes_up = false;
    return false;
  }
  state = trial;
  return true;
}

}  // namespace

std::string_view to_string(ClosureVerdict verdict) {
  switch (verdict) {
    case ClosureVerdict::kCloses:
      return "closes";
    case ClosureVerdict::kElastic:
      return "elastic";
    case ClosureVerdict::kContradictory:
      return "contradictory";
    case ClosureVerdict::kNotFound:
      break;
  }
  return "not_found";
}

std::string length_text(double length_m) {
  const double size = std::abs(length_m);
  if (size >= 1) return fmt::format("{:.3g} m", length_m);
  if (size >= 1e-3) return fmt::format("{:.3g} mm", 1e3 * length_m);
  if (size >= 1e-6 || size == 0) return fmt::format("{:.3g} µm", 1e6 * length_m);
  return fmt::format("{:.3g} nm", 1e9 * length_m);
}

std::string angle_text(double angle_rad) {
  const double size = std::abs(angle_rad);
  if (size >= 1) return fmt::format("{:.3g} rad", angle_rad);
  if (size >= 1e-3) return fmt::format("{:.3g} mrad", 1e3 * angle_rad);
  if (size >= 1e-6 || size == 0) return fmt::format("{:.3g} µrad", 1e6 * angle_rad);
  return fmt::format("{:.3g} nrad", 1e9 * angle_rad);
}

ContradictionReport analyze_contradiction(const System& system, const AssemblyResult& assembly) {
  ContradictionReport report;
  const Scaling& scaling = system.scaling;
  const double length = scaling.length_m;
  report.state = assembly.state;
  report.misfit = phi_at(system, assembly.state);
  report.moved = measure_moves(system, assembly.state);
  const bool assembled = assembly.status == AssemblyStatus::kAssembled;
  const auto not_found = [&] {
    report.verdict = ClosureVerdict::kNotFound;
    report.text = assembly.message;
    return report;
  };
  if (assembly.status == AssemblyStatus::kInconsistentInitial) return not_found();

  std::vector<OpenCluster> open;
  State state = assembly.state;
  const bool near = fit_open_clusters(system, scaling, open, state, report);
  if (!assembled && !near) return not_found();
  report.confident = judge_misclosure(report.blur) != Misclosure::kDoubtful;
  if (assembled && report.confident) return report;
  if (!assembled && judge_misclosure(report.blur) == Misclosure::kNone) return not_found();

  const AllRows rows = make_all_rows(system, scaling);
  bool any_stiffness = false;
  if (!assembled) {
    report.verdict = assemble_elastically(system, scaling, rows, open, state, any_stiffness)
                         ? ClosureVerdict::kElastic
                         : ClosureVerdict::kContradictory;
    report.stiffness_in_vain = report.verdict == ClosureVerdict::kContradictory && any_stiffness;
    report.state = state;
    report.state.v.setZero();
    report.misfit = phi_at(system, state);
    report.moved = measure_moves(system, state);
  }
  for (const OpenCluster& cluster : open) {
    if (cluster.alike.residual <= kWorthAFit * length) continue;
    report.contradictions.push_back(describe(system, rows, length, cluster));
  }
  std::stable_sort(report.contradictions.begin(), report.contradictions.end(),
                   [](const Contradiction& a, const Contradiction& b) { return a.residual_m > b.residual_m; });
  set_reading_if_closed(system, scaling, report);
  write_text(report);
  return report;
}

}  // namespace ferrers
