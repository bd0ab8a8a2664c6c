#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <stdexcept>

#include "ferrers/math/expression.h"
#include "ferrers/testing/allocation_guard.h"
#include "ferrers/testing/andrews_formulas.h"
#include "ferrers/testing/random_formula.h"
#include "ferrers/testing/random_source.h"

namespace ferrers {
namespace {

using expression_testing::parsed;
using namespace witness;  // NOLINT(google-build-using-namespace): a test

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
  const std::vector<std::string> inputs{"x"};
  const double x = 0;
  for (const int blocks : {1, 10, 90, 400}) {
    Expression e = parsed("x");
    for (int i = 0; i < blocks; ++i) {
      std::string text = "a";
      for (int k = 0; k < kLevels; ++k) text = "cos(" + std::to_string(i * kLevels + k) + "*x) + (" + text + ")";
      e = parsed(text).substitute([&](std::string_view name) { return name == "a" ? std::optional(e) : std::nullopt; });
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

TEST(ExpressionProgramTest, SeveralFormulasAreOneProgram) {
  const std::vector<std::string> inputs{"x", "y"};
  const std::vector<Expression> outputs{parsed("x*y"), parsed("y"), parsed("3"), parsed("sin(y*x) + 3"), parsed("x*y")};
  const ExpressionProgram program(outputs, inputs);
  ASSERT_EQ(program.output_count(), 5);
  const double values[] = {2, 5};
  double results[5];
  program.evaluate(values, results);
  EXPECT_EQ(results[0], 10);
  EXPECT_EQ(results[1], 5);
  EXPECT_EQ(results[2], 3);
  EXPECT_EQ(results[3], std::sin(10) + 3);
  EXPECT_EQ(results[4], 10);
}

TEST(ExpressionProgramTest, OutputsMayTakeThePlaceOfTheInputs) {
  const std::vector<std::string> inputs{"x", "y"};
  const std::vector<Expression> outputs{parsed("y"), parsed("x")};
  double values[] = {2, 5};
  ExpressionProgram(outputs, inputs).evaluate(values, values);
  EXPECT_EQ(values[0], 5);
  EXPECT_EQ(values[1], 2);
}

TEST(ExpressionProgramTest, WhatSeveralFormulasShareIsComputedOnce) {
  const std::vector<std::string> inputs{"x", "y"};
  const std::vector<Expression> outputs{parsed("sin(x*y)*exp(x)"), parsed("exp(x)*sin(y*x)"), parsed("sin(x*y) - y")};
  EXPECT_EQ(ExpressionProgram(outputs, inputs).instruction_count(), 5);
}

TEST(ExpressionProgramTest, WhatDependsOnNoInputIsComputedBeforehand) {
  const std::vector<std::string> inputs{"x"};
  EXPECT_EQ(ExpressionProgram(parsed("x + sin(2)*3^2 - if(1 < 2, 0, x)"), inputs).instruction_count(), 1);
}

TEST(ExpressionProgramTest, NoFormulaIsAProgramToo) {
  const ExpressionProgram program(std::span<const Expression>(), {});
  EXPECT_EQ(program.output_count(), 0);
  program.evaluate(nullptr, nullptr);
  EXPECT_THROW(program.evaluate(nullptr), std::invalid_argument);
}

RC_GTEST_PROP(ExpressionProgramTest, AProgramOfSeveralGivesWhatEachGivesAlone, ()) {
  std::vector<Expression> outputs;
  for (int i = 0; i < 4; ++i) outputs.push_back(parsed(expression_testing::random_formula(4)));
  for (int i = 0; i < 4; ++i) outputs.push_back(outputs[static_cast<std::size_t>(i)].derivative("x"));
  const std::vector<std::string> inputs{"x", "y"};
  const double values[] = {*rc::gen::inRange(-300, 300) * 0.01, *rc::gen::inRange(-300, 300) * 0.01};
  const ExpressionProgram together(outputs, inputs);
  double results[8];
  together.evaluate(values, results);
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const double alone = ExpressionProgram(outputs[i], inputs).evaluate(values);
    RC_ASSERT(results[i] == alone || (std::isnan(results[i]) && std::isnan(alone)));
  }
}

TEST(ExpressionProgramTest, AMechanismsEquationsAreThoseFoundOnPaper) {
  for (const AndrewsEnergy energy : {AndrewsEnergy::kAngles, AndrewsEnergy::kCentres}) {
    const ExpressionProgram program(andrews_formulas(energy), andrews_inputs());
    RandomSource random(7);
    for (int pose = 0; pose < 20; ++pose) {
      double inputs[2 * kAndrewsCoordinates], got[kAndrewsOutputs], wanted[kAndrewsOutputs];
      for (double& input : inputs) input = random.between(-3, 3);
      program.evaluate(inputs, got);
      compute_andrews_by_hand(inputs, wanted);
      for (int i = 0; i < kAndrewsOutputs; ++i) {
        EXPECT_NEAR(got[i], wanted[i], 1e-14 + 1e-12 * std::abs(wanted[i])) << "output " << i;
      }
    }
  }
}

TEST(ExpressionProgramTest, SineAndCosineTogetherAreThoseAlone) {
  const std::vector<std::string> inputs{"x"};
  const std::vector<Expression> outputs{parsed("sin(x)"), parsed("cos(x)")};
  const ExpressionProgram program(outputs, inputs);
  EXPECT_EQ(program.instruction_count(), 1);
  RandomSource random(3);
  for (int i = 0; i < 20000; ++i) {
    const double x = random.between(-1, 1) * std::pow(10, random.between(-9, 9));
    double results[2];
    program.evaluate(&x, results);
    ASSERT_EQ(results[0], std::sin(x)) << x;
    ASSERT_EQ(results[1], std::cos(x)) << x;
  }
}

TEST(ExpressionProgramTest, EvaluationAllocatesNothing) {
  if (!AllocationGuard::available()) GTEST_SKIP() << "allocations are not counted in this build";
  const std::vector<std::string> names = andrews_inputs();
  const ExpressionProgram program(andrews_formulas(AndrewsEnergy::kCentres), names);
  std::vector<Expression> many;
  for (int i = 0; i < 3000; ++i) many.push_back(parsed("sin(" + std::to_string(i) + "*be)^3 + hypot(th, be^0.3)"));
  const ExpressionProgram large(many, names), single(many[7], names);
  double inputs[2 * kAndrewsCoordinates] = {0.1, 0.2}, outputs[3000];
  EXPECT_GT(large.register_count(), 3000);
  const AllocationGuard guard;
  program.evaluate(inputs, outputs);
  large.evaluate(inputs, outputs);
  single.evaluate(inputs);
  EXPECT_EQ(guard.count(), 0);
}

}  // namespace
}  // namespace ferrers
