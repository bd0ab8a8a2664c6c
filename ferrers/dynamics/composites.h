#pragma once

#include <vector>

#include "ferrers/dynamics/dynamics_model.h"

/// Problem: mass matrix and bias forces of a tree of bodies.
///
/// Given: poses, twists and bias accelerations of all nodes. Wanted: M and h of M vdot + h = tau. Method: the subtree
/// outboard of each joint moves as one composite body; its momentum for a unit rate of the joint, worked on by every
/// joint between it and ground, is a column of M [featherstone2008, ch. 6], and what its bias acceleration takes, by
/// the joint itself, an entry of h. In world axes about the nodes' origins. Cost: O(bodies · depth). T: `double` or
/// `Traced`.
namespace ferrers {

template <class T>
struct BasicComposite {
  using Vector = Eigen::Matrix<T, 3, 1>;
  T mass = 0;
  Vector first_moment;        ///< Σ m ρ about the node's origin.
  Vector diagonal, products;  ///< Inertia about the node's origin: xx, yy, zz and yz, xz, xy of its tensor.
  Vector moment, force;       ///< Inertia and gravity wrench of the subtree.
};

/// I w for a symmetric tensor.
template <class T>
Eigen::Matrix<T, 3, 1> times(const BasicComposite<T>& c, const Eigen::Matrix<T, 3, 1>& w) {
  const auto &d = c.diagonal, &p = c.products;
  return {d[0] * w[0] + p[2] * w[1] + p[1] * w[2], p[2] * w[0] + d[1] * w[1] + p[0] * w[2],
          p[1] * w[0] + p[0] * w[1] + d[2] * w[2]};
}

/// R I Rᵀ, only its six entries; written out because it is most of the work of a small mechanism.
template <class T>
void rotate_inertia(const Eigen::Matrix<T, 3, 3>& R, const Eigen::Matrix<T, 3, 3>& I, BasicComposite<T>& c) {
  T X[3][3];
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) X[i][j] = R(i, 0) * I(0, j) + R(i, 1) * I(1, j) + R(i, 2) * I(2, j);
  }
  const auto entry = [&](int i, int j) { return X[i][0] * R(j, 0) + X[i][1] * R(j, 1) + X[i][2] * R(j, 2); };
  c.diagonal = {entry(0, 0), entry(1, 1), entry(2, 2)};
  c.products = {entry(1, 2), entry(0, 2), entry(0, 1)};
}

/// The single bodies, about their node's origin O: inertia in world axes, and the wrench of what their bias
/// acceleration takes, with I about O: I α + ω × I ω + m r × (a_O − g) and m (a_O − g + α × r + ω × (ω × r)).
/// `inertias_N`: about the node's origin, node axes. `vel` null: no wrench.
template <class T>
void load_composites(const DynamicsModel& model, const std::vector<Matrix3d>& inertias_N,
                     const BasicPositionKinematics<T>& pos, const BasicVelocityKinematics<T>* vel,
                     std::vector<BasicComposite<T>>& composites) {
  using Vector = Eigen::Matrix<T, 3, 1>;
  const Vector gravity = as_constants<T>(model.system->model->gravity());
  for (int i = 1; i < model.system->body_nodes; ++i) {
    const NodeInertia& body = model.inertias[i];
    const auto& R = pos.nodes[i].R;
    BasicComposite<T>& c = composites[i];
    c.mass = body.mass_kg;
    c.first_moment.noalias() = R * as_constants<T>(Vector3d(body.mass_kg * body.com_N));
    rotate_inertia<T>(R, as_constants<T>(inertias_N[i]), c);
    if (vel == nullptr) continue;
    const auto& k = vel->nodes[i];
    const Vector& s = c.first_moment;
    const Vector a = k.a - gravity;
    c.moment = times<T>(c, k.alpha) + k.w.cross(times<T>(c, k.w)) + s.cross(a);
    c.force = c.mass * a + k.alpha.cross(s) + k.w.cross(k.w.cross(s));
  }
}

/// Adds a child's composite to its parent's: everything moves from the child's origin to the parent's, r away.
template <class T>
void shift_to_parent(const BasicComposite<T>& child, const Eigen::Matrix<T, 3, 1>& r, BasicComposite<T>& parent) {
  // I' = I − [r]×[s]× − [s]×[r]× − m [r]×[r]× = I + 2 (t·r) 1 − t rᵀ − r tᵀ with t = s + ½ m r.
  const Eigen::Matrix<T, 3, 1> t = child.first_moment + T(0.5) * child.mass * r;
  const T twice = T(2) * t.dot(r);
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    parent.diagonal[i] += child.diagonal[i] + twice - T(2) * t[i] * r[i];
    parent.products[i] += child.products[i] - t[j] * r[k] - r[j] * t[k];
  }
  parent.mass += child.mass;
  parent.first_moment += child.first_moment + child.mass * r;
  parent.moment += child.moment + r.cross(child.force);
  parent.force += child.force;
}

/// Calls `write_mass(k, column, value)` for k up to `column`'s node and `write_bias(k, value)`. `composites` are those
/// of `load_composites`, and are added up.
template <class T, class WriteMass, class WriteBias>
void sweep_composites(const System& system, const BasicPositionKinematics<T>& pos,
                      std::vector<BasicComposite<T>>& composites, WriteMass write_mass, WriteBias write_bias) {
  using Vector = Eigen::Matrix<T, 3, 1>;
  for (int i = system.body_nodes - 1; i > 0; --i) {
    const Node& node = system.nodes[i];
    const BasicComposite<T>& c = composites[i];
    for (int column = node.v; column < node.v + node.nv; ++column) {
      const Vector w = pos.S[column].template head<3>(), v = pos.S[column].template tail<3>();
      const Vector force = c.mass * v - c.first_moment.cross(w);
      Vector moment = times<T>(c, w) + c.first_moment.cross(v);
      for (int at = i;;) {
        const Node& inboard = system.nodes[at];
        for (int k = inboard.v; k < inboard.v + inboard.nv; ++k) {
          write_mass(k, column, moment.dot(pos.S[k].template head<3>()) + force.dot(pos.S[k].template tail<3>()));
        }
        if (inboard.parent <= 0) break;
        moment += (pos.nodes[at].p - pos.nodes[inboard.parent].p).cross(force);
        at = inboard.parent;
      }
      write_bias(column, c.moment.dot(w) + c.force.dot(v));
    }
    if (node.parent > 0) {
      shift_to_parent<T>(c, pos.nodes[i].p - pos.nodes[node.parent].p, composites[node.parent]);
    }
  }
}

}  // namespace ferrers
