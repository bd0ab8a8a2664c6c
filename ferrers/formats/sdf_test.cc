#include "ferrers/formats/sdf.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <numbers>
#include <sstream>
#include <string>

#include "ferrers/formats/formats.h"
#include "ferrers/redundancy/mechanism_analysis.h"

namespace ferrers {
namespace {

using Eigen::Vector3d;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kExact = 1e-12;

struct Read {
  ImportedModel model;
  Diagnostics diagnostics;
};

Read read(const std::string& text, ImportOptions options = {}, std::map<std::string, std::string> files = {}) {
  Read result;
  const FileLoader load = [&](const std::string& path) -> std::optional<std::string> {
    const auto found = files.find(path);
    return found == files.end() ? std::nullopt : std::optional(found->second);
  };
  result.model = read_sdf(text, {options, load, result.diagnostics});
  return result;
}

std::string model_17(const std::string& contents, const std::string& version = "1.7") {
  return "<sdf version=\"" + version + "\">\n<model name=\"m\">\n" + contents + "\n</model>\n</sdf>\n";
}

const std::string kMass = "<inertial><mass>1</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial>";
std::string link(const std::string& name, const std::string& pose = "0 0 0 0 0 0") {
  return "<link name=\"" + name + "\"><pose>" + pose + "</pose>" + kMass + "</link>\n";
}
std::string joint(const std::string& name, const std::string& type, const std::string& parent, const std::string& child,
                  const std::string& more = "<axis><xyz>0 0 1</xyz></axis>") {
  return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent>" + parent + "</parent><child>" + child +
         "</child>" + more + "</joint>\n";
}

std::vector<std::string> errors(const Diagnostics& diagnostics) {
  std::vector<std::string> lines;
  for (const Diagnostic& one : diagnostics.items()) {
    if (one.severity == Severity::kError) lines.push_back(one.code + " " + one.message);
  }
  return lines;
}

std::string all_text(const Diagnostics& diagnostics) {
  std::string text;
  for (const Diagnostic& one : diagnostics.items()) text += one.code + " " + one.message + "\n";
  return text;
}

Vector3d vector_of(const Number3& n) { return {n[0].value, n[1].value, n[2].value}; }

Pose pose_of(const PoseSpec& spec) {
  Pose X;
  X.p = vector_of(spec.position);
  if (spec.rotation) {
    const auto& q = *spec.rotation->quaternion;
    X.R = Eigen::Quaterniond(q[0].value, q[1].value, q[2].value, q[3].value).toRotationMatrix();
  }
  return X;
}

const BodySpec& body(const Read& result, const std::string& name) {
  for (const BodySpec& one : result.model.spec.bodies) {
    if (one.name.name == name) return one;
  }
  throw std::runtime_error("no body " + name + "\n" + all_text(result.diagnostics));
}

const JointSpec& joint_named(const Read& result, const std::string& name) {
  for (const JointSpec& one : result.model.spec.joints) {
    if (one.name.name == name) return one;
  }
  throw std::runtime_error("no joint " + name + "\n" + all_text(result.diagnostics));
}

// ---- frames --------------------------------------------------------------------------------------------------------

TEST(SdfTest, PosesFollowChainsOfFramesAndOfJointsBackToTheModel) {
  const Read result = read(model_17(
      "<pose>0 0 1 0 0 1.5707963267948966</pose>" + link("a", "1 0 0 0 0 0") +
      R"(<frame name="f" attached_to="a"><pose>0 2 0 0 0 0</pose></frame>
       <link name="b"><pose relative_to="j">0 0 3 0 0 0</pose></link>)" +
      joint("j", "revolute", "a", "b", "<pose relative_to='f'>0 0 1 0 0 0</pose><axis><xyz>0 0 1</xyz></axis>")));
  EXPECT_THAT(errors(result.diagnostics), ElementsAre());
  // b = (1, 2, 0) + (0, 0, 1) + (0, 0, 3) in the model, which is turned a quarter about z and lifted by 1.
  EXPECT_LT((pose_of(*body(result, "b").pose).p - Vector3d(-2, 1, 5)).norm(), kExact);
}

TEST(SdfTest, ReferencesThatLeadBackToThemselvesAreToldOnceWithTheirPlace) {
  const Read result = read(model_17(link("a") + R"(<frame name="f"><pose relative_to="g">1 0 0 0 0 0</pose></frame>
<frame name="g"><pose relative_to="f">1 0 0 0 0 0</pose></frame>
<frame name="h" attached_to="i"/>
<frame name="i" attached_to="h"/>)"));
  ASSERT_THAT(errors(result.diagnostics),
              testing::UnorderedElementsAre("F605 the pose of 'f' leads back to itself",
                                            "F605 the pose of 'h' leads back to itself",
                                            "F605 what carries the frame of 'h' leads back to itself"));
  for (const Diagnostic& one : result.diagnostics.items()) {
    if (one.message.find("of 'f'") != std::string::npos) {
      EXPECT_EQ(one.at.line, 4);
    }
  }
}

TEST(SdfTest, ModelsPlacedByFramesOfEachOtherAreTold) {
  const std::string inner = R"(<sdf version="1.9"><model name="inner" placement_frame="g">)" + link("b") +
                            R"(<frame name="f"><pose>1 0 0 0 0 0</pose></frame></model></sdf>)";
  const Read result = read(R"(<sdf version="1.9"><world name="w"><model name="A" placement_frame="f">)" + link("a") +
                               R"(<frame name="g"><pose>0 1 0 0 0 0</pose></frame>
<include merge="true"><uri>model://inner</uri></include></model></world></sdf>)",
                           {}, {{"inner/model.sdf", inner}, {"model://inner", inner}, {"inner", inner}});
  EXPECT_THAT(errors(result.diagnostics), testing::Not(ElementsAre()));
}

TEST(SdfTest, AModelIsPlacedByAFrameInsideIt) {
  const Read result = read(R"(<sdf version="1.9"><world name="w"><model name="m" placement_frame="f">
      <pose>5 0 0 0 0 0</pose><frame name="f"><pose>1 0 0 0 0 3.14159265358979312</pose></frame>)" +
                           link("a") + "</model></world></sdf>");
  // The frame is at (5, 0, 0) unturned, so the link is half a turn about it: 5 + 1.
  EXPECT_LT((pose_of(*body(result, "a").pose).p - Vector3d(6, 0, 0)).norm(), kExact);
  EXPECT_NEAR(pose_of(*body(result, "a").pose).R(0, 0), -1, kExact);
}

TEST(SdfTest, RotationsAreReadInRadiansDegreesAndQuaternions) {
  const Read result = read(model_17(
      R"(<link name="a"><pose degrees="true">0 0 0 90 0 0</pose></link>
         <link name="b"><pose rotation_format="quat_xyzw">0 0 0 0.70710678118654757 0 0 0.70710678118654757</pose></link>
         <link name="c"><pose>0 0 0 0.1 0.2 0.3</pose></link>)",
      "1.9"));
  EXPECT_LT((pose_of(*body(result, "a").pose).R - pose_of(*body(result, "b").pose).R).norm(), kExact);
  const Eigen::Matrix3d expected =
      (Eigen::AngleAxisd(0.3, Vector3d::UnitZ()) * Eigen::AngleAxisd(0.2, Vector3d::UnitY()) *
       Eigen::AngleAxisd(0.1, Vector3d::UnitX()))
          .toRotationMatrix();
  EXPECT_LT((pose_of(*body(result, "c").pose).R - expected).norm(), kExact);
}

// ---- links ---------------------------------------------------------------------------------------------------------

TEST(SdfTest, MassCentreAndTensorAreThoseOfTheInertialFrame) {
  const Read result = read(model_17(R"(<link name="a"><inertial><pose>0.1 0.2 0.3 0 0 0.5</pose><mass>2</mass><inertia>
      <ixx>1</ixx><iyy>2</iyy><izz>2.5</izz><ixy>0.1</ixy><ixz>0.2</ixz><iyz>0.3</iyz></inertia></inertial></link>)"));
  const BodySpec& a = body(result, "a");
  EXPECT_EQ(a.mass->value, 2);
  EXPECT_EQ(vector_of(*a.com), Vector3d(0.1, 0.2, 0.3));
  EXPECT_EQ(vector_of(a.inertia.moments), Vector3d(1, 2, 2.5));
  EXPECT_EQ(vector_of(a.inertia.products), Vector3d(0.1, 0.2, 0.3));
  ASSERT_TRUE(a.inertia.rotation.has_value());
  EXPECT_NEAR((*a.inertia.rotation->quaternion)[3].value, std::sin(0.25), kExact);
}

TEST(SdfTest, ALinkWithoutInertialHasTheMassThatTheFormatSaysAndThisIsTold) {
  const Read result = read(model_17("<link name='a'/>"));
  EXPECT_EQ(body(result, "a").mass->value, 1);
  EXPECT_THAT(all_text(result.diagnostics), HasSubstr("has no <inertial>"));
}

TEST(SdfTest, AutomaticMassIsNotComputedAndThisIsAWarning) {
  const Read result = read(model_17("<link name='a'><inertial auto='true'/></link>", "1.11"));
  EXPECT_EQ(body(result, "a").mass->value, 0);
  EXPECT_THAT(all_text(result.diagnostics), HasSubstr("F602"));
}

TEST(SdfTest, AForceHoldsALinkThatFeelsNoGravity) {
  const Read result =
      read(model_17("<link name='a'><gravity>false</gravity><inertial><mass>2</mass></inertial></link>"));
  ASSERT_EQ(result.model.spec.forces.size(), 1u);
  const auto& lift = std::get<LoadSpec>(result.model.spec.forces[0].element);
  EXPECT_NEAR(lift.components[2].expression->constant_value().value(), 19.6, kExact);
}

TEST(SdfTest, LinksOfStaticModelsArePartOfTheGround) {
  const Read result = read(R"(<sdf version="1.6"><world name="w"><model name="floor"><static>true</static>
      <link name="slab"><pose>0 0 -1 0 0 0</pose><visual name="v"><geometry><box><size>1 2 3</size></box></geometry></visual></link>
      </model><model name="m">)" +
                           link("a") + "</model></world></sdf>");
  ASSERT_EQ(result.model.spec.bodies.size(), 1u);
  EXPECT_EQ(result.model.spec.bodies[0].name.name, "a");
  ASSERT_EQ(result.model.visuals.size(), 1u);
  EXPECT_EQ(result.model.visuals[0].body, "ground");
  EXPECT_EQ(result.model.visuals[0].X_BS.p.z(), -1);
}

TEST(SdfTest, NamesCarryTheirModelsWhereSeveralMove) {
  const std::string inner = link("a") + "<model name='in'>" + link("a") + "</model>";
  const Read one = read(model_17(inner, "1.8"));
  EXPECT_EQ(one.model.spec.bodies[0].name.name, "a");
  EXPECT_EQ(one.model.spec.bodies[1].name.name, "in__a");
  const Read two = read("<sdf version='1.8'><world name='w'><model name='p'>" + inner + "</model><model name='q'>" +
                        inner + "</model></world></sdf>");
  EXPECT_EQ(two.model.spec.bodies[3].name.name, "q__in__a");
  EXPECT_EQ(two.model.renamed.at(3).original, "q::in::a");
}

// ---- joints --------------------------------------------------------------------------------------------------------

TEST(SdfTest, AJointStandsWhereItsPoseDrawsItOnBothBodiesAndTurnsAboutItsAxis) {
  const Read result =
      read(model_17(link("a", "1 0 0 0 0 0") + link("b", "1 2 0 0 0 0") +
                    joint("j", "revolute", "a", "b", "<pose>0 0 3 0 0 0</pose><axis><xyz>0 2 0</xyz></axis>")));
  const JointSpec& j = joint_named(result, "j");
  EXPECT_EQ(j.type, JointType::kRevolute);
  EXPECT_EQ(j.bodies[0].name, "a");
  EXPECT_LT((pose_of((*j.frames)[0]).p - Vector3d(0, 2, 3)).norm(), kExact);
  EXPECT_LT((pose_of((*j.frames)[1]).p - Vector3d(0, 0, 3)).norm(), kExact);
  EXPECT_LT((pose_of((*j.frames)[0]).R.col(2) - Vector3d::UnitY()).norm(), kExact);
}

TEST(SdfTest, AxesBefore15AreInTheModelsFrameLaterInTheJoints) {
  const std::string turned = "0 0 0 1.5707963267948966 0 0";  // z of the link is -y of the model
  for (const auto& [version, axis, expected] : std::vector<std::tuple<std::string, std::string, Vector3d>>{
           {"1.4", "<xyz>0 0 1</xyz>", Vector3d::UnitZ()},
           {"1.6", "<xyz>0 0 1</xyz>", -Vector3d::UnitY()},
           {"1.6", "<xyz>0 0 1</xyz><use_parent_model_frame>1</use_parent_model_frame>", Vector3d::UnitZ()},
           {"1.7", "<xyz>0 0 1</xyz>", -Vector3d::UnitY()},
           {"1.7", "<xyz expressed_in='__model__'>0 0 1</xyz>", Vector3d::UnitZ()}}) {
    const Read result =
        read(model_17(link("b", turned) + joint("j", "revolute", "world", "b", "<axis>" + axis + "</axis>"), version));
    EXPECT_LT((pose_of((*joint_named(result, "j").frames)[0]).R.col(2) - expected).norm(), kExact) << version << axis;
  }
}

TEST(SdfTest, AScrewsPitchIsRadiansPerMetreLeftHandedOrMetresPerTurnRightHanded) {
  const std::string axis = "<axis><xyz>0 0 1</xyz></axis>";
  const Read old =
      read(model_17(link("b") + joint("j", "screw", "world", "b", "<thread_pitch>100</thread_pitch>" + axis)));
  EXPECT_NEAR(joint_named(old, "j").lead.value, -2 * std::numbers::pi / 100, kExact);
  const Read later = read(model_17(
      link("b") + joint("j", "screw", "world", "b", "<screw_thread_pitch>0.004</screw_thread_pitch>" + axis), "1.10"));
  EXPECT_EQ(joint_named(later, "j").lead.value, 0.004);
  EXPECT_THAT(errors(read(model_17(link("b") + joint("j", "screw", "world", "b", axis))).diagnostics),
              ElementsAre("F202 a screw joint needs a <screw_thread_pitch>"));
}

TEST(SdfTest, AUniversalJointTurnsAboutItsAxisOnTheParentAndItsSecondAxisOnTheChild) {
  const Read result = read(model_17(link("b") + joint("j", "universal", "world", "b",
                                                      "<axis><xyz>0 1 0</xyz></axis><axis2><xyz>0 0 1</xyz></axis2>")));
  const JointSpec& j = joint_named(result, "j");
  EXPECT_EQ(j.type, JointType::kUniversal);
  EXPECT_LT((pose_of((*j.frames)[0]).R.col(2) - Vector3d::UnitY()).norm(), kExact);
  EXPECT_LT((pose_of((*j.frames)[1]).R.col(0) - Vector3d::UnitZ()).norm(), kExact);
}

TEST(SdfTest, LimitsAreReadWhereTheyAreNone16OrInfinite) {
  const auto limits = [](const std::string& text, const std::string& type = "revolute") {
    const Read result = read(model_17(
        link("b") + joint("j", type, "world", "b", "<axis><xyz>0 0 1</xyz><limit>" + text + "</limit></axis>")));
    return joint_named(result, "j").limits;
  };
  EXPECT_EQ((*limits("<lower>-1</lower><upper>2</upper>"))[1].value, 2);
  EXPECT_FALSE(limits("<lower>-1e16</lower><upper>1e16</upper>").has_value());
  EXPECT_FALSE(limits("<lower>-inf</lower><upper>inf</upper>").has_value());
  EXPECT_FALSE(limits("<lower>-1</lower><upper>1</upper>", "continuous").has_value());
  EXPECT_FALSE(limits("<lower>0</lower><upper>0</upper>").has_value());
  EXPECT_EQ((*limits("<lower>0</lower>"))[0].value, 0);
}

TEST(SdfTest, SpringsAndDampersOfAxesAreForcesUnlessTheyAreToBeIgnored) {
  const std::string text = model_17(
      link("b") +
      joint("j", "prismatic", "world", "b",
            "<axis><xyz>0 0 1</xyz><dynamics><damping>0.5</damping><friction>0.1</friction>"
            "<spring_stiffness>20</spring_stiffness><spring_reference>0.1</spring_reference></dynamics></axis>"));
  const Read result = read(text);
  ASSERT_EQ(result.model.spec.forces.size(), 2u);
  EXPECT_EQ(std::get<JointDampingSpec>(result.model.spec.forces[0].element).damping.value, 0.5);
  EXPECT_EQ(std::get<TorsionSpringSpec>(result.model.spec.forces[1].element).free_angle.value, 0.1);
  EXPECT_THAT(all_text(result.diagnostics), HasSubstr("the constant friction of 'j' is not read"));
  ImportOptions without;
  without.ignore_springs = without.ignore_damping = true;
  EXPECT_TRUE(read(text, without).model.spec.forces.empty());
}

TEST(SdfTest, MimicBecomesACouplingOrWithAnOffsetAFormula) {
  const auto with = [](const std::string& numbers) {
    return model_17(link("a") + link("b") + joint("l", "revolute", "world", "a") +
                        joint("f", "prismatic", "world", "b",
                              "<axis><xyz>0 0 1</xyz><mimic joint='l'>" + numbers + "</mimic></axis>"),
                    "1.11");
  };
  const Read plain = read(with("<multiplier>3</multiplier>"));
  ASSERT_EQ(plain.model.spec.couplings.size(), 1u);
  EXPECT_EQ(plain.model.spec.couplings[0].coefficients[0].value, -3);
  EXPECT_EQ(plain.model.spec.couplings[0].coordinates[1].joint.name, "f");
  const Read moved = read(with("<multiplier>3</multiplier><offset>1</offset><reference>2</reference>"));
  ASSERT_EQ(moved.model.spec.constraints.size(), 1u);  // f - 3 (l - 2) - 1
  const ModelFile built = read_any_model_text(with("<multiplier>3</multiplier><offset>1</offset>"), "m.sdf",
                                              ModelFormat::kSdf, [](const std::string&) { return std::nullopt; });
  EXPECT_FALSE(built.read.diagnostics.has_errors()) << all_text(built.read.diagnostics);
}

TEST(SdfTest, AGearboxTiesTheAnglesOfTwoJointsOnItsReferenceBody) {
  // The second joint's axis points the other way and its parent is the wheel: two signs, which cancel.
  const Read result =
      read(model_17(link("base") + link("a") + link("b") + joint("ja", "revolute", "base", "a") +
                    joint("jb", "revolute", "b", "base", "<axis><xyz>0 0 -1</xyz></axis>") +
                    joint("g", "gearbox", "a", "b",
                          "<gearbox_ratio>4</gearbox_ratio><gearbox_reference_body>base</gearbox_reference_body>"
                          "<axis><xyz>0 0 1</xyz></axis><axis2><xyz>0 0 1</xyz></axis2>")));
  EXPECT_THAT(errors(result.diagnostics), ElementsAre());
  ASSERT_EQ(result.model.spec.couplings.size(), 1u);
  EXPECT_EQ(result.model.spec.couplings[0].coefficients[0].value, 4);
  EXPECT_EQ(result.model.spec.couplings[0].coefficients[1].value, 1);
}

TEST(SdfTest, JointsOfFramesThatAreDrawnApartBringTheseTogetherUnlessTheJointHasAPose) {
  const std::string frame = "<frame name='f'><pose>1 0 0 0 0 0</pose></frame>";
  const std::string axis = "<axis><xyz>0 0 1</xyz></axis>";
  const Read open = read(model_17(link("a") + link("b") + frame + joint("j", "revolute", "f", "b", axis)));
  EXPECT_EQ(pose_of((*joint_named(open, "j").frames)[0]).p, Vector3d(1, 0, 0));
  EXPECT_EQ(pose_of((*joint_named(open, "j").frames)[1]).p, Vector3d(0, 0, 0));
  EXPECT_THAT(all_text(open.diagnostics), HasSubstr("drawn 1 m apart"));
  const Read closed =
      read(model_17(link("a") + link("b") + frame + joint("j", "revolute", "f", "b", "<pose/>" + axis)));
  EXPECT_EQ(pose_of((*joint_named(closed, "j").frames)[0]).p, Vector3d(0, 0, 0));
  EXPECT_THAT(all_text(closed.diagnostics), testing::Not(HasSubstr("apart")));
}

TEST(SdfTest, AFourBarDrawnOpenIsAssembledAndHasTheThreeRedundantConstraintsOfAPlanarOne) {
  std::ifstream stream(std::string(FERRERS_SOURCE_DIR) + "/tests/models/formats/sdf/four_bar_open.sdf");
  std::stringstream text;
  text << stream.rdbuf();
  const ModelFile file = read_any_model_text(text.str(), "four_bar_open.sdf", ModelFormat::kSdf,
                                             [](const std::string&) { return std::nullopt; });
  ASSERT_TRUE(file.read.model.has_value()) << all_text(file.read.diagnostics);
  const MechanismAnalysis analysis = analyze_mechanism(*make_system(*file.read.model));
  ASSERT_TRUE(analysis.redundancy.has_value());
  EXPECT_EQ(analysis.redundancy->closure_rows, 5);
  EXPECT_EQ(analysis.redundancy->closure_rank, 2);
  EXPECT_EQ(analysis.redundancy->mobility, 1);
}

// ---- the base ------------------------------------------------------------------------------------------------------

TEST(SdfTest, WhatNothingTiesToTheWorldFloatsOrIsFixedWhereThisIsAsked) {
  const std::string text = model_17(link("a") + link("b") + link("c") + joint("j", "ball", "a", "b", ""));
  const Read as_in_file = read(text);
  ASSERT_EQ(as_in_file.model.spec.joints.size(), 3u);
  EXPECT_EQ(joint_named(as_in_file, "float_a").type, JointType::kFree);
  EXPECT_EQ(joint_named(as_in_file, "float_c").type, JointType::kFree);
  ImportOptions fixed;
  fixed.base = ImportBase::kFixed;
  EXPECT_EQ(joint_named(read(text, fixed), "base_a").type, JointType::kWeld);
}

TEST(SdfTest, AFreeBaseLeavesOutWeldsToTheWorldAndStaticModels) {
  ImportOptions free;
  free.base = ImportBase::kFree;
  const Read welded = read(model_17(link("a") + joint("j", "fixed", "world", "a", "")), free);
  ASSERT_EQ(welded.model.spec.joints.size(), 1u);
  EXPECT_EQ(welded.model.spec.joints[0].name.name, "float_a");
  const Read standing = read(model_17("<static>true</static>" + link("a")), free);
  EXPECT_EQ(standing.model.spec.bodies.size(), 1u);
}

TEST(SdfTest, GravityIsTheWorldsAndOfModelsAloneThatOfAWorldThatGivesNone) {
  const auto gravity = [](const std::string& before, const std::string& inside) {
    return read("<sdf version='1.5'>" + before + inside + "<model name='m'>" + link("a") + "</model>" +
                (before.empty() ? "" : "</world>") + "</sdf>")
        .model.spec.gravity[2]
        .value;
  };
  EXPECT_EQ(gravity("<world name='w'>", "<gravity>0 0 -1.6</gravity>"), -1.6);
  EXPECT_EQ(gravity("<world name='w'>", "<physics><gravity>0 0 -2</gravity></physics>"), -2);
  EXPECT_EQ(gravity("<world name='w'>", ""), -9.8);
  EXPECT_EQ(gravity("", ""), -9.8);
}

// ---- further files -------------------------------------------------------------------------------------------------

TEST(SdfTest, IncludedModelsAreFoundByTheirFolderPlacedAndRenamed) {
  const std::string hand = model_17("<pose>9 9 9 0 0 0</pose>" + link("palm"), "1.6");
  const std::string config = "<model><sdf version='1.5'>old.sdf</sdf><sdf version='1.6'>new.sdf</sdf></model>";
  const Read result =
      read(model_17(link("a") + "<include><uri>model://hand</uri><name>h</name><pose>1 2 3 0 0 0</pose></include>"), {},
           {{"hand/new.sdf", hand}, {"hand/model.config", config}});
  EXPECT_THAT(errors(result.diagnostics), ElementsAre());
  EXPECT_EQ(pose_of(*body(result, "h__palm").pose).p, Vector3d(1, 2, 3));
}

TEST(SdfTest, AMergedModelsPartsBelongToTheModelAround) {
  const Read result =
      read(model_17(link("a") + "<include merge='true'><uri>hand.sdf</uri><pose>1 0 0 0 0 0</pose></include>" +
                        joint("j", "fixed", "a", "palm", ""),
                    "1.9"),
           {}, {{"hand.sdf", model_17(link("palm", "0 1 0 0 0 0"))}});
  EXPECT_THAT(errors(result.diagnostics), ElementsAre());
  EXPECT_EQ(pose_of(*body(result, "palm").pose).p, Vector3d(1, 1, 0));
}

TEST(SdfTest, MistakesInIncludedFilesAreToldAtTheIncludeWithTheirOwnLine) {
  const Read result = read(model_17(link("a") + "<include><uri>b.sdf</uri></include>"), {},
                           {{"b.sdf", model_17("<link name='x'><pose>1 2</pose></link>")}});
  ASSERT_TRUE(result.diagnostics.has_errors());
  EXPECT_EQ(result.diagnostics.items()[0].message, "in 'b.sdf', line 3: <pose> has 2 numbers, not 6");
  EXPECT_EQ(result.diagnostics.items()[0].at.line, 4);
}

TEST(SdfTest, FilesThatIncludeThemselvesOrMultiplyAreRefused) {
  const std::string own = model_17(link("b") + "<include><uri>b.sdf</uri></include>");
  EXPECT_THAT(errors(read(own, {}, {{"b.sdf", own}}).diagnostics), ElementsAre(HasSubstr("'b.sdf' includes itself")));
  std::map<std::string, std::string> files;
  for (int i = 0; i < 30; ++i) {
    const std::string next = "<include><uri>f" + std::to_string(i + 1) + ".sdf</uri><name>";
    files["f" + std::to_string(i) + ".sdf"] =
        model_17(link("l") + next + "x</name></include>" + next + "y</name></include>");
  }
  const Read many = read(files["f0.sdf"], {}, files);
  EXPECT_THAT(all_text(many.diagnostics), HasSubstr("more than 1000 files are included"));
}

TEST(SdfTest, WhatIsNotReadIsTold) {
  const Read result = read(model_17(link("a") + "<plugin name='p' filename='f.so'><x/></plugin><plugin name='q'/>"));
  EXPECT_THAT(all_text(result.diagnostics), HasSubstr("F601 <plugin> in <model> is not read, nor are 1 more like it"));
}

// ---- broken files --------------------------------------------------------------------------------------------------

TEST(SdfTest, BrokenFilesAreToldWithCodeAndPlace) {
  struct Case {
    std::string text, code;
    int line, column;
  };
  const std::string a = link("a"), b = link("b");
  const std::vector<Case> cases = {
      {"<sdf version='1.7'>\n<model>\n", "F107", 2, 8},
      {"<robot name='x'/>", "F605", 1, 2},
      {"<sdf>\n</sdf>", "F202", 1, 2},
      {"<sdf version='2.0'/>", "F210", 1, 15},
      {"<sdf version='1.2'/>", "F210", 1, 15},
      {"<sdf version='1.7'/>", "F605", 1, 2},
      {"<sdf version='1.7'><world name='w'/>\n<world name='v'/></sdf>", "F605", 2, 2},
      {"<sdf version='1.7'><world name='w'/>\n<model name='v'/></sdf>", "F605", 2, 2},
      {model_17("<link/>"), "F202", 3, 2},
      {model_17("<link name='a'/>\n<link name='a'/>"), "F302", 4, 13},
      {model_17("<link name='a'/>\n<joint name='a' type='ball'><parent>world</parent><child>a</child></joint>"), "F302",
       4, 14},
      {model_17("<link name='a'><pose>1 2 3 x 0 0</pose></link>"), "F206", 3, 22},
      {model_17("<link name='a'><pose>1 2 3</pose></link>"), "F208", 3, 22},
      {model_17("<link name='a'><pose rotation_format='axis'>1 2 3</pose></link>"), "F209", 3, 39},
      {model_17("<link name='a'><pose rotation_format='quat_xyzw'>1 2 3 0 0 0 0</pose></link>"), "F327", 3, 50},
      {model_17("<link name='a'><pose relative_to='b'>1 2 3 0 0 0</pose></link>"), "F604", 3, 17},
      {model_17("<link name='a'><gravity>no</gravity></link>"), "F203", 3, 25},
      {model_17("<link name='a'><inertial><mass>heavy</mass></inertial></link>"), "F206", 3, 32},
      {model_17(a + "<joint name='j' type='ball'><parent>world</parent></joint>"), "F202", 4, 2},
      {model_17(a + "<joint name='j' type='ball'><parent>x</parent><child>a</child></joint>"), "F604", 4, 30},
      {model_17(a + "<joint name='j' type='ball'><parent>a</parent><child>x</child></joint>"), "F604", 4, 48},
      {model_17(a + "<joint name='j' type='ball'><parent>a</parent><child>world</child></joint>"), "F605", 4, 54},
      {model_17(a + "<joint name='j' type='ball'><parent>a</parent><child>a</child></joint>"), "F316", 4, 2},
      {model_17(a + "<joint name='j' type='rope'><parent>world</parent><child>a</child></joint>"), "F602", 4, 23},
      {model_17(a + "<joint name='j'><parent>world</parent><child>a</child></joint>"), "F202", 4, 2},
      {model_17(a + "<joint name='j' type='revolute'><parent>world</parent><child>a</child></joint>"), "F202", 4, 2},
      {model_17(a + "<joint name='j' type='revolute'><parent>world</parent><child>a</child>\n<axis><xyz>0 0 "
                    "0</xyz></axis></joint>"),
       "F318", 5, 12},
      {model_17(a + "<joint name='j' type='universal'><parent>world</parent><child>a</child>\n<axis><xyz>0 0 "
                    "1</xyz></axis><axis2><xyz>0 1 1</xyz></axis2></joint>"),
       "F319", 5, 31},
      {model_17(a + b +
                "<joint name='j' "
                "type='gearbox'><parent>a</parent><child>b</child><gearbox_reference_body>world</"
                "gearbox_reference_body>\n<axis/></joint>"),
       "F602", 6, 2},
      {model_17(a + "<joint name='j' type='revolute'><parent>world</parent><child>a</child>\n<axis><mimic "
                    "joint='x'/></axis></joint>"),
       "F604", 5, 21},
      {model_17(a + "<include/>"), "F202", 4, 2},
      {model_17(a + "<include><uri>model://x</uri></include>"), "F606", 4, 15},
      {model_17(a + "<include><uri>https://example.org/x</uri></include>"), "F606", 4, 15},
      {model_17("<static>true</static>" + a), "F605", 1, 2}};
  for (const Case& one : cases) {
    const Read result = read(one.text);
    ASSERT_TRUE(result.diagnostics.has_errors()) << one.text;
    const auto first = std::find_if(result.diagnostics.items().begin(), result.diagnostics.items().end(),
                                    [](const Diagnostic& d) { return d.severity == Severity::kError; });
    EXPECT_EQ(first->code, one.code) << one.text << first->message;
    EXPECT_EQ(first->at.line, one.line) << one.text << first->message;
    EXPECT_EQ(first->at.column, one.column) << one.text << first->message;
  }
}

}  // namespace
}  // namespace ferrers
