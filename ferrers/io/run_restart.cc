#include "ferrers/io/run_restart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "ferrers/kinematics/coordinates.h"
#include "ferrers/kinematics/floating_bodies.h"

namespace ferrers {
namespace {

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> cells(1);
  for (const char c : line) {
    if (c == ',') {
      cells.emplace_back();
    } else if (c != '\r' && c != '"') {
      cells.back() += c;
    }
  }
  return cells;
}

using Row = std::map<std::string, double>;

// Distance in time of a line's first cell, t; infinite where that is no number.
double distance_in_time(const std::string& line, double t) {
  char* end = nullptr;
  const double at = std::strtod(line.c_str(), &end);
  return end != line.c_str() && std::isfinite(at) ? std::abs(at - t) : INFINITY;
}

// The header and one complete line, which ends with a line end: the last one, or the one nearest in time.
std::string read_row(const std::filesystem::path& file, const std::optional<double>& t, Row& row) {
  std::ifstream in(file);
  if (!in) return fmt::format("'{}' cannot be read", file.string());
  std::string line, last;
  if (!std::getline(in, line)) return fmt::format("'{}' is empty", file.string());
  const std::vector<std::string> names = split(line);
  double nearest = INFINITY;
  while (std::getline(in, line)) {
    if (in.eof()) break;
    const double distance = t ? distance_in_time(line, *t) : 0;
    if (t && !(distance < nearest)) continue;
    nearest = distance;
    last = line;
  }
  const std::vector<std::string> cells = split(last);
  if (last.empty() || cells.size() != names.size()) return fmt::format("'{}' has no complete row", file.string());
  for (std::size_t i = 0; i < names.size(); ++i) {
    char* end = nullptr;
    const double value = std::strtod(cells[i].c_str(), &end);
    if (!cells[i].empty() && *end == '\0' && std::isfinite(value)) row[names[i]] = value;
  }
  return "";
}

class Reader {
 public:
  Reader(const System& system, const Row& row) : system_(system), row_(row), state_(make_drawn_state(system)) {}

  std::string read() {
    state_.t = value("t");
    const auto& joints = system_.model->joints();
    for (std::size_t j = 0; j < joints.size(); ++j) take(JointId(j), joints[j]);
    for (const FloatingBody& body : find_floating_bodies(system_)) take_floating(body);
    if (!missing_.empty())
      return fmt::format("there is no column '{}' with a number in the row that is read", missing_);
    PositionKinematics pos = make_position_kinematics(system_);
    VelocityKinematics vel = make_velocity_kinematics(system_);
    compute_positions(system_, state_.q, pos);
    compute_velocities(system_, pos, state_.q, state_.v, vel);
    accept_winding(system_, pos, state_);
    for (std::size_t j = 0; j < joints.size(); ++j) {
      const JointTypeInfo& type = joint_type_info(joints[j].type);
      const JointMotion motion = measure_joint(system_, JointId(j), state_, VectorXd::Zero(system_.nv), pos, vel);
      for (int i = 0; i < type.nq; ++i) {
        const double wanted = value(position_column(joints[j], i));
        if (!(std::abs(motion.q[i] - wanted) <= 1e-6 * std::max(1.0, std::abs(wanted)))) {
          return fmt::format("joint '{}' is not where '{}' says: the run was made with another model", joints[j].name,
                             position_column(joints[j], i));
        }
      }
    }
    return "";
  }

  const State& state() const { return state_; }

 private:
  static std::string position_column(const Joint& joint, int i) {
    return coordinate_label(joint, joint_type_info(joint.type).position_names[i]);
  }

  double value(const std::string& column) {
    const auto found = row_.find(column);
    if (found != row_.end()) return found->second;
    if (missing_.empty()) missing_ = column;
    return 0;
  }

  void take(JointId id, const Joint& joint) {
    const JointTypeInfo& type = joint_type_info(joint.type);
    const int closure = system_.topology->closure_of_joint[id.index()];
    if (closure >= 0) {
      const CutJoint& cut = system_.cuts[static_cast<std::size_t>(closure)];
      int angle = 0;
      for (int i = 0; i < type.nv && angle < type.winding_count; ++i) {
        if (type.coordinates[i].kind == CoordinateKind::kAngle) {
          state_.winding[cut.winding + angle++] = value(position_column(joint, i));
        }
      }
      return;
    }
    const int n = system_.topology->node_of_joint[id.index()];
    if (n < 0) return;
    take_node(system_.nodes[static_cast<std::size_t>(n)],
              [&joint](std::string_view name) { return coordinate_label(joint, name); });
  }

  void take_floating(const FloatingBody& body) {
    take_node(system_.nodes[static_cast<std::size_t>(body.node)],
              [&body](std::string_view name) { return body.name + "." + std::string(name); });
  }

  template <typename Label>
  void take_node(const Node& node, Label label) {
    for (int i = 0; i < node.nq; ++i) {
      state_.q[node.q + i] = value(label(node.type->position_names[i]));
    }
    for (int i = 0; i < node.nv; ++i) {
      state_.v[node.v + i] = value(label(node.type->coordinates[i].name) + ".velocity");
    }
  }

  const System& system_;
  const Row& row_;
  State state_;
  std::string missing_;
};

bool has_switches(const Model& model) {
  return std::any_of(model.events().begin(), model.events().end(),
                     [](const Event& event) { return event.action == EventSpec::Action::kSwitch; });
}

// What `summary.json` tells beside the state. False: there is none that belongs to the last row.
bool read_switches(const std::filesystem::path& file, double t, RestartResult& result) {
  std::ifstream in(file);
  const nlohmann::json summary = nlohmann::json::parse(in, nullptr, false);
  if (!summary.is_object() || summary.value("t_reached", nlohmann::json()) != t) return false;
  const nlohmann::json off = summary.value("drives_off", nlohmann::json());
  if (!off.is_array()) return false;
  for (const nlohmann::json& name : off) {
    if (!name.is_string()) return false;
    result.drives_off.push_back(name.get<std::string>());
  }
  for (const nlohmann::json& event : summary.value("events", nlohmann::json::array())) {
    if (!event.is_object() || event.value("t", nlohmann::json()) != t) continue;
    const nlohmann::json name = event.value("event", nlohmann::json());
    if (name.is_string()) result.events_acted.push_back(name.get<std::string>());
  }
  return true;
}

// Which drives are on where the state is: only events of the model change that.
std::string read_drives(const Model& model, const std::filesystem::path& folder, RestartResult& result) {
  if (model.events().empty()) return "";
  const std::filesystem::path file = folder / "summary.json";
  const bool told = read_switches(file, result.state->t, result);
  if (!told && has_switches(model)) {
    return fmt::format(
        "'{}' does not tell which drives events had switched off at t = {:g} s (a killed run leaves no summary): run "
        "it again from the start, or go on with a model without 'switch' events",
        file.string(), result.state->t);
  }
  for (const std::string& name : result.drives_off) {
    const auto& drives = model.drives();
    if (std::any_of(drives.begin(), drives.end(), [&](const Drive& drive) { return drive.name == name; })) continue;
    return fmt::format(
        "'{}' has a drive '{}' switched off, which the model does not have: the run was made with "
        "another model",
        file.string(), name);
  }
  return "";
}

RestartResult read_state(const System& system, const std::filesystem::path& folder, const std::optional<double>& t) {
  RestartResult result;
  const std::filesystem::path file = folder / "result.csv";
  Row row;
  result.error = read_row(file, t, row);
  if (!result.error.empty()) return result;
  Reader reader(system, row);
  result.error = reader.read();
  if (!result.error.empty()) {
    result.error = fmt::format("'{}': {}", file.string(), result.error);
    return result;
  }
  result.state = reader.state();
  return result;
}

}  // namespace

RestartResult read_restart(const System& system, const std::filesystem::path& folder) {
  RestartResult result = read_state(system, folder, std::nullopt);
  if (!result.state) return result;
  result.error = read_drives(*system.model, folder, result);
  if (!result.error.empty()) result.state.reset();
  return result;
}

RestartResult read_stored_state(const System& system, const std::filesystem::path& folder, double t) {
  return read_state(system, folder, t);
}

}  // namespace ferrers
