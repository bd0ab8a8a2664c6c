// Pinocchio on a scene of bench/peers: `pinocchio_peer scene.json SECONDS
// [algorithm=cholesky|lcaba|aba-local|aba-world] [points=1|2] [mu=M] [iterations=N] [frame=local|world] [swap=0|1]
// [mode=forward|inverse|simulate]`.
//
// Joints that close loops are rigid constraints that hold `points` points of the axis together, solved by proximal
// iterations: through the factors of the whole system's matrix (`cholesky`) or recursively, with a cost that grows with
// the loops (`lcaba`). Every hinge turns about the z axis of a frame of its own, the kind for which the library has
// code without a general axis.

#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/constrained-dynamics.hpp>
#include <pinocchio/algorithm/energy.hpp>
#include <pinocchio/algorithm/joint-configuration.hpp>
#include <pinocchio/algorithm/rnea.hpp>
#include <pinocchio/config.hpp>
#include <stdexcept>

#if __has_include(<pinocchio/algorithm/loop-constrained-aba.hpp>)
#include <pinocchio/algorithm/loop-constrained-aba.hpp>
#define PEERS_HAS_RECURSION 1
#endif

#include "bench/peers/scene.h"

namespace {

namespace pin = pinocchio;
using Eigen::Matrix3d, Eigen::Vector3d, Eigen::VectorXd;
using peers::json;

#if PINOCCHIO_MAJOR_VERSION >= 4
auto& stabilization(pin::RigidConstraintModel& model) { return model.m_baumgarte_parameters; }
#else
auto& stabilization(pin::RigidConstraintModel& model) { return model.corrector; }
#endif

void set_gain(double& gain, double value) { gain = value; }
template <class Vector>
void set_gain(Vector& gain, double value) {
  gain.setConstant(value);
}

Vector3d vector(const double (&from)[3]) { return {from[0], from[1], from[2]}; }

/// A turn that brings z to the axis.
Matrix3d frame_along(const Vector3d& axis) {
  return Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), axis).toRotationMatrix();
}

/// A spring between ground and a body that hangs on ground by a hinge: its torque follows from the hinge's angle.
struct HingeSpring {
  int v = 0;
  Vector3d axis, hinge, on_ground, arm;
  double stiffness = 0, free_length = 0;

  Vector3d point(double angle) const { return hinge + Eigen::AngleAxisd(angle, axis) * arm; }
  double torque(double angle) const {
    const Vector3d at = point(angle), along = on_ground - at;
    const double length = along.norm();
    return axis.dot((at - hinge).cross(along)) * stiffness * (length - free_length) / length;
  }
  double energy(double angle) const {
    const double stretch = (point(angle) - on_ground).norm() - free_length;
    return stiffness * stretch * stretch / 2;
  }
};

struct Engine {
  pin::Model model;
  std::unique_ptr<pin::Data> data;
  std::vector<pin::RigidConstraintModel> constraints;
  std::vector<pin::RigidConstraintData> constraint_data;
  std::vector<int> joints;  ///< Of the scene, per velocity coordinate; -1: of a free body.
  std::vector<HingeSpring> springs;
  VectorXd constant_tau, tau;
  pin::ProximalSettings settings{1e-14, 1e-10, 2};
  std::string algorithm;

  void forward(const VectorXd& q, const VectorXd& v) {
    tau = constant_tau;
    for (const HingeSpring& s : springs) tau[s.v] += s.torque(q[s.v]);
    if (algorithm == "aba-local") {
      pin::aba(model, *data, q, v, tau, pin::Convention::LOCAL);
    } else if (algorithm == "aba-world") {
      pin::aba(model, *data, q, v, tau, pin::Convention::WORLD);
#ifdef PEERS_HAS_RECURSION
    } else if (algorithm == "lcaba") {
      pin::lcaba(model, *data, q, v, tau, constraints, constraint_data, settings);
#endif
    } else {
      pin::constraintDynamics(model, *data, q, v, tau, constraints, constraint_data, settings);
    }
  }
};

void add_bodies(const peers::Scene& scene, Engine& e, std::vector<pin::JointIndex>& ids,
                std::vector<pin::SE3>& placed) {
  ids.assign(scene.bodies.size(), 0);
  placed.assign(scene.bodies.size(), pin::SE3::Identity());  // of the joints' frames as drawn
  for (const auto& [body, joint] : scene.tree) {
    const peers::Body& b = scene.bodies[static_cast<std::size_t>(body)];
    pin::SE3 here = pin::SE3::Identity(), before = pin::SE3::Identity();
    pin::JointIndex parent = 0;
    pin::JointModel kind;
    if (joint < 0) {
      here.translation() = vector(b.com);
      kind = pin::JointModelFreeFlyer();
    } else {
      const peers::Joint& j = scene.joints[static_cast<std::size_t>(joint)];
      const int other = j.a == body ? j.b : j.a;
      if (other != peers::kGround) {
        parent = ids[static_cast<std::size_t>(other)];
        before = placed[static_cast<std::size_t>(other)];
      }
      here = pin::SE3(frame_along(j.b == body ? vector(j.axis) : Vector3d(-vector(j.axis))), vector(j.at));
      kind = j.revolute ? pin::JointModel(pin::JointModelRZ()) : pin::JointModel(pin::JointModelPZ());
    }
    const pin::JointIndex id = e.model.addJoint(parent, kind, before.actInv(here), b.name);
    const Matrix3d inertia = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(b.inertia);
    const pin::Inertia in_world(b.mass, vector(b.com), inertia);
    e.model.appendBodyToJoint(id, here.actInv(in_world), pin::SE3::Identity());
    ids[static_cast<std::size_t>(body)] = id;
    placed[static_cast<std::size_t>(body)] = here;
    e.joints.insert(e.joints.end(), joint < 0 ? 6 : 1, joint);
  }
}

void add_springs(const peers::Scene& scene, const std::vector<pin::JointIndex>& ids, Engine& e) {
  for (const peers::Spring& s : scene.springs) {
    const auto id = ids.at(static_cast<std::size_t>(s.b));
    const int v = e.model.joints[id].idx_v();
    const peers::Joint& j = scene.joints[static_cast<std::size_t>(e.joints[static_cast<std::size_t>(v)])];
    if (s.a != peers::kGround || e.model.parents[id] != 0) throw std::runtime_error("a spring between moving bodies");
    const Vector3d axis = j.a == peers::kGround ? vector(j.axis) : Vector3d(-vector(j.axis));
    e.springs.push_back(
        {v, axis, vector(j.at), vector(s.on_a), vector(s.on_b) - vector(j.at), s.stiffness, s.free_length});
  }
}

struct Closing {
  int points = 2;
  double gain = 0;  ///< Baumgarte's, 1/s.
  pin::ReferenceFrame frame = pin::LOCAL;
  bool swapped = false;
};

std::unique_ptr<Engine> build(const peers::Scene& scene, const Closing& closing) {
  auto e = std::make_unique<Engine>();
  e->model.gravity.linear() = vector(scene.gravity);
  std::vector<pin::JointIndex> ids;
  std::vector<pin::SE3> placed;
  add_bodies(scene, *e, ids, placed);
  add_springs(scene, ids, *e);
  const auto side = [&](int body, const Vector3d& at) {
    const auto b = static_cast<std::size_t>(body);
    if (body == peers::kGround) return std::pair(pin::JointIndex(0), pin::SE3(Matrix3d::Identity(), at));
    return std::pair(ids[b], placed[b].actInv(pin::SE3(Matrix3d::Identity(), at)));
  };
  for (const int cut : scene.cut) {
    const peers::Joint& j = scene.joints[static_cast<std::size_t>(cut)];
    if (!j.revolute) throw std::runtime_error("a prismatic joint that closes a loop");
    for (int k = 0; k < closing.points; ++k) {
      const Vector3d at = vector(j.at) + (closing.points == 1 ? 0 : k - 0.5) * vector(j.axis);
      const auto [id_1, place_1] = side(closing.swapped ? j.b : j.a, at);
      const auto [id_2, place_2] = side(closing.swapped ? j.a : j.b, at);
      e->constraints.emplace_back(pin::CONTACT_3D, e->model, id_1, place_1, id_2, place_2, closing.frame);
      set_gain(stabilization(e->constraints.back()).Kp, closing.gain * closing.gain);
      set_gain(stabilization(e->constraints.back()).Kd, 2 * closing.gain);
    }
  }
  e->data = std::make_unique<pin::Data>(e->model);
  for (const auto& constraint : e->constraints) e->constraint_data.emplace_back(constraint);
  e->constant_tau = VectorXd::Zero(e->model.nv);
  for (std::size_t k = 0; k < e->joints.size(); ++k) {
    if (e->joints[k] >= 0)
      e->constant_tau[static_cast<long>(k)] = scene.joints[static_cast<std::size_t>(e->joints[k])].torque;
  }
  return e;
}

void prepare(Engine& e) {
#ifdef PEERS_HAS_RECURSION
  if (e.algorithm == "lcaba") pin::computeJointMinimalOrdering(e.model, *e.data, e.constraints);
#else
  if (e.algorithm == "lcaba") throw std::runtime_error("this version has no lcaba");
#endif
#if PINOCCHIO_MAJOR_VERSION >= 4
  if (e.algorithm == "cholesky") pin::initConstraintDynamics(e.model, *e.data, e.constraints, e.constraint_data);
#else
  if (e.algorithm == "cholesky") pin::initConstraintDynamics(e.model, *e.data, e.constraints);
#endif
}

struct FullState {
  VectorXd q, v, a;
};

FullState to_state(const Engine& e, const peers::State& from) {
  FullState s{pin::neutral(e.model), VectorXd::Zero(e.model.nv), VectorXd::Zero(e.model.nv)};
  for (pin::JointIndex id = 1; id < static_cast<pin::JointIndex>(e.model.njoints); ++id) {
    const int q = e.model.joints[id].idx_q(), v = e.model.joints[id].idx_v();
    const int joint = e.joints[static_cast<std::size_t>(v)];
    if (joint >= 0) {
      s.q[q] = from.q[static_cast<std::size_t>(joint)];
      s.v[v] = from.v[static_cast<std::size_t>(joint)];
      continue;
    }
    const peers::FreeBody& body = from.free.front();
    const Eigen::Quaterniond turn(body.quaternion[0], body.quaternion[1], body.quaternion[2], body.quaternion[3]);
    s.q.segment<3>(q) = vector(body.place);
    s.q.segment<4>(q + 3) = turn.coeffs();
    s.v.segment<3>(v) = turn.inverse() * vector(body.velocity);
    s.v.segment<3>(v + 3) = turn.inverse() * vector(body.spin);
  }
  return s;
}

void measure(const peers::Scene& scene, double seconds, bool inverse, Engine& e, json& out) {
  prepare(e);
  std::vector<FullState> states;
  for (const peers::State& s : scene.states) states.push_back(to_state(e, s));
  peers::ErrorMeter error;
  for (std::size_t i = 0; i < states.size(); ++i) {
    e.forward(states[i].q, states[i].v);
    states[i].a = e.data->ddq;
    error.begin();
    for (std::size_t k = 0; k < e.joints.size(); ++k) {
      if (e.joints[k] >= 0)
        error.add(states[i].a[static_cast<long>(k)], scene.states[i].a[static_cast<std::size_t>(e.joints[k])]);
    }
    error.end();
  }
  out["error"] = error.worst();
  if (inverse) {
    out["us"] = peers::least_microseconds(states.size(), seconds, [&](std::size_t i) {
      pin::rnea(e.model, *e.data, states[i].q, states[i].v, states[i].a);
    });
  } else {
    out["us"] =
        peers::least_microseconds(states.size(), seconds, [&](std::size_t i) { e.forward(states[i].q, states[i].v); });
  }
}

/// Dormand and Prince's pair of order 5, by hand: fixed steps (tolerance 0) or steps that keep the local error.
class Stepper {
 public:
  explicit Stepper(Engine& engine) : e_(engine) {}
  long evaluations = 0;

  /// From the engine's state y = (q, v) to `end`; `step`: the first one, or all. False where it does not get there.
  bool run(VectorXd& y, double end, double step, double tolerance) {
    double t = 0;
    derive(y, k_[0]);
    while (t < end * (1 - 1e-12)) {
      const double h = std::min(step, end - t);
      const double error = try_step(y, h);
      if (!std::isfinite(error) || evaluations > 4000000) return false;
      if (tolerance == 0 || error <= tolerance) {
        t += h;
        y = next_;
        std::swap(k_[0], k_[6]);
      }
      if (tolerance > 0) step = h * std::clamp(0.9 * std::pow(tolerance / std::max(error, 1e-300), 0.2), 0.2, 5.0);
      if (step < 1e-9 * end) return false;
    }
    return true;
  }

 private:
  void derive(const VectorXd& y, VectorXd& k) {
    const long n = y.size() / 2;
    q_ = y.head(n);
    v_ = y.tail(n);
    e_.forward(q_, v_);
    k.resize(2 * n);
    k.head(n) = v_;
    k.tail(n) = e_.data->ddq;
    ++evaluations;
  }

  double try_step(const VectorXd& y, double h) {
    auto& k = k_;
    derive(y + h * (1. / 5 * k[0]), k[1]);
    derive(y + h * (3. / 40 * k[0] + 9. / 40 * k[1]), k[2]);
    derive(y + h * (44. / 45 * k[0] - 56. / 15 * k[1] + 32. / 9 * k[2]), k[3]);
    derive(y + h * (19372. / 6561 * k[0] - 25360. / 2187 * k[1] + 64448. / 6561 * k[2] - 212. / 729 * k[3]), k[4]);
    derive(y + h * (9017. / 3168 * k[0] - 355. / 33 * k[1] + 46732. / 5247 * k[2] + 49. / 176 * k[3] -
                    5103. / 18656 * k[4]),
           k[5]);
    next_ = y + h * (35. / 384 * k[0] + 500. / 1113 * k[2] + 125. / 192 * k[3] - 2187. / 6784 * k[4] + 11. / 84 * k[5]);
    derive(next_, k[6]);
    return (h * (71. / 57600 * k[0] - 71. / 16695 * k[2] + 71. / 1920 * k[3] - 17253. / 339200 * k[4] +
                 22. / 525 * k[5] - 1. / 40 * k[6]))
        .lpNorm<Eigen::Infinity>();
  }

  Engine& e_;
  VectorXd k_[7], next_, q_, v_;
};

// step=S (fixed) or tolerance=T, gain=G (Baumgarte's, 1/s), end=T.
void measure_simulation(const peers::Scene& scene, double seconds, int argc, char** argv, Engine& e, json& out) {
  prepare(e);
  const double end = std::stod(peers::setting(argc, argv, "end", "10"));
  const double tolerance = std::stod(peers::setting(argc, argv, "tolerance", "0"));
  const double step =
      std::stod(peers::setting(argc, argv, "step", tolerance > 0 ? std::to_string(end / 1000) : "0.01"));
  const long n = e.model.nv;
  VectorXd start = VectorXd::Zero(2 * n);
  for (long k = 0; k < n; ++k)
    start[n + k] = scene.joints[static_cast<std::size_t>(e.joints[static_cast<std::size_t>(k)])].start_speed;
  const auto mechanical = [&](const VectorXd& y, double& kinetic) {
    const VectorXd q = y.head(n), v = y.tail(n);
    kinetic = pin::computeKineticEnergy(e.model, *e.data, q, v);
    double total = kinetic + pin::computePotentialEnergy(e.model, *e.data, q) - e.constant_tau.dot(q);
    for (const HingeSpring& s : e.springs) total += s.energy(q[s.v]);
    return total;
  };
  Stepper stepper(e);
  VectorXd y = start;
  double kinetic = 0, largest = 0, drift = 0;
  const double first = mechanical(y, kinetic);
  constexpr int kSamples = 100;
  bool finished = true;
  for (int i = 1; i <= kSamples && finished; ++i) {
    finished = stepper.run(y, end / kSamples, step, tolerance);
    drift = std::max(drift, std::abs(mechanical(y, kinetic) - first));
    largest = std::max(largest, kinetic);
  }
  double least = std::numeric_limits<double>::infinity();
  const double begun = peers::cpu_seconds();
  do {
    y = start;
    stepper.evaluations = 0;
    const double from = peers::cpu_seconds();
    finished = stepper.run(y, end, step, tolerance) && finished;
    least = std::min(least, peers::cpu_seconds() - from);
  } while (finished && peers::cpu_seconds() - begun < seconds);
  const auto watched = std::find(e.joints.begin(), e.joints.end(), scene.watched_joint()) - e.joints.begin();
  out["finished"] = finished;
  out["run_s"] = least;
  out["evaluations"] = stepper.evaluations;
  out["angle"] = y[watched];
  out["kinetic_J"] = largest;
  out["drift_J"] = drift;
}

}  // namespace

int main(int argc, char** argv) try {
  const peers::Scene scene = peers::read_scene(argv[1]);
  const double seconds = std::stod(argv[2]);
  json out;
  const double start = peers::cpu_seconds();
  Closing closing;
  closing.points = std::stoi(peers::setting(argc, argv, "points", "2"));
  closing.gain = std::stod(peers::setting(argc, argv, "gain", "0"));
  closing.frame = peers::setting(argc, argv, "frame", "local") == "local" ? pin::LOCAL : pin::LOCAL_WORLD_ALIGNED;
  closing.swapped = peers::setting(argc, argv, "swap", "0") == "1";
  const auto engine = build(scene, closing);
  out["load_s"] = peers::cpu_seconds() - start;
  out["version"] = PINOCCHIO_VERSION;
  engine->algorithm = peers::setting(argc, argv, "algorithm", scene.cut.empty() ? "aba-local" : "cholesky");
  engine->settings = pin::ProximalSettings(1e-14, std::stod(peers::setting(argc, argv, "mu", "1e-10")),
                                           std::stoi(peers::setting(argc, argv, "iterations", "2")));
  const std::string mode = peers::setting(argc, argv, "mode", "forward");
  if (mode == "simulate") {
    measure_simulation(scene, seconds, argc, argv, *engine, out);
  } else {
    measure(scene, seconds, mode == "inverse", *engine, out);
  }
  peers::print(out);
  return 0;
} catch (const std::exception& problem) {
  peers::print({{"failed", problem.what()}});
  return 1;
}
