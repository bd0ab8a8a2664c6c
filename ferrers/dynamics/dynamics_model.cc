#include "ferrers/dynamics/dynamics_model.h"

#include "ferrers/dynamics/friction.h"

namespace ferrers {
namespace {

constexpr std::size_t kMostLawInputs = 64;  // checked when a law is bound

}  // namespace

double BoundLaw::evaluate(const System& system, const State& state, const PositionKinematics& pos,
                          const VelocityKinematics& vel) const {
  double values[kMostLawInputs];
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    if (kinds[i] == LawInput::Kind::kTime) {
      values[i] = state.t;
      continue;
    }
    const Jet jet = measure_coordinate(system, accesses[i], state, pos, vel);
    values[i] = kinds[i] == LawInput::Kind::kPosition ? jet.value : jet.rate;
  }
  return law.value(values);
}

namespace {

class Binder {
 public:
  explicit Binder(std::shared_ptr<const System> system) : model_(std::make_shared<DynamicsModel>()) {
    model_->system = std::move(system);
  }

  std::shared_ptr<const DynamicsModel> bind() {
    bind_inertias();
    for (const ForceElement& force : model().forces()) {
      std::visit([&](const auto& element) { bind_force(element); }, force.element);
    }
    bind_friction();
    for (std::size_t d = 0; d < model().drives().size(); ++d) bind_drive(DriveId(d));
    for (const Event& event : model().events()) model_->events.push_back(bind_law(event.when));
    model_->has_forces = !model_->springs.empty() || !model_->torsion_springs.empty() || !model_->bushings.empty() ||
                         !model_->loads.empty();
    return model_;
  }

 private:
  const System& system() const { return *model_->system; }
  const Model& model() const { return *system().model; }

  void bind_inertias() {
    model_->inertias.resize(system().nodes.size());
    for (std::size_t i = 1; i < system().nodes.size(); ++i) {
      const Node& node = system().nodes[i];
      const Body& body = model().body(node.body);
      NodeInertia& inertia = model_->inertias[i];
      inertia.mass_kg = body.mass_kg;
      inertia.com_N = node.X_BN.inverse() * body.com_m;
      inertia.I_N = node.X_BN.R.transpose() * body.inertia_kgm2 * node.X_BN.R;
      if (!body.has_mass) model_->massless_bodies.push_back(body.name);
    }
  }

  BoundLaw bind_law(const Law& law) {
    BoundLaw bound;
    bound.law = law;
    if (law.inputs().size() > kMostLawInputs)
      model_->unsupported.emplace_back("a law that reads more than 64 quantities");
    for (const LawInput& input : law.inputs()) {
      bound.kinds.push_back(input.kind);
      bound.accesses.push_back(input.kind == LawInput::Kind::kTime ? CoordinateAccess()
                                                                   : system().access(input.coordinate));
    }
    return bound;
  }

  void bind_force(const Spring& s) {
    model_->springs.push_back({system().point(s.first, s.point_1_m), system().point(s.second, s.point_2_m), s.stiffness,
                               s.damping, s.free_length_m});
  }
  void bind_force(const TorsionSpring& s) {
    model_->torsion_springs.push_back({system().access(s.coordinate), s.stiffness, s.damping, s.free_angle});
  }
  void bind_force(const JointDamping& d) {
    model_->torsion_springs.push_back({system().access(d.coordinate), 0, d.damping, 0});
  }
  void bind_force(const Bushing& b) {
    model_->bushings.push_back({system().frame_pair(b.first, b.X_1F, b.second, b.X_2M), b.stiffness, b.damping});
  }
  void bind_force(const Load& load) {
    BoundLoad bound;
    bound.point = system().point(load.body, load.point_m);
    bound.R_NB = system().nodes[bound.point.node].X_BN.R.transpose();
    bound.is_torque = load.is_torque;
    bound.in_body_axes = load.in_body_axes;
    for (int i = 0; i < 3; ++i) bound.components[i] = bind_law(load.components[i]);
    model_->loads.push_back(std::move(bound));
  }

  void bind_friction() {
    for (std::size_t j = 0; j < model().joints().size(); ++j) {
      const Joint& joint = model().joints()[j];
      if (!joint.friction) continue;
      if (joint.friction->coulomb != 0) bind_dry_friction(JointId(j), joint);
      if (joint.friction->viscous == 0) continue;
      const JointTypeInfo& type = joint_type_info(joint.type);
      if (!type.coordinate_jets) bind_relative_damping(JointId(j), type, joint.friction->viscous);
      for (int k = 0; k < static_cast<int>(type.coordinates.size()) && type.coordinate_jets; ++k) {
        model_->torsion_springs.push_back({system().access({JointId(j), k}), 0, joint.friction->viscous, 0});
      }
    }
  }

  // A joint without scalar coordinates (spherical, say): the relative velocities that it leaves free, in F axes.
  void bind_relative_damping(JointId id, const JointTypeInfo& type, double viscous) {
    BoundBushing damper{system().frame_pair(id), Vector6d::Zero(), Vector6d::Constant(viscous)};
    for (const int k : type.row_components) damper.damping[k] = 0;
    model_->bushings.push_back(std::move(damper));
  }

  void bind_dry_friction(JointId id, const Joint& joint) {
    BoundFriction friction;
    friction.joint = id;
    friction.frames = system().frame_pair(id);
    friction.coulomb = joint.friction->coulomb;
    friction.radius_m = joint.friction->radius_m;
    if (const std::string obstacle = find_slips(joint, friction); !obstacle.empty()) {
      model_->unsupported.push_back("Coulomb friction in joint '" + joint.name + "': " + obstacle);
      return;
    }
    friction.first = model_->friction_slips;
    model_->friction_slips += friction.slips;
    model_->frictions.push_back(std::move(friction));
  }

  void bind_drive(DriveId id) {
    const Drive& drive = model().drives()[id.index()];
    static constexpr std::string_view kAxes[] = {".x", ".y", ".z"};
    for (int i = 0; i < drive.components(); ++i) {
      DriveComponent c;
      c.name = drive.kind == Drive::Kind::kPoint ? drive.name + std::string(kAxes[i]) : drive.name;
      c.drive = id;
      c.component = i;
      c.kind = drive.kind;
      c.weight = drive.weight;
      if (drive.kind == Drive::Kind::kCoordinate) {
        c.coordinate = drive.coordinate;
        c.access = system().access(drive.coordinate);
        const Joint& joint = model().joint(drive.coordinate.joint);
        const CoordinateKind kind = joint_type_info(joint.type).coordinates[drive.coordinate.index].kind;
        c.rotary = kind == CoordinateKind::kAngle || kind == CoordinateKind::kRotationRate;
      } else {
        const BodyId first = drive.kind == Drive::Kind::kPoint ? kGround : drive.first;
        const Vector3d p_1 = drive.kind == Drive::Kind::kPoint ? Vector3d(0, 0, 0) : drive.point_1_m;
        c.frames = system().frame_pair(first, {Matrix3d::Identity(), p_1}, drive.second,
                                       {Matrix3d::Identity(), drive.point_2_m});
      }
      if (!drive.motion.empty()) c.motion = drive.motion[i];
      if (!drive.effort.empty()) c.effort = bind_law(drive.effort[i]);
      model_->drives.push_back(std::move(c));
    }
  }

  std::shared_ptr<DynamicsModel> model_;
};

}  // namespace

std::shared_ptr<const DynamicsModel> make_dynamics_model(std::shared_ptr<const System> system) {
  return Binder(std::move(system)).bind();
}

Jet measure_drive(const DynamicsModel& model, const DriveComponent& drive, const State& state,
                  const PositionKinematics& pos, const VelocityKinematics& vel) {
  if (drive.kind == Drive::Kind::kCoordinate) {
    return measure_coordinate(*model.system, drive.access, state, pos, vel);
  }
  const RelativeMotion m = compute_relative_motion(drive.frames, pos, vel);
  if (drive.kind == Drive::Kind::kPoint) return along_first(m, Vector3d::Unit(drive.component));
  Jet sum;
  for (int i = 0; i < 3; ++i) sum = sum + square(along_first(m, m.R_F.col(i)));
  return sqrt(sum);
}

void add_drive_row(const DynamicsModel& model, const DriveComponent& drive, const PositionKinematics& pos,
                   const Jet& jet, Eigen::Ref<Eigen::RowVectorXd> row) {
  if (drive.kind == Drive::Kind::kCoordinate) {
    add_coordinate_row(*model.system, drive.access, pos, jet, 1, row);
  } else {
    add_jet_row(*model.system, drive.frames, pos, jet.W, 1, row);
  }
}

}  // namespace ferrers
