#include <fmt/format.h>

#include <algorithm>

#include "ferrers/core/closest_name.h"
#include "ferrers/model/build_internal.h"

namespace ferrers {
namespace {

constexpr std::string_view kGroundName = "ground";

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }

bool is_valid_name(std::string_view name) {
  if (name.empty() || !is_letter(name.front())) return false;
  return std::all_of(name.begin(), name.end(), [](char c) { return is_letter(c) || (c >= '0' && c <= '9'); });
}

}  // namespace

void ModelAssembler::check_name(const NameRef& name, std::string_view kind) {
  if (is_valid_name(name.name)) return;
  diagnostics_.error("F301", name.at, fmt::format("'{}' is not a valid name for a {}", name.name, kind),
                     "a name starts with a letter or '_' and goes on with letters, digits and '_'");
}

bool ModelAssembler::add_name(NameIndex& index, const NameRef& name, int position, std::string_view kind) {
  check_name(name, kind);
  if (name.name == kGroundName && kind == "body") {
    diagnostics_.error("F301", name.at, "'ground' is the name of the fixed body, which always exists",
                       "call this body something else");
    return false;
  }
  if (index.emplace(name.name, position).second) return true;
  diagnostics_.error("F302", name.at, fmt::format("the {} '{}' is given twice", kind, name.name),
                     "every name stands for one thing");
  return false;
}

void ModelAssembler::index_names() {
  const auto index_all = [this](const auto& specs, NameIndex& index, std::string_view kind, int first = 0) {
    for (const auto& spec : specs) add_name(index, spec.name, first++, kind);
  };
  index_all(spec_->bodies, body_index_, "body", 1);
  body_index_[std::string(kGroundName)] = 0;
  index_all(spec_->joints, joint_index_, "joint");
  index_all(spec_->lagrangian.coordinates, joint_index_, "coordinate", static_cast<int>(spec_->joints.size()));
  NameIndex formulas;
  int points = 0;
  for (const RecordSpec& record : spec_->records) {
    if (record.formula) {
      add_name(formulas, record.name, 0, "recorded formula");
      const bool is_column = record.name.name == "t" || record.name.name == "energy";
      if (!is_column && joint_index_.count(record.name.name) == 0) continue;
      diagnostics_.error("F302", record.name.at,
                         fmt::format("the recorded formula '{}' has the name of {}", record.name.name,
                                     is_column ? "a column of the results" : "a joint or coordinate"),
                         "columns of the results are told apart by their names");
    } else {
      add_name(record_index_, record.name, points++, "recorded point");
    }
  }
  index_all(spec_->drives, drive_index_, "drive");
  NameIndex couplings, forces, events;
  index_all(spec_->couplings, couplings, "coupling");
  index_all(spec_->constraints, couplings, "constraint");
  index_all(spec_->lagrangian.function_constraints, couplings, "constraint");
  index_all(spec_->forces, forces, "force element");
  index_all(spec_->events, events, "event");
  const auto check_row_name = [this](const NameRef& name, std::string_view kind) {
    if (joint_index_.count(name.name) == 0) return;
    diagnostics_.error("F302", name.at, fmt::format("the {} '{}' has the name of a joint", kind, name.name),
                       "constraint rows are named after joints, couplings and constraints, so their names must differ");
  };
  for (const CouplingSpec& coupling : spec_->couplings) check_row_name(coupling.name, "coupling");
  for (const ConstraintSpec& constraint : spec_->constraints) check_row_name(constraint.name, "constraint");
}

std::optional<int> ModelAssembler::find(const NameIndex& index, const NameRef& name, std::string_view kind, Field field,
                                        std::string_view code) {
  const auto found = index.find(name.name);
  if (found != index.end()) return found->second;
  std::vector<std::string_view> known;
  for (const auto& [other, position] : index) known.push_back(other);
  std::sort(known.begin(), known.end());
  diagnostics_.error(
      code, place_or(name.at, field.owner),
      fmt::format("'{}' of '{}' names the {} '{}', which does not exist", field.key, field.owner.name, kind, name.name),
      did_you_mean(name.name, known));
  return std::nullopt;
}

std::optional<BodyId> ModelAssembler::find_body(const NameRef& name, Field field) {
  const std::optional<int> index = find(body_index_, name, "body", field, "F303");
  return index ? std::optional(BodyId(*index)) : std::nullopt;
}

std::optional<JointId> ModelAssembler::find_joint(const NameRef& name, Field field) {
  const std::optional<int> index = find(joint_index_, name, "joint", field, "F304");
  return index ? std::optional(JointId(*index)) : std::nullopt;
}

std::optional<JointCoordinate> ModelAssembler::find_coordinate(const CoordinateRef& ref, Field field) {
  const std::optional<JointId> id = find_joint(ref.joint, field);
  if (!id) return std::nullopt;
  const JointTypeInfo& info = joint_type_info(joint(*id).type);
  std::vector<std::string_view> known;
  for (const CoordinateInfo& coordinate : info.coordinates) {
    if (coordinate.is_scalar()) known.push_back(coordinate.name);
  }
  const SourceRange at = place_or(ref.joint.at, field.owner);
  if (known.empty()) {
    diagnostics_.error(
        "F305", at,
        fmt::format("'{}' of '{}' needs a coordinate, but the {} joint '{}' has no angle or displacement", field.key,
                    field.owner.name, info.name, ref.joint.name));
    return std::nullopt;
  }
  if (ref.coordinate.empty() && known.size() == 1) return JointCoordinate{*id, 0};
  for (std::size_t i = 0; i < known.size(); ++i) {
    if (known[i] == ref.coordinate) return JointCoordinate{*id, static_cast<int>(i)};
  }
  const std::string choices = fmt::format("{}", fmt::join(known, ", "));
  if (ref.coordinate.empty()) {
    diagnostics_.error("F305", at,
                       fmt::format("'{}' of '{}' must say which coordinate of the joint '{}' is meant", field.key,
                                   field.owner.name, ref.joint.name),
                       "it has " + choices);
  } else {
    diagnostics_.error(
        "F305", at, fmt::format("the {} joint '{}' has no coordinate '{}'", info.name, ref.joint.name, ref.coordinate),
        "it has " + choices);
  }
  return std::nullopt;
}

std::optional<BodyPair> ModelAssembler::find_pair(const std::array<NameRef, 2>& names, const NameRef& owner) {
  const std::optional<BodyId> first = find_body(names[0], {"bodies", owner});
  const std::optional<BodyId> second = find_body(names[1], {"bodies", owner});
  if (!first || !second) return std::nullopt;
  if (*first == *second) {
    diagnostics_.error("F316", place_or(names[1].at, owner),
                       fmt::format("'{}' connects the body '{}' with itself", owner.name, names[0].name),
                       "name two different bodies");
    return std::nullopt;
  }
  return BodyPair{owner, {*first, *second}, names};
}

}  // namespace ferrers
