#include "ferrers/model/model.h"

#include <gtest/gtest.h>

#include <set>
#include <stdexcept>

#include "ferrers/testing/build_checks.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers {
namespace {

using namespace witness;  // NOLINT(google-build-using-namespace): a test's vocabulary

/// Link a of length r on ground, b on a by a cylindrical joint at distance 2 r, c on b by a ball.
ModelSpec scaled_chain() {
  ModelSpec spec;
  spec.name = "chain";
  spec.parameters = {parameter("r", 0.5), parameter("l", formula("2*r + s")), parameter("s", 0.0)};
  for (const char* name : {"a", "b", "c"}) {
    BodySpec body;
    body.name = name;
    spec.bodies.push_back(body);
  }
  spec.joints = {joint(JointType::kRevolute, "hinge", "ground", "a", Point::Zero()),
                 joint(JointType::kCylindrical, "tube", "a", "b", Point::Zero()),
                 joint(JointType::kSpherical, "ball", "b", "c", Point::Zero())};
  (*spec.joints[1].place.drawn)[0] = formula("l");
  return spec;
}

TEST(ModelTest, FindsByName) {
  const Model model = built(scaled_chain());
  EXPECT_EQ(model.find_body("ground"), kGround);
  EXPECT_EQ(model.find_body("b"), BodyId(2));
  EXPECT_EQ(model.find_joint("ball"), JointId(2));
  EXPECT_FALSE(model.find_body("x"));
  EXPECT_FALSE(model.find_joint("x"));
  EXPECT_EQ(model.name(), "chain");
}

TEST(ModelTest, CoordinateNamesAreThoseOfTheFile) {
  const Model model = built(scaled_chain());
  EXPECT_EQ(model.coordinate_name({JointId(0), 0}), "hinge");
  EXPECT_EQ(model.coordinate_name({JointId(1), 1}), "tube.displacement");
  EXPECT_EQ(model.coordinate_name({JointId(2), 2}), "ball.omega_z");
}

TEST(ModelTest, CoordinateOfAnotherModelIsACallersBug) {
  const Model model = built(scaled_chain());
  EXPECT_THROW(model.coordinate_name({JointId(3), 0}), std::invalid_argument);
  EXPECT_THROW(model.coordinate_name({JointId(), 0}), std::invalid_argument);
  EXPECT_THROW(model.coordinate_name({JointId(0), 1}), std::invalid_argument);
}

TEST(ModelTest, WithParametersRebuildsEverythingThatDependsOnThem) {
  const Model model = built(scaled_chain());
  const ModelBuildResult longer = model.with_parameters({{"r", 2.0}});
  ASSERT_TRUE(longer.model) << messages(longer.diagnostics);
  EXPECT_EQ(longer.model->joints()[1].X_1F.p.x(), 4.0);
  EXPECT_EQ(longer.model->parameters()[1].value, 4.0);
  EXPECT_EQ(model.joints()[1].X_1F.p.x(), 1.0);
}

TEST(ModelTest, ParameterValuesAddUp) {
  const Model model = built(scaled_chain(), {{"r", 1.0}});
  const ModelBuildResult second = model.with_parameters({{"s", 0.25}});
  ASSERT_TRUE(second.model);
  EXPECT_EQ(second.model->parameters()[1].value, 2.25);
  const ModelBuildResult third = second.model->with_parameters({{"r", 3.0}});
  ASSERT_TRUE(third.model);
  EXPECT_EQ(third.model->parameters()[1].value, 6.25);
}

TEST(ModelTest, BadParametersGiveDiagnosticsAndNoModel) {
  const ModelBuildResult result = built(scaled_chain()).with_parameters({{"q", 1.0}});
  EXPECT_FALSE(result.model);
  EXPECT_EQ(codes(result.diagnostics), Codes{"F310"});
}

TEST(ModelTest, IdsStayValidInTheModelWithOtherParameters) {
  const Model model = built(scaled_chain());
  const Model other = *model.with_parameters({{"r", 2.0}}).model;
  for (std::size_t i = 0; i < model.joints().size(); ++i) {
    EXPECT_EQ(other.joint(JointId(i)).name, model.joint(JointId(i)).name);
  }
}

TEST(ModelTest, EveryCodeOfModelBuildingIsDocumented) {
  std::set<std::string_view> known;
  for (const DiagnosticCode& code : diagnostic_codes()) known.insert(code.code);
  for (int number = 301; number <= 333; ++number) EXPECT_EQ(known.count("F" + std::to_string(number)), 1U) << number;
}

}  // namespace
}  // namespace ferrers
