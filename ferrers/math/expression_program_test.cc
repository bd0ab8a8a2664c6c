#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "ferrers/math/expression.h"
#include "ferrers/testing/random_formula.h"

namespace ferrers {
namespace {

using expression_testing::parsed;

TEST(ExpressionProgramTest, InputsAreTakenByTheirNames) {
  const std::vector<std::string> inputs{"t", "main.position", "unused"};
  const ExpressionProgram program(parsed("main.position - 2*t"), inputs);
  const double values[] = {1, 10, NAN};
  EXPECT_EQ(program.evaluate(values), 8);
}

TEST(ExpressionProgramTest, ANameThatIsNoInputIsTheCallersMistake) {
  const std::vector<std::string> inputs{"t"};
  EXPECT_THROW(ExpressionProgram(parsed("t + x"), inputs), std::invalid_argument);
}

TEST(ExpressionProgramTest, TheDefaultProgramIsZero) { EXPECT_EQ(ExpressionProgram().evaluate(nullptr), 0); }

TEST(ExpressionProgramTest, NotANumberIsNeverHidden) {
  const std::vector<std::string> inputs{"x"};
  const double nan = NAN;
  for (const char* text :
       {"min(x, 1)", "min(1, x)", "max(x, 1)", "max(1, x)", "if(x < 1, 2, 3)", "if(x >= 1, 2, 3)", "sign(x)",
        "smoothstep(x)", "smootherstep(x)", "mod(x, 2)", "abs(x)", "x^2", "atan2(x, 1)"}) {
    EXPECT_TRUE(std::isnan(ExpressionProgram(parsed(text), inputs).evaluate(&nan))) << text;
  }
}

TEST(ExpressionProgramTest, RegistersAreReused) {
  std::string sum = "x";
  for (int i = 0; i < 1500; ++i) sum += " + x*2";
  const std::vector<std::string> inputs{"x"};
  const ExpressionProgram program(parsed(sum), inputs);
  EXPECT_LE(program.register_count(), 4);
  const double x = 1;
  EXPECT_EQ(program.evaluate(&x), 3001);
}

TEST(ExpressionProgramTest, ProgramsOfAnySizeGiveTheSameValue) {
  // Sums nested to the right keep a register per level open: a small, a large and an allocated register file.
  constexpr int kLevels = 50;
  std::string text = "a";
  for (int i = 0; i < kLevels; ++i) text = "cos(x) + (" + text + ")";
  const Expression block = parsed(text);
  const std::vector<std::string> inputs{"x"};
  const double x = 0;
  for (const int blocks : {1, 4, 90}) {
    Expression e = parsed("x");
    for (int i = 0; i < blocks; ++i) {
      e = block.substitute([&](std::string_view name) { return name == "a" ? std::optional(e) : std::nullopt; });
    }
    const ExpressionProgram program(e, inputs);
    EXPECT_GE(program.register_count(), blocks * kLevels);
    EXPECT_EQ(program.evaluate(&x), blocks * kLevels);
  }
}

TEST(ExpressionProgramTest, SharedPartsAreComputedOnce) {
  // Written out, the second derivative of a nest of 100 sines has about 100³/2 operations.
  std::string nested = "x";
  for (int i = 0; i < 100; ++i) nested = "sin(" + nested + ")";
  const std::vector<std::string> inputs{"x"};
  const ExpressionProgram program(parsed(nested).derivative("x").derivative("x"), inputs);
  EXPECT_LT(program.instruction_count(), 2000);
}

}  // namespace
}  // namespace ferrers
