#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <utility>
#include <variant>

#include "ferrers/math/expression.h"
#include "ferrers/math/expression_node.h"

namespace ferrers {
namespace {

using Op = ExpressionOp;

/// How tightly a formula's outermost operation binds, as it is drawn: nothing needs parentheses inside a fraction or
/// under a root.
enum Binding { kAnything, kSum, kProduct, kSigned, kFactor, kAtom };

struct Subtree {
  int index;
  int at_least;
};
using Piece = std::variant<std::string, Subtree>;

/// `phi_1` as a letter with an index; what is longer than a letter stands upright.
std::string latex_word(std::string_view word) {
  const auto upright = [](std::string_view part) {
    return part.size() == 1 || part.find_first_not_of("0123456789") == std::string_view::npos
               ? std::string(part)
               : fmt::format("\\mathrm{{{}}}", part);
  };
  const std::size_t mark = word.find('_');
  if (mark == std::string_view::npos || mark == 0 || mark + 1 == word.size()) {
    std::string escaped;
    for (const char c : word) escaped += c == '_' ? std::string("\\_") : std::string(1, c);
    return upright(escaped);
  }
  std::string index(word.substr(mark + 1));
  for (char& c : index) {
    if (c == '_') c = ',';
  }
  return fmt::format("{}_{{{}}}", upright(word.substr(0, mark)), upright(index));
}

/// 5e-07 as 5 · 10^-7.
std::string latex_number(double value) {
  const std::string text = fmt::format("{}", value);
  const std::size_t mark = text.find('e');
  if (mark == std::string::npos) return text;
  return fmt::format("{} \\cdot 10^{{{}}}", text.substr(0, mark), std::stoi(text.substr(mark + 1)));
}

/// `N*m^2` upright, with its powers raised.
std::string latex_unit(std::string_view unit) {
  static constexpr std::pair<std::string_view, std::string_view> kSigns[] = {
      {"°", "{}^{\\circ}"}, {"·", " \\cdot "}, {"*", " \\cdot "}, {"²", "^{2}"},
      {"³", "^{3}"},        {"µ", "\\mu "},    {"μ", "\\mu "},    {"%", "\\%"},
  };
  std::string out = "\\mathrm{";
  while (!unit.empty()) {
    std::size_t length = 1;
    if (unit[0] == '^') {
      while (length < unit.size() && (unit[length] == '-' || std::isdigit(static_cast<unsigned char>(unit[length])))) {
        ++length;
      }
      out += fmt::format("^{{{}}}", unit.substr(1, length - 1));
    } else {
      std::string_view written = unit.substr(0, 1);
      for (const auto& [sign, latex] : kSigns) {
        if (!unit.starts_with(sign)) continue;
        written = latex;
        length = sign.size();
        break;
      }
      out += written;
    }
    unit.remove_prefix(length);
  }
  return out + "}";
}

/// The sign of a function of one number, empty where it has another notation.
std::string_view latex_function(Op op) {
  switch (op) {
    case Op::kSin:
      return "\\sin";
    case Op::kCos:
      return "\\cos";
    case Op::kTan:
      return "\\tan";
    case Op::kAsin:
      return "\\arcsin";
    case Op::kAcos:
      return "\\arccos";
    case Op::kAtan:
      return "\\arctan";
    case Op::kSinh:
      return "\\sinh";
    case Op::kCosh:
      return "\\cosh";
    case Op::kTanh:
      return "\\tanh";
    case Op::kLog:
      return "\\ln";
    case Op::kLog10:
      return "\\log_{10}";
    case Op::kMin:
      return "\\min";
    case Op::kMax:
      return "\\max";
    default:
      return {};
  }
}

// Bytes. Shared parts are written out each time, so that the text of a small formula's derivative can be endless.
constexpr std::size_t kLongest = 1 << 18;

/// Writes with an explicit stack, so that depth does not matter.
class LatexWriter {
 public:
  LatexWriter(const ExpressionTree& tree, const std::function<std::string(std::string_view)>& name)
      : tree_(tree), name_(name) {}

  std::string write() {
    pending_.push_back(Subtree{static_cast<int>(tree_.nodes.size()) - 1, kAnything});
    while (!pending_.empty()) {
      if (out_.size() > kLongest) return "\\text{(too long to write)}";
      const Piece piece = std::move(pending_.back());
      pending_.pop_back();
      if (const auto* text = std::get_if<std::string>(&piece)) {
        out_ += *text;
      } else {
        write_subtree(std::get<Subtree>(piece));
      }
    }
    return std::move(out_);
  }

 private:
  const ExpressionNode& node(int index) const { return tree_.nodes[static_cast<std::size_t>(index)]; }

  Binding binding(const ExpressionNode& n) const {
    switch (n.op) {
      case Op::kAdd:
      case Op::kSubtract:
        return kSum;
      case Op::kMultiply:
        return kProduct;
      case Op::kNegate:
        return kSigned;
      case Op::kLiteral:
        if (std::signbit(n.value)) return kSigned;
        return n.text >= 0 || latex_number(n.value).find('c') != std::string::npos ? kProduct : kAtom;
      case Op::kDivide:
      case Op::kPower:
      case Op::kExp:
      case Op::kSmoothstep:
      case Op::kSmootherstep:
        return kFactor;
      default:
        return latex_function(n.op).empty() ? kAtom : kFactor;
    }
  }

  /// Whether what is drawn first is a digit, which a product must not run into.
  bool starts_with_digit(int index) const {
    while (true) {
      const ExpressionNode& n = node(index);
      if (n.op == Op::kLiteral) return true;
      if (n.op != Op::kMultiply && n.op != Op::kPower) return false;
      index = n.args[0];
    }
  }

  void then(std::initializer_list<Piece> pieces) {
    pending_.insert(pending_.end(), std::rbegin(pieces), std::rend(pieces));
  }

  void write_subtree(const Subtree& subtree) {
    const ExpressionNode& n = node(subtree.index);
    if (binding(n) < subtree.at_least) {
      then({"\\left(", Subtree{subtree.index, kAnything}, "\\right)"});
      return;
    }
    const auto [a, b, c] = n.args;
    switch (n.op) {
      case Op::kLiteral:
        out_ += n.text < 0
                    ? latex_number(n.value)
                    : latex_number(n.written) + "\\," + latex_unit(tree_.texts[static_cast<std::size_t>(n.text)]);
        break;
      case Op::kPi:
        out_ += "\\pi";
        break;
      case Op::kVariable: {
        const std::string& name = tree_.texts[static_cast<std::size_t>(n.text)];
        out_ += name_ ? name_(name) : latex_word(name);
        break;
      }
      case Op::kNegate:
        return then({"-", Subtree{a, kFactor}});
      case Op::kAdd:
        return then({Subtree{a, kSum}, " + ", Subtree{b, kProduct}});
      case Op::kSubtract:
        return then({Subtree{a, kSum}, " - ", Subtree{b, kProduct}});
      case Op::kMultiply:
        return then({Subtree{a, kProduct}, starts_with_digit(b) ? " \\cdot " : " \\, ", Subtree{b, kFactor}});
      case Op::kDivide:
        return then({"\\frac{", Subtree{a, kAnything}, "}{", Subtree{b, kAnything}, "}"});
      case Op::kPower:
        return write_power(a, b);
      default:
        write_function(n);
    }
  }

  /// sin²(x) carries its exponent on its name.
  void write_power(int base, int exponent) {
    const ExpressionNode& n = node(base);
    const std::string_view function = n.args[1] < 0 ? latex_function(n.op) : std::string_view();
    const bool on_name =
        !function.empty() && n.op != Op::kLog10 && node(exponent).is_literal() && node(exponent).value > 0;
    if (on_name) {
      then({std::string(function) + "^{", Subtree{exponent, kAnything}, "}\\left(", Subtree{n.args[0], kAnything},
            "\\right)"});
    } else {
      then({Subtree{base, kAtom}, "^{", Subtree{exponent, kAnything}, "}"});
    }
  }

  void write_function(const ExpressionNode& n) {
    const auto [a, b, c] = n.args;
    const Subtree first{a, kAnything}, second{b, kAnything};
    switch (n.op) {
      case Op::kSqrt:
        return then({"\\sqrt{", first, "}"});
      case Op::kAbs:
        return then({"\\left|", first, "\\right|"});
      case Op::kFloor:
        return then({"\\left\\lfloor ", first, " \\right\\rfloor"});
      case Op::kExp:
        return then({"\\mathrm{e}^{", first, "}"});
      case Op::kLess:
        return then({first, " < ", second});
      case Op::kLessEqual:
        return then({first, " \\le ", second});
      case Op::kGreater:
        return then({first, " > ", second});
      case Op::kGreaterEqual:
        return then({first, " \\ge ", second});
      case Op::kIf:
        return then({"\\begin{cases} ", second, " & ", first, " \\\\ ", Subtree{c, kAnything},
                     " & \\text{otherwise} \\end{cases}"});
      default:
        break;
    }
    const std::string_view sign = latex_function(n.op);
    const std::string name =
        sign.empty() ? fmt::format("\\operatorname{{{}}}", expression_op_name(n.op)) : std::string(sign);
    if (b < 0) return then({name + "\\left(", first, "\\right)"});
    then({name + "\\left(", first, ", ", second, "\\right)"});
  }

  const ExpressionTree& tree_;
  const std::function<std::string(std::string_view)>& name_;
  std::vector<Piece> pending_;
  std::string out_;
};

}  // namespace

std::string Expression::to_latex(const std::function<std::string(std::string_view)>& name) const {
  return LatexWriter(*tree_, name).write();
}

}  // namespace ferrers
