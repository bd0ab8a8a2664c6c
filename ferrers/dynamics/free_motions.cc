#include "ferrers/dynamics/free_motions.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "ferrers/math/rank.h"

namespace ferrers {
namespace {

std::vector<std::string> names(const System& system, const std::vector<JointCoordinate>& coordinates) {
  std::vector<std::string> names;
  for (const JointCoordinate& one : coordinates) names.push_back(system.model->coordinate_name(one));
  return names;
}

std::string describe(const System& system, const FreeMotions& found, const MatrixXd& free) {
  std::vector<std::string> moving = names(system, found.moving);
  if (moving.empty()) {  // what moves has no scalar coordinate
    for (int v = 0; v < system.nv; ++v) {
      if (!is_negligible(free.row(v).norm(), 1.0)) moving.push_back(system.coordinate_names[v]);
    }
  }
  std::string text =
      fmt::format("the drives leave {} motion(s) free; still moving: {}", found.count, fmt::join(moving, " "));
  const auto reach = static_cast<int>(found.to_drive.size());
  if (reach > 0) {
    text += fmt::format("; a drive with a 'motion' on '{}' would determine {}",
                        fmt::join(names(system, found.to_drive), "', '"),
                        reach < found.count ? "a part of it"
                        : found.count > 1   ? "them"
                                            : "it");
  }
  if (reach < found.count) text += "; what moves in a spherical or free joint takes drives on points or distances";
  return text;
}

}  // namespace

FreeMotions find_free_motions(const System& system, const Scaling& scaling, const State& state,
                              const PositionKinematics& pos, const VelocityKinematics& vel, const MatrixXd& free) {
  FreeMotions found;
  found.count = static_cast<int>(free.cols());
  std::vector<Eigen::RowVectorXd> rows;
  for (std::size_t j = 0; j < system.model->joints().size(); ++j) {
    const JointTypeInfo& type = joint_type_info(system.model->joints()[j].type);
    for (int k = 0; k < static_cast<int>(type.coordinates.size()); ++k) {
      const bool angle = type.coordinates[k].kind == CoordinateKind::kAngle;
      if (!type.coordinates[k].is_scalar()) continue;
      const CoordinateAccess access = system.access({JointId(j), k});
      const Jet jet = measure_coordinate(system, access, state, pos, vel);
      Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(system.nv);
      add_coordinate_row(system, access, pos, jet, angle ? scaling.length_m : 1.0, row);
      row = row * scaling.columns.asDiagonal() * free;
      if (is_negligible(row.norm(), 1.0)) continue;
      found.moving.push_back({JointId(j), k});
      rows.push_back(std::move(row));
    }
  }
  if (!rows.empty()) {
    MatrixXd rates(static_cast<long>(rows.size()), free.cols());
    for (std::size_t i = 0; i < rows.size(); ++i) rates.row(static_cast<long>(i)) = rows[i];
    const int reach = decide_rank(compute_singular_values(rates), 1.0).rank;
    for (const int i : choose_independent_rows(rates, reach)) found.to_drive.push_back(found.moving[i]);
  }
  found.message = describe(system, found, free);
  return found;
}

}  // namespace ferrers
