// Any bytes as a formula: whatever they are, they are parsed or refused with a place, and what was parsed goes through
// every operation on formulas.

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>
#include <vector>

#include "ferrers/math/expression.h"

namespace {

using namespace ferrers;  // NOLINT(google-build-using-namespace): a program, not a header

constexpr int kShort = 16;  // instructions up to which derivatives are written out, which may take very long texts

void check(bool holds) {
  if (!holds) std::abort();
}

bool same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

std::optional<Expression> read(std::string_view text, Diagnostics& diagnostics) {
  const std::optional<Expression> e = Expression::parse(text, {3, 7, 0}, diagnostics);
  check(e.has_value() != diagnostics.has_errors());
  for (const Diagnostic& one : diagnostics.items()) check(one.at.line >= 3 && one.at.column >= 1);
  return e;
}

/// The text must read back as the same formula, if it is not too long or too deep for the parser.
void check_text(const Expression& e, const std::vector<std::string>& names, const std::vector<double>& values) {
  const std::string text = e.to_string();
  check(!text.empty() && !e.to_latex().empty());
  Diagnostics diagnostics;
  const std::optional<Expression> back = Expression::parse(text, {}, diagnostics);
  if (!back) {
    check(diagnostics.items().front().code == "F405");
    return;
  }
  check(back->to_string() == text);
  check(same(ExpressionProgram(*back, names).evaluate(values.data()),
             ExpressionProgram(e, names).evaluate(values.data())));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  Diagnostics diagnostics;
  const std::optional<Expression> e = read(text, diagnostics);
  for (const Diagnostic& one : diagnostics.items()) check(!format_diagnostic(one, "f", "\n\n      " + text).empty());
  if (!e) return 0;

  std::vector<std::string> names;
  std::vector<double> values;
  for (const ExpressionName& name : e->names()) {
    names.push_back(name.name);
    values.push_back(0.75 * static_cast<double>(values.size()) - 0.5);
  }
  check_text(*e, names, values);
  e->dimension([](std::string_view) { return std::nullopt; }, diagnostics);
  e->dimension([](std::string_view name) { return Dimension{static_cast<int>(name.size() % 3), 1, 0}; }, diagnostics);

  std::vector<Expression> formulas{*e, e->simplified(), -*e, *e + *e, *e / *e};
  formulas.push_back(e->rate([](std::string_view name) { return Expression::variable(name); }));
  for (std::size_t i = 0; i < std::min<std::size_t>(names.size(), 3); ++i) {
    formulas.push_back(e->derivative(names[i]));
    formulas.push_back(formulas.back().derivative(names.front()));
  }
  formulas.push_back(sum_of(formulas));
  for (const Expression& formula : formulas) {
    formula.to_latex();
    if (ExpressionProgram(formula, names).instruction_count() <= kShort) check_text(formula, names, values);
  }
  std::vector<double> together(formulas.size());
  ExpressionProgram(formulas, names).evaluate(values.data(), together.data());
  for (std::size_t i = 0; i < formulas.size(); ++i) {
    check(same(ExpressionProgram(formulas[i], names).evaluate(values.data()), together[i]));
  }
  return 0;
}
