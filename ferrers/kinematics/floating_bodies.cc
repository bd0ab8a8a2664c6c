#include "ferrers/kinematics/floating_bodies.h"

#include <algorithm>

namespace ferrers {

std::vector<FloatingBody> find_floating_bodies(const System& system) {
  const Model& model = *system.model;
  std::vector<FloatingBody> all;
  const auto is_taken = [&](const std::string& name) {
    const auto has_name = [&](const auto& one) { return one.name == name; };
    const std::vector<Joint>& joints = model.joints();
    const std::vector<RecordedPoint>& records = model.records();
    return std::any_of(joints.begin(), joints.end(), has_name) ||
           std::any_of(records.begin(), records.end(), has_name) || std::any_of(all.begin(), all.end(), has_name);
  };
  for (std::size_t i = 1; i < system.nodes.size(); ++i) {
    if (system.topology->forest.nodes[i].joint.valid()) continue;
    std::string name = model.body(system.nodes[i].body).name;
    while (is_taken(name)) name.insert(0, "body_");
    all.push_back({static_cast<int>(i), std::move(name)});
  }
  return all;
}

}  // namespace ferrers
