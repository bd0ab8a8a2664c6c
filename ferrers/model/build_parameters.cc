#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "ferrers/core/closest_name.h"
#include "ferrers/model/build_internal.h"

namespace ferrers {
namespace {

constexpr double kLargestNumber = 1e50;  // its sixth power is still a number
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

bool is_reserved(std::string_view name) { return name == "t" || name == "pi"; }

}  // namespace

SourceRange place_or(SourceRange at, const NameRef& owner) { return at.known() ? at : owner.at; }

SourceRange place_of(const Number& n, Field field) {
  if (n.expression && n.expression->at().known()) return n.expression->at();
  return place_or(n.at, field.owner);
}

void ModelAssembler::build_parameters() {
  for (const ParameterSpec& spec : spec_->parameters) {
    const int position = static_cast<int>(model_.parameters_.size());
    add_name(parameter_index_, spec.name, position, "parameter");
    if (is_reserved(spec.name.name)) {
      diagnostics_.error("F301", spec.name.at, fmt::format("a parameter cannot be called '{}'", spec.name.name),
                         "'t' is the time and 'pi' the number in every formula");
    }
    Parameter parameter;
    parameter.name = spec.name.name;
    parameter.value = kUnknown;
    parameter.dimension = spec.dimension;
    parameter.doc = spec.doc;
    model_.parameters_.push_back(std::move(parameter));
  }
  check_overrides();
  for (const int index : parameter_order(parameter_uses())) evaluate_parameter(index);
  for (std::size_t i = 0; i < spec_->parameters.size(); ++i) check_parameter_bounds(static_cast<int>(i));
}

void ModelAssembler::check_overrides() {
  std::vector<std::string_view> known;
  for (const ParameterSpec& spec : spec_->parameters) known.push_back(spec.name.name);
  for (const auto& [name, value] : overrides_) {
    if (parameter_index_.count(name) == 0) {
      diagnostics_.error("F310", {}, fmt::format("there is no parameter '{}' to set", name), did_you_mean(name, known));
    } else if (!std::isfinite(value)) {
      diagnostics_.error("F309", {},
                         fmt::format("the value given for the parameter '{}' is not a finite number", name));
    }
  }
}

/// For each parameter, the parameters that its formula uses; none where its value is overridden.
std::vector<std::vector<int>> ModelAssembler::parameter_uses() {
  std::vector<std::vector<int>> uses(spec_->parameters.size());
  for (std::size_t i = 0; i < uses.size(); ++i) {
    const ParameterSpec& spec = spec_->parameters[i];
    if (!spec.value.expression || overrides_.count(spec.name.name) != 0) continue;
    for (const ExpressionName& name : spec.value.expression->names()) {
      const auto found = parameter_index_.find(name.name);
      if (found != parameter_index_.end()) uses[i].push_back(found->second);
    }
  }
  return uses;
}

/// An order in which every parameter comes after those that it uses; what is left out hangs on a cycle, and is
/// reported.
std::vector<int> ModelAssembler::parameter_order(const std::vector<std::vector<int>>& uses) {
  std::vector<std::vector<int>> users(uses.size());
  std::vector<std::size_t> waiting(uses.size());
  std::vector<int> order;
  for (std::size_t i = 0; i < uses.size(); ++i) {
    waiting[i] = uses[i].size();
    for (const int used : uses[i]) users[static_cast<std::size_t>(used)].push_back(static_cast<int>(i));
    if (waiting[i] == 0) order.push_back(static_cast<int>(i));
  }
  std::vector<bool> done(uses.size(), false);
  for (std::size_t next = 0; next < order.size(); ++next) {
    const std::size_t i = static_cast<std::size_t>(order[next]);
    done[i] = true;
    for (const int user : users[i]) {
      if (--waiting[static_cast<std::size_t>(user)] == 0) order.push_back(user);
    }
  }
  if (order.size() < uses.size()) report_cycle(uses, done);
  return order;
}

/// Walks from any parameter that waits to one that it waits for, until one comes again; reports every such ring once.
void ModelAssembler::report_cycle(const std::vector<std::vector<int>>& uses, const std::vector<bool>& done) {
  std::vector<int> seen_in_walk(uses.size(), -1);
  for (std::size_t start = 0; start < uses.size(); ++start) {
    std::vector<int> walk;
    int i = static_cast<int>(start);
    while (!done[static_cast<std::size_t>(i)] && seen_in_walk[static_cast<std::size_t>(i)] < 0) {
      seen_in_walk[static_cast<std::size_t>(i)] = static_cast<int>(start);
      walk.push_back(i);
      const auto& used = uses[static_cast<std::size_t>(i)];
      i = *std::find_if(used.begin(), used.end(), [&](int u) { return !done[static_cast<std::size_t>(u)]; });
    }
    const auto ring = std::find(walk.begin(), walk.end(), i);
    if (ring == walk.end()) continue;
    std::string text;
    for (auto it = ring; it != walk.end(); ++it)
      text += model_.parameters_[static_cast<std::size_t>(*it)].name + " -> ";
    const ParameterSpec& spec = spec_->parameters[static_cast<std::size_t>(i)];
    diagnostics_.error("F307", place_of(spec.value, {"value", spec.name}),
                       fmt::format("the parameter '{}' depends on itself: {}{}", spec.name.name, text, spec.name.name),
                       "give one of them a number");
  }
}

void ModelAssembler::evaluate_parameter(int index) {
  const ParameterSpec& spec = spec_->parameters[static_cast<std::size_t>(index)];
  Parameter& parameter = model_.parameters_[static_cast<std::size_t>(index)];
  const Field field{"value", spec.name};
  const auto given = overrides_.find(spec.name.name);
  if (spec.value.expression) {
    const auto dimension_of = [this](std::string_view name) { return parameter_dimension(name); };
    Diagnostics heard_elsewhere;
    const auto dimension = spec.value.expression->dimension(dimension_of, heard_elsewhere);
    if (!parameter.dimension && dimension && *dimension != kPureNumber) parameter.dimension = dimension;
  }
  parameter.value = given != overrides_.end() ? given->second : number(spec.value, parameter.dimension, field);
}

void ModelAssembler::check_parameter_bounds(int index) {
  const ParameterSpec& spec = spec_->parameters[static_cast<std::size_t>(index)];
  Parameter& parameter = model_.parameters_[static_cast<std::size_t>(index)];
  if (spec.min) parameter.min = number(*spec.min, parameter.dimension, {"min", spec.name});
  if (spec.max) parameter.max = number(*spec.max, parameter.dimension, {"max", spec.name});
  if (spec.tolerance) {
    parameter.tolerance = number_at_least_zero(*spec.tolerance, parameter.dimension, {"tolerance", spec.name});
  }
  if (parameter.min && parameter.max && *parameter.min > *parameter.max) {
    diagnostics_.error("F308", place_of(*spec.max, {"max", spec.name}),
                       fmt::format("'max' of the parameter '{}' is below its 'min'", parameter.name));
    return;
  }
  const bool low = parameter.min && parameter.value < *parameter.min;
  const bool high = parameter.max && parameter.value > *parameter.max;
  if (!low && !high) return;
  diagnostics_.error("F308", place_of(spec.value, {"value", spec.name}),
                     fmt::format("the parameter '{}' is {}, {} its '{}' of {}", parameter.name, parameter.value,
                                 low ? "below" : "above", low ? "min" : "max", low ? *parameter.min : *parameter.max),
                     "values are in SI here");
}

std::optional<Dimension> ModelAssembler::parameter_dimension(std::string_view name) const {
  const auto found = parameter_index_.find(std::string(name));
  if (found == parameter_index_.end()) return std::nullopt;
  return model_.parameters_[static_cast<std::size_t>(found->second)].dimension;
}

double ModelAssembler::number(const Number& n, std::optional<Dimension> wanted, Field field) {
  const double value = any_number(n, wanted, field);
  if (std::isnan(value) || std::abs(value) <= kLargestNumber) return value;
  diagnostics_.error(
      "F338", place_of(n, field),
      fmt::format("'{}' of '{}' is {:.3g}, beyond what can be computed with", field.key, field.owner.name, value),
      fmt::format("numbers are at most {:.0g} in SI units", kLargestNumber));
  return kUnknown;
}

double ModelAssembler::any_number(const Number& n, std::optional<Dimension> wanted, Field field) {
  if (n.expression) {
    check_dimension(*n.expression, wanted, field);
    return evaluate(*n.expression, field);
  }
  if (std::isfinite(n.value)) return n.value;
  diagnostics_.error("F309", place_of(n, field),
                     fmt::format("'{}' of '{}' is not a finite number", field.key, field.owner.name));
  return kUnknown;
}

double ModelAssembler::number_at_least_zero(const Number& n, std::optional<Dimension> wanted, Field field) {
  const double value = number(n, wanted, field);
  if (value < 0) {
    diagnostics_.error("F311", place_of(n, field),
                       fmt::format("'{}' of '{}' is {}, but cannot be negative", field.key, field.owner.name, value));
  }
  return value;
}

/// The value over the parameters; NaN, silently, where a parameter has no value because of an error of its own.
double ModelAssembler::evaluate(const Expression& expression, Field field) {
  std::vector<std::string> inputs;
  std::vector<double> values;
  bool known = true;
  for (const ExpressionName& name : expression.names()) {
    const auto found = parameter_index_.find(name.name);
    if (found == parameter_index_.end()) {
      report_unknown_name(name, field);
      known = false;
      continue;
    }
    inputs.push_back(name.name);
    values.push_back(model_.parameters_[static_cast<std::size_t>(found->second)].value);
    known = known && std::isfinite(values.back());
  }
  if (!known) return kUnknown;
  const double value = ExpressionProgram(expression, inputs).evaluate(values.data());
  if (std::isfinite(value)) return value;
  diagnostics_.error("F408", place_or(expression.at(), field.owner),
                     fmt::format("the formula of '{}' of '{}' has no finite value", field.key, field.owner.name),
                     "look for a division by zero or a root of a negative number");
  return kUnknown;
}

void ModelAssembler::check_dimension(const Expression& expression, std::optional<Dimension> wanted, Field field) {
  const auto got =
      expression.dimension([this](std::string_view name) { return parameter_dimension(name); }, diagnostics_);
  // Numbers without a unit are in SI, whatever they measure: a pure number is never wrong by itself.
  if (!got || !wanted || *got == *wanted || *got == kPureNumber) return;
  diagnostics_.error(
      "F204", place_or(expression.at(), field.owner),
      fmt::format("'{}' of '{}' wants {}, got {}", field.key, field.owner.name, to_string(*wanted), to_string(*got)));
}

void ModelAssembler::report_unknown_name(const ExpressionName& name, Field field) {
  std::vector<std::string_view> known;
  for (const Parameter& parameter : model_.parameters_) known.push_back(parameter.name);
  std::string hint = did_you_mean(name.name, known);
  if (name.name == "t") hint = "the time 't' is known in laws only";
  if (name.name.find('.') != std::string::npos) hint = "joint coordinates are known in efforts and forces only";
  diagnostics_.error(
      "F403", place_or(name.at, field.owner),
      fmt::format("'{}' of '{}' uses '{}', which is no parameter", field.key, field.owner.name, name.name), hint);
}

Vector3d ModelAssembler::vector(const Number3& n, std::optional<Dimension> wanted, Field field) {
  return {number(n[0], wanted, field), number(n[1], wanted, field), number(n[2], wanted, field)};
}

}  // namespace ferrers
