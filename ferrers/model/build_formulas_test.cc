#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ferrers/testing/build_checks.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers {
namespace {

using namespace witness;  // NOLINT(google-build-using-namespace): a test's vocabulary
using testing::HasSubstr;

Expression parsed(const std::string& text) { return *formula(text).expression; }

/// Coordinates x in m and angle in rad beside a hinge of a body.
ModelSpec system_of_two() {
  ModelSpec spec;
  spec.parameters = {parameter("k", 5.0)};
  spec.bodies.push_back(rod_body("arm", Point::Zero(), Point::UnitX(), 1));
  spec.joints = {joint(JointType::kRevolute, "hinge", "ground", "arm", Point::Zero())};
  spec.lagrangian.coordinates.resize(2);
  spec.lagrangian.coordinates[0].name = "x";
  spec.lagrangian.coordinates[0].dimension = kLength;
  spec.lagrangian.coordinates[1].name = "angle";
  spec.lagrangian.kinetic_energy = parsed("x.velocity^2 + angle.velocity^2");
  spec.records = {record("P", "arm", Point::UnitX())};
  return spec;
}

ModelSpec with_constraint(const std::string& text, bool on_velocities = false) {
  ModelSpec spec = system_of_two();
  ConstraintSpec constraint;
  constraint.name = "tie";
  constraint.formula = parsed(text);
  constraint.on_velocities = on_velocities;
  spec.constraints = {constraint};
  return spec;
}

TEST(BuildFormulasTest, ConstraintsReadCoordinatesJointsPointsAndTime) {
  for (const char* text : {"x - k*sin(angle)", "hinge.position - angle", "P.x^2 + P.y*x - t", "hinge.angle*P.z"}) {
    EXPECT_EQ(build_codes(with_constraint(text)), Codes{}) << text;
  }
  const Model model = built(with_constraint("x - k*hinge.position"));
  ASSERT_EQ(model.couplings().size(), 1U);
  EXPECT_EQ(model.couplings()[0].scalars.size(), 2U);
  EXPECT_TRUE(model.is_coordinate(model.find_joint("x")->index()));
}

TEST(BuildFormulasTest, AConstraintMustReadSomethingAndTheRightThing) {
  EXPECT_EQ(build_codes(with_constraint("k - 5")), Codes{"F336"});
  EXPECT_EQ(build_codes(with_constraint("t - 1")), Codes{"F336"});
  EXPECT_EQ(build_codes(with_constraint("x.velocity - angle")), Codes{"F336"});
  EXPECT_EQ(build_codes(with_constraint("x - angle", true)), Codes{"F336"});
  EXPECT_EQ(build_codes(with_constraint("x.velocity^2 - 1", true)), Codes{"F336"});
  EXPECT_EQ(build_codes(with_constraint("x.velocity - k*angle.velocity", true)), Codes{});
}

TEST(BuildFormulasTest, UnknownNamesAreHintedAt) {
  const auto hint = [](const std::string& text, const std::string& code) {
    const ModelBuildResult result = build_model(with_constraint(text));
    EXPECT_EQ(codes(result.diagnostics), Codes{code}) << text;
    return result.diagnostics.items().front().hint;
  };
  EXPECT_THAT(hint("x - angel", "F403"), HasSubstr("angle"));
  EXPECT_THAT(hint("x - hinge", "F403"), HasSubstr("hinge.position"));
  EXPECT_THAT(hint("x - P", "F403"), HasSubstr("P.x"));
  EXPECT_THAT(hint("x - P.w", "F305"), HasSubstr("x.velocity"));
  EXPECT_THAT(hint("x - hinje.position", "F304"), HasSubstr("hinge"));
}

TEST(BuildFormulasTest, NamesMustNotClash) {
  ModelSpec spec = system_of_two();
  spec.lagrangian.coordinates[0].name = "k";
  spec.lagrangian.kinetic_energy = parsed("angle.velocity^2");
  EXPECT_EQ(build_codes(spec), Codes{"F302"});
  spec.lagrangian.coordinates[0].name = "hinge";
  EXPECT_EQ(build_codes(spec), Codes{"F302"});
  spec = with_constraint("x - angle");
  spec.constraints[0].name = "hinge";
  EXPECT_EQ(build_codes(spec), Codes{"F302"});
  spec.constraints[0].name = "tie";
  spec.constraints.push_back(spec.constraints[0]);
  EXPECT_EQ(build_codes(spec), Codes{"F302"});
}

TEST(BuildFormulasTest, NamesThatFormulasAndResultsUseAreNoCoordinates) {
  for (const char* name : {"t", "energy", "pi", "sin"}) {
    ModelSpec spec = system_of_two();
    spec.lagrangian.coordinates[0].name = name;
    spec.lagrangian.kinetic_energy = parsed("angle.velocity^2");
    EXPECT_THAT(build_codes(spec), testing::Contains("F301")) << name;
  }
}

TEST(BuildFormulasTest, RecordedFormulasAreToldApartFromOtherColumns) {
  for (const char* name : {"x", "hinge", "t", "energy"}) {
    ModelSpec spec = system_of_two();
    RecordSpec record;
    record.name = name;
    record.formula = parsed("2*x");
    spec.records.push_back(record);
    EXPECT_EQ(build_codes(spec), Codes{"F302"}) << name;
    spec.records.back().name = "twice";
    EXPECT_EQ(build_codes(spec), Codes{});
  }
}

TEST(BuildFormulasTest, ACoordinateMovesInOneWay) {
  ModelSpec spec = system_of_two();
  spec.motions = {{{NameRef("x"), ""}, law("t")}, {{NameRef("angle"), ""}, law("t")}};
  EXPECT_EQ(build_codes(spec), Codes{});
  spec.motions.push_back({{NameRef("x"), "position"}, law("2*t")});
  EXPECT_EQ(build_codes(spec), Codes{"F302"});
}

TEST(BuildFormulasTest, EnergiesAreChecked) {
  ModelSpec spec = system_of_two();
  spec.lagrangian.potential_energy = parsed("x*angle.velocity");
  EXPECT_EQ(build_codes(spec), Codes{"F337"});
  spec.lagrangian.potential_energy.reset();
  spec.lagrangian.kinetic_energy.reset();
  spec.lagrangian.mass_matrix = {{parsed("2"), parsed("x")}};
  EXPECT_EQ(build_codes(spec), Codes{"F337"});
  spec.lagrangian.mass_matrix = {{parsed("2"), parsed("x")}, {parsed("angle"), parsed("1")}};
  EXPECT_EQ(build_codes(spec), Codes{"F337"});
  spec.lagrangian.mass_matrix[1][0] = parsed("x");
  EXPECT_EQ(build_codes(spec), Codes{});
  spec.lagrangian.kinetic_energy = parsed("x.velocity^2");
  EXPECT_EQ(build_codes(spec), Codes{"F211"});
}

TEST(BuildFormulasTest, DrivesByFormulasAreChecked) {
  const auto drive = [](const std::string& quantity) {
    ModelSpec spec = system_of_two();
    DriveSpec one;
    one.name = "ram";
    one.quantity = parsed(quantity);
    one.effort = {law("1")};
    spec.drives = {one};
    return spec;
  };
  EXPECT_EQ(build_codes(drive("x*cos(angle)")), Codes{});
  EXPECT_EQ(build_codes(drive("k")), Codes{"F329"});
  EXPECT_EQ(build_codes(drive("x.velocity")), Codes{"F329"});
  EXPECT_EQ(build_codes(drive("x*(1 + t)")), Codes{"F329"});
  ModelSpec mapped = drive("x");
  mapped.drives[0].quantity.reset();
  mapped.drives[0].map = {{{NameRef("x"), ""}, parsed("1 + angle")}, {{NameRef("hinge"), ""}, parsed("2")}};
  EXPECT_EQ(build_codes(mapped), Codes{});
  mapped.drives[0].map[0].second = parsed("angle.velocity");
  EXPECT_EQ(build_codes(mapped), Codes{"F329"});
  mapped.drives[0].map[0].second = parsed("1");
  mapped.drives[0].motion = {law("t")};
  EXPECT_EQ(build_codes(mapped), Codes{"F329"});
}

}  // namespace
}  // namespace ferrers
