#include "ferrers/math/expression.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <stdexcept>

#include "ferrers/testing/random_formula.h"

namespace ferrers {
namespace {

using expression_testing::parsed;
using expression_testing::random_formula;
using expression_testing::value_at;

double value_of(std::string_view text) { return parsed(text).constant_value().value(); }

Diagnostic only_error(std::string_view text, SourceRange at = {3, 11, 0}) {
  Diagnostics diagnostics;
  EXPECT_FALSE(Expression::parse(text, at, diagnostics)) << text;
  EXPECT_EQ(diagnostics.items().size(), 1u) << text;
  return diagnostics.empty() ? Diagnostic{} : diagnostics.items().front();
}

TEST(ExpressionTest, OperatorsBindAsInMathematics) {
  EXPECT_EQ(value_of("1 + 2*3"), 7);
  EXPECT_EQ(value_of("2 - 3 - 4"), -5);
  EXPECT_EQ(value_of("24/4/3"), 2);
  EXPECT_EQ(value_of("2^3^2"), 512);
  EXPECT_EQ(value_of("-3^2"), -9);
  EXPECT_EQ(value_of("(-3)^2"), 9);
  EXPECT_EQ(value_of("2^-1"), 0.5);
  EXPECT_EQ(value_of("3^3 + 3^4*100 + 2^5*10000"), 328127);
  EXPECT_EQ(value_of("4^-2 + 0^0"), 1.0625);
  EXPECT_EQ(value_of("2*-3"), -6);
  EXPECT_EQ(value_of("- -+3"), 3);
  EXPECT_EQ(value_of(" ( 1+1 ) * .5e+1 "), 10);
}

TEST(ExpressionTest, FunctionsHaveTheirUsualValues) {
  EXPECT_DOUBLE_EQ(value_of("sin(pi/6) + cos(0) + tan(pi/4)"), 2.5);
  EXPECT_DOUBLE_EQ(value_of("asin(1) + acos(1) + atan(1)"), 0.75 * M_PI);
  EXPECT_DOUBLE_EQ(value_of("atan2(1, -1)"), 0.75 * M_PI);
  EXPECT_DOUBLE_EQ(value_of("log(exp(2)) + log10(1000)"), 5);
  EXPECT_DOUBLE_EQ(value_of("cosh(1)^2 - sinh(1)^2"), 1);
  EXPECT_EQ(value_of("min(3, 1, 2) + max(3, 1, 2)*10"), 31);
  EXPECT_EQ(value_of("sign(-2) + sign(0)*10 + sign(5)*100"), 99);
  EXPECT_EQ(value_of("mod(7, 3) + mod(-1, 3)*10"), 21);
  EXPECT_EQ(value_of("pow(2, 10) + hypot(3, 4) + sqrt(16) + abs(-1) + floor(2.7)"), 1024 + 5 + 4 + 1 + 2);
  EXPECT_EQ(value_of("smoothstep(-1) + smoothstep(0.5) + smoothstep(2)"), 1.5);
  EXPECT_EQ(value_of("smootherstep(-1) + smootherstep(0.5) + smootherstep(2)"), 1.5);
}

TEST(ExpressionTest, IfChoosesByAComparison) {
  EXPECT_EQ(value_of("if(1 < 2, 10, 20)"), 10);
  EXPECT_EQ(value_of("if(2 <= 1, 10, 20)"), 20);
  EXPECT_EQ(value_of("if(1 + 1 >= 2, 10, 20)"), 10);
  EXPECT_EQ(value_of("if(1 > 2, log(-1), 20)"), 20);
}

TEST(ExpressionTest, LiteralsMayCarryUnits) {
  EXPECT_EQ(value_of("5 mm"), 0.005);
  EXPECT_EQ(value_of("5mm"), 0.005);
  EXPECT_DOUBLE_EQ(value_of("30 deg"), M_PI / 6);
  EXPECT_EQ(value_of("200 N/mm"), 200e3);
  EXPECT_EQ(value_of("5 mm^2"), 5e-6);
  EXPECT_EQ(value_of("5 mm²"), 5e-6);
  EXPECT_DOUBLE_EQ(value_of("(5 mm)^2"), 25e-6);
  EXPECT_EQ(value_of("2 kg*m^2/s^2*3"), 6);
  EXPECT_EQ(value_of("4 s^-1"), 4);
  EXPECT_EQ(value_of("5 mm/2"), 0.0025);
  EXPECT_EQ(value_of("6 mm*min(2, 3)"), 0.012);
  EXPECT_EQ(value_of("1 m + 2 mm"), 1.002);
}

TEST(ExpressionTest, AUnitEndsAtASpaceSoThatNamesMayFollow) {
  EXPECT_TRUE(parsed("2 m/s").names().empty());
  const std::vector<ExpressionName> names = parsed("2 m / s").names();
  ASSERT_EQ(names.size(), 1u);
  EXPECT_EQ(names[0].name, "s");
  EXPECT_TRUE(parsed("5 mm*r").depends_on("r"));
  EXPECT_TRUE(parsed("5 mm*m.position").depends_on("m.position"));
}

TEST(ExpressionTest, NamesComeOnceInOrderWithTheirFirstPlace) {
  Diagnostics diagnostics;
  const auto e = Expression::parse("b*main.position + sin(a)*b + pi", {7, 20, 0}, diagnostics);
  ASSERT_TRUE(e);
  const std::vector<ExpressionName> names = e->names();
  ASSERT_EQ(names.size(), 3u);
  EXPECT_EQ(names[0].name, "b");
  EXPECT_EQ(names[0].at, (SourceRange{7, 20, 1}));
  EXPECT_EQ(names[1].name, "main.position");
  EXPECT_EQ(names[1].at, (SourceRange{7, 22, 13}));
  EXPECT_EQ(names[2].name, "a");
  EXPECT_EQ(e->at(), (SourceRange{7, 20, 31}));
  EXPECT_FALSE(e->depends_on("pi"));
  EXPECT_FALSE(e->constant_value());
}

TEST(ExpressionTest, PlacesFollowLineBreaks) {
  Diagnostics diagnostics;
  EXPECT_FALSE(Expression::parse("a +\n b + ?", {4, 9, 0}, diagnostics));
  ASSERT_EQ(diagnostics.items().size(), 1u);
  EXPECT_EQ(diagnostics.items()[0].at, (SourceRange{5, 6, 1}));
}

struct Mistake {
  const char* text;
  const char* code;
  int column;  // From 1 in the text.
  const char* message;
  const char* hint;
};

TEST(ExpressionTest, EveryMistakeHasItsColumnAndItsRemedy) {
  const Mistake mistakes[] = {
      {"", "F401", 1, "empty", ""},
      {"   ", "F401", 1, "empty", ""},
      {"x**2", "F401", 2, "got '*'", "'^'"},
      {"1 +", "F401", 4, "ends where", ""},
      {"(1 + 2", "F401", 1, "never closed", ""},
      {"1 + 2)", "F401", 6, "got ')'", ""},
      {"2(x)", "F401", 2, "operator", "'*'"},
      {"a b", "F401", 3, "operator", "'*'"},
      {"1,5", "F401", 2, "got ','", "decimal point"},
      {"x = 3", "F401", 3, "got '='", "assignment"},
      {"a < b", "F401", 3, "got '<'", "if(a < b, then, else)"},
      {"if(a == b, 1, 2)", "F401", 6, "comparison", "if(a < b, then, else)"},
      {"if(a, 1, 2)", "F401", 5, "comparison", "if(a < b, then, else)"},
      {"if(0 < a < 1, 1, 2)", "F401", 10, "got '<'", "once"},
      {"sin", "F401", 1, "function", "sin(...)"},
      {"if + 1", "F401", 1, "function", "if(a < b, then, else)"},
      {"3 mm ^2", "F401", 6, "not clear", "(5 mm)^2"},
      {"3 mm^x", "F401", 5, "not clear", "(5 mm)^2"},
      {"3 − 2", "F401", 3, "'−'", "minus"},
      {"2·x", "F401", 2, "'·'", "'*'"},
      {"θ", "F401", 1, "'θ'", "letters"},
      {"a.", "F401", 2, "'.'", ""},
      {"a..b", "F401", 2, "'.'", ""},
      {"1.2.3", "F401", 4, "got '.'", ""},
      {"\x01", "F401", 1, "byte 0x01", ""},
      {"x \xff", "F401", 3, "byte 0xFF", ""},
      {"ln(x)", "F402", 1, "no function 'ln'", "'log'"},
      {"1 + sine(x)", "F402", 5, "no function 'sine'", "'sin'"},
      {"main.position(3)", "F402", 1, "no function", "'*'"},
      {"sin(1, 2)", "F404", 1, "takes 1 argument, got 2", ""},
      {"2 + atan2(1)", "F404", 5, "takes 2 arguments, got 1", ""},
      {"max(1)", "F404", 1, "2 or more arguments, got 1", ""},
      {"cos()", "F404", 1, "got 0", ""},
      {"1e999", "F406", 1, "too large", ""},
      {"3 + 5 furlong", "F407", 7, "'furlong' is not a unit", "'*'"},
      {"2x", "F407", 2, "'x' is not a unit", "'*'"},
      {"2 main.position", "F407", 3, "'main.position' is not a unit", "'*'"},
      {"2 pi", "F407", 3, "'pi' is not a unit", "'*'"},
      {"2 m2", "F407", 3, "'m2' is not a unit", "'*'"},
      {"2 _a", "F407", 3, "'_a' is not a unit", "'*'"},
  };
  for (const Mistake& mistake : mistakes) {
    SCOPED_TRACE(mistake.text);
    const Diagnostic d = only_error(mistake.text);
    EXPECT_EQ(d.code, mistake.code);
    EXPECT_EQ(d.at.line, 3);
    EXPECT_EQ(d.at.column, 10 + mistake.column);
    EXPECT_NE(d.message.find(mistake.message), std::string::npos) << d.message;
    EXPECT_NE(d.hint.find(mistake.hint), std::string::npos) << d.hint;
  }
  EXPECT_EQ(only_error(std::string_view("a\0b", 3)).at.column, 12);
  EXPECT_EQ(only_error("1 +", {}).at, (SourceRange{0, 4, 0}));
}

TEST(ExpressionTest, WrongWordsAreAllReportedAtOnce) {
  Diagnostics diagnostics;
  EXPECT_FALSE(Expression::parse("ln(x) + 5 furlong + sin(1, 2) + 1e999", {1, 1, 0}, diagnostics));
  std::string codes;
  for (const Diagnostic& d : diagnostics.items()) codes += d.code + " ";
  EXPECT_EQ(codes, "F402 F407 F404 F406 ");
}

std::string repeated(std::string_view piece, int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += piece;
  return text;
}

TEST(ExpressionTest, DeepNestingIsAnErrorAndNeverExhaustsTheStack) {
  for (const char* piece : {"(", "-", "+", "2^", "sin(", "if(1<", "x^-", "min(1,", "(-"}) {
    for (const int count : {250, 3000, 100000}) {
      const Diagnostic d = only_error(repeated(piece, count) + "x");
      EXPECT_EQ(d.code, "F405") << piece << " " << count;
    }
  }
  EXPECT_EQ(value_of(repeated("(", 190) + "1" + repeated(")", 190)), 1);
  EXPECT_EQ(value_of(repeated("-", 190) + "1"), 1);
}

TEST(ExpressionTest, LongFlatFormulasAreFine) {
  EXPECT_EQ(value_of("0" + repeated("+1", 8000)), 8000);
  EXPECT_EQ(value_of("min(1" + repeated(",1", 500) + ")"), 1);
  EXPECT_EQ(only_error("0" + repeated("+1", 9000)).code, "F405");
}

TEST(ExpressionTest, SubstitutionReplacesNamesAndGrowsByAdditionOnly) {
  const Expression r = parsed("2*x");
  const Expression e = parsed("a*a + y").substitute([&](std::string_view name) -> std::optional<Expression> {
    if (name == "a") return r;
    return std::nullopt;
  });
  EXPECT_EQ(value_at(e, 3, 5), 41);
  // 200 doublings: 2^200 leaves if every use were copied.
  Expression doubled = parsed("x");
  for (int i = 0; i < 200; ++i) {
    doubled = parsed("a + a").substitute([&](std::string_view) { return std::optional(doubled); });
  }
  EXPECT_EQ(value_at(doubled, 1, 0), std::pow(2.0, 200));
  EXPECT_EQ(value_at(doubled.derivative("x"), 1, 0), std::pow(2.0, 200));
}

TEST(ExpressionTest, AnyDepthMayBeBuiltDifferentiatedAndDestroyed) {
  Expression deep = parsed("x");
  for (int i = 0; i < 2000; ++i) {
    deep = parsed("a + 1").substitute([&](std::string_view) { return std::optional(deep); });
  }
  const Expression copy = deep;
  EXPECT_EQ(value_at(deep, 1, 0), 2001);
  EXPECT_EQ(deep.derivative("x").to_string(), "1");
  EXPECT_EQ(copy.to_string().size(), 1 + 2000 * 4u);
}

TEST(ExpressionTest, KeywordsMayNotBeNames) {
  EXPECT_TRUE(is_expression_keyword("pi"));
  EXPECT_TRUE(is_expression_keyword("if"));
  EXPECT_TRUE(is_expression_keyword("sin"));
  EXPECT_FALSE(is_expression_keyword("sine"));
  EXPECT_FALSE(is_expression_keyword("r"));
}

TEST(ExpressionTest, ConstantsAndVariablesNeedNoText) {
  EXPECT_EQ(Expression().constant_value(), 0.0);
  EXPECT_EQ(Expression::constant(-2.5).to_string(), "-2.5");
  EXPECT_EQ(Expression::variable("main.position").to_string(), "main.position");
  EXPECT_THROW(Expression::constant(INFINITY), std::invalid_argument);
}

TEST(ExpressionTest, TextKeepsTheOrderOfOperations) {
  for (const char* text : {"a + b + c",
                           "a + (b + c)",
                           "a - (b - c)",
                           "a / (b * c)",
                           "a * (b / c)",
                           "-a^2",
                           "(-a)^2",
                           "2^-a^b",
                           "(a^b)^c",
                           "(3 mm)^2",
                           "3 mm * m",
                           "a * -b",
                           "-(a + b)",
                           "min(a, b, c)",
                           "min(a, min(b, c))",
                           "if(a + 1 <= b, c, -c)",
                           "1e-07 + pi",
                           "atan2(a, b)",
                           "-3 deg",
                           "a - -b"}) {
    EXPECT_EQ(parsed(text).to_string(), text);
  }
  EXPECT_EQ(parsed("pow(a, b)").to_string(), "a^b");
  EXPECT_EQ(Expression::constant(-3).to_string(), "-3");
}

bool same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

RC_GTEST_PROP(ExpressionTest, TextReadsBackAsTheSameFormula, ()) {
  const Expression e = parsed(random_formula(4));
  const Expression back = parsed(e.to_string());
  RC_ASSERT(back.to_string() == e.to_string());
  const double x = *rc::gen::inRange(-300, 300) * 0.01, y = *rc::gen::inRange(-300, 300) * 0.01;
  RC_ASSERT(same(value_at(back, x, y), value_at(e, x, y)));
  const Expression slope = e.derivative("x");
  RC_ASSERT(same(value_at(parsed(slope.to_string()), x, y), value_at(slope, x, y)));
}

void check_survives(const std::string& text) {
  Diagnostics diagnostics;
  const std::optional<Expression> e = Expression::parse(text, {1, 5, 0}, diagnostics);
  RC_ASSERT(e.has_value() != diagnostics.has_errors());
  for (const Diagnostic& d : diagnostics.items()) {
    RC_ASSERT(d.at.line >= 1 && d.at.column >= 1);
    RC_ASSERT(!format_diagnostic(d, "f", "    " + text).empty());
  }
  if (e) {
    RC_ASSERT(Expression::parse(e->to_string(), {}, diagnostics).has_value());
    e->dimension([](std::string_view) { return std::nullopt; }, diagnostics);
    RC_ASSERT(!e->derivative("x").to_string().empty());
  }
}

RC_GTEST_PROP(ExpressionTest, NoBytesBreakTheParser, (const std::string& bytes)) { check_survives(bytes); }

RC_GTEST_PROP(ExpressionTest, NoSoupOfWordsBreaksTheParser, ()) {
  const char* words[] = {"x", "y.z", "1", "2.5", "1e3", "mm", "N/m", "^",  "^2",   "*",   "/",
                         "+", "-",   "(", ")",   ",",   "if", "<",   ">=", "sin",  "min", "pi",
                         " ", "\n",  "²", "·",   "θ",   ".",  "e5",  "1e", "\xc3", "_"};
  std::string text;
  const int count = *rc::gen::inRange(1, 25);
  for (int i = 0; i < count; ++i) text += words[*rc::gen::inRange<std::size_t>(0, std::size(words))];
  check_survives(text);
}

RC_GTEST_PROP(ExpressionTest, ABrokenFormulaNeverBreaksTheParser, ()) {
  std::string text = random_formula(3);
  const auto place = *rc::gen::inRange<std::size_t>(0, text.size());
  if (*rc::gen::arbitrary<bool>()) {
    text.erase(place, 1);
  } else {
    text[place] = *rc::gen::arbitrary<char>();
  }
  check_survives(text);
}

}  // namespace
}  // namespace ferrers
