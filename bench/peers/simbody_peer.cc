// Simbody on a scene of bench/peers: `simbody_peer scene.json SECONDS [mode=forward|simulate]`.
//
// Mobilized bodies along the tree; a joint that closes a loop is a ball, and two angles between its axis and others
// across it: five rows, as drawn. The library solves them by least squares at every evaluation, whatever their rank.

#include <Simbody.h>

#include <stdexcept>

#include "bench/peers/scene.h"

namespace {

using namespace SimTK;  // NOLINT(google-build-using-namespace): a program, not a header
using peers::json;

Vec3 vector(const double (&from)[3]) { return {from[0], from[1], from[2]}; }

/// A frame at a joint whose z axis, or x axis for slides, is the joint's.
Transform frame_at(const peers::Joint& joint, double sign) {
  return {Rotation(UnitVec3(sign * vector(joint.axis)), joint.revolute ? CoordinateAxis(ZAxis) : CoordinateAxis(XAxis)),
          vector(joint.at)};
}

struct Engine {
  MultibodySystem system;
  SimbodyMatterSubsystem matter{system};
  GeneralForceSubsystem forces{system};
  std::vector<MobilizedBody> bodies;
  std::vector<int> joints;  ///< Of the scene, per mobility in the state; -1: of a free body.
};

/// Every body's frame has the drawing's axes, and the point of its joint (its mass centre if it floats) as origin.
void add_bodies(const peers::Scene& scene, Engine& e, std::vector<Vec3>& origins) {
  e.bodies.resize(scene.bodies.size());
  origins.assign(scene.bodies.size(), Vec3(0));
  for (const auto& [body, joint] : scene.tree) {
    const auto i = static_cast<std::size_t>(body);
    const peers::Body& b = scene.bodies[i];
    const Vec3 origin = joint < 0 ? vector(b.com) : vector(scene.joints[static_cast<std::size_t>(joint)].at);
    const Vec3 com = vector(b.com) - origin;
    const Inertia central(SymMat33(b.inertia[0], b.inertia[1], b.inertia[4], b.inertia[2], b.inertia[5], b.inertia[8]));
    const Body::Rigid rigid(MassProperties(b.mass, com, central.shiftFromMassCenter(com, b.mass)));
    origins[i] = origin;
    if (joint < 0) {
      e.bodies[i] = MobilizedBody::Free(e.matter.Ground(), Transform(origin), rigid, Transform());
      continue;
    }
    const peers::Joint& j = scene.joints[static_cast<std::size_t>(joint)];
    const int other = j.a == body ? j.b : j.a;
    const double sign = j.b == body ? 1 : -1;
    MobilizedBody& parent = other == peers::kGround ? e.matter.updGround() : e.bodies[static_cast<std::size_t>(other)];
    const Vec3 before = other == peers::kGround ? Vec3(0) : origins[static_cast<std::size_t>(other)];
    const Transform drawn = frame_at(j, sign);
    const Transform inboard(drawn.R(), drawn.p() - before), outboard(drawn.R(), Vec3(0));
    if (j.revolute) {
      e.bodies[i] = MobilizedBody::Pin(parent, inboard, rigid, outboard);
    } else {
      e.bodies[i] = MobilizedBody::Slider(parent, inboard, rigid, outboard);
    }
    if (j.torque != 0) Force::MobilityConstantForce(e.forces, e.bodies[i], 0, j.torque);
  }
}

std::unique_ptr<Engine> build(const peers::Scene& scene) {
  auto e = std::make_unique<Engine>();
  Force::UniformGravity(e->forces, e->matter, vector(scene.gravity));
  std::vector<Vec3> origins;
  add_bodies(scene, *e, origins);
  const auto side = [&](int body) -> MobilizedBody& {
    return body == peers::kGround ? e->matter.updGround() : e->bodies[static_cast<std::size_t>(body)];
  };
  const auto local = [&](int body, const Vec3& at) {
    return body == peers::kGround ? at : at - origins[static_cast<std::size_t>(body)];
  };
  for (const int cut : scene.cut) {
    const peers::Joint& j = scene.joints[static_cast<std::size_t>(cut)];
    if (!j.revolute) throw std::runtime_error("a prismatic joint that closes a loop");
    const Rotation R = frame_at(j, 1).R();
    Constraint::Ball(side(j.a), local(j.a, vector(j.at)), side(j.b), local(j.b, vector(j.at)));
    Constraint::ConstantAngle(side(j.a), R.x(), side(j.b), R.z());
    Constraint::ConstantAngle(side(j.a), R.y(), side(j.b), R.z());
  }
  for (const peers::Spring& s : scene.springs) {
    Force::TwoPointLinearSpring(e->forces, side(s.a), local(s.a, vector(s.on_a)), side(s.b), local(s.b, vector(s.on_b)),
                                s.stiffness, s.free_length);
  }
  return e;
}

void name_coordinates(const peers::Scene& scene, const SimTK::State& state, Engine& e) {
  e.joints.assign(static_cast<std::size_t>(state.getNU()), -1);
  for (const auto& [body, joint] : scene.tree) {
    if (joint < 0) continue;
    const MobilizedBody& mobile = e.bodies[static_cast<std::size_t>(body)];
    e.joints[static_cast<std::size_t>(static_cast<int>(mobile.getFirstUIndex(state)))] = joint;
  }
}

void set_state(const peers::Scene& scene, const Engine& e, const peers::State& from, SimTK::State& state) {
  for (const auto& [body, joint] : scene.tree) {
    const MobilizedBody& mobile = e.bodies[static_cast<std::size_t>(body)];
    if (joint >= 0) {
      mobile.setOneQ(state, 0, from.q[static_cast<std::size_t>(joint)]);
      mobile.setOneU(state, 0, from.v[static_cast<std::size_t>(joint)]);
      continue;
    }
    const peers::FreeBody& f = from.free.front();
    const Rotation turn(Quaternion(f.quaternion[0], f.quaternion[1], f.quaternion[2], f.quaternion[3]));
    const Vec3 drawn = vector(scene.bodies[static_cast<std::size_t>(body)].com);
    mobile.setQToFitTransform(state, Transform(turn, vector(f.place) - drawn));
    mobile.setUToFitVelocity(state, SpatialVec(vector(f.spin), vector(f.velocity)));
  }
}

void measure_forward(const peers::Scene& scene, double seconds, Engine& e, SimTK::State& state, json& out) {
  std::vector<std::pair<Vector, Vector>> states;
  peers::ErrorMeter error;
  for (const peers::State& s : scene.states) {
    set_state(scene, e, s, state);
    states.emplace_back(state.getQ(), state.getU());
    e.system.realize(state, Stage::Acceleration);
    error.begin();
    for (std::size_t k = 0; k < e.joints.size(); ++k) {
      if (e.joints[k] >= 0) error.add(state.getUDot()[static_cast<int>(k)], s.a[static_cast<std::size_t>(e.joints[k])]);
    }
    error.end();
  }
  out["error"] = error.worst();
  out["us"] = peers::least_microseconds(states.size(), seconds, [&](std::size_t i) {
    state.updQ() = states[i].first;
    state.updU() = states[i].second;
    e.system.realize(state, Stage::Acceleration);
  });
}

// accuracy=A, end=T: Runge-Kutta-Merson with projection.
void measure_simulation(const peers::Scene& scene, double seconds, int argc, char** argv, Engine& e,
                        const SimTK::State& prepared, json& out) {
  const double end = std::stod(peers::setting(argc, argv, "end", "10"));
  const double accuracy = std::stod(peers::setting(argc, argv, "tolerance", "1e-4"));
  SimTK::State start = prepared;
  for (const auto& [body, joint] : scene.tree) {
    e.bodies[static_cast<std::size_t>(body)].setOneU(start, 0,
                                                     scene.joints[static_cast<std::size_t>(joint)].start_speed);
  }
  const auto mechanical = [&](const SimTK::State& state, double& kinetic) {
    e.system.realize(state, Stage::Dynamics);
    kinetic = e.system.calcKineticEnergy(state);
    double work = 0;
    for (std::size_t k = 0; k < e.joints.size(); ++k)
      work += scene.joints[static_cast<std::size_t>(e.joints[k])].torque * state.getQ()[static_cast<int>(k)];
    return e.system.calcEnergy(state) - work;
  };
  double least = Infinity, kinetic = 0, largest = 0, drift = 0;
  const double begun = peers::cpu_seconds();
  do {
    RungeKuttaMersonIntegrator integrator(e.system);
    integrator.setAccuracy(accuracy);
    TimeStepper stepper(e.system, integrator);
    const double from = peers::cpu_seconds();
    stepper.initialize(start);
    double watching = 0;
    const double first = mechanical(integrator.getState(), kinetic);
    for (int i = 1; i <= 100; ++i) {
      stepper.stepTo(end * i / 100);
      const double paused = peers::cpu_seconds();
      drift = std::max(drift, std::abs(mechanical(integrator.getState(), kinetic) - first));
      largest = std::max(largest, kinetic);
      watching += peers::cpu_seconds() - paused;
    }
    least = std::min(least, peers::cpu_seconds() - from - watching);
    const auto watched = std::find(e.joints.begin(), e.joints.end(), scene.watched_joint()) - e.joints.begin();
    out["angle"] = integrator.getState().getQ()[static_cast<int>(watched)];
  } while (peers::cpu_seconds() - begun < seconds);
  out["finished"] = true;
  out["run_s"] = least;
  out["kinetic_J"] = largest;
  out["drift_J"] = drift;
}

}  // namespace

int main(int argc, char** argv) try {
  const peers::Scene scene = peers::read_scene(argv[1]);
  const double seconds = std::stod(argv[2]);
  json out;
  const double start = peers::cpu_seconds();
  const auto engine = build(scene);
  SimTK::State state = engine->system.realizeTopology();
  engine->system.realizeModel(state);
  out["load_s"] = peers::cpu_seconds() - start;
  int major = 0, minor = 0, build_number = 0;
  SimTK_version_simbody(&major, &minor, &build_number);
  out["version"] = std::to_string(major) + "." + std::to_string(minor);
  name_coordinates(scene, state, *engine);
  if (peers::setting(argc, argv, "mode", "forward") == "simulate") {
    measure_simulation(scene, seconds, argc, argv, *engine, state, out);
  } else {
    measure_forward(scene, seconds, *engine, state, out);
  }
  peers::print(out);
  return 0;
} catch (const std::exception& problem) {
  peers::print({{"failed", problem.what()}});
  return 1;
}
