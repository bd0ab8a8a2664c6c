#include "ferrers/formats/joint_recognition.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "ferrers/math/rotation.h"
#include "ferrers/model/pose_spec.h"

namespace ferrers {
namespace {

using Eigen::Vector3d;

constexpr double kNegligible = 1e-6;  // not a rank decision: masses and lengths that are noise in real files

Vector3d values(const Number3& numbers) { return {numbers[0].value, numbers[1].value, numbers[2].value}; }

bool is_plain(const Number3& numbers) {
  return std::none_of(numbers.begin(), numbers.end(), [](const Number& one) { return one.expression.has_value(); });
}

/// The pose in numbers; nothing where it depends on parameters or turns about an axis.
std::optional<Pose> plain_pose(const PoseSpec& spec) {
  if (!is_plain(spec.position)) return std::nullopt;
  Pose pose;
  pose.p = values(spec.position);
  if (!spec.rotation) return pose;
  if (!spec.rotation->quaternion) return std::nullopt;
  const std::array<Number, 4>& q = *spec.rotation->quaternion;
  Eigen::Quaterniond quaternion(q[0].value, q[1].value, q[2].value, q[3].value);
  for (const Number& one : q) {
    if (one.expression) return std::nullopt;
  }
  if (!(quaternion.norm() > 0)) return std::nullopt;
  pose.R = quaternion.normalized().toRotationMatrix();
  return pose;
}

/// Every name that the specification uses beside the definitions of joints and bodies themselves.
class NamesInUse {
 public:
  explicit NamesInUse(const ModelSpec& spec) {
    for (const CouplingSpec& one : spec.couplings) {
      for (const CoordinateRef& ref : one.coordinates) add(ref);
    }
    for (const ConstraintSpec& one : spec.constraints) add(one.formula);
    add_lagrangian(spec.lagrangian);
    for (const auto& [ref, law] : spec.motions) add(ref), add(law);
    for (const ForceSpec& one : spec.forces) {
      std::visit([this](const auto& element) { add_element(element); }, one.element);
    }
    for (const DriveSpec& one : spec.drives) add_drive(one);
    for (const InitialSpec& one : spec.initial) joints.insert(one.joint.name);
    for (const RecordSpec& one : spec.records) {
      bodies.insert(one.body.name);
      if (one.formula) add(*one.formula);
    }
    for (const EventSpec& one : spec.events) add(one.when);
  }

  std::set<std::string> joints, bodies;

 private:
  void add(const CoordinateRef& ref) { joints.insert(ref.joint.name); }
  void add(const Expression& formula) {
    for (const ExpressionName& one : formula.names()) joints.insert(one.name.substr(0, one.name.find('.')));
  }
  void add(const LawSpec& law) {
    if (law.expression) add(*law.expression);
  }
  void add_lagrangian(const LagrangianSpec& given) {
    for (const auto* one : {&given.kinetic_energy, &given.potential_energy, &given.dissipation}) {
      if (*one) add(**one);
    }
    for (const auto& row : given.mass_matrix) {
      for (const Expression& entry : row) add(entry);
    }
    for (const auto& [ref, force] : given.forces) add(ref), add(force);
  }
  void add_element(const TorsionSpringSpec& one) { add(one.coordinate); }
  void add_element(const JointDampingSpec& one) { add(one.coordinate); }
  void add_element(const SpringSpec& one) { add_bodies(one.bodies); }
  void add_element(const BushingSpec& one) { add_bodies(one.bodies); }
  void add_element(const LoadSpec& one) {
    bodies.insert(one.body.name);
    for (const LawSpec& law : one.components) add(law);
  }
  void add_drive(const DriveSpec& one) {
    if (one.coordinate) add(*one.coordinate);
    if (one.bodies) add_bodies(*one.bodies);
    if (one.quantity) add(*one.quantity);
    for (const auto& [ref, formula] : one.map) add(ref), add(formula);
    for (const LawSpec& law : one.motion) add(law);
    for (const LawSpec& law : one.effort) add(law);
  }
  void add_bodies(const std::array<NameRef, 2>& pair) {
    for (const NameRef& one : pair) bodies.insert(one.name);
  }
};

struct PlainJoint {
  const JointSpec* spec = nullptr;
  Pose X_1F, X_2M;
};

/// Where the axes of two joints on one body meet at a right angle: along z of the one's frame, and of the other's.
std::optional<std::array<double, 2>> right_crossing(const Pose& one, const Pose& other) {
  const Vector3d z1 = one.R.col(2), z2 = other.R.col(2);
  if (std::abs(z1.dot(z2)) > kNegligible) return std::nullopt;
  const Vector3d way = other.p - one.p;
  if (std::abs(way.dot(z1.cross(z2))) > kNegligible) return std::nullopt;
  return std::array<double, 2>{way.dot(z1), -way.dot(z2)};
}

/// What is usual, whatever single parts weigh; 0 where all are zero.
double median_of_nonzero(std::vector<double> values) {
  values.erase(std::remove(values.begin(), values.end(), 0.0), values.end());
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<long>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

class RowFinder {
 public:
  explicit RowFinder(const ModelSpec& spec) : used_(spec) {
    for (const JointSpec& joint : spec.joints) {
      for (const NameRef& body : joint.bodies) ++joint_count_[body.name];
      add_plain(joint);
    }
    find_light_bodies(spec);
  }

  std::vector<RevoluteRow> find(const ModelSpec& spec) {
    std::vector<RevoluteRow> rows;
    std::set<std::string> taken;
    for (const JointSpec& joint : spec.joints) {
      const PlainJoint* first = plain(joint.name.name);
      if (first == nullptr || taken.count(joint.name.name) > 0 || is_continued(*first, taken)) continue;
      RevoluteRow row = row_from(*first, taken);
      for (const std::string& name : row.joints) taken.insert(name);
      if (row.joints.size() > 1) rows.push_back(std::move(row));
    }
    return rows;
  }

 private:
  void add_plain(const JointSpec& joint) {
    const bool bare = !joint.limits && !joint.friction && !joint.stiffness && !joint.misalignment;
    if (joint.type != JointType::kRevolute || !joint.frames || !bare || used_.joints.count(joint.name.name) > 0) return;
    const std::optional<Pose> first = plain_pose((*joint.frames)[0]), second = plain_pose((*joint.frames)[1]);
    if (!first || !second) return;
    plain_[joint.name.name] = {&joint, *first, *second};
    to_[joint.bodies[1].name] = joint.name.name;
    from_[joint.bodies[0].name] = joint.name.name;
  }

  /// Bodies that weigh nothing and that two joints alone hold.
  void find_light_bodies(const ModelSpec& spec) {
    const auto inertia = [](const BodySpec& body) { return values(body.inertia.moments).cwiseAbs().maxCoeff(); };
    const auto mass = [](const BodySpec& body) { return body.mass ? body.mass->value : 0; };
    std::vector<double> masses, inertias;
    for (const BodySpec& body : spec.bodies) masses.push_back(mass(body)), inertias.push_back(inertia(body));
    const double usual_mass = median_of_nonzero(std::move(masses));
    const double usual_inertia = median_of_nonzero(std::move(inertias));
    for (const BodySpec& body : spec.bodies) {
      const bool is_tensor =
          body.inertia.kind == InertiaSpec::Kind::kPoint || body.inertia.kind == InertiaSpec::Kind::kTensor;
      const bool in_numbers = !(body.mass && body.mass->expression) && is_plain(body.inertia.moments);
      if (!is_tensor || !in_numbers || joint_count_[body.name.name] != 2 || used_.bodies.count(body.name.name) > 0) {
        continue;
      }
      const bool weighs_nothing = mass(body) <= kNegligible * usual_mass;
      if (weighs_nothing && inertia(body) <= kNegligible * usual_inertia) light_.insert(body.name.name);
    }
  }

  const PlainJoint* plain(const std::string& joint) const {
    const auto found = plain_.find(joint);
    return found == plain_.end() ? nullptr : &found->second;
  }

  /// The joint that goes on from a joint's second body, which is light.
  const PlainJoint* next(const PlainJoint& joint) const {
    const std::string& between = joint.spec->bodies[1].name;
    const auto found = from_.find(between);
    if (light_.count(between) == 0 || found == from_.end()) return nullptr;
    return plain(found->second);
  }

  bool crosses(const PlainJoint& one, const PlainJoint& other) const {
    return right_crossing(one.X_2M, other.X_1F).has_value();
  }

  /// Whether a row that starts further in front goes through this joint.
  bool is_continued(const PlainJoint& joint, const std::set<std::string>& taken) const {
    const std::string& between = joint.spec->bodies[0].name;
    const auto before = to_.find(between);
    if (light_.count(between) == 0 || before == to_.end() || taken.count(before->second) > 0) return false;
    const PlainJoint* other = plain(before->second);
    return other != nullptr && other != &joint && crosses(*other, joint);
  }

  RevoluteRow row_from(const PlainJoint& first, const std::set<std::string>& taken) const {
    RevoluteRow row;
    row.joints = {first.spec->name.name};
    const PlainJoint* second = next(first);
    if (second == nullptr || taken.count(second->spec->name.name) > 0 || !crosses(first, *second)) return row;
    if (second->spec->bodies[1].name == first.spec->bodies[0].name) return row;
    row.joints.push_back(second->spec->name.name);
    row.between.push_back(first.spec->bodies[1].name);
    const PlainJoint* third = next(*second);
    if (third == nullptr || third->spec->bodies[1].name == first.spec->bodies[0].name || !crosses(*second, *third)) {
      return row;
    }
    // Both neighbours meet the second axis in the same point of it.
    const double to_first = (*right_crossing(first.X_2M, second->X_1F))[1];
    const double to_third = (*right_crossing(second->X_2M, third->X_1F))[0];
    if (std::abs(to_first - to_third) > kNegligible) return row;
    row.type = JointType::kSpherical;
    row.joints.push_back(third->spec->name.name);
    row.between.push_back(second->spec->bodies[1].name);
    return row;
  }

  NamesInUse used_;
  std::map<std::string, int> joint_count_;
  std::map<std::string, PlainJoint> plain_;
  std::map<std::string, std::string> to_, from_;  ///< Body to plain joint that ends or starts there.
  std::set<std::string> light_;
};

/// The one joint that moves like the row.
JointSpec merged(const RevoluteRow& row, const std::vector<const JointSpec*>& joints) {
  std::vector<std::array<Pose, 2>> frames;
  for (const JointSpec* one : joints)
    frames.push_back({*plain_pose((*one->frames)[0]), *plain_pose((*one->frames)[1])});
  const std::array<double, 2> crossing = *right_crossing(frames[0][1], frames[1][0]);
  const Pose X_M1F2 = frames[0][1].inverse() * frames[1][0];
  Pose X_aF = frames[0][0];  // on the first body, at the point where the axes meet
  X_aF.p = X_aF * Vector3d(0, 0, crossing[0]);
  if (row.type == JointType::kUniversal) {
    const Vector3d second_axis = frames[0][0].R * X_M1F2.R.col(2);
    X_aF.R = frame_from_zx(frames[0][0].R.col(2), second_axis);
  }
  Pose X_ab;  // all of the row at zero
  for (const std::array<Pose, 2>& one : frames) X_ab = X_ab * one[0] * one[1].inverse();
  JointSpec joint;
  joint.name = joints.front()->name;
  joint.type = row.type;
  joint.bodies = {joints.front()->bodies[0], joints.back()->bodies[1]};
  joint.frames = {pose_spec(X_aF, joint.name.at), pose_spec(X_ab.inverse() * X_aF, joint.name.at)};
  return joint;
}

}  // namespace

std::vector<RevoluteRow> find_revolute_rows(const ModelSpec& spec) { return RowFinder(spec).find(spec); }

void merge_revolute_rows(ModelSpec& spec, const std::vector<RevoluteRow>& rows, Diagnostics& diagnostics) {
  std::map<std::string, const JointSpec*> by_name;
  for (const JointSpec& joint : spec.joints) by_name[joint.name.name] = &joint;
  std::map<std::string, JointSpec> first_of_row;
  std::set<std::string> gone_joints, gone_bodies;
  for (const RevoluteRow& row : rows) {
    std::vector<const JointSpec*> joints;
    for (const std::string& name : row.joints) joints.push_back(by_name.at(name));
    JointSpec joint = merged(row, joints);
    diagnostics.notice("F603", joint.name.at,
                       fmt::format("the revolute joints '{}' become one {} joint '{}'", fmt::join(row.joints, "', '"),
                                   row.type == JointType::kSpherical ? "spherical" : "universal", joint.name.name));
    gone_joints.insert(row.joints.begin() + 1, row.joints.end());
    gone_bodies.insert(row.between.begin(), row.between.end());
    first_of_row.emplace(joint.name.name, std::move(joint));
  }
  std::vector<JointSpec> joints;
  for (JointSpec& joint : spec.joints) {
    const auto found = first_of_row.find(joint.name.name);
    if (found != first_of_row.end()) {
      joints.push_back(std::move(found->second));
    } else if (gone_joints.count(joint.name.name) == 0) {
      joints.push_back(std::move(joint));
    }
  }
  spec.joints = std::move(joints);
  const auto is_gone = [&](const BodySpec& body) { return gone_bodies.count(body.name.name) > 0; };
  spec.bodies.erase(std::remove_if(spec.bodies.begin(), spec.bodies.end(), is_gone), spec.bodies.end());
}

}  // namespace ferrers
