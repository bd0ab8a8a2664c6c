// MuJoCo on a scene of bench/peers: `mujoco_peer scene.json SECONDS model=FILE.xml [solver=newton|cg|pgs]
// [jacobian=dense|sparse|auto] [impedance=D] [timeconst=T]`.
//
// Joints that close loops are equality constraints, which MuJoCo keeps softly: the stiffest impedance that it takes is
// set. There is no warm start, since states repeat here; everything that a mechanism without contacts does not need is
// switched off in the model file.

#include <mujoco/mujoco.h>

#include <cstring>
#include <memory>
#include <stdexcept>

#include "bench/peers/scene.h"

namespace {

using peers::json;

struct Engine {
  mjModel* m = nullptr;
  mjData* d = nullptr;
  ~Engine() {
    mj_deleteData(d);
    mj_deleteModel(m);
  }
};

void set_options(const std::string& solver, const std::string& jacobian, double impedance, double timeconst,
                 mjModel* m) {
  m->opt.solver = solver == "cg" ? mjSOL_CG : solver == "pgs" ? mjSOL_PGS : mjSOL_NEWTON;
  m->opt.jacobian = jacobian == "dense" ? mjJAC_DENSE : jacobian == "sparse" ? mjJAC_SPARSE : mjJAC_AUTO;
  for (int i = 0; i < m->neq; ++i) {
    m->eq_solimp[mjNIMP * i] = m->eq_solimp[mjNIMP * i + 1] = impedance;
    m->eq_solref[mjNREF * i] = timeconst;
    m->eq_solref[mjNREF * i + 1] = 1;
  }
}

std::vector<int> joints_of_coordinates(const mjModel* m, const peers::Scene& scene) {
  std::vector<int> joints(static_cast<std::size_t>(m->nv), -1);
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    const int id = mj_name2id(m, mjOBJ_JOINT, scene.joints[j].name.c_str());
    if (id >= 0) joints[static_cast<std::size_t>(m->jnt_dofadr[id])] = static_cast<int>(j);
  }
  return joints;
}

struct FullState {
  std::vector<mjtNum> q, v;
};

FullState to_state(const mjModel* m, const std::vector<int>& joints, const peers::State& from) {
  FullState s{std::vector<mjtNum>(m->qpos0, m->qpos0 + m->nq), std::vector<mjtNum>(static_cast<std::size_t>(m->nv))};
  for (int id = 0; id < m->njnt; ++id) {
    const auto q = static_cast<std::size_t>(m->jnt_qposadr[id]), v = static_cast<std::size_t>(m->jnt_dofadr[id]);
    if (m->jnt_type[id] == mjJNT_FREE) {
      const peers::FreeBody& body = from.free.front();
      mju_copy3(&s.q[q], body.place);
      mju_copy4(&s.q[q + 3], body.quaternion);
      mju_copy3(&s.v[v], body.velocity);
      mjtNum turn[9];
      mju_quat2Mat(turn, body.quaternion);
      mju_mulMatTVec(&s.v[v + 3], turn, body.spin, 3, 3);
      continue;
    }
    s.q[q] = from.q[static_cast<std::size_t>(joints[v])];
    s.v[v] = from.v[static_cast<std::size_t>(joints[v])];
  }
  return s;
}

void copy(const std::vector<mjtNum>& from, mjtNum* to) { std::memcpy(to, from.data(), from.size() * sizeof(mjtNum)); }

void apply_torques(const peers::Scene& scene, const std::vector<int>& joints, mjData* d) {
  for (std::size_t k = 0; k < joints.size(); ++k) {
    if (joints[k] >= 0) d->qfrc_applied[k] = scene.joints[static_cast<std::size_t>(joints[k])].torque;
  }
}

void measure_forward(const peers::Scene& scene, double seconds, bool inverse, Engine& engine, json& out) {
  const mjModel* m = engine.m;
  mjData* d = engine.d;
  const std::vector<int> joints = joints_of_coordinates(m, scene);
  std::vector<FullState> states;
  for (const peers::State& s : scene.states) states.push_back(to_state(m, joints, s));
  apply_torques(scene, joints, d);
  const auto forward = [&](std::size_t i) {
    copy(states[i].q, d->qpos);
    copy(states[i].v, d->qvel);
    mj_forward(m, d);
  };
  std::vector<std::vector<mjtNum>> accelerations;
  peers::ErrorMeter error;
  for (std::size_t i = 0; i < states.size(); ++i) {
    forward(i);
    error.begin();
    for (std::size_t k = 0; k < joints.size(); ++k) {
      if (joints[k] >= 0) error.add(d->qacc[k], scene.states[i].a[static_cast<std::size_t>(joints[k])]);
    }
    error.end();
    accelerations.emplace_back(d->qacc, d->qacc + m->nv);
  }
  out["error"] = error.worst();
  out["rows"] = d->nefc;
  if (!inverse) {
    out["us"] = peers::least_microseconds(states.size(), seconds, forward);
    return;
  }
  // The recursive Newton-Euler pass alone, with the positions and velocities that it needs.
  std::vector<mjtNum> efforts(static_cast<std::size_t>(m->nv));
  out["us"] = peers::least_microseconds(states.size(), seconds, [&](std::size_t i) {
    copy(states[i].q, d->qpos);
    copy(states[i].v, d->qvel);
    copy(accelerations[i], d->qacc);
    mj_kinematics(m, d);
    mj_comPos(m, d);
    mj_comVel(m, d);
    mj_rne(m, d, 1, efforts.data());
  });
}

// step=S, integrator=rk4|euler|implicit|implicitfast, end=T: final angle, largest kinetic energy, drift of energy.
void measure_simulation(const peers::Scene& scene, double seconds, int argc, char** argv, Engine& engine, json& out) {
  mjModel* m = engine.m;
  mjData* d = engine.d;
  const double end = std::stod(peers::setting(argc, argv, "end", "10"));
  const double step = std::stod(peers::setting(argc, argv, "step", "0.001"));
  const std::string integrator = peers::setting(argc, argv, "integrator", "rk4");
  m->opt.integrator = integrator == "rk4" ? mjINT_RK4 : integrator == "euler" ? mjINT_EULER : mjINT_IMPLICIT;
#if mjVERSION_HEADER >= 300
  if (integrator == "implicitfast") m->opt.integrator = mjINT_IMPLICITFAST;
#endif
  m->opt.timestep = step;
  m->opt.disableflags &= ~mjDSBL_WARMSTART;
  const std::vector<int> joints = joints_of_coordinates(m, scene);
  const auto watched = std::find(joints.begin(), joints.end(), scene.watched_joint()) - joints.begin();
  const long steps = std::lround(end / step);
  const auto start = [&] {
    mj_resetData(m, d);
    apply_torques(scene, joints, d);
    for (std::size_t k = 0; k < joints.size(); ++k) {
      if (joints[k] >= 0) d->qvel[k] = scene.joints[static_cast<std::size_t>(joints[k])].start_speed;
    }
  };
  const auto mechanical = [&](double& kinetic) {
    mj_energyPos(m, d);
    mj_energyVel(m, d);
    kinetic = d->energy[1];
    double work = 0;
    for (std::size_t k = 0; k < joints.size(); ++k) work += d->qfrc_applied[k] * (d->qpos[k] - m->qpos0[k]);
    return d->energy[0] + d->energy[1] - work;
  };
  start();
  mj_forward(m, d);
  double kinetic = 0, largest = 0, drift = 0;
  const double first = mechanical(kinetic);
  const long every = std::max(1L, steps / 100);
  for (long i = 1; i <= steps; ++i) {
    mj_step(m, d);
    if (i % every) continue;
    mj_fwdPosition(m, d);
    drift = std::max(drift, std::abs(mechanical(kinetic) - first));
    largest = std::max(largest, kinetic);
  }
  double least = std::numeric_limits<double>::infinity();
  const double begun = peers::cpu_seconds();
  do {
    start();
    const double from = peers::cpu_seconds();
    for (long i = 0; i < steps; ++i) mj_step(m, d);
    least = std::min(least, peers::cpu_seconds() - from);
  } while (peers::cpu_seconds() - begun < seconds);
  out["finished"] = std::isfinite(d->qpos[watched]) && d->warning[mjWARN_BADQACC].number == 0;
  out["run_s"] = least;
  out["angle"] = d->qpos[watched];
  out["kinetic_J"] = largest;
  out["drift_J"] = drift;
}

}  // namespace

int main(int argc, char** argv) try {
  const peers::Scene scene = peers::read_scene(argv[1]);
  const double seconds = std::stod(argv[2]);
  json out;
  Engine engine;
  char problem[1000] = "";
  const double start = peers::cpu_seconds();
  engine.m = mj_loadXML(peers::setting(argc, argv, "model", "").c_str(), nullptr, problem, sizeof problem);
  if (!engine.m) throw std::runtime_error(problem);
  set_options(peers::setting(argc, argv, "solver", "newton"), peers::setting(argc, argv, "jacobian", "auto"),
              std::stod(peers::setting(argc, argv, "impedance", "0.9999")),
              std::stod(peers::setting(argc, argv, "timeconst", "0.02")), engine.m);
  engine.d = mj_makeData(engine.m);
  out["load_s"] = peers::cpu_seconds() - start;
  out["version"] = mj_versionString();
  const std::string mode = peers::setting(argc, argv, "mode", "forward");
  if (mode == "simulate") {
    measure_simulation(scene, seconds, argc, argv, engine, out);
  } else {
    measure_forward(scene, seconds, mode == "inverse", engine, out);
  }
  peers::print(out);
  return 0;
} catch (const std::exception& problem) {
  peers::print({{"failed", problem.what()}});
  return 1;
}
