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

struct ExpressionNode;  // the syntax tree, private to expression*.cc

/// A name used in an expression, with its first place.
struct ExpressionName {
  std::string name;  ///< May be dotted: `main.position`.
  SourceRange at;
};

/// A formula over named quantities: parsed once, differentiated exactly, evaluated through an `ExpressionProgram`.
///
/// Immutable and cheap to copy (a shared tree). Values are SI; a literal may carry a unit (`5 mm`).
class Expression {
 public:
  Expression();  ///< The constant 0.
  static Expression constant(double value);
  static Expression variable(std::string name);

  /// Parses `text` (without the leading '='), whose first byte stands at `at` in the file; errors go to `diagnostics`
  /// with their exact column. Depth and length are limited; never throws, never recurses without bound.
  static std::optional<Expression> parse(std::string_view text, SourceRange at, Diagnostics& diagnostics);

  /// Every name used, except `pi`, each once, in order of appearance.
  std::vector<ExpressionName> names() const;
  bool depends_on(std::string_view name) const;
  std::optional<double> constant_value() const;  ///< Set when no name is left.

  /// The exact derivative with respect to a name, simplified. Not smooth points (abs at 0) give one side's value.
  Expression derivative(std::string_view name) const;

  /// The same formula with names replaced where `replacement` returns a formula.
  Expression substitute(const std::function<std::optional<Expression>(std::string_view)>& replacement) const;

  /// The dimension, where it can be told: names whose dimension `dimension_of` does not know (nullopt) match anything.
  /// Contradictions (m + kg, sin of a length) go to `diagnostics` as F204. Result nullopt: unknown, fits anything.
  std::optional<Dimension> dimension(const std::function<std::optional<Dimension>(std::string_view)>& dimension_of,
                                     Diagnostics& diagnostics) const;

  std::string to_string() const;  ///< Reads back as the same formula.
  SourceRange at() const;         ///< Where the formula stands.

  const ExpressionNode& root() const { return *root_; }

 private:
  explicit Expression(std::shared_ptr<const ExpressionNode> root);
  std::shared_ptr<const ExpressionNode> root_;
  friend class ExpressionProgram;
};

/// An expression as straight-line code over an array of inputs: evaluation allocates nothing.
class ExpressionProgram {
 public:
  ExpressionProgram();  ///< The constant 0 of no inputs.

  /// `inputs[i]` is the name whose value stands at `values[i]`. Throws `std::invalid_argument` for a name that is no input.
  ExpressionProgram(const Expression& expression, std::span<const std::string> inputs);

  double evaluate(const double* values) const;  ///< Cost: linear in the size of the formula.

 private:
  struct Instruction;
  std::shared_ptr<const std::vector<Instruction>> code_;
  int stack_size_ = 1;
};

}  // namespace ferrers
