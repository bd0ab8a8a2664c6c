#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "ferrers/model/joint_change.h"
#include "ferrers/redundancy/analysis.h"

/// Problem: which rows a designer can set free are not single rows but what one joint carries less than another.
///
/// Given: the self-stresses Z over all joints' rows. Wanted: per group of joints that share self-stresses the changes
/// of one joint that release rows (or combinations of them) on which Z has full row rank; what is rank deficient there
/// would add mobility and is left out.
/// Units: Z in scaled units (moments over the characteristic length).
namespace ferrers {

/// One line of the table of changes.
struct ReleaseKind {
  JointType from, to;
  std::span<const int> components;  ///< Of the joint's wrench (`kComponentNames`) that may be released.
  bool one_of = false;              ///< One direction among the components instead of all of them.
  std::span<const int> also = {};   ///< Released with it.
  /// How readily a designer makes the change, 0…1: weighs the conditioning in the ranking.
  double preference = 1;
  bool is_bearing = true;  ///< The joint loses a bearing's function: where ground is one side, a little less liked.
  int count = 1;           ///< As how many changes it counts; more than one: only where nothing else will do.
  std::string_view says;   ///< What it costs and gains.
};
std::span<const ReleaseKind> release_kinds();

struct ReleaseCandidate {
  int joint = 0;
  int kind = 0;                           ///< Index in `release_kinds`.
  Vector3d direction = Vector3d::Zero();  ///< As `JointChange` wants it.
  MatrixXd rows;                          ///< rows of the joint × k: orthonormal combinations that are released.
  double preference = 1;                  ///< Of the kind, ground and floating members considered.
  std::vector<std::vector<std::pair<int, double>>> block;  ///< k rows of Z, sparse over the group's columns.
  int k() const { return static_cast<int>(rows.cols()); }
};

/// Self-stresses that share joints, and what can be changed there.
struct ReleaseGroup {
  std::vector<int> columns;                                               ///< Of Z.
  std::vector<int> joints;                                                ///< Loaded by them, ascending.
  std::vector<std::pair<int, std::vector<std::pair<int, double>>>> rows;  ///< Z of all rows: (row, entries by column).
  std::vector<ReleaseCandidate> candidates;                               ///< By joint.
  int size() const { return static_cast<int>(columns.size()); }
};

/// A change that would help but that other parts of the model forbid.
struct ReleaseObstacle {
  std::string joint;
  JointType to = JointType::kRevolute;
  std::string reason;
};

/// Groups up to this many self-stresses are measured by an orthonormal basis of theirs, so that nothing depends on the
/// basis given; larger ones by the given (sparse, unit) columns.
inline constexpr int kLargestOrthonormal = 200;

/// U (upper triangular) with Z U⁻¹ orthonormal. For groups up to `kLargestOrthonormal`.
MatrixXd triangular_factor(const ReleaseGroup& group);

/// Rows of Z, dense, in that basis: B U⁻¹.
MatrixXd orthonormal_rows(const std::vector<std::vector<std::pair<int, double>>>& rows, const MatrixXd& U);

/// Cost: linear in the nonzeros of Z, times the kinds of changes.
std::vector<ReleaseGroup> find_release_groups(const System& system, const State& state, const RedundancyReport& report,
                                              std::vector<ReleaseObstacle>& obstacles);

}  // namespace ferrers
