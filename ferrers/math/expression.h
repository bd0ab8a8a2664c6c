#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ferrers/core/diagnostics.h"
#include "ferrers/core/units.h"

namespace ferrers {

struct ExpressionTree;  // the syntax tree, private to expression*.cc

/// A name used in an expression, with its first place.
struct ExpressionName {
  std::string name;  ///< May be dotted: `main.position`.
  SourceRange at;
};

/// Whether formulas use this name themselves (`pi` and the functions), so that nothing else may be called so.
bool is_expression_keyword(std::string_view name);

/// A formula over named quantities: parsed once, differentiated exactly, evaluated through an `ExpressionProgram`.
///
/// The language: `+ - * / ^` (`^` binds tightest and to the right, so `-x^2` is −(x²)), parentheses, `pi`, names that
/// may be dotted, and the functions
///
///     sin cos tan asin acos atan atan2(y, x) sinh cosh tanh exp log log10 sqrt abs sign floor
///     min(a, b, ...) max(a, b, ...) mod(a, b) pow(a, b) hypot(a, b) if(a < b, then, else)
///     smoothstep(x)  smootherstep(x)   from 0 to 1 over x in [0, 1] with one, with two, continuous derivatives
///
/// Comparisons `< <= > >=` stand only as the first argument of `if`. mod(a, b) is a − b·floor(a/b).
///
/// Values are SI; a literal may carry a unit: `5 mm`, `200 N/m`, `3 mm^2`. The unit is the longest run of unit names
/// joined by `*`, `/` and whole powers *without spaces*, so `2 m/s` is a velocity and `2 m / s` divides by the name s.
///
/// Immutable and cheap to copy (a shared tree). No operation recurses over the tree, so none can exhaust the stack.
class Expression {
 public:
  Expression();                              ///< The constant 0.
  static Expression constant(double value);  ///< Throws `std::invalid_argument` when not finite.
  static Expression variable(std::string_view name);

  /// Parses `text` (without the leading '='), whose first byte stands at `at` in the file; errors go to `diagnostics`
  /// with their exact column (from column 1 when `at` is unknown). At most 16384 bytes, 200 levels of nesting.
  /// Never throws. Cost: O(length).
  static std::optional<Expression> parse(std::string_view text, SourceRange at, Diagnostics& diagnostics);

  /// Every name used, except `pi`, each once, in order of appearance.
  std::vector<ExpressionName> names() const;
  bool depends_on(std::string_view name) const;
  std::optional<double> constant_value() const;  ///< Set when no name is left.

  /// The exact derivative with respect to a name, lightly simplified, with common subexpressions shared. A kink (abs at
  /// 0, min, if) gives one side's value; a jump (sign, floor) counts as flat; where the true derivative is unbounded or
  /// undefined (sqrt at 0, hypot at the origin) its value is infinite or NaN. Cost: O(size).
  ///
  /// A term that does not depend on the name counts as 0 even where it has no value, and what cancels (x − x,
  /// sin(x)² + cos(x)² − 1) is gone.
  Expression derivative(std::string_view name) const;

  /// The rate of change where names change at given rates: Σ ∂/∂name · rate_of(name), over the names for which
  /// `rate_of` returns one; the others are constant. Done in one go, it is shorter than the sum of the derivatives.
  /// With q_j ↦ v_j the velocity of a quantity; of a constraint row that is G v, and the rate of G v again is −gamma.
  Expression rate(const std::function<std::optional<Expression>(std::string_view)>& rate_of) const;

  /// The same formula in simplest form: factors and terms gathered, numbers worked out, equal parts shared. Its value
  /// is that of this formula up to rounding; where that is NaN or infinite (0*x at x = 1/0), so is this one. Cost:
  /// O(size).
  Expression simplified() const;

  /// The same formula with names replaced where `replacement` returns a formula.
  Expression substitute(const std::function<std::optional<Expression>(std::string_view)>& replacement) const;

  /// The dimension, where it can be told: names whose dimension `dimension_of` does not know (nullopt) match anything.
  /// Contradictions (m + kg, sin of a length) go to `diagnostics` as F204. Result nullopt: unknown, fits anything.
  /// A bare literal is a pure number as a factor (`3*r` is a length) and fits anything as a term (`r + 0.1`);
  /// arithmetic of bare literals alone stays bare. Exponents of a quantity must leave whole exponents of m, kg and s.
  std::optional<Dimension> dimension(const std::function<std::optional<Dimension>(std::string_view)>& dimension_of,
                                     Diagnostics& diagnostics) const;

  /// Reads back as a formula with the same operations in the same order. Cost: linear in the text, in which shared
  /// parts of a derivative are written out each time.
  std::string to_string() const;

  /// In LaTeX, for math mode: fractions, roots, powers, functions by their usual signs. `name` writes a name
  /// (`\\varphi` for `phi`); without it `l_1` is `l_{1}`, longer words stand upright. Given up in words after 256 KiB.
  std::string to_latex(const std::function<std::string(std::string_view)>& name = {}) const;

  SourceRange at() const;  ///< Where the formula stands.

 private:
  explicit Expression(std::shared_ptr<const ExpressionTree> tree);
  std::shared_ptr<const ExpressionTree> tree_;
  friend class ExpressionProgram;
  friend class ExpressionOperators;
};

/// Sums, differences, products and quotients of formulas, in simplest form: 0 + x is x, 1*x is x, 0*x and x - x are 0
/// whatever x is worth, numbers are worked out. Equal parts of both are shared. Cost: the size of both.
Expression operator+(const Expression& a, const Expression& b);
Expression operator-(const Expression& a, const Expression& b);
Expression operator*(const Expression& a, const Expression& b);
Expression operator/(const Expression& a, const Expression& b);
Expression operator-(const Expression& a);

/// The sum of all terms in their order, 0 of none. Cost: the size of all, where adding one by one would copy the first
/// term as often as there are others.
Expression sum_of(std::span<const Expression> terms);

/// Formulas as straight-line code over an array of inputs; common subexpressions are computed once, also those that
/// several formulas share.
///
/// Each value is that of the formula's operations as they are written, to the last bit (but for the sign of NaN); small
/// whole powers are products. Mass matrix, forces, constraints, Jacobian and gamma of Andrews' squeezer, differentiated
/// from its energies, take 0.17 µs, and 0.15 µs by hand (bench/expression_bench.cc).
///
/// On processors with AVX the code of all but the smallest programs is native, with the same bits as result; elsewhere,
/// or where memory may not be executed, it is interpreted.
///
/// Evaluation allocates nothing: its registers stand on the stack. (Beyond 16384 registers, which takes thousands of
/// outputs or a hostile formula, they are allocated.) Copies share the code; evaluation from several threads is safe.
class ExpressionProgram {
 public:
  ExpressionProgram();  ///< The constant 0 of no inputs.

  /// `inputs[i]` is the name whose value stands at `values[i]`. Throws `std::invalid_argument` for a name that is no
  /// input. Cost: linear in the sizes of the formulas and the number of inputs.
  ExpressionProgram(const Expression& expression, std::span<const std::string> inputs);
  ExpressionProgram(std::span<const Expression> outputs, std::span<const std::string> inputs);

  /// The value of a program of one output; throws `std::invalid_argument` for any other. Outside a function's domain
  /// (log of -1) the value is NaN or infinite. Cost: linear in the size of the formula.
  double evaluate(const double* inputs) const;

  /// Writes `output_count()` values, in the order of the formulas. `outputs` may be the same array as `inputs`.
  void evaluate(const double* inputs, double* outputs) const;

  bool is_native() const;
  ExpressionProgram interpreted() const;  ///< The same without native code.

  int output_count() const;
  int register_count() const;
  int instruction_count() const;

 private:
  struct Code;
  std::shared_ptr<const Code> code_;
};

}  // namespace ferrers
