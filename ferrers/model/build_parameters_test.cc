#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "ferrers/testing/build_checks.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers {
namespace {

using namespace witness;  // NOLINT(google-build-using-namespace): a test's vocabulary
using testing::HasSubstr;

ModelSpec with_parameters(std::vector<ParameterSpec> parameters) {
  ModelSpec spec;
  spec.parameters = std::move(parameters);
  return spec;
}

ParameterSpec bounded(double value, double min, double max) {
  ParameterSpec spec = parameter("r", value);
  spec.min = min;
  spec.max = max;
  return spec;
}

ParameterSpec with_dimension(ParameterSpec spec, Dimension dimension) {
  spec.dimension = dimension;
  return spec;
}

TEST(BuildParametersTest, FormulasMayUseLaterParametersAndPi) {
  const Model model = built(
      with_parameters({parameter("a", formula("2*b + pi")), parameter("b", formula("c^2")), parameter("c", 3.0)}));
  EXPECT_NEAR(model.parameters()[0].value, 18 + M_PI, 1e-14);
  EXPECT_EQ(model.parameters()[1].value, 9.0);
  EXPECT_EQ(model.parameters()[2].name, "c");
}

TEST(BuildParametersTest, LongChainsNeedNoStack) {
  std::vector<ParameterSpec> chain = {parameter("p0", 1.0)};
  for (int i = 1; i < 20000; ++i) {
    chain.push_back(parameter(numbered("p", i), formula(numbered("p", i - 1).append(" + 1"))));
  }
  std::reverse(chain.begin(), chain.end());
  EXPECT_EQ(built(with_parameters(chain)).parameters().front().value, 20000.0);
}

TEST(BuildParametersTest, CycleIsReportedOnceWithItsRingAndNothingElse) {
  const ModelBuildResult result =
      build_model(with_parameters({parameter("a", formula("b + 1")), parameter("b", formula("c")),
                                   parameter("c", formula("a")), parameter("d", formula("a"))}));
  EXPECT_FALSE(result.model);
  ASSERT_EQ(codes(result.diagnostics), Codes{"F307"});
  EXPECT_THAT(result.diagnostics.items()[0].message, HasSubstr("a -> b -> c -> a"));
}

TEST(BuildParametersTest, EveryCycleIsReported) {
  EXPECT_EQ(build_codes(with_parameters({parameter("d", formula("c")), parameter("a", formula("a")),
                                         parameter("b", formula("c")), parameter("c", formula("b"))})),
            (Codes{"F307", "F307"}));
}

TEST(BuildParametersTest, OverrideBreaksACycle) {
  const ModelSpec spec = with_parameters({parameter("a", formula("b")), parameter("b", formula("a"))});
  EXPECT_EQ(built(spec, {{"b", 4.0}}).parameters()[0].value, 4.0);
}

TEST(BuildParametersTest, UnknownNameSuggestsTheNearOne) {
  const ModelBuildResult result =
      build_model(with_parameters({parameter("length", 1.0), parameter("b", formula("2*lenght", {3, 10, 0}))}));
  ASSERT_EQ(codes(result.diagnostics), Codes{"F403"});
  EXPECT_THAT(result.diagnostics.items()[0].hint, HasSubstr("length"));
  EXPECT_EQ(result.diagnostics.items()[0].at.line, 3);
  EXPECT_EQ(result.diagnostics.items()[0].at.column, 12);
}

TEST(BuildParametersTest, WhatFollowsFromABrokenParameterStaysSilent) {
  ModelSpec spec = with_parameters({parameter("a", formula("nobody")), parameter("b", formula("a*2"))});
  spec.gravity = {Number(0), Number(0), formula("b")};
  EXPECT_EQ(build_codes(spec), Codes{"F403"});
}

TEST(BuildParametersTest, TimeIsNoParameter) {
  const ModelBuildResult result = build_model(with_parameters({parameter("a", formula("2*t"))}));
  ASSERT_EQ(codes(result.diagnostics), Codes{"F403"});
  EXPECT_THAT(result.diagnostics.items()[0].hint, HasSubstr("laws"));
}

TEST(BuildParametersTest, ReservedAndRepeatedNamesAreErrors) {
  EXPECT_EQ(build_codes(with_parameters({parameter("t", 1.0), parameter("pi", 3.0)})), (Codes{"F301", "F301"}));
  EXPECT_EQ(build_codes(with_parameters({parameter("r", 1.0), parameter("r", 2.0)})), Codes{"F302"});
  EXPECT_EQ(build_codes(with_parameters({parameter("2r", 1.0), parameter("", 1.0)})), (Codes{"F301", "F301"}));
}

TEST(BuildParametersTest, ValuesOutsideTheirBoundsAreErrors) {
  EXPECT_EQ(build_codes(with_parameters({bounded(1.0, 0.5, 2.0)})), Codes{});
  EXPECT_EQ(build_codes(with_parameters({bounded(0.4, 0.5, 2.0)})), Codes{"F308"});
  EXPECT_EQ(build_codes(with_parameters({bounded(1.0, 2.0, 0.5)})), Codes{"F308"});
  EXPECT_EQ(build_codes(with_parameters({bounded(1.0, 0.5, 2.0)}), {{"r", 3.0}}), Codes{"F308"});
}

TEST(BuildParametersTest, BoundsMayUseOtherParameters) {
  ParameterSpec limited = parameter("a", 5.0);
  limited.max = formula("2*b");
  EXPECT_EQ(build_codes(with_parameters({limited, parameter("b", 2.0)})), Codes{"F308"});
  EXPECT_EQ(build_codes(with_parameters({limited, parameter("b", 3.0)})), Codes{});
}

TEST(BuildParametersTest, NegativeToleranceIsAnError) {
  ParameterSpec spec = parameter("a", 1.0);
  spec.tolerance = -0.1;
  EXPECT_EQ(build_codes(with_parameters({spec})), Codes{"F311"});
}

TEST(BuildParametersTest, NonFiniteResultsAreErrors) {
  EXPECT_EQ(build_codes(with_parameters({parameter("a", formula("1/b")), parameter("b", 0.0)})), Codes{"F408"});
  EXPECT_EQ(build_codes(with_parameters({parameter("a", Number(INFINITY))})), Codes{"F309"});
}

TEST(BuildParametersTest, UnknownOrNonFiniteOverridesAreErrors) {
  const ModelSpec spec = with_parameters({parameter("radius", 1.0)});
  const ModelBuildResult result = build_model(spec, {{"radious", 2.0}});
  ASSERT_EQ(codes(result.diagnostics), Codes{"F310"});
  EXPECT_THAT(result.diagnostics.items()[0].hint, HasSubstr("radius"));
  EXPECT_EQ(build_codes(spec, {{"radius", NAN}}), Codes{"F309"});
}

TEST(BuildParametersTest, DimensionGoesFromParameterToParameterToField) {
  ModelSpec spec = with_parameters({with_dimension(parameter("r", 0.1), kLength), parameter("l", formula("3*r")),
                                    parameter("ratio", formula("l/r"))});
  EXPECT_EQ(built(spec).parameters()[1].dimension, kLength);
  spec.gravity = {Number(0), Number(0), formula("l")};
  const ModelBuildResult result = build_model(spec);
  ASSERT_EQ(codes(result.diagnostics), Codes{"F204"});
  EXPECT_THAT(result.diagnostics.items()[0].message, HasSubstr("wants m/s^2, got m"));
}

TEST(BuildParametersTest, NumbersWithoutAUnitFitAnything) {
  ModelSpec spec = with_parameters({parameter("g", 9.81), parameter("f", formula("sin(2)"))});
  spec.gravity = {formula("2*g"), formula("f"), formula("9.81")};
  EXPECT_EQ(build_codes(spec), Codes{});
}

}  // namespace
}  // namespace ferrers
