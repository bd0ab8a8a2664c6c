#include "ferrers/testing/transforms.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <functional>
#include <random>
#include <set>
#include <stdexcept>
#include <string>

#include "ferrers/math/rotation.h"
#include "ferrers/model/model.h"
#include "ferrers/model/pose_spec.h"
#include "ferrers/testing/random_source.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers::witness {
namespace {

using Map = std::function<Point(const Point&)>;

double literal(const Number& n) {
  if (n.expression) throw std::invalid_argument("transforms: a number is an expression");
  return n.value;
}

Point literal(const Number3& n) { return {literal(n[0]), literal(n[1]), literal(n[2])}; }

void map(Number3& n, const Map& f) { n = numbers(f(literal(n))); }
void map(std::optional<Number3>& n, const Map& f) {
  if (n) map(*n, f);
}
void multiply(Number& n, double s) { n = Number(literal(n) * s); }
void multiply(std::optional<Number>& n, double s) {
  if (n) multiply(*n, s);
}
void multiply(Number3& n, double s) {
  for (Number& entry : n) multiply(entry, s);
}
void multiply(std::optional<Number3>& n, double s) {
  if (n) multiply(*n, s);
}

/// Σ weights · laws as one law.
LawSpec combined(const std::array<LawSpec, 3>& laws, const Eigen::RowVector3d& weights) {
  std::string text = "0";
  for (int i = 0; i < 3; ++i) {
    if (laws[i].samples) throw std::invalid_argument("transforms: a sampled load");
    if (weights[i] == 0 || !laws[i].expression) continue;
    text += " + (" + Expression::constant(weights[i]).to_string() + ")*(" + laws[i].expression->to_string() + ")";
  }
  return law(text);
}

void multiply(LawSpec& l, double s) {
  if (l.samples) {
    for (double& value : l.samples->second) value *= s;
  } else if (l.expression) {
    l.expression = law("(" + Expression::constant(s).to_string() + ")*(" + l.expression->to_string() + ")").expression;
  }
}

Eigen::Matrix3d matrix_of(const std::optional<RotationSpec>& rotation) {
  if (!rotation) return Eigen::Matrix3d::Identity();
  if (rotation->axis_angle) {
    return Eigen::AngleAxisd(literal(rotation->axis_angle->second), literal(rotation->axis_angle->first).normalized())
        .toRotationMatrix();
  }
  if (!rotation->quaternion) return Eigen::Matrix3d::Identity();
  const auto& q = *rotation->quaternion;
  return Eigen::Quaterniond(literal(q[0]), literal(q[1]), literal(q[2]), literal(q[3])).normalized().toRotationMatrix();
}

RotationSpec rotation_spec(const Eigen::Matrix3d& R) {
  const Eigen::Quaterniond q(R);
  RotationSpec spec;
  spec.quaternion = std::array<Number, 4>{Number(q.w()), Number(q.x()), Number(q.y()), Number(q.z())};
  return spec;
}

/// Applies a rigid motion or a similarity to every place: `point` to points, `direction` to directions.
class Mover {
 public:
  /// `local_too`: also points that are given in a body's own frame (right for similarities only).
  Mover(const ModelSpec& spec, Map point, Map direction, bool local_too = false)
      : point_(std::move(point)), direction_(std::move(direction)), local_too_(local_too) {
    for (const BodySpec& body : spec.bodies) {
      if (body.pose) posed_.insert(body.name.name);
    }
  }

  bool posed(const NameRef& body) const { return posed_.count(body.name) > 0; }

  void body(BodySpec& body) const {
    if (body.pose) {
      map(body.pose->position, point_);
      return;
    }
    map(body.com, point_);
    map(body.inertia.from, point_);
    map(body.inertia.to, point_);
  }

  void joint(JointSpec& joint) const {
    map(joint.place.drawn, point_);
    map(joint.axis.drawn, direction_);
    map(joint.axis2.drawn, direction_);
    map(joint.x, direction_);
    map(joint.line_of_action, direction_);
    if (joint.centers) {
      for (Number3& centre : *joint.centers) map(centre, point_);
    }
    for (std::size_t i = 0; joint.frames && i < 2; ++i) {
      if (in_world(joint.bodies[i])) map((*joint.frames)[i].position, point_);
    }
    if (joint.points && (local_too_ || !joint.points_on_bodies)) pair(joint.bodies, *joint.points);
  }

  void force(ForceSpec& force) const {
    if (auto* spring = std::get_if<SpringSpec>(&force.element)) pair(spring->bodies, spring->points);
    if (auto* bushing = std::get_if<BushingSpec>(&force.element)) {
      map(bushing->place.drawn, point_);
      map(bushing->axis.drawn, direction_);
      map(bushing->x, direction_);
    }
    if (auto* load = std::get_if<LoadSpec>(&force.element); load && in_world(load->body)) map(load->place, point_);
  }

  void drive(DriveSpec& drive) const {
    if (drive.bodies && drive.points) pair(*drive.bodies, *drive.points);
  }

  void all(ModelSpec& spec) const {
    for (BodySpec& b : spec.bodies) body(b);
    for (JointSpec& j : spec.joints) joint(j);
    for (ForceSpec& f : spec.forces) force(f);
    for (DriveSpec& d : spec.drives) drive(d);
    for (RecordSpec& r : spec.records) {
      if (in_world(r.body)) map(r.place, point_);
    }
  }

 private:
  void pair(const std::array<NameRef, 2>& bodies, std::array<Number3, 2>& points) const {
    for (int i = 0; i < 2; ++i) {
      if (in_world(bodies[i])) map(points[i], point_);
    }
  }

  bool in_world(const NameRef& body) const { return local_too_ || !posed(body); }

  Map point_, direction_;
  bool local_too_;
  std::set<std::string> posed_;
};

/// Writes out the default x axis of joints that have a drawn axis.
void fix_x_axes(ModelSpec& spec) {
  for (JointSpec& joint : spec.joints) {
    const bool default_x =
        joint.axis.drawn && !joint.x && joint.type != JointType::kUniversal && joint.type != JointType::kGearMesh;
    if (default_x) joint.x = numbers(frame_from_z(literal(*joint.axis.drawn).normalized()).col(0));
  }
}

void rotate_loads(ModelSpec& spec, const Eigen::Matrix3d& R, const Mover& mover) {
  for (ForceSpec& force : spec.forces) {
    auto* load = std::get_if<LoadSpec>(&force.element);
    if (!load || (load->in_body_axes && mover.posed(load->body))) continue;
    const std::array<LawSpec, 3> old = load->components;
    for (int i = 0; i < 3; ++i) load->components[i] = combined(old, R.row(i));
  }
  for (DriveSpec& drive : spec.drives) {
    if (!drive.point) continue;
    for (std::vector<LawSpec>* laws : {&drive.motion, &drive.effort}) {
      if (laws->size() != 3) continue;
      const std::array<LawSpec, 3> old = {(*laws)[0], (*laws)[1], (*laws)[2]};
      for (int i = 0; i < 3; ++i) (*laws)[i] = combined(old, R.row(i));
    }
  }
}

JointType type_of(const ModelSpec& spec, const NameRef& name) {
  for (const JointSpec& joint : spec.joints) {
    if (joint.name.name == name.name) return joint.type;
  }
  throw std::invalid_argument("transforms: no joint '" + name.name + "'");
}

/// Whether a scalar coordinate is a length; rotation vectors and poses throw.
bool is_length(const ModelSpec& spec, const NameRef& joint, const std::string& coordinate) {
  const JointType type = type_of(spec, joint);
  if (type == JointType::kPrismatic) return true;
  if (type == JointType::kRevolute || type == JointType::kScrew || type == JointType::kUniversal) return false;
  if (type == JointType::kSpherical && coordinate.rfind("omega", 0) == 0) return false;
  if (coordinate.empty()) throw std::invalid_argument("transforms: '" + joint.name + "' needs a coordinate");
  return coordinate.rfind("displacement", 0) == 0;
}

void scale_force(const ModelSpec& spec, ForceSpec& force, double s) {
  if (auto* spring = std::get_if<SpringSpec>(&force.element)) multiply(spring->free_length, s);
  if (auto* bushing = std::get_if<BushingSpec>(&force.element)) {
    multiply(bushing->moment_stiffness, s * s);
    multiply(bushing->moment_damping, s * s);
  }
  if (auto* load = std::get_if<LoadSpec>(&force.element)) {
    for (LawSpec& component : load->components) multiply(component, load->is_torque ? s * s : s);
  }
  if (auto* torsion = std::get_if<TorsionSpringSpec>(&force.element)) {
    const bool length = is_length(spec, torsion->coordinate.joint, torsion->coordinate.coordinate);
    multiply(torsion->stiffness, length ? 1 : s * s);
    multiply(torsion->damping, length ? 1 : s * s);
    multiply(torsion->free_angle, length ? s : 1);
  }
  if (auto* damping = std::get_if<JointDampingSpec>(&force.element)) {
    const bool length = is_length(spec, damping->coordinate.joint, damping->coordinate.coordinate);
    multiply(damping->damping, length ? 1 : s * s);
  }
}

void scale_joint(JointSpec& joint, double s) {
  multiply(joint.lead, s);
  multiply(joint.length, s);
  if (joint.stiffness) multiply(joint.stiffness->moment, s * s);
  if (joint.misalignment) multiply(joint.misalignment->translation, s);
  const bool slides = joint.type == JointType::kPrismatic;
  if (joint.limits && slides) {
    for (Number& limit : *joint.limits) multiply(limit, s);
  }
  if (joint.friction) {
    if (!slides) multiply(joint.friction->viscous, s * s);
    multiply(joint.friction->radius, s);
  }
}

void scale_drive(const ModelSpec& spec, DriveSpec& drive, double s) {
  const bool angle = drive.coordinate && !is_length(spec, drive.coordinate->joint, drive.coordinate->coordinate);
  for (LawSpec& l : drive.motion) multiply(l, angle ? 1 : s);
  for (LawSpec& l : drive.effort) multiply(l, angle ? s * s : s);
}

}  // namespace

ModelSpec rotated(const ModelSpec& spec, const Eigen::Matrix3d& R) {
  ModelSpec out = spec;
  fix_x_axes(out);
  for (const InitialSpec& initial : out.initial) {
    const JointType type = type_of(out, initial.joint);
    if (type == JointType::kSpherical || type == JointType::kFree) {
      throw std::invalid_argument("rotated: initial values of '" + initial.joint.name + "'");
    }
  }
  const Map turn = [&R](const Point& p) -> Point { return R * p; };
  const Mover mover(out, turn, turn);
  map(out.gravity, turn);
  mover.all(out);
  for (BodySpec& body : out.bodies) {
    std::optional<RotationSpec>& rotation = body.pose ? body.pose->rotation : body.inertia.rotation;
    rotation = rotation_spec(R * matrix_of(rotation));
    const bool turns =
        body.pose || body.inertia.kind == InertiaSpec::Kind::kBox || body.inertia.kind == InertiaSpec::Kind::kTensor;
    if (!turns) rotation.reset();
  }
  for (JointSpec& joint : out.joints) {
    for (std::size_t i = 0; joint.frames && i < 2; ++i) {
      if (mover.posed(joint.bodies[i])) continue;
      std::optional<RotationSpec>& rotation = (*joint.frames)[i].rotation;
      rotation = rotation_spec(R * matrix_of(rotation));
    }
  }
  rotate_loads(out, R, mover);
  return out;
}

ModelSpec shifted(const ModelSpec& spec, const Eigen::Vector3d& p) {
  ModelSpec out = spec;
  Mover(
      out, [&p](const Point& x) -> Point { return x + p; }, [](const Point& x) { return x; })
      .all(out);
  return out;
}

ModelSpec scaled(const ModelSpec& spec, double s) {
  ModelSpec out = spec;
  Mover(
      out, [s](const Point& x) -> Point { return s * x; }, [](const Point& x) { return x; }, true)
      .all(out);
  multiply(out.gravity, s);
  for (BodySpec& body : out.bodies) {
    if (body.pose) {
      multiply(body.com, s);
      multiply(body.inertia.from, s);
      multiply(body.inertia.to, s);
    }
    multiply(body.inertia.moments, s * s);
    multiply(body.inertia.products, s * s);
    multiply(body.inertia.size, s);
    multiply(body.inertia.radius, s);
  }
  for (JointSpec& joint : out.joints) {
    scale_joint(joint, s);
    for (auto& [name, point] : joint.place.on_body) multiply(point, s);
  }
  for (CouplingSpec& coupling : out.couplings) {
    for (std::size_t i = 0; i < coupling.coordinates.size(); ++i) {
      const CoordinateRef& c = coupling.coordinates[i];
      if (is_length(out, c.joint, c.coordinate)) multiply(coupling.coefficients[i], 1 / s);
    }
  }
  for (ForceSpec& force : out.forces) scale_force(out, force, s);
  for (DriveSpec& drive : out.drives) scale_drive(out, drive, s);
  for (InitialSpec& initial : out.initial) {
    if (!is_length(out, initial.joint, initial.coordinate)) continue;
    for (Number& n : initial.position) multiply(n, s);
    for (Number& n : initial.velocity) multiply(n, s);
  }
  return out;
}

ModelSpec permuted(const ModelSpec& spec, std::uint64_t seed) {
  ModelSpec out = spec;
  std::mt19937_64 random(seed);
  const auto shuffle = [&random](auto& list) {
    for (std::size_t i = list.size(); i > 1; --i) std::swap(list[i - 1], list[random() % i]);
  };
  shuffle(out.bodies);
  shuffle(out.joints);
  shuffle(out.couplings);
  shuffle(out.forces);
  shuffle(out.drives);
  return out;
}

ModelSpec in_parts(const ModelSpec& spec, std::uint64_t seed) {
  const Model model = *build_model(spec).model;
  ModelSpec out = spec;
  RandomSource random(seed);
  const auto weld = [&](const std::string& name, const std::string& first, const std::string& second) {
    JointSpec joint = witness::joint(JointType::kWeld, name, first, second, random.vector(1));
    joint.axis = {};
    joint.merge = true;
    out.joints.push_back(joint);
  };
  for (std::size_t b = 0; b < spec.bodies.size(); ++b) {
    const Body& whole = model.bodies()[b + 1];
    const double share = 0.5 * (1 + random.vector(0.8).x());
    const Pose X_WP(random.rotation(), random.vector(1));
    const auto piece = [&](const std::string& name, const Pose& X, double of_all) {
      const Matrix3d R = X.R.transpose() * whole.X_WB.R;
      BodySpec part = tensor_body(name, X.inverse() * (whole.X_WB * whole.com_m),
                                  of_all * (R * whole.inertia_kgm2 * R.transpose()), of_all * whole.mass_kg);
      part.pose = pose_spec(X);
      return part;
    };
    const std::string name = whole.name, second = name + "_part", third = name + "_bolt";
    if (whole.has_mass) {
      const bool posed = spec.bodies[b].pose.has_value();
      out.bodies[b] = piece(name, whole.X_WB, 1 - share);
      if (!posed) out.bodies[b].pose.reset();
      out.bodies.push_back(piece(second, X_WP, share));
    } else {
      out.bodies.push_back({NameRef(second), {}, {}, {}, pose_spec(X_WP)});
    }
    weld("weld_" + second, name, second);
    const bool has_third = random.chance(0.5);
    if (has_third) {
      out.bodies.push_back(whole.has_mass ? piece(third, Pose(random.rotation(), random.vector(1)), 0)
                                          : BodySpec{NameRef(third), {}, {}, {}, {}});
      weld("weld_" + third, third, random.chance(0.5) ? name : second);
    }
    for (std::size_t j = 0; j < spec.joints.size(); ++j) {
      const JointSpec& joint = spec.joints[j];
      if (joint.frames || !joint.place.drawn || (joint.axis.given() && !joint.axis.drawn)) continue;
      for (NameRef& body : out.joints[j].bodies) {
        if (body.name == name && random.chance(0.6)) body = has_third && random.chance(0.5) ? third : second;
      }
    }
  }
  return out;
}

}  // namespace ferrers::witness
