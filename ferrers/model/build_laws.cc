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

bool is_scalar(const CoordinateInfo& info) {
  return info.kind == CoordinateKind::kAngle || info.kind == CoordinateKind::kDisplacement;
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
    add(coordinate.name);
    if (is_scalar(coordinate)) add(std::string(coordinate.name) + std::string(kVelocitySuffix));
  }
  return words;
}

/// What a word after "joint." reads; nothing where the type has no such value.
std::optional<LawInput> read_word(const JointTypeInfo& info, JointId id, std::string_view word) {
  using Kind = LawInput::Kind;
  if (info.coordinates.size() == 1 && word == "position") return LawInput{Kind::kPosition, {id, 0}};
  if (info.coordinates.size() == 1 && word == "velocity") return LawInput{Kind::kVelocity, {id, 0}};
  const bool rate = ends_with(word, kVelocitySuffix);
  if (rate) word.remove_suffix(kVelocitySuffix.size());
  for (std::size_t i = 0; i < info.coordinates.size(); ++i) {
    if (info.coordinates[i].name != word) continue;
    const bool is_velocity = rate || !is_scalar(info.coordinates[i]);
    return LawInput{is_velocity ? Kind::kVelocity : Kind::kPosition, {id, static_cast<int>(i)}};
  }
  return std::nullopt;
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
  check_dimension(expression, wanted, field);
  std::vector<std::string> names;
  std::vector<LawInput> inputs;
  bool usable = true;
  for (const ExpressionName& name : expression.names()) {
    const auto parameter = parameter_index_.find(name.name);
    if (parameter != parameter_index_.end() && name.name != "t") {
      usable = usable && std::isfinite(model_.parameters_[static_cast<std::size_t>(parameter->second)].value);
      continue;
    }
    const std::optional<LawInput> input = law_input(name, scope, field);
    usable = usable && input.has_value();
    if (!input) continue;
    names.push_back(name.name);
    inputs.push_back(*input);
  }
  if (!usable) return std::nullopt;
  const Expression with_numbers = expression.substitute([&](std::string_view name) -> std::optional<Expression> {
    const auto parameter = parameter_index_.find(std::string(name));
    if (name == "t" || parameter == parameter_index_.end()) return std::nullopt;
    return Expression::constant(model_.parameters_[static_cast<std::size_t>(parameter->second)].value);
  });
  const std::optional<double> constant = with_numbers.constant_value();
  if (!constant || std::isfinite(*constant)) return Law(with_numbers, std::move(names), std::move(inputs));
  diagnostics_.error("F408", place_or(expression.at(), field.owner),
                     fmt::format("the formula of '{}' of '{}' has no finite value", field.key, field.owner.name));
  return std::nullopt;
}

std::optional<LawInput> ModelAssembler::law_input(const ExpressionName& name, LawScope scope, Field field) {
  if (name.name == "t") return LawInput{};
  const std::size_t dot = name.name.find('.');
  const SourceRange at = place_or(name.at, field.owner);
  if (dot == std::string::npos) {
    std::vector<std::string_view> known = {"t"};
    for (const Parameter& parameter : model_.parameters_) known.push_back(parameter.name);
    std::string hint = did_you_mean(name.name, known);
    if (hint.empty() && joint_index_.count(name.name) != 0) {
      hint = fmt::format("the joint's coordinate is '{}.position'", name.name);
    }
    diagnostics_.error("F403", at,
                       fmt::format("'{}' of '{}' uses '{}', which is neither 't' nor a parameter", field.key,
                                   field.owner.name, name.name),
                       hint);
    return std::nullopt;
  }
  if (scope == LawScope::kOfState) return joint_input(name, dot, field);
  diagnostics_.error("F330", at,
                     fmt::format("'{}' of '{}' uses '{}', but a prescribed motion is a law of time only", field.key,
                                 field.owner.name, name.name),
                     "to tie joint coordinates to each other use a coupling");
  return std::nullopt;
}

std::optional<LawInput> ModelAssembler::joint_input(const ExpressionName& name, std::size_t dot, Field field) {
  const SourceRange at = place_or(name.at, field.owner);
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
