#include "ferrers/kinematics/coordinates.h"

#include "ferrers/core/checks.h"

namespace ferrers {
namespace {

// A component of ω or of the point's velocity of a cut spherical or free joint: a rate without a value.
Jet measure_rate(const RelativeMotion& m, int index) {
  Jet jet;
  const Vector3d axis = m.R_F.col(index % 3);
  if (index < 3) {
    jet.rate = axis.dot(m.w);
    jet.bias = axis.dot(m.alpha - m.w1.cross(m.w));
    jet.W.head<3>() = axis;
  } else {
    jet.rate = axis.dot(m.v);
    jet.bias = axis.dot(m.a - 2 * m.w1.cross(m.v));
    jet.W.tail<3>() = axis;
  }
  return jet;
}

}  // namespace

Jet measure_coordinate(const System& system, const CoordinateAccess& access, const State& state,
                       const PositionKinematics& pos, const VelocityKinematics& acc) {
  if (access.in_tree) {
    Jet jet;
    jet.value = access.q >= 0 ? state.q[access.q] : 0;
    jet.rate = state.v[access.v];
    return jet;
  }
  if (access.point >= 0) {
    const RelativeMotion motion = compute_relative_motion(system.points[access.point], pos, acc);
    return along_first(motion, Vector3d::Unit(access.axis));
  }
  const CutJoint& cut = system.cuts[access.cut];
  const RelativeMotion motion = compute_relative_motion(cut.frames, pos, acc);
  if (!cut.type->coordinate_jets) return measure_rate(motion, access.jet);
  Jet jets[6];
  cut.type->coordinate_jets(cut.constants, motion, jets);
  Jet jet = jets[access.jet];
  return access.winding >= 0 ? continued(jet, state.winding[access.winding]) : jet;
}

void clear_coordinate_row(const System& system, const CoordinateAccess& access, Eigen::Ref<Eigen::RowVectorXd> row) {
  if (access.in_tree) {
    row[access.v] = 0;
    return;
  }
  for (const FramePair::PathEntry& entry : system.frames(access).path) {
    const Node& node = system.nodes[entry.node];
    row.segment(node.v, node.nv).setZero();
  }
}

void add_coordinate_row(const System& system, const CoordinateAccess& access, const PositionKinematics& pos,
                        const Jet& jet, double scale, Eigen::Ref<Eigen::RowVectorXd> row) {
  if (access.in_tree) {
    row[access.v] += scale;
  } else {
    add_jet_row(system, system.frames(access), pos, jet.W, scale, row);
  }
}

namespace {

// Rotation (and, for a free joint, position) of a cut joint without scalar coordinates.
void measure_rotation(const JointTypeInfo& type, const RelativeMotion& m, JointMotion& out) {
  const Eigen::Quaterniond u(Matrix3d(m.R_F.transpose() * m.R_M));
  const double sign = u.w() < 0 ? -1 : 1;
  double* q = out.q + type.quaternion_at;
  q[0] = sign * u.w();
  for (int i = 0; i < 3; ++i) q[1 + i] = sign * u.vec()[i];
  const Vector3d w = m.R_F.transpose() * m.w;
  const Vector3d alpha = m.R_F.transpose() * (m.alpha - m.w1.cross(m.w));
  for (int i = 0; i < 3; ++i) {
    out.v[i] = w[i];
    out.vdot[i] = alpha[i];
  }
  if (type.nv < 6) return;
  const Vector3d p = m.R_F.transpose() * m.d, v = m.R_F.transpose() * m.v;
  const Vector3d a = m.R_F.transpose() * (m.a - 2 * m.w1.cross(m.v));
  for (int i = 0; i < 3; ++i) {
    out.q[i] = p[i];
    out.v[3 + i] = v[i];
    out.vdot[3 + i] = a[i];
  }
}

}  // namespace

JointMotion measure_joint(const System& system, JointId id, const State& state, const VectorXd& vdot,
                          const PositionKinematics& pos, const VelocityKinematics& acc) {
  JointMotion out;
  const int node_index = system.topology->node_of_joint.at(id.index());
  if (node_index >= 0) {
    const Node& node = system.nodes[node_index];
    for (int i = 0; i < node.nq; ++i) out.q[i] = state.q[node.q + i];
    for (int i = 0; i < node.nv; ++i) {
      out.v[i] = state.v[node.v + i];
      out.vdot[i] = vdot[node.v + i];
    }
    return out;
  }
  const CutJoint& cut = system.cuts[system.topology->closure_of_joint[id.index()]];
  const RelativeMotion motion = compute_relative_motion(cut.frames, pos, acc);
  if (cut.type->quaternion_at >= 0) {
    measure_rotation(*cut.type, motion, out);
    return out;
  }
  if (!cut.type->coordinate_jets) return out;
  Jet jets[6];
  cut.type->coordinate_jets(cut.constants, motion, jets);
  for (int i = 0, slot = 0; i < cut.type->nv; ++i) {
    if (cut.type->coordinates[i].kind == CoordinateKind::kAngle) {
      jets[i] = continued(jets[i], state.winding[cut.winding + slot++]);
    }
    out.q[i] = jets[i].value;
    out.v[i] = jets[i].rate;
    out.vdot[i] = jets[i].bias;
  }
  return out;
}

}  // namespace ferrers
