#include <fmt/format.h>

#include <cmath>

#include "ferrers/formats/mjcf_import.h"

namespace ferrers::mjcf {
namespace {

std::size_t positions_of(const TreeJoint& joint) { return joint.scalar() ? 1 : joint.kind == JointKind::kBall ? 4 : 7; }

std::size_t velocities_of(const TreeJoint& joint) {
  return joint.scalar() ? 1 : joint.kind == JointKind::kBall ? 3 : 6;
}

std::vector<Number> numbers_of(std::initializer_list<Vector3d> vectors) {
  std::vector<Number> all;
  for (const Vector3d& v : vectors) all.insert(all.end(), {Number(v.x()), Number(v.y()), Number(v.z())});
  return all;
}

void add_quaternion(const Eigen::Quaterniond& q, std::vector<Number>& to) {
  to.insert(to.end(), {Number(q.w()), Number(q.x()), Number(q.y()), Number(q.z())});
}

Eigen::Quaterniond quaternion_at(const double* wxyz) {
  Eigen::Quaterniond q(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
  if (!(q.norm() > 1e-14)) return Eigen::Quaterniond::Identity();
  return q.normalized();
}

/// Position and velocity of one joint. Angular velocities of MuJoCo are in the moving body's axes, ours in the first
/// body's.
InitialSpec state_of(const TreeJoint& joint, const double* q, const double* v) {
  InitialSpec initial;
  initial.joint = {joint.name, joint.element.main_at()};
  initial.at = joint.element.main_at();
  if (joint.scalar()) {
    initial.position = {Number(*q)};
    if (v != nullptr) initial.velocity = {Number(*v)};
    return initial;
  }
  if (joint.kind == JointKind::kBall) {
    const Eigen::Quaterniond turn = quaternion_at(q);
    add_quaternion(turn, initial.position);
    if (v != nullptr) initial.velocity = numbers_of({turn * Vector3d(v)});
    return initial;
  }
  const Eigen::Quaterniond turn = quaternion_at(q + 3);
  initial.position = numbers_of({Vector3d(q)});
  add_quaternion(turn, initial.position);
  if (v != nullptr) initial.velocity = numbers_of({turn * Vector3d(v + 3), Vector3d(v)});
  return initial;
}

struct Counts {
  std::size_t positions = 0, velocities = 0;
};

Counts count_coordinates(const Tree& tree) {
  Counts counts;
  for (const TreeBody& body : tree.bodies) {
    for (const TreeJoint& joint : body.joints) {
      counts.positions += joint.added ? 0 : positions_of(joint);
      counts.velocities += joint.added ? 0 : velocities_of(joint);
    }
  }
  return counts;
}

bool has_constraints(const Import& import) {
  std::size_t joints = 0;
  for (std::size_t i = 1; i < import.tree.bodies.size(); ++i) {
    joints += std::max<std::size_t>(1, import.tree.bodies[i].joints.size());
  }
  const ModelSpec& spec = import.result.spec;
  return spec.joints.size() > joints || !spec.couplings.empty() || !spec.constraints.empty();
}

void add_state(Import& import, const std::vector<double>* q, const std::vector<double>* v, bool guess) {
  std::size_t at_q = 0, at_v = 0;
  for (const TreeBody& body : import.tree.bodies) {
    for (const TreeJoint& joint : body.joints) {
      if (joint.added) continue;
      InitialSpec initial = state_of(joint, q->data() + at_q, v != nullptr ? v->data() + at_v : nullptr);
      at_q += positions_of(joint);
      at_v += velocities_of(joint);
      initial.guess = guess;
      if (!joint.replaced) import.spec().initial.push_back(std::move(initial));
    }
  }
}

/// A joint that is drawn more than half a turn from zero: the drawing alone does not tell how many turns.
void add_far_references(Import& import) {
  for (const TreeBody& body : import.tree.bodies) {
    for (const TreeJoint& joint : body.joints) {
      if (joint.kind != JointKind::kHinge || std::abs(joint.ref) < 3.14159) continue;
      InitialSpec initial = state_of(joint, &joint.ref, nullptr);
      initial.guess = true;
      import.spec().initial.push_back(std::move(initial));
    }
  }
}

}  // namespace

void add_initial_state(Import& import) {
  std::vector<Element> keys;
  for (const Element& section : import.root.children("keyframe")) {
    for (const Element& key : section.children("key")) keys.push_back(key);
  }
  if (keys.empty()) return add_far_references(import);
  for (const Element& key : keys) key.mark_read_with_all();
  const Element& key = keys.front();
  const Counts counts = count_coordinates(import.tree);
  const auto q = Attributes(key).numbers("qpos", counts.positions, counts.positions);
  const auto v = Attributes(key).numbers("qvel", counts.velocities, counts.velocities);
  if (!q) return;
  const bool guess = has_constraints(import);
  add_state(import, &*q, v && !guess ? &*v : nullptr, guess);
  const std::string others = keys.size() > 1 ? fmt::format("; {} more are not read", keys.size() - 1) : "";
  key.diagnostics().notice(
      "F603", key.at(),
      guess ? fmt::format("the positions of the key '{}' are where the assembly starts{}", key.text_of("name"), others)
            : fmt::format("the key '{}' is the initial state{}", key.text_of("name"), others));
  if (!v || !guess) return;
  key.diagnostics().notice("F601", key.attribute_at("qvel"),
                           "the velocities of a key are not read where there are constraints");
}

}  // namespace ferrers::mjcf
