#pragma once

#include <memory>
#include <string>
#include <vector>

#include "ferrers/dynamics/dynamics_model.h"

/// Problem: a run must say where a joint leaves its `limits`; it is not stopped there (stops are contact).
///
/// Given: the states of a run in the order of time. Wanted: per joint and limit, when it is first crossed, how often,
/// and how far the coordinate gets beyond. What happens between two states comes from the cubic through both states'
/// values and rates: fourth order in their spacing. Cost: O(joints with limits) per state.
namespace ferrers {

/// One limit that a joint crossed.
struct LimitCrossing {
  std::string joint;
  bool upper = false;  ///< Which of the two.
  double limit = 0;    ///< rad or m.
  double t = 0;        ///< When it was first crossed, s; of the first state if that is beyond already.
  int times = 1;       ///< How often it was left to the outside.
  double excess = 0;   ///< Farthest beyond, rad or m.
  double excess_t = 0;
};

class LimitWatch {
 public:
  explicit LimitWatch(std::shared_ptr<const DynamicsModel> model);

  bool any() const { return !watched_.empty(); }
  /// Kinematics computed at `state`; times must not go back.
  void observe(const State& state, const PositionKinematics& pos, const VelocityKinematics& vel);
  void observe(const State& state);  ///< With kinematics of its own.
  double last_t() const { return t_; }
  /// In the order of the model file, lower limit first.
  std::vector<LimitCrossing> crossings() const;

 private:
  struct Watched {
    JointId joint;
    CoordinateAccess access;
    double limits[2];
    double value = 0, rate = 0;  ///< At the last state.
    int count[2] = {0, 0};
    double t[2] = {}, excess[2] = {}, excess_t[2] = {};
  };
  void follow(Watched& one, int side, double t, double value, double rate);
  struct End {
    double t, beyond, rate;  ///< s; beyond the limit, rad or m; per s.
  };
  static void pass(Watched& one, int side, const End& from, const End& to);

  std::shared_ptr<const DynamicsModel> model_;
  std::vector<Watched> watched_;
  PositionKinematics pos_;
  VelocityKinematics vel_;
  bool started_ = false;
  double t_ = 0;
};

/// A sentence for a run's notices.
std::string describe(const LimitCrossing& crossing);

}  // namespace ferrers
