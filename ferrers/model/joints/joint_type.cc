#include "ferrers/model/joints/joint_type.h"

namespace ferrers {
namespace {

constexpr std::array<const JointTypeInfo*, 16> kTable = {
    &kWeldJoint,      &kRevoluteJoint,   &kPrismaticJoint,   &kScrewJoint,        &kCylindricalJoint, &kUniversalJoint,
    &kSphericalJoint, &kPlanarJoint,     &kPointOnLineJoint, &kPointOnPlaneJoint, &kDistanceJoint,    &kGearMeshJoint,
    &kFreeJoint,      &kAngleCoordinate, &kLengthCoordinate, &kOtherCoordinate};
constexpr std::size_t kOfBodies = 13;

}  // namespace

const JointTypeInfo& joint_type_info(JointType type) { return *kTable[static_cast<std::size_t>(type)]; }

std::span<const JointTypeInfo* const> all_joint_types() {
  return std::span<const JointTypeInfo* const>(kTable).first(kOfBodies);
}

const JointTypeInfo* find_joint_type(std::string_view name) {
  for (const JointTypeInfo* info : all_joint_types()) {
    if (info->name == name) return info;
  }
  return nullptr;
}

std::string coordinate_label(const Joint& joint, std::string_view coordinate) {
  return joint_type_info(joint.type).carries_body ? joint.name + "." + std::string(coordinate) : joint.name;
}

bool is_flipped(const JointTypeInfo& type, const RelativeMotion& m) {
  int moments = 0;
  for (const int component : type.row_components) moments += component >= 3 ? 1 : 0;
  const bool z_reversed = moments >= 2 && m.R_F.col(2).dot(m.R_M.col(2)) < 0;
  const bool x_reversed = moments == 3 && m.R_F.col(0).dot(m.R_M.col(0)) < 0;
  return z_reversed || x_reversed;
}

Eigen::Vector3d reaction_point_from_M(const Joint& joint, const RelativeMotion& m) {
  if (joint.type != JointType::kGearMesh || joint.constants.mesh_holds_as_drawn_only) return Eigen::Vector3d::Zero();
  // The pitch point divides the line of centres in the ratio of the base radii: P − c_2 = e ρ_2 / (ρ_1 − ρ_2) · D.
  const Eigen::Vector3d z = m.R_F.col(2);
  const Eigen::Vector3d centres = m.d - z * z.dot(m.d);
  const double rho_1 = joint.constants.base_radius_1_m, rho_2 = joint.constants.base_radius_2_m;
  return centres * (rho_2 / (rho_1 - rho_2));
}

}  // namespace ferrers
