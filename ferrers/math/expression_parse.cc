#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <numbers>
#include <utility>

#include "ferrers/core/closest_name.h"
#include "ferrers/math/expression.h"
#include "ferrers/math/expression_node.h"
#include "ferrers/math/expression_scan.h"

namespace ferrers {
namespace {

using Op = ExpressionOp;

constexpr std::size_t kMaxLength = 16384;  // Bytes of one formula.
constexpr int kMaxNesting = 200;           // Parentheses, signs and powers within one another.
constexpr int kBroken = -1;                // Stands for a subtree after a syntax error.

/// Recursive descent, one function per rule. A syntax error ends the parse; what is only a wrong word (an unknown unit
/// or function) is reported and the parse goes on.
class Parser {
 public:
  Parser(std::string_view text, SourceRange at, Diagnostics& diagnostics)
      : scan_(text, at), size_(text.size()), diagnostics_(diagnostics) {}

  std::shared_ptr<const ExpressionTree> parse() {
    if (size_ > kMaxLength) {
      report("F405", 0, 1, fmt::format("the formula is longer than {} bytes", kMaxLength),
             "give its parts as parameters");
      return nullptr;
    }
    scan_.skip_spaces();
    const std::size_t begin = scan_.position();
    if (scan_.at_end()) {
      report("F401", 0, 1, "the formula is empty");
      return nullptr;
    }
    const int root = sum();
    const std::size_t end = scan_.position();
    scan_.skip_spaces();
    if (root != kBroken && !scan_.at_end()) unexpected("an operator");
    if (failed_) return nullptr;
    return builder_.finish(root, scan_.place(begin, end));
  }

 private:
  /// One level of nesting, as long as it lives.
  struct Level {
    explicit Level(int& nesting_depth) : depth(nesting_depth) { ++depth; }
    ~Level() { --depth; }
    Level(const Level&) = delete;
    Level& operator=(const Level&) = delete;
    int& depth;
  };

  void report(std::string_view code, std::size_t begin, std::size_t end, std::string message, std::string hint = {}) {
    failed_ = true;
    diagnostics_.error(code, scan_.place(begin, end), std::move(message), std::move(hint));
  }

  bool too_deep() {
    if (depth_ <= kMaxNesting) return false;
    report("F405", scan_.position(), scan_.position() + 1,
           fmt::format("the formula nests deeper than {} levels", kMaxNesting), "give its parts as parameters");
    return true;
  }

  // sum: product (('+' | '-') product)*
  int sum() {
    const Level level(depth_);
    if (too_deep()) return kBroken;
    int left = product();
    while (left != kBroken) {
      scan_.skip_spaces();
      const std::size_t at = scan_.position();
      const char sign = scan_.peek();
      if (sign != '+' && sign != '-') break;
      scan_.move_to(at + 1);
      const int right = product();
      left = right == kBroken ? kBroken : node(sign == '+' ? Op::kAdd : Op::kSubtract, at, 1, left, right);
    }
    return left;
  }

  // product: signed (('*' | '/') signed)*
  int product() {
    int left = signed_power();
    while (left != kBroken) {
      scan_.skip_spaces();
      const std::size_t at = scan_.position();
      const char sign = scan_.peek();
      if ((sign != '*' && sign != '/') || (sign == '*' && scan_.peek(1) == '*')) break;
      scan_.move_to(at + 1);
      const int right = signed_power();
      left = right == kBroken ? kBroken : node(sign == '*' ? Op::kMultiply : Op::kDivide, at, 1, left, right);
    }
    return left;
  }

  // signed: ('-' | '+') signed | power
  int signed_power() {
    scan_.skip_spaces();
    const std::size_t at = scan_.position();
    if (scan_.take("+")) return deeper_signed_power();
    if (!scan_.take("-")) return power();
    const int operand = deeper_signed_power();
    return operand == kBroken ? kBroken : node(Op::kNegate, at, 1, operand);
  }

  int deeper_signed_power() {
    const Level level(depth_);
    return too_deep() ? kBroken : signed_power();
  }

  // power: atom ('^' signed)?
  int power() {
    const int base = atom();
    if (base == kBroken) return kBroken;
    scan_.skip_spaces();
    const std::size_t at = scan_.position();
    if (scan_.peek() != '^') return base;
    if (base == last_unit_literal_) {
      report("F401", at, at + 1, "it is not clear whether this power is of the unit or of the whole quantity",
             "write '5 mm^2' without spaces for square millimetres, or '(5 mm)^2'");
      return kBroken;
    }
    scan_.move_to(at + 1);
    const int exponent = deeper_signed_power();
    return exponent == kBroken ? kBroken : node(Op::kPower, at, 1, base, exponent);
  }

  // atom: number unit? | name | function '(' ... ')' | '(' sum ')'
  int atom() {
    scan_.skip_spaces();
    const std::size_t begin = scan_.position();
    if (scan_.take("(")) {
      const int inner = sum();
      if (inner == kBroken || !close_parenthesis(begin, "an operator or ')'")) return kBroken;
      last_unit_literal_ = kBroken;
      return inner;
    }
    if (const std::string_view number = scan_.take_number(); !number.empty()) return literal(begin, number);
    const std::string_view name = scan_.take_name();
    if (name.empty()) return unexpected("a number, a name or '('");
    scan_.skip_spaces();
    if (scan_.peek() == '(') return call(begin, name);
    if (find_expression_function(name) != nullptr) {
      report("F401", begin, begin + name.size(), fmt::format("'{}' is a function and needs arguments", name),
             name == "if" ? "write 'if(a < b, then, else)'" : fmt::format("write '{}(...)'", name));
      return kBroken;
    }
    const SourceRange at = scan_.place(begin, begin + name.size());
    if (name != "pi") return builder_.variable(name, at);
    ExpressionNode pi;
    pi.op = Op::kPi;
    pi.value = std::numbers::pi;
    pi.at = at;
    return builder_.add(pi);
  }

  int literal(std::size_t begin, std::string_view number) {
    const std::size_t end = scan_.position();
    ExpressionNode node;
    const auto [rest, error] = std::from_chars(number.data(), number.data() + number.size(), node.value);
    if (error != std::errc() || rest != number.data() + number.size()) {
      report("F406", begin, end, fmt::format("'{}' is too large or too small for a number", clipped(number)));
      node.value = 1;
    }
    while (scan_.peek() == ' ' || scan_.peek() == '\t') scan_.move_to(scan_.position() + 1);
    const std::size_t unit_begin = scan_.position();
    if (!scan_.unit_word().empty() || scan_.peek() == '_') {
      if (!literal_unit(node, unit_begin)) return kBroken;
    } else {
      scan_.move_to(end);
    }
    node.at = scan_.place(begin, scan_.position());
    const int index = builder_.add(node);
    if (node.text >= 0) last_unit_literal_ = index;
    return index;
  }

  bool literal_unit(ExpressionNode& node, std::size_t begin) {
    const std::string_view text = scan_.take_unit();
    const std::optional<Unit> unit = parse_unit(text);
    if (!unit || !std::isfinite(to_si(node.value, *unit))) {
      const std::string_view word = text.empty() ? scan_.take_name() : text;
      const std::string_view shown = word.empty() ? scan_.unit_word() : word;
      if (word.empty()) scan_.move_to(begin + shown.size());
      report("F407", begin, begin + shown.size(), fmt::format("'{}' is not a unit", clipped(shown)),
             fmt::format("for a product write '*' before '{}'", clipped(shown)));
      return true;
    }
    node.written = node.value;
    node.value = to_si(node.written, *unit);
    node.text = builder_.text(text);
    return true;
  }

  int call(std::size_t begin, std::string_view name) {
    const std::size_t end = begin + name.size();
    const ExpressionFunction* function = find_expression_function(name);
    if (function == nullptr)
      report("F402", begin, end, fmt::format("there is no function '{}'", clipped(name)), advice(name));
    const std::size_t open = scan_.position();
    scan_.move_to(open + 1);
    std::vector<int> args;
    if (!scan_.take(")")) {
      do {
        const bool is_condition = args.empty() && function != nullptr && function->op == Op::kIf;
        args.push_back(is_condition ? condition() : sum());
        if (args.back() == kBroken) return kBroken;
      } while (scan_.take(","));
      if (!close_parenthesis(open, "an operator, ',' or ')'")) return kBroken;
    }
    if (function == nullptr) return builder_.literal(0);
    const int count = static_cast<int>(args.size());
    if (count < function->min_arguments || count > function->max_arguments) {
      const std::string wanted =
          function->max_arguments == kManyArguments
              ? "2 or more arguments"
              : fmt::format("{} argument{}", function->min_arguments, function->min_arguments == 1 ? "" : "s");
      report("F404", begin, end, fmt::format("'{}' takes {}, got {}", name, wanted, count));
      return builder_.literal(0);
    }
    last_unit_literal_ = kBroken;
    if (function->op == Op::kIf) return node(function->op, begin, name.size(), args[0], args[1], args[2]);
    if (count == 1) return node(function->op, begin, name.size(), args[0]);
    int result = args[0];
    for (int i = 1; i < count; ++i) result = node(function->op, begin, name.size(), result, args[i]);
    return result;
  }

  // condition: sum ('<' | '<=' | '>' | '>=') sum
  int condition() {
    const int left = sum();
    if (left == kBroken) return kBroken;
    scan_.skip_spaces();
    const std::size_t at = scan_.position();
    constexpr std::pair<std::string_view, Op> kComparisons[] = {
        {"<=", Op::kLessEqual}, {">=", Op::kGreaterEqual}, {"<", Op::kLess}, {">", Op::kGreater}};
    for (const auto& [sign, op] : kComparisons) {
      if (!scan_.take(sign)) continue;
      const int right = sum();
      return right == kBroken ? kBroken : node(op, at, sign.size(), left, right);
    }
    return unexpected("a comparison (<, <=, >, >=)", "write if(a < b, then, else)");
  }

  bool close_parenthesis(std::size_t open, std::string_view wanted) {
    if (scan_.take(")")) return true;
    if (scan_.at_end()) {
      report("F401", open, open + 1, "this '(' is never closed");
    } else {
      unexpected(wanted);
    }
    return false;
  }

  int node(Op op, std::size_t begin, std::size_t length, int a, int b = -1, int c = -1) {
    ExpressionNode made;
    made.op = op;
    made.args = {a, b, c};
    made.at = scan_.place(begin, begin + length);
    return builder_.add(made);
  }

  int unexpected(std::string_view wanted, std::string_view hint = {}) {
    scan_.skip_spaces();
    const std::size_t at = scan_.position();
    if (scan_.at_end()) {
      report("F401", size_, size_ + 1, fmt::format("the formula ends where {} was expected", wanted),
             std::string(hint));
    } else {
      const std::size_t end = at + scan_.character_length();
      report("F401", at, end, fmt::format("expected {}, got {}", wanted, scan_.shown_character()),
             hint.empty() ? character_advice() : std::string(hint));
    }
    return kBroken;
  }

  std::string character_advice() const {
    constexpr std::pair<std::string_view, std::string_view> kAdvice[] = {
        {"**", "a power is written '^'"},
        {"==", "there is no test for equality; compare with '<' or '>'"},
        {"=", "a formula holds no assignment; '=' stands only before it"},
        {"<", "a comparison stands only as the first argument of if(a < b, then, else), once"},
        {">", "a comparison stands only as the first argument of if(a > b, then, else), once"},
        {"&", "nest if(...) in if(...) for 'and'"},
        {"|", "nest if(...) in if(...) for 'or'"},
        {"%", "write mod(a, b) for a remainder"},
        {"²", "a power is written '^2'"},
        {"³", "a power is written '^3'"},
        {"·", "a product is written '*'"},
        {"×", "a product is written '*'"},
        {"−", "minus is written '-'"},
        {"÷", "a quotient is written '/'"},
        {"√", "write sqrt(x)"},
        {"π", "write pi"},
        {"(", "a product is written with '*'"},
        {",", "a decimal point is '.'"},
        {"[", "a formula gives one number; use '(' and ')'"},
        {"{", "use '(' and ')'"},
    };
    for (const auto& [sign, hint] : kAdvice) {
      if (scan_.text(scan_.position(), size_).starts_with(sign)) return std::string(hint);
    }
    if (is_name_start(scan_.peek())) return "a product is written with '*'";
    return static_cast<unsigned char>(scan_.peek()) >= 0x80 ? "names are made of letters A to Z, digits and '_'" : "";
  }

  static std::string advice(std::string_view name) {
    constexpr std::pair<std::string_view, std::string_view> kOthers[] = {
        {"ln", "log"},        {"lg", "log10"}, {"arcsin", "asin"}, {"arccos", "acos"},  {"arctan", "atan"},
        {"arctan2", "atan2"}, {"fabs", "abs"}, {"sgn", "sign"},    {"signum", "sign"},  {"fmod", "mod"},
        {"power", "pow"},     {"step", "if"},  {"iff", "if"},      {"heaviside", "if"}, {"tg", "tan"},
        {"sh", "sinh"},       {"ch", "cosh"},  {"th", "tanh"},
    };
    for (const auto& [other, ours] : kOthers) {
      if (other == name) return fmt::format("did you mean '{}'?", ours);
    }
    std::vector<std::string_view> names;
    for (const ExpressionFunction& function : expression_functions()) names.push_back(function.name);
    const std::string near = did_you_mean(name, names);
    return near.empty() ? "if it is a name, a product with what follows is written with '*'" : near;
  }

  static std::string clipped(std::string_view word) {
    constexpr std::size_t kShown = 40;
    return word.size() <= kShown ? std::string(word) : std::string(word.substr(0, kShown)) + "...";
  }

  ExpressionScanner scan_;
  std::size_t size_;
  Diagnostics& diagnostics_;
  ExpressionTreeBuilder builder_;
  int depth_ = 0;
  int last_unit_literal_ = kBroken;  // The node of the last quantity written without parentheses around it.
  bool failed_ = false;
};

}  // namespace

std::optional<Expression> Expression::parse(std::string_view text, SourceRange at, Diagnostics& diagnostics) {
  std::shared_ptr<const ExpressionTree> tree = Parser(text, at, diagnostics).parse();
  if (!tree) return std::nullopt;
  return Expression(std::move(tree));
}

}  // namespace ferrers
