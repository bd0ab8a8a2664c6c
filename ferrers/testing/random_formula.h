#pragma once

#include <rapidcheck.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "ferrers/math/expression.h"

/// Random formulas for the tests of expression*.cc.
namespace ferrers::expression_testing {

inline Expression parsed(std::string_view text) {
  Diagnostics diagnostics;
  const std::optional<Expression> expression = Expression::parse(text, {1, 1, 0}, diagnostics);
  if (!expression) throw std::runtime_error("cannot parse: " + std::string(text));
  return *expression;
}

inline double value_at(const Expression& expression, double x, double y) {
  const std::vector<std::string> names{"x", "y"};
  const double values[] = {x, y};
  return ExpressionProgram(expression, names).evaluate(values);
}

/// A random formula of x and y, written with every operation of the language.
inline std::string random_formula(int depth) {
  const auto pick = [](int count) { return *rc::gen::inRange(0, count); };
  if (depth == 0 || pick(8) == 0) {
    const char* leaves[] = {"x", "y", "pi", "2", "0.5", "3 mm", "x", "30 deg", "1.25e-1", "7", "y", "0"};
    return leaves[pick(12)];
  }
  const auto a = [depth] { return random_formula(depth - 1); };
  const char* unary[] = {"sin", "cos", "tan",   "asin", "acos", "atan", "sinh",  "cosh",       "tanh",
                         "exp", "log", "log10", "sqrt", "abs",  "sign", "floor", "smoothstep", "smootherstep"};
  const char* binary[] = {"atan2", "hypot", "mod", "min", "max", "pow"};
  const char* operators[] = {" + ", " - ", "*", "/", " - ", "*"};
  const char* comparisons[] = {"<", "<=", ">", ">="};
  switch (pick(7)) {
    case 0:
    case 1:
      return "(" + a() + operators[pick(6)] + a() + ")";
    case 2:
      return std::string(unary[pick(18)]) + "(" + a() + ")";
    case 3:
      return std::string(binary[pick(6)]) + "(" + a() + ", " + a() + ")";
    case 4:
      return "(" + a() + ")^" + (pick(3) == 0 ? "(" + a() + ")" : std::to_string(pick(4)));
    case 5:
      return "-" + a();
    default:
      return "if(" + a() + comparisons[pick(4)] + a() + ", " + a() + ", " + a() + ")";
  }
}

}  // namespace ferrers::expression_testing
