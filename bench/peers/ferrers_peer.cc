// Ferrers on a scene of bench/peers: `ferrers_peer scene.json SECONDS model=FILE [mode=forward|inverse|simulate]`.
//
// Forward dynamics with the multipliers of all closing rows that count, by the library's recommended formulation; the
// time to read the model file, to lay it out and decide, and to answer all questions of `analyze`.

#include <Eigen/Geometry>
#include <stdexcept>

#include "bench/peers/scene.h"
#include "ferrers/dynamics/forward_dynamics.h"
#include "ferrers/dynamics/tree_inverse.h"
#include "ferrers/io/model_reader.h"
#include "ferrers/redundancy/mechanism_analysis.h"
#include "ferrers/redundancy/selection.h"
#include "ferrers/simulate/simulation.h"

namespace {

using namespace ferrers;  // NOLINT(google-build-using-namespace): a program, not a header
using peers::json;

std::shared_ptr<const System> read_system(const std::string& path) {
  ModelReadResult read = read_model_file(path);
  if (!read.model) throw std::runtime_error("the model of " + path + " does not build");
  return make_system(std::move(*read.model));
}

Vector3d vector(const double (&from)[3]) { return {from[0], from[1], from[2]}; }

// The scene tells where the mass centre is; the coordinates are those of the node's frame in its joint's.
void set_free(const System& system, const Node& node, const peers::FreeBody& from, State& state) {
  const Matrix3d turn =
      Eigen::Quaterniond(from.quaternion[0], from.quaternion[1], from.quaternion[2], from.quaternion[3])
          .toRotationMatrix();
  const Vector3d com = vector(from.place), spin = vector(from.spin);
  const Vector3d drawn = system.model->body(node.body).com_m;
  const Pose X_WB{turn, com - turn * drawn}, X_WM = X_WB * node.X_BN;
  const Matrix3d to_F = node.X_PJ.R.transpose();
  const Eigen::Quaterniond relative(Matrix3d(to_F * X_WM.R));
  const Vector3d place = to_F * (X_WM.p - node.X_PJ.p);
  const Vector3d rate = to_F * (vector(from.velocity) + spin.cross(X_WM.p - com)), turning = to_F * spin;
  double* q = state.q.data() + node.q;
  double* v = state.v.data() + node.v;
  std::copy(place.data(), place.data() + 3, q);
  const double quaternion[] = {relative.w(), relative.x(), relative.y(), relative.z()};
  std::copy(quaternion, quaternion + 4, q + node.type->quaternion_at);
  std::copy(turning.data(), turning.data() + 3, v);
  std::copy(rate.data(), rate.data() + 3, v + 3);
}

/// Which joint of the scene moves each coordinate, -1 for those of free bodies.
std::vector<int> joints_of_coordinates(const System& system, const peers::Scene& scene) {
  std::vector<int> joints(static_cast<std::size_t>(system.nv), -1);
  for (int j = 0; j < static_cast<int>(scene.joints.size()); ++j) {
    const auto id = system.model->find_joint(scene.joints[static_cast<std::size_t>(j)].name);
    const CoordinateAccess access = system.access({*id, 0});
    if (access.in_tree) joints[static_cast<std::size_t>(access.v)] = j;
  }
  return joints;
}

State to_state(const System& system, const std::vector<int>& joints, const peers::State& from) {
  State state = make_drawn_state(system);
  for (std::size_t i = 1; i < system.nodes.size(); ++i) {
    const Node& node = system.nodes[i];
    if (node.type->quaternion_at >= 0) {
      for (const peers::FreeBody& body : from.free) set_free(system, node, body, state);
      continue;
    }
    const auto joint = static_cast<std::size_t>(joints[static_cast<std::size_t>(node.v)]);
    state.q[node.q] = from.q[joint];
    state.v[node.v] = from.v[joint];
  }
  PositionKinematics pos = make_position_kinematics(system);
  compute_positions(system, state.q, pos);
  accept_winding(system, pos, state);
  return state;
}

struct Loaded {
  std::shared_ptr<const System> system;
  std::shared_ptr<const DynamicsModel> dynamics;
  std::vector<int> joints;
  std::vector<State> states;
  json out;
};

Loaded load(const peers::Scene& scene, const std::string& model) {
  Loaded l;
  const double start = peers::cpu_seconds();
  l.system = read_system(model);
  l.dynamics = make_dynamics_model(l.system);
  l.out["load_s"] = peers::cpu_seconds() - start;
  l.joints = joints_of_coordinates(*l.system, scene);
  for (const peers::State& s : scene.states) l.states.push_back(to_state(*l.system, l.joints, s));
  return l;
}

Selection decide(const System& system, const State& state) {
  const ConstraintBlocks blocks = compute_constraint_blocks(system, state);
  return select_rows_and_coordinates(system, decide_clusters(system, system.scaling, blocks));
}

void measure_forward(const peers::Scene& scene, double seconds, Loaded& l) {
  const double start = peers::cpu_seconds();
  const Selection selection = decide(*l.system, l.states.front());
  l.out["decide_s"] = peers::cpu_seconds() - start;
  const double begin = peers::cpu_seconds();
  ForwardDynamics dynamics(l.dynamics, l.states.front());
  l.out["compile_s"] = peers::cpu_seconds() - begin;
  l.out["native"] = dynamics.is_native();
  const ForwardResult& result = dynamics.result();
  const auto evaluate = [&](std::size_t i) { dynamics.evaluate(l.states[i]); };
  peers::ErrorMeter error;
  for (std::size_t i = 0; i < l.states.size(); ++i) {
    evaluate(i);
    if (result.status != ForwardStatus::kSolved) throw std::runtime_error("not solved");
    error.begin();
    for (std::size_t k = 0; k < l.joints.size(); ++k) {
      if (l.joints[k] < 0) continue;
      error.add(result.vdot[static_cast<long>(k)], scene.states[i].a[static_cast<std::size_t>(l.joints[k])]);
    }
    error.end();
  }
  l.out["us"] = peers::least_microseconds(l.states.size(), seconds, evaluate);
  l.out["error"] = error.worst();
  l.out["rank"] = selection.rows.size();
}

// Of an open tree: the efforts that the accelerations need. The library forms M for it.
void measure_inverse(const peers::Scene& scene, double seconds, Loaded& l) {
  Equations equations = make_equations(*l.dynamics);
  VectorXd efforts(l.system->nv);
  std::vector<VectorXd> accelerations;
  const Selection none = decide(*l.system, l.states.front());
  const auto solver = make_forward_solver(recommended_formulation(), *l.system, none);
  ForwardResult result = make_forward_result(*l.system);
  for (const State& state : l.states) {
    compute_equations(*l.dynamics, state, equations);
    solver->solve(equations, result);
    accelerations.push_back(result.vdot);
  }
  TreeInverse inverse(l.dynamics);
  const auto evaluate = [&](std::size_t i) { efforts = inverse.evaluate(l.states[i], accelerations[i]); };
  double worst = 0;
  for (std::size_t i = 0; i < l.states.size(); ++i) {
    evaluate(i);
    worst = std::max(worst, efforts.lpNorm<Eigen::Infinity>() / equations.force.lpNorm<Eigen::Infinity>());
  }
  l.out["us"] = peers::least_microseconds(l.states.size(), seconds, evaluate);
  l.out["error"] = worst;  // the true efforts are zero
  l.out["states"] = scene.states.size();
}

void measure_analysis(Loaded& l) {
  const double start = peers::cpu_seconds();
  const MechanismAnalysis analysis = analyze_mechanism(*l.system);
  l.out["analyze_s"] = peers::cpu_seconds() - start;
  l.out["assembled"] = analysis.is_assembled();
}

struct Run {
  RunSummary summary;
  double cpu_s = 0, largest_kinetic = 0, final_angle = 0;
};

/// Where positions and velocities of the tree's coordinates stand in a row of results.
std::vector<std::pair<std::size_t, std::size_t>> columns_of_coordinates(const Loaded& l, const peers::Scene& scene) {
  const std::vector<std::string> names = run_columns(*l.dynamics);
  const auto column = [&](const std::string& name) {
    return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
  };
  std::vector<std::pair<std::size_t, std::size_t>> columns;
  for (const int joint : l.joints) {
    const peers::Joint& j = scene.joints.at(static_cast<std::size_t>(joint));
    const std::string name = j.name + (j.revolute ? ".angle" : ".displacement");
    columns.emplace_back(column(name), column(name + ".velocity"));
  }
  return columns;
}

Run run_once(const Loaded& l, const peers::Scene& scene, const SimulationOptions& options) {
  Run run;
  RunControl control;
  State last = make_drawn_state(*l.system);
  PositionKinematics pos = make_position_kinematics(*l.system);
  VelocityKinematics vel = make_velocity_kinematics(*l.system);
  const auto columns = columns_of_coordinates(l, scene);
  control.on_sample = [&](const RunSample& sample) {
    for (std::size_t k = 0; k < columns.size(); ++k) {
      last.q[static_cast<long>(k)] = sample.values.at(columns[k].first);
      last.v[static_cast<long>(k)] = sample.values.at(columns[k].second);
    }
    compute_positions(*l.system, last.q, pos);
    compute_velocities(*l.system, pos, last.q, last.v, vel);
    run.largest_kinetic = std::max(run.largest_kinetic, compute_energy(*l.dynamics, last, pos, vel).kinetic);
  };
  const double start = peers::cpu_seconds();
  run.summary = simulate(l.dynamics, options, control);
  run.cpu_s = peers::cpu_seconds() - start;
  const auto at = std::find(l.joints.begin(), l.joints.end(), scene.watched_joint());
  if (at != l.joints.end()) run.final_angle = last.q[at - l.joints.begin()];
  return run;
}

// step=S or tolerance=T, integrator=NAME, end=T, samples=N. The time is that of a run with one row, the drift of energy
// that of a run with many.
void measure_simulation(const peers::Scene& scene, int argc, char** argv, Loaded& l) {
  SimulationOptions options;
  const double end = std::stod(peers::setting(argc, argv, "end", "10"));
  const std::string step = peers::setting(argc, argv, "step", ""),
                    tolerance = peers::setting(argc, argv, "tolerance", "");
  if (!step.empty()) options.step = std::stod(step);
  if (!tolerance.empty()) options.tolerance = std::stod(tolerance);
  options.integrator = find_integrator(peers::setting(argc, argv, "integrator", "dormand-prince-8"));
  options.native_code = NativeCode::kAlways;  // made in the first run, which is not timed
  options.with_reactions = options.find_singular_poses = false;
  options.grid = {end, end / std::stod(peers::setting(argc, argv, "samples", "100"))};
  const Run sampled = run_once(l, scene, options);
  options.grid = {end, end};
  double least = std::numeric_limits<double>::infinity();
  const double start = peers::cpu_seconds();
  const double seconds = std::stod(argv[2]);
  Run run;
  do {
    run = run_once(l, scene, options);
    least = std::min(least, run.cpu_s);
  } while (peers::cpu_seconds() - start < seconds);
  const RunSummary& s = sampled.summary;
  const double work = s.work ? s.work->drives : 0;
  l.out["finished"] = s.status == RunStatus::kFinished && run.summary.status == RunStatus::kFinished;
  l.out["message"] = s.message;
  l.out["run_s"] = least;
  l.out["evaluations"] = run.summary.evaluations;
  l.out["angle"] = run.final_angle;
  l.out["kinetic_J"] = sampled.largest_kinetic;
  l.out["drift_J"] =
      work == 0 ? std::max(s.energy_max - s.energy_start, s.energy_start - s.energy_min) : std::abs(s.balance_error);
}

}  // namespace

int main(int argc, char** argv) try {
  const peers::Scene scene = peers::read_scene(argv[1]);
  const double seconds = std::stod(argv[2]);
  Loaded l = load(scene, peers::setting(argc, argv, "model", ""));
  const std::string mode = peers::setting(argc, argv, "mode", "forward");
  if (mode == "forward") measure_forward(scene, seconds, l);
  if (mode == "inverse") measure_inverse(scene, seconds, l);
  if (mode == "analyze") measure_analysis(l);
  if (mode == "simulate") measure_simulation(scene, argc, argv, l);
  peers::print(l.out);
  return 0;
} catch (const std::exception& problem) {
  peers::print({{"failed", problem.what()}});
  return 1;
}
