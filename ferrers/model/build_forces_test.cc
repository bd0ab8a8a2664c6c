#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "ferrers/testing/build_checks.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers {
namespace {

using namespace witness;  // NOLINT(google-build-using-namespace): a test's vocabulary

/// Bodies a, b, c in a chain: hinge (revolute), tube (cylindrical), ball (spherical); b stands at (1, 0, 0).
ModelSpec chain() {
  ModelSpec spec;
  for (const char* name : {"a", "b", "c"}) {
    BodySpec body;
    body.name = name;
    spec.bodies.push_back(body);
  }
  spec.bodies[1].pose = PoseSpec{number3(1, 0, 0), std::nullopt, {}};
  spec.joints = {joint(JointType::kRevolute, "hinge", "ground", "a", Point::Zero()),
                 joint(JointType::kCylindrical, "tube", "a", "b", Point::Zero()),
                 joint(JointType::kSpherical, "ball", "b", "c", Point::Zero())};
  return spec;
}

CoordinateRef of(const std::string& joint_name, const std::string& coordinate = "") {
  CoordinateRef ref;
  ref.joint = joint_name;
  ref.coordinate = coordinate;
  return ref;
}

template <class Element>
ModelSpec with_force(const Element& element) {
  ModelSpec spec = chain();
  ForceSpec force;
  force.name = "f";
  force.element = element;
  spec.forces = {force};
  return spec;
}

ModelSpec with_coupling(std::vector<CoordinateRef> coordinates, std::vector<Number> coefficients) {
  ModelSpec spec = chain();
  CouplingSpec coupling;
  coupling.name = "gear";
  coupling.coordinates = std::move(coordinates);
  coupling.coefficients = std::move(coefficients);
  spec.couplings = {coupling};
  return spec;
}

SpringSpec spring_between_a_and_b() {
  SpringSpec spring;
  spring.bodies = {NameRef("a"), NameRef("b")};
  spring.points = {number3(0, 0, 0), number3(0, 2, 2)};
  spring.stiffness = 10.0;
  return spring;
}

TEST(BuildCouplingsTest, CoordinatesAreFoundByName) {
  const Model model = built(with_coupling({of("hinge"), of("tube", "displacement")}, {Number(2.0), Number(1.0)}));
  const Coupling& coupling = model.couplings().at(0);
  EXPECT_EQ(coupling.scalars[0].coordinate, (JointCoordinate{JointId(0), 0}));
  EXPECT_EQ(coupling.scalars[1].coordinate, (JointCoordinate{JointId(1), 1}));
  EXPECT_EQ(coupling.coefficients, (std::vector<double>{2.0, 1.0}));
}

TEST(BuildCouplingsTest, WrongCoordinatesAreErrors) {
  const std::vector<Number> two = {Number(1.0), Number(1.0)};
  EXPECT_EQ(build_codes(with_coupling({of("hinge"), of("tube")}, two)), Codes{"F305"});
  EXPECT_EQ(build_codes(with_coupling({of("hinge"), of("tube", "angel")}, two)), Codes{"F305"});
  EXPECT_EQ(build_codes(with_coupling({of("hinge"), of("ball", "omega_x")}, two)), Codes{"F305"});
  EXPECT_EQ(build_codes(with_coupling({of("hinge"), of("hing")}, two)), Codes{"F304"});
  EXPECT_EQ(build_codes(with_coupling({of("hinge"), of("hinge", "angle")}, two)), Codes{"F328"});
}

TEST(BuildCouplingsTest, CoefficientsMustMatchAndNotAllVanish) {
  EXPECT_EQ(build_codes(with_coupling({of("hinge"), of("tube", "angle")}, {Number(1.0)})), Codes{"F328"});
  EXPECT_EQ(build_codes(with_coupling({of("hinge")}, {Number(0.0)})), Codes{"F328"});
}

TEST(BuildCouplingsTest, CouplingMayNotHaveTheNameOfAJoint) {
  ModelSpec spec = with_coupling({of("hinge")}, {Number(1.0)});
  spec.couplings[0].name = "tube";
  EXPECT_EQ(build_codes(spec), Codes{"F302"});
}

TEST(BuildForcesTest, FreeLengthOfASpringIsItsLengthAsDrawn) {
  const Model model = built(with_force(spring_between_a_and_b()));
  const Spring& spring = std::get<Spring>(model.forces().at(0).element);
  EXPECT_EQ(spring.free_length_m, 3.0);  // from the origin to (1, 0, 0) + (0, 2, 2)
  EXPECT_EQ(spring.point_2_m, Vector3d(0, 2, 2));
  SpringSpec shorter = spring_between_a_and_b();
  shorter.free_length = 0.5;
  const Model other = built(with_force(shorter));
  EXPECT_EQ(std::get<Spring>(other.forces()[0].element).free_length_m, 0.5);
}

TEST(BuildForcesTest, NegativeSpringConstantsAreErrors) {
  SpringSpec spring = spring_between_a_and_b();
  spring.stiffness = -1.0;
  spring.damping = -1.0;
  EXPECT_EQ(build_codes(with_force(spring)), (Codes{"F311", "F311"}));
}

TEST(BuildForcesTest, SpringOfABodyWithItselfIsAnError) {
  SpringSpec spring = spring_between_a_and_b();
  spring.bodies[1] = "a";
  EXPECT_EQ(build_codes(with_force(spring)), Codes{"F316"});
}

TEST(BuildForcesTest, TorsionSpringHasTheDimensionOfItsCoordinate) {
  TorsionSpringSpec spring;
  spring.coordinate = of("tube", "angle");
  spring.stiffness = formula("2 N*m");
  EXPECT_EQ(build_codes(with_force(spring)), Codes{});
  spring.stiffness = formula("2 N/m");
  EXPECT_EQ(build_codes(with_force(spring)), Codes{"F204"});
  spring.coordinate = of("tube", "displacement");
  EXPECT_EQ(build_codes(with_force(spring)), Codes{});
}

TEST(BuildForcesTest, DampingOfABallActsOnItsThreeRates) {
  JointDampingSpec damping;
  damping.coordinate = of("ball");
  damping.damping = 0.5;
  const Model model = built(with_force(damping));
  ASSERT_EQ(model.forces().size(), 3U);
  for (int i = 0; i < 3; ++i) {
    const auto& element = std::get<JointDamping>(model.forces()[static_cast<std::size_t>(i)].element);
    EXPECT_EQ(element.coordinate, (JointCoordinate{JointId(2), i}));
    EXPECT_EQ(element.damping, 0.5);
  }
  damping.coordinate = of("tube");
  EXPECT_EQ(build_codes(with_force(damping)), Codes{"F305"});
}

TEST(BuildForcesTest, BushingFramesCoincideAsDrawn) {
  BushingSpec bushing;
  bushing.bodies = {NameRef("a"), NameRef("b")};
  bushing.place.drawn = number3(0, 1, 0);
  bushing.axis.drawn = number3(1, 0, 0);
  bushing.force_stiffness = number3(1, 2, 3);
  const Model model = built(with_force(bushing));
  const Bushing& element = std::get<Bushing>(model.forces().at(0).element);
  EXPECT_LT((element.X_1F.R.col(2) - Vector3d::UnitX()).norm(), 1e-15);
  EXPECT_LT((element.X_2M.p - Vector3d(-1, 1, 0)).norm(), 1e-15);
  EXPECT_EQ(element.stiffness[2], 3.0);
  EXPECT_EQ(element.stiffness[3], 0.0);
  bushing.moment_damping = number3(0, 0, -1);
  bushing.place = {};
  EXPECT_EQ(build_codes(with_force(bushing)), (Codes{"F311", "F317"}));
}

TEST(BuildForcesTest, ForceActsAtItsPlaceElseAtTheMassCentre) {
  LoadSpec load;
  load.body = "c";
  load.components = {law("1"), law("t"), law("hinge.angle")};
  EXPECT_EQ(build_codes(with_force(load)), Codes{"F317"});
  load.place = number3(1, 2, 3);
  const Model model = built(with_force(load));
  EXPECT_EQ(std::get<Load>(model.forces().at(0).element).point_m, Vector3d(1, 2, 3));
  load.place.reset();
  load.is_torque = true;
  EXPECT_EQ(build_codes(with_force(load)), Codes{});
  ModelSpec heavy = with_force(load);
  heavy.bodies[2].com = number3(0, 0, 7);
  const Model other = built(heavy);
  EXPECT_EQ(std::get<Load>(other.forces().at(0).element).point_m, Vector3d(0, 0, 7));
}

TEST(BuildForcesTest, ForceOnAnUnknownBodyIsAnError) {
  LoadSpec load;
  load.body = "d";
  load.components = {law("1"), law("q"), law("0")};
  EXPECT_EQ(build_codes(with_force(load)), (Codes{"F403", "F303"}));
}

}  // namespace
}  // namespace ferrers
