#pragma once

#include <string>
#include <utility>
#include <vector>

#include "ferrers/redundancy/analysis.h"

/// Problem: a rod between two ball joints may spin about itself. The mobility counts that freedom, the mechanism's
/// function does not.
///
/// Given: a system at an assembled state. Wanted: the spins of one body (with what is welded to it) that move no other
/// body, no joint's point, no coupled and no driven coordinate. The body has joints with two or more others: the
/// rotation of a shaft in bearings of one frame is its function.
/// Method: per body, the null space of its joints' rows on its own six velocities with the joints' points held. Cost:
/// linear in the model.
namespace ferrers {

struct IdleFreedom {
  std::string body;
  std::vector<std::string> joints;      ///< That let it spin.
  Vector3d axis = Vector3d::Zero();     ///< Unit vector, world, at the state.
  Vector3d point_m = Vector3d::Zero();  ///< A point of the axis, world.
};

std::vector<IdleFreedom> idle_freedoms(const System& system, const State& state, const RedundancyReport& report);

/// The same question about joints as they might be.
class SpinAnalyzer {
 public:
  /// Keeps references to `system` and `report`.
  SpinAnalyzer(const System& system, const State& state, const RedundancyReport& report);

  int body_count() const { return static_cast<int>(joints_of_.size()); }  ///< Welded bodies count once.
  const std::vector<int>& joints_of(int body) const { return joints_of_[body]; }
  /// The (welded) bodies of a joint.
  std::pair<int, int> bodies_of(int joint) const { return bodies_of_[joint]; }
  bool is_fixed(int body) const { return body == ground_; }
  /// Idle spins of one body, as unit twists (angular, linear at the world point `p`), where of some joints combinations
  /// of rows are set free: (joint, rows of the joint × released).
  MatrixXd spins(int body, const std::vector<std::pair<int, const MatrixXd*>>& released, Vector3d& p) const;
  std::vector<IdleFreedom> find() const;

 private:
  struct ExtraRow {  // of a coupling or a drive: wrenches on the second of two bodies, opposite on the first
    struct Part {
      std::pair<int, int> bodies;
      Vector3d p;
      Wrench W;
    };
    std::vector<Part> parts;
  };
  void add_extra_rows();
  const System& system_;
  const RedundancyReport& report_;
  PositionKinematics pos_;
  JointWrenches wrenches_;
  std::vector<std::string> name_of_;
  std::vector<std::vector<int>> joints_of_, extra_of_;
  std::vector<std::pair<int, int>> bodies_of_;
  std::vector<ExtraRow> extra_;
  int ground_ = 0;
};

}  // namespace ferrers
