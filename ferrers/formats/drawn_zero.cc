#include "ferrers/formats/drawn_zero.h"

#include <cmath>
#include <memory>

#include "ferrers/kinematics/motion.h"
#include "ferrers/kinematics/state.h"
#include "ferrers/model/joints/joint_type.h"
#include "ferrers/model/pose_spec.h"

namespace ferrers {
namespace {

constexpr double kAtZero = 1e-9;  // m, rad

/// The part of a relative pose that the joint moves by; nothing for joints whose frames cannot be moved by it.
std::optional<Pose> own_motion(JointType type, const Pose& X_FM) {
  const double angle = std::atan2(X_FM.R(1, 0), X_FM.R(0, 0));
  const Matrix3d turn = Eigen::AngleAxisd(angle, Vector3d::UnitZ()).toRotationMatrix();
  const Vector3d& p = X_FM.p;
  switch (type) {
    case JointType::kRevolute:
      return Pose(turn, Vector3d::Zero());
    case JointType::kPrismatic:
      return Pose(Matrix3d::Identity(), Vector3d(0, 0, p.z()));
    case JointType::kCylindrical:
      return Pose(turn, Vector3d(0, 0, p.z()));
    case JointType::kPlanar:
      return Pose(turn, Vector3d(p.x(), p.y(), 0));
    case JointType::kSpherical:
      return Pose(X_FM.R, Vector3d::Zero());
    case JointType::kFree:
      return X_FM;
    default:
      return std::nullopt;
  }
}

}  // namespace

std::optional<DrawnZero> move_zeros_to_drawing(const Model& model) {
  if (!model.couplings().empty()) return std::nullopt;
  const auto system = make_system(std::make_shared<const Model>(model));
  PositionKinematics pos = make_position_kinematics(*system);
  compute_positions(*system, system->drawn_q, pos);
  DrawnZero out{model.spec(), {}};
  for (std::size_t j = 0; j < model.coordinates_begin(); ++j) {
    const Joint& joint = model.joints()[j];
    const Pose X_WF = body_pose(*system, pos, joint.first) * joint.X_1F;
    const Pose X_WM = body_pose(*system, pos, joint.second) * joint.X_2M;
    const std::optional<Pose> X = own_motion(joint.type, X_WF.inverse() * X_WM);
    if (!X || (X->p.norm() < kAtZero && rotation_log(X->R).norm() < kAtZero)) continue;
    JointSpec& spec = out.spec.joints[model.spec_index(JointId(j))];
    spec.place = spec.axis = spec.axis2 = {};
    spec.x.reset();
    spec.frames = {pose_spec(model.part(spec.bodies[0].name).X_BP.inverse() * joint.X_1F * *X, spec.name.at),
                   pose_spec(model.part(spec.bodies[1].name).X_BP.inverse() * joint.X_2M, spec.name.at)};
    if (joint.limits) {
      const double by = joint.type == JointType::kPrismatic ? X->p.z() : std::atan2(X->R(1, 0), X->R(0, 0));
      spec.limits = {Number((*joint.limits)[0] - by), Number((*joint.limits)[1] - by)};
    }
    out.moved.push_back(joint.name);
  }
  if (out.moved.empty()) return std::nullopt;
  return out;
}

}  // namespace ferrers
