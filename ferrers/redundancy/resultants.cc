#include "ferrers/redundancy/resultants.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

namespace ferrers {
namespace {

// Bodies joined by welds count as one: the first of them.
std::vector<int> rigid_groups(const Model& model) {
  std::vector<int> group(model.bodies().size());
  std::iota(group.begin(), group.end(), 0);
  const auto find = [&](int i) {
    while (group[i] != i) i = group[i];
    return i;
  };
  for (const Joint& joint : model.joints()) {
    if (joint.type != JointType::kWeld) continue;
    const int a = find(static_cast<int>(joint.first.index())), b = find(static_cast<int>(joint.second.index()));
    group[std::max(a, b)] = std::min(a, b);
  }
  for (std::size_t i = 0; i < group.size(); ++i) group[i] = find(static_cast<int>(i));
  return group;
}

class Finder {
 public:
  Finder(const System& system, const State& state, const RedundancyReport& report)
      : model_(*system.model), report_(report), group_(rigid_groups(model_)), Z_(report.self_stresses) {
    PositionKinematics pos = make_position_kinematics(system);
    compute_positions(system, state.q, pos);
    wrenches_ = compute_joint_frame_wrenches(system, state, pos);
  }

  std::vector<UniqueResultant> find() {
    std::map<std::pair<int, int>, std::vector<int>> between;
    std::map<int, std::vector<int>> on;
    for (std::size_t j = 0; j < model_.joints().size(); ++j) {
      const Joint& joint = model_.joints()[j];
      const int a = group_[joint.first.index()], b = group_[joint.second.index()];
      if (a == b || !report_.reactions[j].participates) continue;
      between[{std::min(a, b), std::max(a, b)}].push_back(static_cast<int>(j));
      for (const int body : {a, b}) on[body].push_back(static_cast<int>(j));
    }
    for (const auto& [bodies, joints] : between) {
      if (joints.size() >= 2) judge(joints, bodies.second, bodies.first);
    }
    std::set<std::vector<int>> told;
    for (const auto& [bodies, joints] : between) told.insert(joints);
    for (const auto& [body, joints] : on) {
      if (body != 0 && joints.size() >= 3 && told.count(joints) == 0) judge(joints, body, -1);
    }
    return std::move(found_);
  }

 private:
  // What the self-stresses put into the sum, scaled: moments over L, at the first joint's point. Shape: 6 × loading
  // ones.
  MatrixXd stress_sum(const std::vector<int>& joints, int on) const {
    const Vector3d at = wrenches_[joints.front()].p_M;
    std::map<int, Wrench> sums;
    for (const int j : joints) {
      const JointFrameWrenches& joint = wrenches_[j];
      const bool second = group_[model_.joints()[j].second.index()] == on;
      for (int i = 0; i < report_.rows.count[j]; ++i) {
        Wrench w = joint.T.col(i) * (second ? 1.0 : -1.0);
        w.head<3>() += (joint.p_M - at).cross(w.tail<3>());
        w.head<3>() /= report_.characteristic_length_m;
        using Iterator = Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator;
        for (Iterator it(Z_, report_.rows.first[j] + i); it; ++it) {
          auto& sum = sums.try_emplace(static_cast<int>(it.col()), Wrench::Zero()).first->second;
          sum += w * it.value();
        }
      }
    }
    MatrixXd out(6, static_cast<long>(sums.size()));
    long k = 0;
    for (const auto& [column, sum] : sums) out.col(k++) = sum;
    return out;
  }

  void judge(const std::vector<int>& joints, int on, int from) {
    UniqueResultant r;
    r.unique_dimension = 6 - analyze_rank(stress_sum(joints, on), 1.0).decision.rank;
    int most = 0;
    for (const int j : joints) {
      const ReactionUniqueness& one = report_.reactions[j];
      most = std::max(most, one.unique_dimension + 6 - one.rows);
      r.joints.push_back(one.joint);
    }
    r.separate_dimension = std::min(6, most);
    if (r.unique_dimension <= r.separate_dimension) return;
    r.on_body = model_.bodies()[on].name;
    if (from >= 0) r.from_body = model_.bodies()[from].name;
    found_.push_back(std::move(r));
  }

  const Model& model_;
  const RedundancyReport& report_;
  std::vector<int> group_;
  Eigen::SparseMatrix<double, Eigen::RowMajor> Z_;
  JointWrenches wrenches_;
  std::vector<UniqueResultant> found_;
};

}  // namespace

std::vector<UniqueResultant> find_unique_resultants(const System& system, const State& state,
                                                    const RedundancyReport& report) {
  if (report.redundant == 0) return {};
  return Finder(system, state, report).find();
}

}  // namespace ferrers
