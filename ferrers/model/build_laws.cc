#include <fmt/format.h>

#include <cmath>

#include "ferrers/core/closest_name.h"
#include "ferrers/model/build_internal.h"

namespace ferrers {
namespace {

constexpr std::string_view kVelocitySuffix = ".velocity";

bool ends_with(std::string_view text, std::string_view end) {
  return text.size() > end.size() && text.substr(text.size() - end.size()) == end;
}

/// The words after "joint." that a law may use for a joint of this type.
std::string readable_words(const JointTypeInfo& info) {
  std::string words;
  const auto add = [&words](std::string_view word) { words += (words.empty() ? "" : ", ") + std::string(word); };
  if (info.coordinates.size() == 1) {
    add("position");
    add("velocity");
  }
  for (const CoordinateInfo& coordinate : info.coordinates) {
    if (coordinate.name != "position") add(coordinate.name);
    if (coordinate.is_scalar() && coordinate.name != "position")
      add(std::string(coordinate.name) + std::string(kVelocitySuffix));
  }
  return words;
}

/// What a word after "joint." reads; nothing where the type has no such value.
std::optional<LawInput> read_word(const JointTypeInfo& info, JointId id, std::string_view word) {
  using Kind = LawInput::Kind;
  if (info.coordinates.size() == 1 && word == "position") return LawInput{Kind::kPosition, {{id, 0}}};
  if (info.coordinates.size() == 1 && word == "velocity") return LawInput{Kind::kVelocity, {{id, 0}}};
  const bool rate = ends_with(word, kVelocitySuffix);
  if (rate) word.remove_suffix(kVelocitySuffix.size());
  for (std::size_t i = 0; i < info.coordinates.size(); ++i) {
    if (info.coordinates[i].name != word) continue;
    const bool is_velocity = rate || !info.coordinates[i].is_scalar();
    return LawInput{is_velocity ? Kind::kVelocity : Kind::kPosition, {{id, static_cast<int>(i)}}};
  }
  return std::nullopt;
}

std::optional<LawInput> read_point(int point, std::string_view word) {
  const bool rate = ends_with(word, kVelocitySuffix);
  if (rate) word.remove_suffix(kVelocitySuffix.size());
  if (word.size() != 1 || word[0] < 'x' || word[0] > 'z') return std::nullopt;
  return LawInput{rate ? LawInput::Kind::kVelocity : LawInput::Kind::kPosition, {{}, point, word[0] - 'x'}};
}

}  // namespace

/// The law, over time and (with kOfState) joint coordinates; parameters become numbers. Nothing, after a message, if
/// wrong.
std::optional<Law> ModelAssembler::law(const LawSpec& spec, LawScope scope, std::optional<Dimension> wanted,
                                       Field field) {
  if (spec.samples) return sampled(spec, field);
  if (spec.expression) return formula(*spec.expression, scope, wanted, field);
  diagnostics_.error("F330", place_or(spec.at, field.owner),
                     fmt::format("'{}' of '{}' has neither a formula nor samples", field.key, field.owner.name));
  return std::nullopt;
}

std::optional<Law> ModelAssembler::sampled(const LawSpec& spec, Field field) {
  const auto& [times, values] = *spec.samples;
  const SourceRange at = place_or(spec.at, field.owner);
  const std::string what = fmt::format("the sampled law '{}' of '{}'", field.key, field.owner.name);
  if (times.size() < 2 || times.size() != values.size()) {
    diagnostics_.error("F330", at, fmt::format("{} needs at least two samples, each a time and a value", what));
    return std::nullopt;
  }
  for (std::size_t k = 0; k < times.size(); ++k) {
    if (!std::isfinite(times[k]) || !std::isfinite(values[k])) {
      diagnostics_.error("F309", at, fmt::format("{} is not finite in sample {}", what, k + 1));
      return std::nullopt;
    }
    if (k > 0 && times[k] <= times[k - 1]) {
      diagnostics_.error("F330", at, fmt::format("the times of {} do not increase at sample {}", what, k + 1));
      return std::nullopt;
    }
  }
  return Law::sampled(times, values);
}

std::optional<Law> ModelAssembler::formula(const Expression& expression, LawScope scope,
                                           std::optional<Dimension> wanted, Field field) {
  std::optional<StateFormula> found = state_formula(expression, scope, wanted, field);
  if (!found) return std::nullopt;
  return Law(found->expression, std::move(found->names), std::move(found->inputs));
}

std::optional<LawInput> ModelAssembler::law_input(const ExpressionName& name, LawScope scope, Field field) {
  if (name.name == "t") return LawInput{};
  const std::size_t dot = name.name.find('.');
  const SourceRange at = place_or(name.at, field.owner);
  if (dot == std::string::npos) {
    const auto known_joint = joint_index_.find(name.name);
    const bool is_coordinate =
        known_joint != joint_index_.end() && model_.is_coordinate(static_cast<std::size_t>(known_joint->second));
    if (is_coordinate && scope == LawScope::kOfState) {
      return LawInput{LawInput::Kind::kPosition, {{JointId(known_joint->second), 0}}};
    }
    std::vector<std::string_view> known = {"t"};
    for (const Parameter& parameter : model_.parameters_) known.push_back(parameter.name);
    for (std::size_t j = model_.coordinates_begin_; j < model_.joints_.size(); ++j) {
      known.push_back(model_.joints_[j].name);
    }
    std::string hint = did_you_mean(name.name, known);
    if (is_coordinate) {
      hint = "a prescribed motion is a law of time only";
    } else if (hint.empty() && known_joint != joint_index_.end()) {
      hint = fmt::format("the joint's coordinate is '{}.position'", name.name);
    } else if (hint.empty() && record_index_.count(name.name) != 0) {
      hint = fmt::format("the point's coordinates are '{0}.x', '{0}.y' and '{0}.z'", name.name);
    }
    const bool has_coordinates = scope == LawScope::kOfState && model_.coordinates_begin_ < model_.joints_.size();
    const char* coordinates = has_coordinates ? " nor a coordinate" : "";
    diagnostics_.error("F403", at,
                       fmt::format("'{}' of '{}' uses '{}', which is neither 't' nor a parameter{}", field.key,
                                   field.owner.name, name.name, coordinates),
                       hint);
    return std::nullopt;
  }
  if (scope == LawScope::kOfState) return dotted_input(name, dot, field);
  diagnostics_.error("F330", at,
                     fmt::format("'{}' of '{}' uses '{}', but a prescribed motion is a law of time only", field.key,
                                 field.owner.name, name.name),
                     "to tie coordinates to each other use 'couplings' or 'constraints'");
  return std::nullopt;
}

/// `joint.position`, `coordinate.velocity`, `point.x`, `point.x.velocity`.
std::optional<LawInput> ModelAssembler::dotted_input(const ExpressionName& name, std::size_t dot, Field field) {
  const SourceRange at = place_or(name.at, field.owner);
  const std::string owner = name.name.substr(0, dot);
  if (const auto point = record_index_.find(owner); point != record_index_.end() && joint_index_.count(owner) == 0) {
    if (const auto input = read_point(point->second, std::string_view(name.name).substr(dot + 1))) return input;
    diagnostics_.error("F305", at,
                       fmt::format("a formula cannot read '{}' of the point '{}'", name.name.substr(dot + 1), owner),
                       "it has x, y, z, x.velocity, y.velocity, z.velocity, in world axes");
    return std::nullopt;
  }
  const std::optional<JointId> id = find_joint(NameRef(name.name.substr(0, dot), at), field);
  if (!id) return std::nullopt;
  const JointTypeInfo& info = joint_type_info(joint(*id).type);
  const std::optional<LawInput> input = read_word(info, *id, std::string_view(name.name).substr(dot + 1));
  if (input) return input;
  const std::string words = readable_words(info);
  diagnostics_.error("F305", at,
                     fmt::format("a formula cannot read '{}' of the {} joint '{}'", name.name.substr(dot + 1),
                                 info.name, name.name.substr(0, dot)),
                     words.empty() ? "this joint has no coordinates" : "it has " + words);
  return std::nullopt;
}

}  // namespace ferrers
