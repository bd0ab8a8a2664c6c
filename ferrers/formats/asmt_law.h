#pragma once

#include <optional>
#include <string_view>

#include "ferrers/core/diagnostics.h"
#include "ferrers/math/expression.h"

namespace ferrers {

/// A formula of an ASMT file, of `time` (which becomes `t`) and numbers, times `factor`.
///
/// The language: `+ - * / ^`, parentheses, numbers with an exponent after `e` or `d` (`4.0d` is 4), `pi`, `time`, and
/// the functions abs, sin, cos, asin, arcsin, arctan. A sign directly before a number and after `*`, `/` or `^` belongs
/// to the number (`2*-3^2` is 18). No formula at all is 0. Errors at their column: F602 for what is known there and has
/// no counterpart (spline, integral, rampstep, piecewise, functions, transitions), F401 for the rest. Cost: linear.
std::optional<Expression> read_asmt_law(std::string_view text, SourceRange at, double factor, Diagnostics& diagnostics);

}  // namespace ferrers
