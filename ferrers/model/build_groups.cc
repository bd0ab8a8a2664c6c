#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "ferrers/model/build_internal.h"
#include "ferrers/model/mass_properties.h"

/// Rigid groups: bodies that welds with `merge` hold are one body of the model. Poses follow the welds from the first
/// body of a group. A weld in a loop of welds stays a joint: it shares its loads with the others, and may not fit them.
namespace ferrers {
namespace {

/// For each link, whether leaving it out would part what it joins. Depth first, without recursion (Tarjan).
std::vector<bool> find_bridges(int bodies, const std::vector<std::array<int, 2>>& links) {
  std::vector<std::vector<int>> at(static_cast<std::size_t>(bodies));
  for (std::size_t i = 0; i < links.size(); ++i) {
    for (const int body : links[i]) at[static_cast<std::size_t>(body)].push_back(static_cast<int>(i));
  }
  struct Visit {
    int body, by;          // the link that led there
    std::size_t next = 0;  // of its links
  };
  std::vector<bool> bridge(links.size(), false);
  std::vector<int> order(static_cast<std::size_t>(bodies), -1), low = order;
  int count = 0;
  for (int start = 0; start < bodies; ++start) {
    if (order[static_cast<std::size_t>(start)] >= 0) continue;
    std::vector<Visit> way = {{start, -1}};
    order[static_cast<std::size_t>(start)] = low[static_cast<std::size_t>(start)] = count++;
    while (!way.empty()) {
      Visit& here = way.back();
      const auto body = static_cast<std::size_t>(here.body);
      if (here.next < at[body].size()) {
        const int by = at[body][here.next++];
        if (by == here.by) continue;
        const std::array<int, 2>& link = links[static_cast<std::size_t>(by)];
        const int other = link[0] == here.body ? link[1] : link[0];
        const auto there = static_cast<std::size_t>(other);
        if (order[there] >= 0) {
          low[body] = std::min(low[body], order[there]);
        } else {
          order[there] = low[there] = count++;
          way.push_back({other, by});
        }
        continue;
      }
      const Visit done = here;
      way.pop_back();
      if (way.empty()) break;
      const auto before = static_cast<std::size_t>(way.back().body);
      low[before] = std::min(low[before], low[body]);
      bridge[static_cast<std::size_t>(done.by)] = low[body] > order[before];
    }
  }
  return bridge;
}

}  // namespace

/// Those whose bodies and frames are known; messages about the others.
std::vector<GroupWeld> ModelAssembler::place_merged_welds() {
  std::vector<GroupWeld> welds;
  for (const JointSpec& spec : spec_->joints) {
    if (!spec.merge) continue;
    if (spec.type != JointType::kWeld || spec.stiffness || spec.misalignment || spec.friction) {
      diagnostics_.error(
          "F211", spec.name.at,
          fmt::format("'{}' cannot be merged: it is no weld, or has stiffness or misalignment", spec.name.name),
          "leave out 'merge'");
      continue;
    }
    Joint weld;
    Diagnostics before;
    std::swap(before, diagnostics_);
    joint_is_placed_.assign(1, false);
    build_joint(spec, weld);
    std::swap(before, diagnostics_);
    // A weld with errors stays a joint, and has its messages as such.
    if (before.has_errors() || !joint_is_placed_[0] || weld.first == weld.second) continue;
    diagnostics_.append(before);
    welds.push_back({&spec, {weld.first.index(), weld.second.index()}, weld.X_1F * weld.X_2M.inverse()});
  }
  return welds;
}

/// Groups and the poses in them, as these welds make them.
void ModelAssembler::follow_welds(const std::vector<GroupWeld>& welds) {
  const std::size_t count = model_.bodies_.size();
  std::vector<std::vector<std::size_t>> held(count);
  for (std::size_t w = 0; w < welds.size(); ++w) {
    for (const int body : welds[w].bodies) held[static_cast<std::size_t>(body)].push_back(w);
  }
  groups_.assign(count, {-1, {}});
  for (std::size_t first = 0; first < count; ++first) {
    if (groups_[first].first >= 0) continue;
    groups_[first] = {static_cast<int>(first), {}};
    std::vector<std::size_t> reached = {first};
    for (std::size_t i = 0; i < reached.size(); ++i) {
      const std::size_t at = reached[i];
      for (const std::size_t w : held[at]) {
        const bool forward = welds[w].bodies[0] == static_cast<int>(at);
        const auto next = static_cast<std::size_t>(welds[w].bodies[forward ? 1 : 0]);
        if (groups_[next].first >= 0) continue;
        groups_[next] = {static_cast<int>(first),
                         groups_[at].X_BP * (forward ? welds[w].X_12 : welds[w].X_12.inverse())};
        reached.push_back(next);
      }
    }
  }
}

/// Those that no loop of welds, or of welds and other joints of one group, goes through: only these are merged, or a
/// redundancy would be hidden.
std::vector<GroupWeld> ModelAssembler::welds_outside_loops(const std::vector<GroupWeld>& welds) {
  follow_welds(welds);
  std::vector<std::array<int, 2>> links;
  for (const GroupWeld& weld : welds) links.push_back(weld.bodies);
  for (const JointSpec& spec : spec_->joints) {
    if (spec.merge) continue;
    const auto a = body_index_.find(spec.bodies[0].name), b = body_index_.find(spec.bodies[1].name);
    if (a == body_index_.end() || b == body_index_.end()) continue;
    const auto group = [this](int body) { return groups_[static_cast<std::size_t>(body)].first; };
    if (group(a->second) == group(b->second)) links.push_back({a->second, b->second});
  }
  const std::vector<bool> bridges = find_bridges(static_cast<int>(model_.bodies_.size()), links);
  std::vector<GroupWeld> outside;
  for (std::size_t w = 0; w < welds.size(); ++w) {
    if (bridges[w]) outside.push_back(welds[w]);
  }
  return outside;
}

/// Makes the specification that the rest is built from.
void ModelAssembler::leave_out(const std::vector<GroupWeld>& welds) {
  std::map<const JointSpec*, int> merged;
  for (const GroupWeld& weld : welds) {
    merged[weld.spec] = groups_[static_cast<std::size_t>(weld.bodies[0])].first;
  }
  auto rest = std::make_shared<ModelSpec>(*spec_);
  rest->joints.clear();
  std::vector<int> places(spec_->joints.size() + spec_->lagrangian.coordinates.size(), -1);
  for (std::size_t j = 0; j < spec_->joints.size(); ++j) {
    const JointSpec& spec = spec_->joints[j];
    const auto found = merged.find(&spec);
    if (found != merged.end()) {
      merged_welds_[found->second].push_back(spec.name.name);
      continue;
    }
    places[j] = static_cast<int>(rest->joints.size());
    rest->joints.push_back(spec);
  }
  for (std::size_t k = 0; k < spec_->lagrangian.coordinates.size(); ++k) {
    places[spec_->joints.size() + k] = static_cast<int>(rest->joints.size() + k);
  }
  for (auto one = joint_index_.begin(); one != joint_index_.end();) {
    const int place = places[static_cast<std::size_t>(one->second)];
    if (place < 0) {
      one = joint_index_.erase(one);
    } else {
      (one++)->second = place;
    }
  }
  spec_ = std::move(rest);
}

void ModelAssembler::merge_welded_parts() {
  const std::vector<GroupWeld> welds = place_merged_welds();
  if (welds.empty()) return;
  const std::vector<GroupWeld> merged = welds_outside_loops(welds);
  follow_welds(merged);
  leave_out(merged);
}

/// One body of several: masses added up, inertias about the common mass centre.
Body ModelAssembler::group_of(const std::vector<int>& members) {
  Body group = body(BodyId(members.front()));
  if (members.size() == 1) return group;
  const auto place = [this](int member) -> const Pose& { return groups_[static_cast<std::size_t>(member)].X_BP; };
  group.merged_welds = std::move(merged_welds_[members.front()]);
  group.mass_kg = 0;
  Vector3d moment = Vector3d::Zero();
  for (const int member : members) {
    const Body& part = body(BodyId(member));
    group.parts.push_back({part.name, place(member), part.X_WB});
    group.has_mass = group.has_mass && part.has_mass;
    group.mass_kg += part.mass_kg;
    moment += part.mass_kg * (place(member) * part.com_m);
  }
  group.com_m = group.mass_kg > 0 ? Vector3d(moment / group.mass_kg) : group.com_m;
  group.inertia_kgm2.setZero();
  for (const int member : members) {
    const Body& part = body(BodyId(member));
    const Vector3d c = place(member) * part.com_m - group.com_m;
    group.inertia_kgm2 += rotate_inertia(part.inertia_kgm2, place(member).R) +
                          part.mass_kg * (c.squaredNorm() * Matrix3d::Identity() - c * c.transpose());
  }
  return group;
}

/// Bodies become groups, and whatever stands on a part stands on its group.
void ModelAssembler::put_groups_together() {
  if (groups_.empty()) return;
  std::vector<std::vector<int>> members(groups_.size());
  for (std::size_t i = 0; i < groups_.size(); ++i) {
    members[static_cast<std::size_t>(groups_[i].first)].push_back(static_cast<int>(i));
  }
  std::vector<Body> bodies;
  std::vector<int> place(groups_.size(), 0);
  for (const std::vector<int>& group : members) {
    if (group.empty()) continue;
    for (const int member : group) place[static_cast<std::size_t>(member)] = static_cast<int>(bodies.size());
    bodies.push_back(group_of(group));
  }
  // The pose of what `id` named, which then names the group.
  const auto move = [&](BodyId& id) -> const Pose& {
    const auto part = static_cast<std::size_t>(id.index());
    id = BodyId(place[part]);
    return groups_[part].X_BP;
  };
  const auto move_frame = [&](BodyId& id, Pose& X) { X = move(id) * X; };
  const auto move_point = [&](BodyId& id, Vector3d& p) { p = move(id) * p; };
  for (Joint& joint : model_.joints_) {
    move_frame(joint.first, joint.X_1F);
    move_frame(joint.second, joint.X_2M);
  }
  for (ForceElement& force : model_.forces_) {
    if (auto* spring = std::get_if<Spring>(&force.element)) {
      move_point(spring->first, spring->point_1_m);
      move_point(spring->second, spring->point_2_m);
    } else if (auto* bushing = std::get_if<Bushing>(&force.element)) {
      move_frame(bushing->first, bushing->X_1F);
      move_frame(bushing->second, bushing->X_2M);
    } else if (auto* load = std::get_if<Load>(&force.element)) {
      const Pose& X = move(load->body);
      load->point_m = X * load->point_m;
      load->R_BP = X.R;
    }
  }
  for (Drive& drive : model_.drives_) {
    if (drive.kind != Drive::Kind::kDistance && drive.kind != Drive::Kind::kPoint) continue;
    if (drive.first.valid()) move_point(drive.first, drive.point_1_m);
    if (drive.second.valid()) move_point(drive.second, drive.point_2_m);
  }
  for (RecordedPoint& point : model_.records_) move_point(point.body, point.point_m);
  model_.bodies_ = std::move(bodies);
}

}  // namespace ferrers
