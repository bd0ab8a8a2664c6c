// Native code against the interpreter, bit by bit.

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <bit>
#include <cmath>
#include <numeric>

#include "ferrers/math/expression.h"
#include "ferrers/math/machine_memory.h"
#include "ferrers/testing/andrews_formulas.h"
#include "ferrers/testing/needs_machine_code.h"
#include "ferrers/testing/random_formula.h"
#include "ferrers/testing/random_source.h"

namespace ferrers {
namespace {

using expression_testing::parsed;
using expression_testing::random_formula;
using namespace witness;  // NOLINT(google-build-using-namespace): a test

bool same(double a, double b) {  // of NaN only that it is one
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b) || (std::isnan(a) && std::isnan(b));
}

void expect_same(const ExpressionProgram& program, const std::vector<double>& inputs, const std::string& what) {
  const auto count = static_cast<std::size_t>(program.output_count());
  std::vector<double> native(count, -7), interpreted(count, -8);
  program.evaluate(inputs.data(), native.data());
  program.interpreted().evaluate(inputs.data(), interpreted.data());
  for (std::size_t i = 0; i < count; ++i) {
    EXPECT_TRUE(same(native[i], interpreted[i])) << what << "[" << i << "]: " << native[i] << " " << interpreted[i];
  }
}

TEST(ExpressionMachineTest, GivesTheBitsOfTheInterpreter) {
  NEEDS_MACHINE_CODE();
  EXPECT_TRUE(rc::check([] {
    std::vector<std::string> texts;
    std::vector<Expression> formulas;
    const int count = *rc::gen::inRange(1, 8);
    for (int i = 0; i < count; ++i) texts.push_back(random_formula(5));
    for (const std::string& text : texts) formulas.push_back(parsed(text));
    formulas.push_back(formulas.front());  // an output twice
    formulas.push_back(parsed("y"));       // and ones that nothing computes
    formulas.push_back(parsed("2.5"));
    const std::vector<std::string> names{"x", "y"};
    const ExpressionProgram program(formulas, names);
    for (const auto& [x, y] :
         {std::pair(0.3, -1.7), std::pair(0.0, 0.0), std::pair(-2.0, 3.0), std::pair(1e9, double(NAN))}) {
      expect_same(program, {x, y}, texts.front());
    }
  }));
}

TEST(ExpressionMachineTest, EveryOperationIsThatOfTheInterpreter) {
  NEEDS_MACHINE_CODE();
  std::string padding;  // enough steps to be worth native code
  for (int i = 0; i < 20; ++i) padding += " + x*" + std::to_string(i + 2) + ".5";
  for (const char* text : {"x + y",
                           "x - y",
                           "x*y",
                           "x/y",
                           "-x",
                           "x^y",
                           "x^2",
                           "x^-1",
                           "sin(x)",
                           "cos(x)",
                           "tan(x)",
                           "asin(x)",
                           "sqrt(x)",
                           "abs(x)",
                           "sign(x)",
                           "atan2(x, y)",
                           "hypot(x, y)",
                           "mod(x, y)",
                           "min(x, y)",
                           "max(x, y)",
                           "if(x < y, x, y)",
                           "if(x >= y, 2, 3)",
                           "floor(x)",
                           "exp(x)",
                           "sin(x)*cos(x) - sin(y)",
                           "abs(-x) - sqrt(y*y)",
                           "x - x",
                           "x/x",
                           "sqrt(sqrt(y))",
                           "x*x*y*y",
                           "smoothstep(x)",
                           "log10(y)"}) {
    const std::vector<Expression> outputs{parsed(text), parsed("(" + std::string(text) + ")" + padding)};
    const std::vector<std::string> names{"x", "y"};
    const ExpressionProgram program(outputs, names);
    EXPECT_TRUE(program.is_native());
    const double inf = HUGE_VAL;
    for (const double x : {0.0, -0.0, 0.7, -3.25, 1e308, inf, -inf, double(NAN)}) {
      for (const double y : {0.0, 2.5, -1.5, inf, double(NAN)}) expect_same(program, {x, y}, text);
    }
  }
}

TEST(ExpressionMachineTest, MoreValuesThanRegistersAreKeptInMemory) {
  NEEDS_MACHINE_CODE();
  // Forty sums that all are needed to the end, and calls between them.
  std::vector<Expression> outputs;
  std::string all = "0";
  for (int i = 1; i <= 40; ++i) {
    const std::string one = "(x*" + std::to_string(i) + ".25 + y/" + std::to_string(i) + ")";
    all += " + " + one + "*" + one + "*sin(" + one + ")*cos(" + one + ")";
    outputs.push_back(parsed(one + "*exp(" + one + "/50)"));
  }
  outputs.push_back(parsed(all));
  outputs.push_back(parsed("exp(" + all + ")*x - (" + all + ")"));
  const std::vector<std::string> names{"x", "y"};
  const ExpressionProgram program(outputs, names);
  RandomSource random(5);
  for (int i = 0; i < 100; ++i) expect_same(program, {random.between(-1, 1), random.between(-1, 1)}, "sums");
}

TEST(ExpressionMachineTest, TheSqueezersFormulasGiveTheSameBits) {
  NEEDS_MACHINE_CODE();
  const std::vector<std::string> names = andrews_inputs();
  const ExpressionProgram program(andrews_formulas(AndrewsEnergy::kCentres), names);
  EXPECT_TRUE(program.is_native());
  EXPECT_FALSE(program.interpreted().is_native());
  RandomSource random(9);
  for (int i = 0; i < 200; ++i) {
    std::vector<double> inputs(names.size());
    for (double& input : inputs) input = random.between(-2, 2);
    expect_same(program, inputs, "squeezer");
  }
}

TEST(ExpressionMachineTest, OutputsMayBeTheInputs) {
  std::string text = "x";
  for (int i = 0; i < 30; ++i) text += " + " + std::to_string(i) + ".5*y*x";
  const std::vector<Expression> outputs{parsed(text), parsed(text + " - y"), parsed("x + y")};
  const std::vector<std::string> names{"x", "y"};
  const ExpressionProgram program(outputs, names);
  double apart[3], together[3] = {0.3, 0.8, 0};
  program.evaluate(together, apart);
  program.evaluate(together, together);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(apart[i], together[i]);
}

}  // namespace
}  // namespace ferrers
