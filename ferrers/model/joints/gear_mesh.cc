#include "ferrers/model/joints/joint_type.h"

namespace ferrers {
namespace {

constexpr std::array<int, 1> kRows = {0};

// Directions of the line of centres seen from each gear.
template <class T>
void angles(const JointConstants&, const BasicRelativeMotion<T>& m, BasicJet<T>* out) {
  out[0] = atan2(along_first(m, m.R_F.col(1)), along_first(m, m.R_F.col(0)));
  out[1] = atan2(along_second(m, m.R_M.col(1)), along_second(m, m.R_M.col(0)));
}

// With signed base radii ρ_i, ρ = ρ_1 − ρ_2, centre distance D and L = √(D² − ρ²), the length of the common tangent
// plus what is wound on the base circles is constant:
//   phi = s (L − ρ acos(ρ/D)) + ρ_1 (α − θ_1) − ρ_2 (α − θ_2) + offset,
// α the direction of the line of centres, θ_i the gears' rotations, s the sign of (line of action)·(line of centres).
template <class T>
void rows(const JointConstants& c, const BasicRelativeMotion<T>& m, const T* winding, BasicJet<T>* out) {
  if (c.mesh_holds_as_drawn_only) {
    out[0] = along_first(m, m.R_F * c.line_of_action_F.template cast<T>());
    return;
  }
  using std::acos, std::sqrt;
  BasicJet<T> direction[2];
  angles(c, m, direction);
  const BasicJet<T> distance = sqrt(square(along_first(m, m.R_F.col(0))) + square(along_first(m, m.R_F.col(1))));
  const double rho = c.base_radius_1_m - c.base_radius_2_m;
  const T D = distance.value;
  const T L = sqrt(D * D - rho * rho);
  const BasicJet<T> tangent = chain(distance, L - rho * acos(rho / D), L / D, rho * rho / (D * D * L));
  out[0] = c.mesh_side * tangent + c.base_radius_1_m * continued(direction[0], winding[0]) -
           c.base_radius_2_m * continued(direction[1], winding[1]) + c.mesh_offset_m;
}

}  // namespace

/// Involute teeth in contact: base radii constant, centre distance free. F and M sit at the gears' centres with z along
/// their axes; the row is the force along the line of action (x as drawn).
const JointTypeInfo kGearMeshJoint = {.type = JointType::kGearMesh,
                                      .name = "gear_mesh",
                                      .placement = PlacementRule::kMesh,
                                      .row_components = kRows,
                                      .winding_count = 2,
                                      .rows = {rows<double>, rows<Traced>},
                                      .angles = angles};

}  // namespace ferrers
