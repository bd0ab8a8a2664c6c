#include "ferrers/dynamics/dynamics_model.h"

#include <algorithm>

#include "ferrers/dynamics/friction.h"
#include "ferrers/dynamics/lagrangian_terms.h"

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
    for (const RecordedFormula& one : model().recorded_formulas()) model_->recorded.push_back(bind_law(one.law));
    bind_lagrangian();
    model_->has_forces = !model_->springs.empty() || !model_->torsion_springs.empty() || !model_->bushings.empty() ||
                         !model_->loads.empty() || model_->lagrangian.has_forces;
    return model_;
  }

 private:
  const System& system() const { return *model_->system; }
  const Model& model() const { return *system().model; }

  void bind_inertias() {
    model_->inertias.resize(system().nodes.size());
    for (std::size_t i = 1; i < system().nodes.size(); ++i) {
      const Node& node = system().nodes[i];
      if (!node.type->carries_body) continue;
      const Body& body = model().body(node.body);
      NodeInertia& inertia = model_->inertias[i];
      inertia.mass_kg = body.mass_kg;
      inertia.com_N = node.X_BN.inverse() * body.com_m;
      inertia.I_N = node.X_BN.R.transpose() * body.inertia_kgm2 * node.X_BN.R;
      if (!body.has_mass) model_->massless_bodies.push_back(body.name);
    }
  }

  void bind_lagrangian() {
    const Lagrangian& lagrangian = model().lagrangian();
    if (!lagrangian.any()) return;
    BoundLagrangian& bound = model_->lagrangian;
    std::vector<std::string> inputs = lagrangian.values;
    inputs.insert(inputs.end(), lagrangian.rates.begin(), lagrangian.rates.end());
    inputs.emplace_back("t");
    for (const StateScalar& scalar : lagrangian.scalars) {
      bound.scalars.push_back(system().scalar_access(scalar));
      bound.in_tree = bound.in_tree && bound.scalars.back().in_tree;
    }
    for (const Lagrangian::MassEntry& entry : lagrangian.mass) bound.mass.emplace_back(entry.row, entry.column);
    bound.mass_pattern = lagrangian_mass_pattern(system());
    bound.has_forces = lagrangian.has_forces();
    bound.power_of_time = lagrangian.power_of_time.constant_value() != 0.0;
    if (lagrangian.system) {
      const int n = static_cast<int>(bound.scalars.size());
      std::vector<double> parameters;
      for (const Parameter& parameter : model().parameters()) parameters.push_back(parameter.value);
      bound.inertia = make_inertia_program(lagrangian.system, n, parameters);
      bound.force = make_force_program(lagrangian.system, n, parameters);
      bound.energy = make_energy_program(lagrangian.system, n, parameters);
      return;
    }
    std::vector<Expression> inertia;
    for (const Lagrangian::MassEntry& entry : lagrangian.mass) {
      inertia.push_back(entry.value);
    }
    inertia.insert(inertia.end(), lagrangian.bias.begin(), lagrangian.bias.end());
    bound.inertia = StateProgram(inertia, inputs);
    bound.force = StateProgram(lagrangian.force, inputs);
    const std::vector<Expression> energy = {lagrangian.kinetic_part, lagrangian.potential_part,
                                            lagrangian.power_of_time};
    bound.energy = StateProgram(energy, inputs);
  }

  BoundLaw bind_law(const Law& law) {
    BoundLaw bound;
    bound.law = law;
    if (law.inputs().size() > kMostLawInputs)
      model_->unsupported.emplace_back("a law that reads more than 64 quantities");
    for (const LawInput& input : law.inputs()) {
      bound.kinds.push_back(input.kind);
      bound.accesses.push_back(input.kind == LawInput::Kind::kTime ? CoordinateAccess()
                                                                   : system().scalar_access(input.scalar));
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
    bound.R_NB = system().nodes[bound.point.node].X_BN.R.transpose() * load.R_BP;
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
      c.acts = drive.acts;
      if (drive.kind == Drive::Kind::kCoordinate) {
        c.coordinate = drive.coordinate;
        c.access = system().access(drive.coordinate);
        const Joint& joint = model().joint(drive.coordinate.joint);
        const CoordinateInfo& info = joint_type_info(joint.type).coordinates[drive.coordinate.index];
        c.rotary = info.is_angular();
        c.has_unit = info.kind != CoordinateKind::kOther;
      } else if (drive.kind == Drive::Kind::kFormula) {
        c.formula = make_formula_block(system(), *drive.relation, drive.scalars);
        c.has_unit = false;
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

FormulaEvaluation make_lagrangian_evaluation(const BoundLagrangian& bound) {
  const std::size_t count = bound.scalars.size();
  const int outputs = std::max(bound.inertia.output_count(), bound.force.output_count());
  return {std::vector<Jet>(count), std::vector<double>(2 * count + 1),
          std::vector<double>(static_cast<std::size_t>(outputs))};
}

std::vector<int> acting_drives(const DynamicsModel& model) {
  std::vector<int> out;
  for (int i = 0; i < model.nu(); ++i) {
    if (model.drives[static_cast<std::size_t>(i)].acts) out.push_back(i);
  }
  return out;
}

FormulaEvaluation make_drive_evaluation(const DynamicsModel& model) {
  FormulaEvaluation largest;
  for (const DriveComponent& drive : model.drives) {
    if (drive.kind != Drive::Kind::kFormula) continue;
    const FormulaEvaluation one = make_formula_evaluation(drive.formula);
    if (one.jets.size() > largest.jets.size()) largest.jets = one.jets;
    if (one.inputs.size() > largest.inputs.size()) largest.inputs = one.inputs;
    if (one.outputs.size() > largest.outputs.size()) largest.outputs = one.outputs;
  }
  return largest;
}

Jet measure_drive(const DynamicsModel& model, const DriveComponent& drive, const State& state,
                  const PositionKinematics& pos, const VelocityKinematics& vel, FormulaEvaluation& work) {
  if (drive.kind == Drive::Kind::kCoordinate) {
    return measure_coordinate(*model.system, drive.access, state, pos, vel);
  }
  if (drive.kind == Drive::Kind::kFormula) {
    evaluate_formulas(*model.system, drive.formula, state, pos, vel, work);
    return formula_jet(drive.formula, drive.formula.rows.front(), work);
  }
  const RelativeMotion m = compute_relative_motion(drive.frames, pos, vel);
  if (drive.kind == Drive::Kind::kPoint) return along_first(m, Vector3d::Unit(drive.component));
  Jet sum;
  for (int i = 0; i < 3; ++i) sum = sum + square(along_first(m, m.R_F.col(i)));
  return sqrt(sum);
}

void add_drive_row(const DynamicsModel& model, const DriveComponent& drive, const PositionKinematics& pos,
                   const Jet& jet, const FormulaEvaluation& work, Eigen::Ref<Eigen::RowVectorXd> row) {
  if (drive.kind == Drive::Kind::kCoordinate) {
    add_coordinate_row(*model.system, drive.access, pos, jet, 1, row);
  } else if (drive.kind == Drive::Kind::kFormula) {
    add_formula_row(*model.system, drive.formula, drive.formula.rows.front(), pos, work, row);
  } else {
    add_jet_row(*model.system, drive.frames, pos, jet.W, 1, row);
  }
}

}  // namespace ferrers
