#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "ferrers/core/closest_name.h"
#include "ferrers/io/parameter_table.h"
#include "ferrers/io/value_reader.h"

namespace ferrers {
namespace {

struct Range {
  std::string name;
  double from = 0, to = 0;
  std::size_t count = 0;

  // The ends as they are given; between them, of the ways to write it, the one whose round values come out round.
  double value(std::size_t i) const {
    if (i == 0 || i + 1 == count) return i == 0 ? from : to;
    const double last = static_cast<double>(count - 1), k = static_cast<double>(i);
    const double sum = from * (last - k) + to * k;
    return std::isfinite(sum) ? sum / last : from * ((last - k) / last) + to * (k / last);
  }
};

std::optional<std::size_t> whole_number(std::string_view text) {
  std::size_t value = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (code != std::errc() || end != text.data() + text.size() || text.empty()) return std::nullopt;
  return value;
}

/// 'name=from:to:count'; nothing, with a message, where it is something else.
std::optional<Range> read_range(std::string_view text, const Model& model, Diagnostics& diagnostics) {
  const auto fail = [&](std::string message, std::string hint) {
    diagnostics.error("F216", {}, std::move(message), std::move(hint));
    return std::nullopt;
  };
  const std::size_t equals = text.find('='), first = text.find(':', equals), second = text.find(':', first + 1);
  if (equals == 0 || first == std::string_view::npos || second == std::string_view::npos) {
    return fail(fmt::format("{} is not name=from:to:count", quoted_in_message(text)),
                "for instance length=100 mm:200 mm:11");
  }
  Range range;
  range.name = text.substr(0, equals);
  const auto& parameters = model.parameters();
  const auto found = std::find_if(parameters.begin(), parameters.end(),
                                  [&](const Parameter& parameter) { return parameter.name == range.name; });
  if (found == parameters.end()) {
    std::vector<std::string_view> known;
    for (const Parameter& parameter : parameters) known.push_back(parameter.name);
    return fail(fmt::format("the model has no parameter {}", quoted_in_message(range.name)),
                did_you_mean(range.name, known));
  }
  LawFiles laws(std::nullopt);
  ValueReader values(laws, diagnostics);
  const auto number = [&](std::size_t begin, std::size_t end) {
    return values.written_number(text.substr(begin, end - begin), {}, {range.name, {}}, found->dimension);
  };
  const auto from = number(equals + 1, first), to = number(first + 1, second);
  const auto count = whole_number(text.substr(second + 1));
  if (!count || *count == 0) {
    return fail(
        fmt::format("{} is not how many values '{}' takes", quoted_in_message(text.substr(second + 1)), range.name),
        "a whole number from 1 on");
  }
  if (!from || !to) return std::nullopt;
  range.from = from->value;
  range.to = to->value;
  range.count = *count;
  if (range.count == 1 && range.from != range.to) {
    return fail(fmt::format("one value of '{}' cannot be both ends of {}", range.name, quoted_in_message(text)),
                "two values are the ends themselves");
  }
  return range;
}

/// How many combinations there are; 0: too many.
std::size_t combinations(const std::vector<Range>& ranges) {
  std::size_t rows = 1;
  for (const Range& range : ranges) {
    if (range.count > kMostParameterRows / rows) return 0;
    rows *= range.count;
  }
  return rows;
}

}  // namespace

ParameterTableResult make_parameter_grid(std::span<const std::string> texts, const Model& model) {
  ParameterTableResult result;
  std::vector<Range> ranges;
  ParameterTable table;
  for (const std::string& text : texts) {
    auto range = read_range(text, model, result.diagnostics);
    if (!range) continue;
    if (std::find(table.names.begin(), table.names.end(), range->name) != table.names.end()) {
      result.diagnostics.error("F216", {}, fmt::format("the parameter '{}' is varied twice", range->name));
      continue;
    }
    table.names.push_back(range->name);
    ranges.push_back(std::move(*range));
  }
  if (result.diagnostics.has_errors()) return result;
  const std::size_t rows = ranges.empty() ? 0 : combinations(ranges);
  if (rows == 0) {
    const bool none = ranges.empty();
    result.diagnostics.error(
        "F216", {},
        none ? "no parameter is varied" : fmt::format("these are more than {} combinations", kMostParameterRows));
    return result;
  }
  table.values.reserve(rows * ranges.size());
  std::vector<std::size_t> at(ranges.size(), 0);
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t i = 0; i < ranges.size(); ++i) table.values.push_back(ranges[i].value(at[i]));
    for (std::size_t i = ranges.size(); i-- > 0 && ++at[i] == ranges[i].count;) at[i] = 0;
  }
  result.table = std::move(table);
  return result;
}

}  // namespace ferrers
