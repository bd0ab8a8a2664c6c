#include <gtest/gtest.h>

#include "ferrers/testing/random_formula.h"

namespace ferrers {
namespace {

using expression_testing::parsed;

TEST(ExpressionLatexTest, FormulasAreDrawnAsInBooks) {
  const std::pair<const char*, const char*> cases[] = {
      {"a + b*c", "a + b \\, c"},
      {"(a + b)*c", "\\left(a + b\\right) \\, c"},
      {"a*(-b)", "a \\, \\left(-b\\right)"},
      {"(a + b)/(c - d)", "\\frac{a + b}{c - d}"},
      {"(a/b)^2", "\\left(\\frac{a}{b}\\right)^{2}"},
      {"a^b^c", "a^{b^{c}}"},
      {"-a^2", "-a^{2}"},
      {"(-a)^2", "\\left(-a\\right)^{2}"},
      {"-(a + b)", "-\\left(a + b\\right)"},
      {"a - (b - c)", "a - \\left(b - c\\right)"},
      {"x*2*3.5", "x \\cdot 2 \\cdot 3.5"},
      {"sin(a + b)^2", "\\sin^{2}\\left(a + b\\right)"},
      {"cos(a)*sin(b)", "\\cos\\left(a\\right) \\, \\sin\\left(b\\right)"},
      {"sqrt(a^2 + 1)", "\\sqrt{a^{2} + 1}"},
      {"abs(a)*floor(b)", "\\left|a\\right| \\, \\left\\lfloor b \\right\\rfloor"},
      {"exp(-a)*log(b)", "\\mathrm{e}^{-a} \\, \\ln\\left(b\\right)"},
      {"atan2(a, b)", "\\operatorname{atan2}\\left(a, b\\right)"},
      {"2*pi", "2 \\, \\pi"},
      {"1e-7*a", "1 \\cdot 10^{-7} \\, a"},
      {"5 mm*a", "5\\,\\mathrm{mm} \\, a"},
      {"5 kg*m^2/s", "5\\,\\mathrm{kg \\cdot m^{2}/s}"},
      {"l_1 + main.position + m_ab", "l_{1} + \\mathrm{main.position} + m_{\\mathrm{ab}}"},
      {"if(a < 1, b, c)", "\\begin{cases} b & a < 1 \\\\ c & \\text{otherwise} \\end{cases}"},
  };
  for (const auto& [formula, latex] : cases) EXPECT_EQ(parsed(formula).to_latex(), latex) << formula;
}

// Written out, its second derivative would fill the memory: shared parts come again and again.
TEST(ExpressionLatexTest, AFormulaThatTakesNoEndIsGivenUp) {
  const Expression tower = parsed("y^y^y^y^x^x^x^x^y^y^y^y^x^x^x^x^y^y^y^y^y^y^x");
  EXPECT_NE(tower.derivative("y").derivative("x").to_latex().find("too long"), std::string::npos);
}

TEST(ExpressionLatexTest, NamesAreWrittenAsTheCallerWants) {
  const auto greek = [](std::string_view name) { return name == "phi" ? "\\varphi" : std::string(name); };
  EXPECT_EQ(parsed("phi*r").to_latex(greek), "\\varphi \\, r");
}

}  // namespace
}  // namespace ferrers
