#include "ferrers/model/joint_change.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ferrers/core/checks.h"
#include "ferrers/model/joints/joint_type.h"
#include "ferrers/model/pose_spec.h"

namespace ferrers {
namespace {

constexpr std::string_view kVelocity = ".velocity";
constexpr double kSameDirection = 1e-9;  // rounding of directions that are equal by construction

bool has_axis(JointType type) {
  const PlacementRule rule = joint_type_info(type).placement;
  return rule == PlacementRule::kPointAxis || rule == PlacementRule::kPointNormal;
}

bool turns_about_axis(JointType type) {
  return type == JointType::kRevolute || type == JointType::kCylindrical || type == JointType::kScrew;
}

std::string_view only_coordinate(JointType type) {
  const auto coordinates = joint_type_info(type).coordinates;
  return coordinates.size() == 1 ? coordinates[0].name : std::string_view();
}

// "J.angle.velocity" → J, angle, and whether the velocity is meant.
struct CoordinateWord {
  std::string joint, coordinate;
  bool velocity = false;
};
CoordinateWord split_word(std::string_view name, JointType type) {
  CoordinateWord out;
  const std::size_t dot = name.find('.');
  out.joint = std::string(name.substr(0, dot));
  std::string_view word = name.substr(dot + 1);
  out.velocity = word == "velocity";
  if (word.size() > kVelocity.size() && word.substr(word.size() - kVelocity.size()) == kVelocity) {
    out.velocity = true;
    word.remove_suffix(kVelocity.size());
  }
  out.coordinate = std::string(word == "position" || word == "velocity" ? only_coordinate(type) : word);
  return out;
}

bool is_literal(const Number3& n) {
  return std::none_of(n.begin(), n.end(), [](const Number& one) { return one.expression.has_value(); });
}

bool is_literal(const PlaceSpec& place) {
  const auto literal = [](const auto& entry) { return is_literal(entry.second); };
  return (!place.drawn || is_literal(*place.drawn)) && std::all_of(place.on_body.begin(), place.on_body.end(), literal);
}

bool turns_with_parameters(const std::optional<PoseSpec>& pose) {
  if (!pose || !pose->rotation) return false;
  const RotationSpec& r = *pose->rotation;
  if (r.axis_angle) return !is_literal(r.axis_angle->first) || r.axis_angle->second.expression.has_value();
  const auto formula = [](const Number& n) { return n.expression.has_value(); };
  return r.quaternion && std::any_of(r.quaternion->begin(), r.quaternion->end(), formula);
}

bool is_by_formula(const PoseSpec& pose) { return !is_literal(pose.position) || turns_with_parameters(pose); }

Number3 rounded(const Vector3d& v) {
  Number3 out;
  for (int i = 0; i < 3; ++i) {
    const double nearest = std::round(v[i]);
    out[i] = Number(std::abs(v[i] - nearest) < 1e-14 ? nearest + 0.0 : v[i]);
  }
  return out;
}

// Every name of a joint coordinate in the specification, brought to the changed types.
class Renamer {
 public:
  Renamer(const ModelSpec& before, const std::vector<JointChange>& changes) {
    for (const JointSpec& joint : before.joints) {
      for (const JointChange& change : changes) {
        if (change.joint == joint.name.name) types_[change.joint] = {joint.type, change.to};
      }
    }
  }

  void apply(ModelSpec& spec) const {
    for (CouplingSpec& coupling : spec.couplings) {
      for (CoordinateRef& ref : coupling.coordinates) rename(ref.joint.name, ref.coordinate);
    }
    for (ForceSpec& force : spec.forces) std::visit([this](auto& element) { rename(element); }, force.element);
    for (DriveSpec& drive : spec.drives) {
      if (drive.coordinate) rename(drive.coordinate->joint.name, drive.coordinate->coordinate);
      for (LawSpec& law : drive.effort) rename(law);
    }
    for (InitialSpec& initial : spec.initial) rename(initial.joint.name, initial.coordinate);
    for (EventSpec& event : spec.events) event.when = renamed(event.when);
  }

 private:
  void rename(const std::string& joint, std::string& coordinate) const {
    const auto found = types_.find(joint);
    if (found == types_.end()) return;
    const auto [from, to] = found->second;
    const std::string_view kept =
        kept_coordinate(from, to, coordinate.empty() ? only_coordinate(from) : std::string_view(coordinate));
    coordinate = only_coordinate(to) == kept ? std::string() : std::string(kept);
  }
  void rename(SpringSpec&) const {}
  void rename(BushingSpec&) const {}
  void rename(TorsionSpringSpec& s) const { rename(s.coordinate.joint.name, s.coordinate.coordinate); }
  void rename(JointDampingSpec& s) const { rename(s.coordinate.joint.name, s.coordinate.coordinate); }
  void rename(LoadSpec& load) const {
    for (LawSpec& law : load.components) rename(law);
  }
  void rename(LawSpec& law) const {
    if (law.expression) law.expression = renamed(*law.expression);
  }

  Expression renamed(const Expression& expression) const {
    return expression.substitute([this](std::string_view name) -> std::optional<Expression> {
      const auto found = types_.find(std::string(name.substr(0, name.find('.'))));
      if (found == types_.end() || name.find('.') == std::string_view::npos) return std::nullopt;
      const CoordinateWord word = split_word(name, found->second.first);
      const std::string_view kept = kept_coordinate(found->second.first, found->second.second, word.coordinate);
      return Expression::variable(fmt::format("{}.{}{}", word.joint, kept, word.velocity ? kVelocity : ""));
    });
  }

  std::unordered_map<std::string, std::pair<JointType, JointType>> types_;
};

// The joint with its frames on the bodies that the file names, where those are parts of rigid groups.
Joint on_parts(const Model& model, JointId id) {
  Joint joint = model.joint(id);
  const auto& bodies = model.spec().joints[model.spec_index(id)].bodies;
  joint.X_1F = model.part(bodies[0].name).X_BP.inverse() * joint.X_1F;
  joint.X_2M = model.part(bodies[1].name).X_BP.inverse() * joint.X_2M;
  return joint;
}

// The frames of a joint given by them, with the new direction; the zero of an angle that is kept stays where it was.
void turn_frames(const JointChange& change, const Joint& before, const Model& model, JointSpec& spec) {
  const Pose &F = before.X_1F, &M = before.X_2M;
  const Matrix3d second_from_first =
      before.type == JointType::kSpherical
          ? Matrix3d(model.part(spec.bodies[1].name).X_WP.R.transpose() * model.part(spec.bodies[0].name).X_WP.R)
          : Matrix3d(M.R * F.R.transpose());
  const Vector3d direction = F.R * change.direction;
  const Matrix3d R =
      change.to == JointType::kUniversal ? frame_from_zx(F.R.col(2), direction) : frame_from_z(direction);
  spec.frames = {pose_spec({R, F.p}), pose_spec({second_from_first * R, M.p})};
}

// Gives one joint its new type and place; `before` is the joint as it was built. Returns what stands against it.
std::string retype(const JointChange& change, const Joint& before, const Model& model, JointSpec& spec) {
  const bool other_line = change.to == JointType::kPointOnLine && change.direction.norm() > 0.5;
  const bool wants_direction = other_line || joint_change_kind(spec.type, change.to) == ChangeKind::kDirected;
  if (wants_direction) {
    require(std::abs(change.direction.norm() - 1) < 1e-6, "change_joints: this change needs a unit direction");
    const bool by_body = !spec.axis.on_body.empty();
    const auto& bodies = model.spec().bodies;
    const bool turning = std::any_of(bodies.begin(), bodies.end(), [&](const BodySpec& body) {
      const bool mine = body.name.name == spec.bodies[0].name || body.name.name == spec.bodies[1].name;
      return mine && turns_with_parameters(body.pose);
    });
    const bool by_formula = spec.frames && (is_by_formula((*spec.frames)[0]) || is_by_formula((*spec.frames)[1]));
    if (!is_literal(spec.axis) || (spec.x && !is_literal(*spec.x)) || turning || by_formula) {
      return fmt::format(
          "the axis of '{}' depends on parameters, so that a second direction cannot be given in numbers",
          spec.name.name);
    }
    if (spec.frames) {
      turn_frames(change, before, model, spec);
      spec.type = change.to;
      return "";
    }
    PlaceSpec place;
    const bool on_second = change.to == JointType::kUniversal;
    const Vector3d own = on_second ? before.X_2M.R * change.direction : before.X_1F.R * change.direction;
    if (by_body) {
      place.on_body = {{spec.bodies[on_second ? 1 : 0], rounded(own)}};
    } else {
      const int side = on_second ? 1 : 0;
      place.drawn = rounded(model.part(spec.bodies[side].name).X_WP.R * own);
    }
    (on_second ? spec.axis2 : spec.axis) = place;
  }
  if (!wants_direction && !has_axis(change.to)) spec.axis = {};
  if (!has_axis(change.to) || wants_direction) spec.x.reset();
  spec.type = change.to;
  spec.lead = Number();
  return "";
}

// What one joint cannot keep whatever its frame.
void drop_coordinate_extras(const JointSpec& before, JointSpec& spec, std::vector<std::string>& notes) {
  const auto after = joint_type_info(spec.type).coordinates;
  const bool same = after.size() == 1 && only_coordinate(spec.type) == only_coordinate(before.type);
  const auto note = [&](std::string_view what) {
    notes.push_back(fmt::format("the {} of '{}' {} left out: a {} joint has no place for {}", what, spec.name.name,
                                what == "limits" ? "are" : "is", joint_type_info(spec.type).name,
                                what == "limits" ? "them" : "it"));
  };
  if (spec.limits && !same) {
    spec.limits.reset();
    note("limits");
  }
  if (spec.friction && !same) {
    spec.friction.reset();
    note("friction");
  }
}

// A vector or a diagonal in a frame that turned by R (new ← old). False where it cannot be written.
bool turn(const Matrix3d& R, bool diagonal, std::optional<Number3>& n) {
  if (!n) return true;
  const bool literal = is_literal(*n);
  if (!diagonal) {
    if (!literal) return false;
    n = rounded(R * Vector3d((*n)[0].value, (*n)[1].value, (*n)[2].value));
    return true;
  }
  if (literal && (*n)[0].value == (*n)[1].value && (*n)[1].value == (*n)[2].value) return true;
  Number3 out;
  for (int i = 0; i < 3; ++i) {
    int from = 0;
    R.row(i).cwiseAbs().maxCoeff(&from);
    if (std::abs(std::abs(R(i, from)) - 1) > kSameDirection) return false;
    out[i] = (*n)[from];
  }
  n = out;
  return true;
}

void turn_extras(const Matrix3d& R, JointSpec& spec, std::vector<std::string>& notes) {
  if ((R - Matrix3d::Identity()).cwiseAbs().maxCoeff() < kSameDirection) return;
  const auto note = [&](std::string_view what) {
    notes.push_back(fmt::format("the {} of '{}' is left out: a {} joint has other axes", what, spec.name.name,
                                joint_type_info(spec.type).name));
  };
  if (spec.stiffness && !(turn(R, true, spec.stiffness->force) && turn(R, true, spec.stiffness->moment))) {
    spec.stiffness.reset();
    note("stiffness");
  }
  if (spec.misalignment &&
      !(turn(R, false, spec.misalignment->translation) && turn(R, false, spec.misalignment->rotation))) {
    spec.misalignment.reset();
    note("misalignment");
  }
}

// Meshes read the gears' axis and centres off hinges; they must not lose them.
void write_out_meshes(const Model& model, ModelSpec& spec) {
  for (std::size_t j = 0; j < model.coordinates_begin(); ++j) {
    const Joint& mesh = model.joints()[j];
    JointSpec& out = spec.joints[model.spec_index(JointId(j))];
    if (mesh.type != JointType::kGearMesh || mesh.constants.mesh_holds_as_drawn_only) continue;
    const Joint own = on_parts(model, JointId(j));
    const Pose F = model.part(out.bodies[0].name).X_WP * own.X_1F, M = model.part(out.bodies[1].name).X_WP * own.X_2M;
    if (!out.axis.given()) out.axis.drawn = rounded(F.R.col(2));
    if (!out.centers) out.centers = {rounded(F.p), rounded(M.p)};
  }
}

JointChangeResult refused(std::string reason) {
  JointChangeResult out;
  out.reason = std::move(reason);
  return out;
}

}  // namespace

ChangeKind joint_change_kind(JointType from, JointType to) {
  using T = JointType;
  if (from == to) return ChangeKind::kImpossible;
  if (to == T::kFree) {
    const PlacementRule rule = joint_type_info(from).placement;
    return rule == PlacementRule::kTwoPoints || rule == PlacementRule::kMesh ? ChangeKind::kImpossible
                                                                             : ChangeKind::kPlain;
  }
  const bool axis = has_axis(from) && from != T::kPointOnPlane && from != T::kScrew;
  const bool point = from == T::kSpherical || from == T::kWeld;
  switch (to) {
    case T::kSpherical:
      return axis || from == T::kUniversal || from == T::kWeld ? ChangeKind::kPlain : ChangeKind::kImpossible;
    case T::kUniversal:
      return from == T::kRevolute ? ChangeKind::kDirected : ChangeKind::kImpossible;
    case T::kRevolute:
    case T::kPrismatic:
    case T::kCylindrical:
    case T::kPointOnLine:
      if (from == T::kScrew && to == T::kCylindrical) return ChangeKind::kPlain;
      return axis ? ChangeKind::kPlain : point ? ChangeKind::kDirected : ChangeKind::kImpossible;
    case T::kPlanar:
      return axis && from != T::kPointOnLine ? ChangeKind::kPlain : ChangeKind::kImpossible;
    case T::kPointOnPlane:
      return from == T::kPlanar        ? ChangeKind::kPlain
             : from == T::kPointOnLine ? ChangeKind::kDirected
                                       : ChangeKind::kImpossible;
    default:
      return ChangeKind::kImpossible;
  }
}

std::string_view kept_coordinate(JointType from, JointType to, std::string_view coordinate) {
  if (coordinate.empty() || from == JointType::kFree || to == JointType::kFree) return {};
  const bool about_axis = turns_about_axis(from) || from == JointType::kPlanar;
  if (coordinate == "angle" && about_axis) {
    if (to == JointType::kUniversal) return "angle_1";
    if (turns_about_axis(to) || to == JointType::kPlanar) return "angle";
  }
  const auto slides = [](JointType type) { return type == JointType::kPrismatic || type == JointType::kCylindrical; };
  if (coordinate == "displacement" && slides(from) && slides(to)) return "displacement";
  return {};
}

CoordinateUses::CoordinateUses(const ModelSpec& spec) {
  for (const JointSpec& joint : spec.joints) types_[joint.name.name] = joint.type;
  const auto named = [](std::string_view kind, const NameRef& name) {
    return fmt::format("the {} '{}'", kind, name.name);
  };
  for (const CouplingSpec& coupling : spec.couplings) {
    for (const CoordinateRef& ref : coupling.coordinates) {
      add(ref.joint.name, ref.coordinate, named("coupling", coupling.name));
    }
  }
  for (const DriveSpec& drive : spec.drives) {
    if (drive.coordinate) add(drive.coordinate->joint.name, drive.coordinate->coordinate, named("drive", drive.name));
    for (const LawSpec& law : drive.effort) {
      if (law.expression) add_names(*law.expression, named("drive", drive.name));
    }
  }
  for (const ForceSpec& force : spec.forces) {
    const std::string user = named("force element", force.name);
    if (const auto* spring = std::get_if<TorsionSpringSpec>(&force.element)) {
      add(spring->coordinate.joint.name, spring->coordinate.coordinate, user);
    } else if (const auto* damping = std::get_if<JointDampingSpec>(&force.element)) {
      add(damping->coordinate.joint.name, damping->coordinate.coordinate, user);
    } else if (const auto* load = std::get_if<LoadSpec>(&force.element)) {
      for (const LawSpec& law : load->components) {
        if (law.expression) add_names(*law.expression, user);
      }
    }
  }
  for (const InitialSpec& initial : spec.initial) add(initial.joint.name, initial.coordinate, "its initial value");
  for (const EventSpec& event : spec.events) add_names(event.when, named("event", event.name));
}

void CoordinateUses::add(const std::string& joint, std::string_view coordinate, std::string user) {
  const auto type = types_.find(joint);
  if (type == types_.end()) return;
  uses_[joint].push_back(
      {std::move(user), std::string(coordinate.empty() ? only_coordinate(type->second) : coordinate)});
}

void CoordinateUses::add_names(const Expression& expression, const std::string& user) {
  for (const ExpressionName& name : expression.names()) {
    const auto type = types_.find(name.name.substr(0, name.name.find('.')));
    if (type == types_.end() || name.name.find('.') == std::string::npos) continue;
    const CoordinateWord word = split_word(name.name, type->second);
    add(word.joint, word.coordinate, user);
  }
}

std::string CoordinateUses::obstacle(const std::string& joint, JointType to) const {
  const auto found = uses_.find(joint);
  if (found == uses_.end()) return "";
  const JointType from = types_.at(joint);
  for (const Use& use : found->second) {
    if (!kept_coordinate(from, to, use.coordinate).empty()) continue;
    return fmt::format("{} uses {} of '{}', which a {} joint does not have", use.user,
                       use.coordinate.empty() ? "the coordinates" : "'" + use.coordinate + "'", joint,
                       joint_type_info(to).name);
  }
  return "";
}

JointChangeResult change_joints(const ModelSpec& spec, const std::vector<JointChange>& changes,
                                const std::map<std::string, double>& parameter_values) {
  const ModelBuildResult before = build_model(spec, parameter_values);
  if (!before.model) return refused("the model has errors");
  const CoordinateUses uses(spec);
  JointChangeResult out;
  out.spec = spec;
  std::vector<JointId> changed;
  bool loses_hinge = false;
  for (const JointChange& change : changes) {
    const std::optional<JointId> id = before.model->find_joint(change.joint);
    require(id.has_value(), "change_joints: unknown joint");
    const Joint joint = on_parts(*before.model, *id);
    const std::size_t index = before.model->spec_index(*id);
    JointSpec& target = out.spec->joints[index];
    require(joint_change_kind(joint.type, change.to) != ChangeKind::kImpossible && target.type == joint.type,
            "change_joints: this change is not known, or given twice");
    if (std::string obstacle = uses.obstacle(change.joint, change.to); !obstacle.empty()) return refused(obstacle);
    if (change.to == JointType::kUniversal && !target.axis.on_body.empty() && uses.any(change.joint)) {
      return refused(fmt::format("the angle of '{}' is used and would start from another zero", change.joint));
    }
    if (std::string fault = retype(change, joint, *before.model, target); !fault.empty()) return refused(fault);
    drop_coordinate_extras(spec.joints[index], target, out.notes);
    loses_hinge = loses_hinge || (turns_about_axis(joint.type) && !turns_about_axis(change.to));
    changed.push_back(*id);
  }
  Renamer(spec, changes).apply(*out.spec);
  // Welds that are joints stay so: with another joint gone they might be merged otherwise.
  for (std::size_t j = 0; j < before.model->coordinates_begin(); ++j) {
    out.spec->joints[before.model->spec_index(JointId(j))].merge = false;
  }
  if (loses_hinge) write_out_meshes(*before.model, *out.spec);
  const ModelBuildResult after = build_model(*out.spec, parameter_values);
  if (!after.model) {
    for (const Diagnostic& one : after.diagnostics.items()) {
      if (one.severity == Severity::kError) return refused("the changed model would have an error: " + one.message);
    }
  }
  for (const JointId id : changed) {
    turn_extras(after.model->joint(id).X_1F.R.transpose() * before.model->joint(id).X_1F.R,
                out.spec->joints[before.model->spec_index(id)], out.notes);
  }
  return out;
}

}  // namespace ferrers
