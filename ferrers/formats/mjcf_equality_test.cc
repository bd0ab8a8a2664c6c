#include <cmath>

#include "ferrers/formats/mjcf_test_model.h"

namespace ferrers {
namespace {

using mjcf_testing::build;
using mjcf_testing::joint_of;
using mjcf_testing::messages;
using mjcf_testing::read_text;
using mjcf_testing::values;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kPi = 3.14159265358979323846;

/// Two bodies on hinges about y, 1 m apart, and what <equality>, <tendon> and so on say of them.
std::string two_arms(const std::string& more) {
  return R"(<mujoco><worldbody>
    <body name="a"><joint name="ja" axis="0 1 0"/><geom size="0.1"/><site name="sa" pos="0 0 1"/></body>
    <body name="b" pos="1 0 0" euler="0 0 90"><joint name="jb" axis="1 0 0"/><geom size="0.1"/>
      <site name="sb" pos="0 0 2"/></body></worldbody>)" +
         more + "</mujoco>";
}

TEST(MjcfEqualityTest, AConnectMeetsWhereTheReferenceConfigurationHasIt) {
  const auto read =
      read_text(two_arms("<equality><connect name='c' body1='a' body2='b' anchor='0.5 0 1'/></equality>"));
  const JointSpec& joint = joint_of(read.model.spec, "c");
  EXPECT_EQ(joint.type, JointType::kSpherical);
  EXPECT_EQ(values((*joint.frames)[0].position), (std::array<double, 3>{0.5, 0, 1}));
  const auto on_second = values((*joint.frames)[1].position);
  EXPECT_NEAR(on_second[0], 0, 1e-15);
  EXPECT_NEAR(on_second[1], 0.5, 1e-15);
  EXPECT_NEAR(on_second[2], 1, 1e-15);
}

TEST(MjcfEqualityTest, WithoutASecondBodyTheWorldIsMeant) {
  const auto read = read_text(two_arms("<equality><connect name='c' body1='b' anchor='0 0 0'/></equality>"));
  EXPECT_EQ(joint_of(read.model.spec, "c").bodies[1].name, "ground");
  EXPECT_NEAR(values((*joint_of(read.model.spec, "c").frames)[1].position)[0], 1, 1e-15);
}

TEST(MjcfEqualityTest, SitesMeetWhereTheyAreOnTheirBodies) {
  const auto read =
      read_text(two_arms("<equality><connect name='c' site1='sa' site2='sb'/>"
                         "<weld name='w' site1='sa' site2='sb'/></equality>"));
  EXPECT_EQ(values((*joint_of(read.model.spec, "c").frames)[1].position), (std::array<double, 3>{0, 0, 2}));
  EXPECT_EQ(joint_of(read.model.spec, "w").type, JointType::kWeld);
}

TEST(MjcfEqualityTest, AWeldHoldsTheReferencePoseOrTheOneThatItSays) {
  const auto read =
      read_text(two_arms("<equality><weld name='as_drawn' body1='a' body2='b'/>"
                         "<weld name='said' body1='a' body2='b' relpose='1 2 3 0 1 0 0' anchor='0 0 4'/>"
                         "</equality>"));
  const auto frames = *joint_of(read.model.spec, "as_drawn").frames;
  EXPECT_EQ(values(frames[0].position), (std::array<double, 3>{1, 0, 0}));
  EXPECT_EQ(values(frames[1].position), (std::array<double, 3>{0, 0, 0}));
  const auto said = *joint_of(read.model.spec, "said").frames;
  EXPECT_EQ(values(said[0].position), (std::array<double, 3>{1, 2, 3}));
  EXPECT_EQ((*said[0].rotation->quaternion)[1].value, 1);
  EXPECT_EQ(values(said[1].position), (std::array<double, 3>{0, 0, 4}));
}

TEST(MjcfEqualityTest, AWeldWithoutTorqueHoldsAPoint) {
  const auto read = read_text(two_arms("<equality><weld name='w' body1='a' body2='b' torquescale='0'/></equality>"));
  EXPECT_EQ(joint_of(read.model.spec, "w").type, JointType::kSpherical);
}

TEST(MjcfEqualityTest, ProportionalJointsAreACouplingAndOthersAFormula) {
  const auto read =
      read_text(two_arms("<equality><joint name='p' joint1='ja' joint2='jb' polycoef='0 2 0 0 0'/>"
                         "<joint name='q' joint1='ja' joint2='jb' polycoef='0.1 0 3'/>"
                         "<joint name='r' joint1='jb' polycoef='0.5'/></equality>"));
  ASSERT_EQ(read.model.spec.couplings.size(), 1U);
  const CouplingSpec& coupling = read.model.spec.couplings[0];
  EXPECT_EQ(coupling.coefficients[0].value, 1);
  EXPECT_EQ(coupling.coefficients[1].value, -2);
  ASSERT_EQ(read.model.spec.constraints.size(), 2U);
  const std::vector<std::string> inputs = {"ja.position", "jb.position"};
  const double at[] = {0.7, 0.2};
  EXPECT_NEAR(ExpressionProgram(read.model.spec.constraints[0].formula, inputs).evaluate(at), 0.7 - 0.1 - 3 * 0.04,
              1e-15);
  EXPECT_NEAR(ExpressionProgram(read.model.spec.constraints[1].formula, inputs).evaluate(at), 0.2 - 0.5, 1e-15);
}

TEST(MjcfEqualityTest, PolynomialsCountFromTheReferenceConfiguration) {
  const auto read = read_text(R"(<mujoco><compiler angle="radian"/><worldbody>
      <body><joint name="x" ref="0.5"/><geom size="1"/></body><body><joint name="y" ref="2"/><geom size="1"/></body>
    </worldbody><equality><joint name="p" joint1="y" joint2="x" polycoef="0.1 2 0 0 1"/></equality></mujoco>)");
  ASSERT_EQ(read.model.spec.constraints.size(), 1U) << messages(read.diagnostics);
  const std::vector<std::string> inputs = {"x.position", "y.position"};
  const double x = 0.8, d = x - 0.5;
  const double at[] = {x, 2 + 0.1 + 2 * d + std::pow(d, 4)};
  EXPECT_NEAR(ExpressionProgram(read.model.spec.constraints[0].formula, inputs).evaluate(at), 0, 1e-14);
}

TEST(MjcfEqualityTest, FixedTendonsAreSumsOfCoordinates) {
  const std::string tendons =
      "<tendon><fixed name='s'><joint joint='ja' coef='1'/><joint joint='jb' coef='2'/></fixed>"
      "<fixed name='t'><joint joint='jb' coef='5'/></fixed></tendon>";
  const auto read = read_text(two_arms(tendons + "<equality><tendon name='e' tendon1='s' tendon2='t' polycoef='0 3'/>"
                                                 "</equality><actuator><motor name='m' tendon='s'/></actuator>"));
  ASSERT_EQ(read.model.spec.couplings.size(), 1U) << messages(read.diagnostics);
  EXPECT_EQ(read.model.spec.couplings[0].coefficients[1].value, 2 - 15);
  ASSERT_EQ(read.model.spec.drives.size(), 1U);
  const std::vector<std::string> inputs = {"ja.position", "jb.position"};
  const double at[] = {1, 10};
  EXPECT_EQ(ExpressionProgram(*read.model.spec.drives[0].quantity, inputs).evaluate(at), 21);
}

TEST(MjcfEqualityTest, WhatIsNotActiveIsLeftOutAndSaid) {
  const auto read = read_text(two_arms("<equality><connect body1='a' anchor='0 0 0' active='false'/></equality>"));
  EXPECT_EQ(read.model.spec.joints.size(), 2U);
  EXPECT_THAT(messages(read.diagnostics), HasSubstr("a <connect> that is not active is left out"));
  const auto off =
      read_text(two_arms("<option><flag equality='disable'/></option>"
                         "<equality><connect body1='a' anchor='0 0 0'/></equality>"));
  EXPECT_EQ(off.model.spec.joints.size(), 2U);
}

TEST(MjcfForcesTest, SpringsDampersRotorsAndWeightBecomeForces) {
  const auto read = read_text(R"(<mujoco><option gravity="0 0 -10"/><worldbody><body name="a" gravcomp="0.5">
      <joint name="j" stiffness="3" springref="90" damping="2" armature="0.4"/>
      <geom size="1" mass="6"/></body></worldbody></mujoco>)");
  const ModelSpec& spec = read.model.spec;
  ASSERT_EQ(spec.forces.size(), 3U);
  const auto& spring = std::get<TorsionSpringSpec>(spec.forces[0].element);
  EXPECT_EQ(spring.stiffness.value, 3);
  EXPECT_NEAR(spring.free_angle.value, kPi / 2, 1e-15);
  EXPECT_EQ(std::get<JointDampingSpec>(spec.forces[1].element).damping.value, 2);
  EXPECT_EQ(std::get<LoadSpec>(spec.forces[2].element).components[2].expression->constant_value(), 30.0);
  const std::vector<std::string> inputs = {"j.velocity"};
  const double v[] = {3};
  EXPECT_NEAR(ExpressionProgram(*spec.lagrangian.kinetic_energy, inputs).evaluate(v), 0.5 * 0.4 * 9, 1e-15);
}

TEST(MjcfForcesTest, TheyAreLeftOutWhereAsked) {
  ImportOptions options;
  options.ignore_armature = options.ignore_damping = options.ignore_springs = true;
  const auto read = read_text(
      "<mujoco><worldbody><body><joint stiffness='3' damping='2' armature='1'/><geom size='1'/>"
      "</body></worldbody></mujoco>",
      options);
  EXPECT_TRUE(read.model.spec.forces.empty());
  EXPECT_FALSE(read.model.spec.lagrangian.given());
}

TEST(MjcfForcesTest, BallsAndFreeBodiesHaveThemInEveryDirection) {
  const Model model = build(R"(<mujoco><worldbody>
      <body name="a"><joint name="ball" type="ball" stiffness="3" damping="2" armature="0.4"/><geom size="1"/></body>
      <body name="b"><joint name="free" type="free" stiffness="5" damping="2" armature="0.4"/><geom size="1"/></body>
    </worldbody></mujoco>)");
  ASSERT_EQ(model.forces().size(),
            2U + 3U + 1U);  // bushings of both, a damper per axis of the ball, one of the free body
  EXPECT_EQ(model.lagrangian().mass.size(), 9U);
}

TEST(MjcfForcesTest, PolynomialSpringsAndDampersActAlongTheirCoordinate) {
  const auto read = read_text(
      "<mujoco><compiler angle='radian'/><worldbody><body><joint name='j' stiffness='0 2 3' "
      "springref='0.5' damping='0 4 5'/><geom size='1'/></body></worldbody></mujoco>");
  const auto& forces = read.model.spec.lagrangian.forces;
  ASSERT_EQ(forces.size(), 1U);
  const std::vector<std::string> inputs = {"j.position", "j.velocity"};
  const double at[] = {1.5, -2};
  EXPECT_NEAR(ExpressionProgram(forces[0].second, inputs).evaluate(at), -5 + 16 + 40, 1e-14);
}

TEST(MjcfForcesTest, ATimeConstantAndADampingRatioAreStiffnessAndDampingOfWhatHangsOnTheJoint) {
  // One mass on a slide: k = m / (T d)^2 and d = 2 m / T. On the slide of a second one it is the harmonic sum,
  // 1 / (1/m1 + 1/m2), by which the inverse of M has (1/m1 + 1/m2) on its diagonal.
  const auto read = read_text(R"(<mujoco><worldbody>
      <body><joint type="slide" springdamper="0.5 2"/><geom size="1" mass="6"/></body>
      <body><joint type="slide"/><geom size="1" mass="2"/>
        <body><joint type="slide" springdamper="0.5 2"/><geom size="1" mass="6"/></body></body></worldbody></mujoco>)");
  const ModelSpec& spec = read.model.spec;
  ASSERT_EQ(spec.forces.size(), 4U) << messages(read.diagnostics);
  EXPECT_NEAR(std::get<TorsionSpringSpec>(spec.forces[0].element).stiffness.value, 6, 1e-12);
  EXPECT_NEAR(std::get<JointDampingSpec>(spec.forces[1].element).damping.value, 24, 1e-12);
  EXPECT_NEAR(std::get<TorsionSpringSpec>(spec.forces[2].element).stiffness.value, 1.5, 1e-12);
  EXPECT_NEAR(std::get<JointDampingSpec>(spec.forces[3].element).damping.value, 6, 1e-12);
}

TEST(MjcfKeyframeTest, TheFirstKeyIsTheInitialStateOfATree) {
  const auto read = read_text(R"(<mujoco><worldbody>
      <body name="a"><freejoint name="f"/><geom size="1"/>
        <body name="b"><joint name="j"/><geom size="1"/><body name="c"><joint name="s" type="ball"/><geom size="1"/></body></body>
      </body></worldbody>
      <keyframe><key name="k" qpos="1 2 3 0 0 1 0  0.4  0 1 0 0" qvel="1 2 3 4 5 6 7 8 9 10"/><key name="l"/></keyframe>
    </mujoco>)");
  ASSERT_EQ(read.model.spec.initial.size(), 3U) << messages(read.diagnostics);
  const InitialSpec& free = read.model.spec.initial[0];
  EXPECT_EQ(free.position[2].value, 3);
  EXPECT_EQ(free.position[5].value, 1);
  EXPECT_EQ(free.velocity[0].value, -4);  // half a turn about y
  EXPECT_EQ(free.velocity[1].value, 5);
  EXPECT_EQ(free.velocity[3].value, 1);
  EXPECT_EQ(read.model.spec.initial[1].position[0].value, 0.4);
  EXPECT_EQ(read.model.spec.initial[2].velocity[1].value, -9);
  EXPECT_FALSE(free.guess);
  EXPECT_THAT(messages(read.diagnostics), HasSubstr("the key 'k' is the initial state; 1 more are not read"));
}

TEST(MjcfKeyframeTest, WithConstraintsItIsAGuess) {
  const auto read =
      read_text(two_arms("<equality><joint joint1='ja' joint2='jb'/></equality>"
                         "<keyframe><key qpos='0.1 0.1' qvel='1 1'/></keyframe>"));
  ASSERT_EQ(read.model.spec.initial.size(), 2U);
  EXPECT_TRUE(read.model.spec.initial[0].guess);
  EXPECT_TRUE(read.model.spec.initial[0].velocity.empty());
}

TEST(MjcfActuatorsTest, EachJointTakesOneDriveAndTheRestIsTold) {
  const auto read =
      read_text(two_arms("<actuator><motor name='m' joint='ja' gear='3'/><position joint='ja'/>"
                         "<velocity joint='jb'/><general site='sa'/></actuator>"));
  ASSERT_EQ(read.model.spec.drives.size(), 2U);
  EXPECT_EQ(read.model.spec.drives[0].name.name, "m");
  EXPECT_EQ(read.model.spec.drives[1].name.name, "jb_drive");
  EXPECT_THAT(messages(read.diagnostics), HasSubstr("its joint has a drive already"));
  EXPECT_THAT(messages(read.diagnostics), HasSubstr("it acts neither on a joint nor on a fixed tendon"));
}

}  // namespace
}  // namespace ferrers
