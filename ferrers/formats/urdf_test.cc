#include "ferrers/formats/urdf.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>

#include "ferrers/formats/formats.h"
#include "ferrers/kinematics/system.h"
#include "ferrers/redundancy/mechanism_analysis.h"
#include "ferrers/testing/third_party.h"

namespace ferrers {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// Files by name, as a loader.
using Files = std::map<std::string, std::string>;

ModelFile read(const std::string& text, ImportOptions import = {}, const Files& files = {}) {
  import.keep_welds = true;  // every link is looked at
  const FileLoader load = [&](const std::string& path) -> std::optional<std::string> {
    const auto found = files.find(path);
    return found == files.end() ? std::nullopt : std::optional(found->second);
  };
  return read_any_model_text(text, "robot.urdf", ModelFormat::kUrdf, load, {}, import);
}

ModelFile read_closed(const std::string& text, const std::string& closures) {
  ImportOptions import;
  import.closures = "robot.yaml";
  return read(text, import, {{"robot.yaml", closures}});
}

std::string all_messages(const ModelFile& file) {
  std::string text;
  for (const Diagnostic& one : file.read.diagnostics.items()) {
    text +=
        one.code + " " + std::to_string(one.at.line) + ":" + std::to_string(one.at.column) + " " + one.message + "\n";
  }
  return text;
}

std::string robot(const std::string& contents) { return "<robot name=\"r\">\n" + contents + "</robot>\n"; }

std::string link(const std::string& name, const std::string& mass = "1") {
  return "<link name=\"" + name + "\"><inertial><origin xyz=\"0.1 0 0\"/><mass value=\"" + mass +
         "\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial></link>\n";
}

std::string joint(const std::string& name, const std::string& type, const std::string& parent, const std::string& child,
                  const std::string& rest = "") {
  return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent + "\"/><child link=\"" + child +
         "\"/>" + rest + "</joint>\n";
}

std::string empty_link(const std::string& name) { return "<link name=\"" + name + "\"/>\n"; }

/// A bar of length 1 along x that turns about z at its parent's point `at`.
std::string bar(const std::string& name, const std::string& parent, const std::string& at) {
  return link(name) +
         joint(name + "_pin", "continuous", parent, name, "<origin xyz=\"" + at + "\"/><axis xyz=\"0 0 1\"/>");
}

const Joint& joint_of(const ModelFile& file, const std::string& name) {
  return file.read.model->joint(*file.read.model->find_joint(name));
}
const Body& body_of(const ModelFile& file, const std::string& name) {
  return file.read.model->body(*file.read.model->find_body(name));
}

MechanismAnalysis analysis(const ModelFile& file) { return analyze_mechanism(*make_system(*file.read.model)); }

TEST(UrdfTest, ALinkIsABodyWithItsInertiaAboutTheMassCentre) {
  const ModelFile file = read(robot(R"(<link name="a"><inertial>
    <origin xyz="0.1 0.2 0.3" rpy="0 0 1.5707963267948966"/><mass value="2"/>
    <inertia ixx="1" ixy="0" ixz="0" iyy="2" iyz="0" izz="2.5"/></inertial></link>)"));
  ASSERT_TRUE(file.read.model) << all_messages(file);
  const Body& a = body_of(file, "a");
  EXPECT_EQ(a.mass_kg, 2);
  EXPECT_TRUE(a.com_m.isApprox(Eigen::Vector3d(0.1, 0.2, 0.3)));
  // A quarter turn about z changes Ixx and Iyy.
  EXPECT_TRUE(a.inertia_kgm2.isApprox(Eigen::Vector3d(2, 1, 2.5).asDiagonal().toDenseMatrix(), 1e-15));
}

TEST(UrdfTest, TheRootLinkIsFixedOrFreeOrTheGroundItself) {
  EXPECT_EQ(joint_of(read(robot(link("a"))), "fixed_base").type, JointType::kWeld);
  ImportOptions free;
  free.base = ImportBase::kFree;
  EXPECT_EQ(joint_of(read(robot(link("a")), free), "floating_base").type, JointType::kFree);
  const std::string on_world = robot(empty_link("world") + link("a") + joint("j", "fixed", "world", "a"));
  const ModelFile grounded = read(on_world);
  EXPECT_EQ(grounded.read.model->bodies().size(), 2U);
  EXPECT_EQ(joint_of(grounded, "j").first, BodyId(0));
  EXPECT_EQ(read(on_world, free).read.model->bodies().size(), 3U);
  EXPECT_EQ(joint_of(read(robot(link("world"))), "fixed_base").second, BodyId(1));  // a 'world' that weighs something
}

TEST(UrdfTest, JointTypesAreThoseOfTheMechanism) {
  const std::vector<std::pair<std::string, JointType>> types = {
      {"revolute", JointType::kRevolute}, {"continuous", JointType::kRevolute}, {"prismatic", JointType::kPrismatic},
      {"fixed", JointType::kWeld},        {"floating", JointType::kFree},       {"planar", JointType::kPlanar}};
  for (const auto& [name, type] : types) {
    const ModelFile file = read(robot(link("a") + link("b") + joint("j", name, "a", "b")));
    ASSERT_TRUE(file.read.model) << name << "\n" << all_messages(file);
    EXPECT_EQ(joint_of(file, "j").type, type) << name;
  }
}

TEST(UrdfTest, AJointTurnsAboutItsAxisAtItsOrigin) {
  const ModelFile file = read(robot(link("a") + link("b") +
                                    joint("j", "continuous", "a", "b",
                                          "<origin xyz=\"1 2 3\" rpy=\"0 0 1.5707963267948966\"/>"
                                          "<axis xyz=\"0 3 4\"/>")));
  const Joint& j = joint_of(file, "j");
  EXPECT_TRUE(j.X_1F.p.isApprox(Eigen::Vector3d(1, 2, 3)));
  EXPECT_TRUE(j.X_1F.R.col(2).isApprox(Eigen::Vector3d(-0.6, 0, 0.8), 1e-12));
  EXPECT_TRUE(j.X_2M.p.isZero());
  EXPECT_TRUE(j.X_2M.R.col(2).isApprox(Eigen::Vector3d(0, 0.6, 0.8), 1e-12));
  // As drawn the coordinate is zero: the two frames coincide.
  const Pose F = body_of(file, "a").X_WB * j.X_1F, M = body_of(file, "b").X_WB * j.X_2M;
  EXPECT_TRUE(F.R.isApprox(M.R, 1e-12) && F.p.isApprox(M.p, 1e-12));
}

TEST(UrdfTest, TheDefaultAxisIsX) {
  const ModelFile file = read(robot(link("a") + link("b") + joint("j", "continuous", "a", "b")));
  EXPECT_TRUE(joint_of(file, "j").X_1F.R.col(2).isApprox(Eigen::Vector3d::UnitX()));
}

TEST(UrdfTest, RollPitchYawTurnsAboutFixedAxesInThisOrder) {
  const ModelFile file =
      read(robot(link("a") + link("b") + joint("j", "fixed", "a", "b", "<origin rpy=\"0.3 -0.4 0.5\"/>")));
  const double r = 0.3, p = -0.4, y = 0.5;
  Eigen::Matrix3d Rx, Ry, Rz;
  Rx << 1, 0, 0, 0, std::cos(r), -std::sin(r), 0, std::sin(r), std::cos(r);
  Ry << std::cos(p), 0, std::sin(p), 0, 1, 0, -std::sin(p), 0, std::cos(p);
  Rz << std::cos(y), -std::sin(y), 0, std::sin(y), std::cos(y), 0, 0, 0, 1;
  EXPECT_TRUE(body_of(file, "b").X_WB.R.isApprox(Rz * Ry * Rx, 1e-14));
}

TEST(UrdfTest, LimitsThatAreMissingAreNoLimits) {
  const auto limits = [](const std::string& attributes) {
    const ModelFile file =
        read(robot(link("a") + link("b") + joint("j", "revolute", "a", "b", "<limit " + attributes + "/>")));
    EXPECT_TRUE(file.read.model) << all_messages(file);
    return std::pair(joint_of(file, "j").limits, all_messages(file));
  };
  EXPECT_FALSE(limits("effort=\"1\" velocity=\"2\"").first);
  EXPECT_THAT(limits("effort=\"1\" velocity=\"2\"").second, HasSubstr("'effort' of <limit> is not read"));
  EXPECT_EQ(limits("lower=\"-1\" upper=\"2\"").first, (std::array<double, 2>{-1, 2}));
  EXPECT_FALSE(limits("lower=\"0\" upper=\"0\"").first);
  EXPECT_THAT(limits("lower=\"0\" upper=\"0\"").second, HasSubstr("no way to go"));
  EXPECT_FALSE(limits("upper=\"2\"").first);
  EXPECT_THAT(limits("upper=\"2\"").second, HasSubstr("one limit only"));
}

TEST(UrdfTest, DampingActsInJointsAndDryFrictionIsTold) {
  const std::string text =
      robot(link("a") + link("b") + joint("j", "prismatic", "a", "b", "<dynamics damping=\"0.7\" friction=\"0.2\"/>"));
  const ModelFile file = read(text);
  ASSERT_EQ(file.read.model->forces().size(), 1U);
  EXPECT_EQ(std::get<JointDamping>(file.read.model->forces()[0].element).damping, 0.7);
  EXPECT_THAT(all_messages(file), HasSubstr("F601 4:103 'friction' of <dynamics> is not read"));
  ImportOptions without;
  without.ignore_damping = true;
  EXPECT_TRUE(read(text, without).read.model->forces().empty());
}

TEST(UrdfTest, AMimicIsACouplingOrWithAnOffsetAFormula) {
  const auto mimic = [](const std::string& rest) {
    return read(robot(link("a") + link("b") + link("c") + joint("j", "continuous", "a", "b") +
                      joint("k", "continuous", "a", "c", "<mimic joint=\"j\" " + rest + "/>")));
  };
  const ModelFile linear = mimic("multiplier=\"-2\"");
  ASSERT_TRUE(linear.read.model) << all_messages(linear);
  EXPECT_THAT(linear.read.model->couplings().at(0).coefficients, ElementsAre(1, 2));  // k + 2 j = 0
  EXPECT_EQ(analysis(linear).redundancy->mobility, 1);
  const ModelFile shifted = mimic("offset=\"0.5\"");
  ASSERT_TRUE(shifted.read.model) << all_messages(shifted);
  EXPECT_EQ(shifted.read.spec.constraints.at(0).formula.to_string(), "k.position - (j.position + 0.5)");
}

TEST(UrdfTest, ATransmissionIsADrive) {
  const ModelFile file = read(robot(link("a") + link("b") + joint("j", "continuous", "a", "b") +
                                    "<transmission name=\"t\"><type>transmission_interface/SimpleTransmission</type>"
                                    "<joint name=\"j\"/><actuator name=\"m 1\">"
                                    "<mechanicalReduction>50</mechanicalReduction></actuator></transmission>"));
  ASSERT_EQ(file.read.model->drives().size(), 1U);
  EXPECT_EQ(file.read.model->drives()[0].name, "m_1");
  EXPECT_THAT(all_messages(file), HasSubstr("<mechanicalReduction> is not used"));
}

TEST(UrdfTest, ARotorAddsItsInertiaTimesTheSquareOfItsGearRatio) {
  const std::string text = robot(link("a") + link("b") + joint("j", "continuous", "a", "b") +
                                 "<transmission><joint name=\"j\"/><actuator name=\"m\">"
                                 "<drake:rotor_inertia value=\"0.01\"/><drake:gear_ratio value=\"10\"/></actuator>"
                                 "</transmission>");
  const ModelFile file = read(text);
  ASSERT_TRUE(file.read.model) << all_messages(file);
  ASSERT_TRUE(file.read.spec.lagrangian.kinetic_energy);
  EXPECT_EQ(file.read.spec.lagrangian.kinetic_energy->to_string(), "0.5 * j.velocity^2");
  ImportOptions without;
  without.ignore_armature = true;
  EXPECT_FALSE(read(text, without).read.spec.lagrangian.kinetic_energy);
}

TEST(UrdfTest, VisualsAreKeptWithTheirColours) {
  const ModelFile file = read(robot(R"(<material name="red"><color rgba="1 0 0 1"/></material>
    <link name="a"><visual><origin xyz="1 0 0"/><geometry><cylinder radius="0.1" length="2"/></geometry>
    <material name="red"/></visual>
    <visual><geometry><mesh filename="package://a.stl" scale="2 2 2"/></geometry></visual></link>)"));
  ASSERT_EQ(file.visuals.size(), 2U);
  EXPECT_EQ(file.visuals[0].kind, VisualShape::Kind::kCylinder);
  EXPECT_EQ(file.visuals[0].size, (std::array<double, 3>{0.1, 2, 0}));
  EXPECT_EQ(*file.visuals[0].rgba, (std::array<double, 4>{1, 0, 0, 1}));
  EXPECT_EQ(file.visuals[1].mesh, "package://a.stl");
  EXPECT_THAT(all_messages(file), HasSubstr("1 mesh file, which are not opened"));
}

TEST(UrdfTest, WhatIsNotReadIsTold) {
  const ModelFile file = read(robot("<gazebo reference=\"a\"/><link name=\"a\"><collision/></link>"));
  EXPECT_THAT(all_messages(file), HasSubstr("F601 2:2 <gazebo> in <robot> is not read"));
  EXPECT_THAT(all_messages(file), HasSubstr("<collision> in <link> is not read"));
}

TEST(UrdfTest, NamesThatTheNativeFormatDoesNotAllowAreChangedAndListed) {
  const ModelFile file = read(robot(link("left leg") + link("ground") + joint("a-b", "fixed", "left leg", "ground")));
  ASSERT_TRUE(file.read.model) << all_messages(file);
  EXPECT_TRUE(file.read.model->find_body("left_leg"));
  EXPECT_TRUE(file.read.model->find_body("ground_"));
  EXPECT_TRUE(file.read.model->find_joint("a_b"));
  EXPECT_EQ(file.renamed.size(), 3U);
}

// The parallelogram four-bar of three bars of length 1 on pins 1 apart: G is 5 x 3 of rank 2 [closed form: one
// freedom].
TEST(UrdfTest, ALoopJointClosesAPlanarFourBar) {
  const std::string text =
      robot(empty_link("world") + bar("a", "world", "0 0 0") + bar("b", "a", "1 0 0") + bar("c", "world", "0 1 0") +
            R"(<loop name="shut" type="revolute"><predecessor link="b"><origin xyz="0 1 0"/>
    </predecessor><successor link="c"><origin xyz="1 0 0"/></successor><axis xyz="0 0 1"/></loop>)");
  const ModelFile file = read(text);
  ASSERT_TRUE(file.read.model) << all_messages(file);
  const MechanismAnalysis a = analysis(file);
  ASSERT_TRUE(a.is_assembled());
  EXPECT_EQ(a.redundancy->closure_rows, 5);
  EXPECT_EQ(a.redundancy->closure_rank, 2);
  EXPECT_EQ(a.redundancy->mobility, 1);
  EXPECT_EQ(a.redundancy->redundant, 3);
}

// A rotor beside an arm on one base: ratio times the predecessor's motion is the successor's.
TEST(UrdfTest, ACouplingJoinsTheWaysFromWhereTheyBranch) {
  const ModelFile file = read(robot(link("base") + bar("rotor", "base", "0 0 0") + bar("hip", "base", "0 0 0") +
                                    bar("knee", "hip", "1 0 0") +
                                    R"(<coupling name="belt"><predecessor link="knee"/><successor link="rotor"/>
    <ratio value="6"/></coupling>)"));
  ASSERT_TRUE(file.read.model) << all_messages(file);
  const Coupling& belt = file.read.model->couplings().at(0);
  ASSERT_EQ(belt.scalars.size(), 3U);
  EXPECT_EQ(file.read.model->coordinate_name(belt.scalars[0].coordinate), "knee_pin");
  EXPECT_EQ(file.read.model->coordinate_name(belt.scalars[1].coordinate), "hip_pin");
  EXPECT_EQ(file.read.model->coordinate_name(belt.scalars[2].coordinate), "rotor_pin");
  EXPECT_THAT(belt.coefficients, ElementsAre(6, 6, -1));
}

/// Two arms of two bars each from a base, with marker links at the tips.
std::string two_arms() {
  return robot(link("base") + bar("a", "base", "0 0 0") + bar("b", "a", "1 0 0") + bar("c", "base", "1 0 0") +
               bar("d", "c", "0 1 0") + empty_link("tip_A") +
               joint("tip_A_frame", "fixed", "b", "tip_A", "<origin xyz=\"0 1 0\"/>") + empty_link("tip_B") +
               joint("tip_B_frame", "fixed", "d", "tip_B", "<origin xyz=\"0 0 0\"/>"));
}

TEST(UrdfTest, ClosuresJoinPointsOrFrames) {
  const ModelFile points =
      read_closed(two_arms(), "closed_loop: [['tip_A', 'tip_B_frame']]\ntype: ['3D']\nname_mot: [a_pin]\n");
  ASSERT_TRUE(points.read.model) << all_messages(points);
  EXPECT_EQ(joint_of(points, "tip").type, JointType::kSpherical);
  EXPECT_EQ(points.read.model->drives().size(), 1U);
  const MechanismAnalysis a = analysis(points);
  EXPECT_EQ(a.redundancy->closure_rows, 3);
  EXPECT_EQ(a.redundancy->closure_rank, 2);
  EXPECT_EQ(a.redundancy->mobility, 2);
  const ModelFile frames = read_closed(two_arms(), "closed_loop: [[tip_A, tip_B]]\ntype: [6d]\n");
  EXPECT_EQ(joint_of(frames, "tip").type, JointType::kWeld);
  EXPECT_EQ(analysis(frames).redundancy->closure_rows, 5);  // of a hinge: the weld is in the tree
  EXPECT_EQ(analysis(frames).redundancy->redundant, 3);     // all of it is planar: 6 closing rows hold 3 ways to move
}

TEST(UrdfTest, FixedJointsMergeLinksButNotThoseToTheGroundNorClosures) {
  const std::string text =
      robot(link("a") + link("b") + link("c") + link("d") + joint("pin", "continuous", "a", "b") +
            joint("bolt", "fixed", "b", "c") + joint("turn", "continuous", "a", "d") +
            "<loop name=\"ring\" type=\"fixed\"><predecessor link=\"c\"/><successor link=\"d\"/></loop>");
  const ModelFile file =
      read_any_model_text(text, "robot.urdf", ModelFormat::kUrdf, [](const std::string&) { return std::nullopt; });
  ASSERT_TRUE(file.read.model) << all_messages(file);
  const Model& model = *file.read.model;
  EXPECT_EQ(model.bodies().size(), 4U);  // ground, a, b with c, d
  EXPECT_EQ(model.find_body("c"), model.find_body("b"));
  EXPECT_FALSE(model.find_joint("bolt"));
  EXPECT_TRUE(model.find_joint("fixed_base"));
  EXPECT_TRUE(model.find_joint("ring"));
}

TEST(UrdfTest, ClosuresReplaceJoints) {
  const ModelFile file = read_closed(two_arms(),
                                     "closed_loop: []\ntype: []\njoint_name: [a_pin, b_pin, c_pin]\n"
                                     "joint_type: [SPHERICAL, UJOINT_ZY, fixed]\n");
  ASSERT_TRUE(file.read.model) << all_messages(file);
  EXPECT_EQ(joint_of(file, "a_pin").type, JointType::kSpherical);
  const Joint& universal = joint_of(file, "b_pin");
  EXPECT_EQ(universal.type, JointType::kUniversal);
  EXPECT_TRUE(universal.X_1F.R.col(2).isApprox(Eigen::Vector3d::UnitZ()));
  EXPECT_TRUE(universal.X_2M.R.col(0).isApprox(Eigen::Vector3d::UnitY()));
  EXPECT_EQ(joint_of(file, "c_pin").type, JointType::kWeld);
}

TEST(UrdfTest, AFileBesideThatIsNoFileOfClosuresIsToldAndNotUsed) {
  ImportOptions beside;
  beside.closures = "robot.yaml";
  beside.closures_may_be_another_file = true;
  const ModelFile file = read(robot(link("a")), beside, {{"robot.yaml", "controllers: {arm: {type: position}}\n"}});
  EXPECT_TRUE(file.read.model);
  EXPECT_THAT(all_messages(file), HasSubstr("'robot.yaml' is no file of closures"));
}

struct Broken {
  std::string text, code;
  int line, column;
};

TEST(UrdfTest, BrokenFilesAreRefusedAtTheirPlace) {
  const std::string a = "<link name=\"a\"/>\n", b = "<link name=\"b\"/>\n", c = "<link name=\"c\"/>\n";
  const auto j = [](const std::string& rest) { return "<joint name=\"j\" type=\"fixed\">" + rest + "</joint>\n"; };
  const std::string ends = "<parent link=\"a\"/><child link=\"b\"/>";
  const std::vector<Broken> all = {
      {"", "F103", 0, 0},
      {"robot: 1", "F107", 1, 8},
      {"<robot><link name=\"a\"></robot>", "F107", 1, 25},
      {"<sdf/>", "F605", 1, 2},
      {"<robot/>", "F605", 1, 2},
      {robot("<link/>"), "F202", 2, 2},
      {robot(a + a), "F302", 3, 13},
      {robot(a + b), "F605", 3, 13},
      {robot(a + b + j("<parent link=\"a\"/>")), "F202", 4, 2},
      {robot(a + b + j("<parent link=\"a\"/><child link=\"x\"/>")), "F604", 4, 61},
      {robot(a + b + j("<parent link=\"b\"/><child link=\"b\"/>")), "F605", 4, 61},
      {robot(a + b + j(ends) + "<joint name=\"k\" type=\"fixed\">" + ends + "</joint>\n"), "F605", 5, 61},
      {robot(a + b + j(ends) + "<joint name=\"k\" type=\"fixed\"><parent link=\"b\"/><child link=\"a\"/></joint>\n"),
       "F605", 1, 2},
      {robot(a + b + c + j("<parent link=\"b\"/><child link=\"c\"/>") +
             "<joint name=\"k\" type=\"fixed\"><parent link=\"c\"/><child link=\"b\"/></joint>\n"),
       "F605", 3, 13},
      {robot(a + b + "<joint name=\"j\" type=\"ball\">" + ends + "</joint>\n"), "F209", 4, 23},
      {robot(a + b + j(ends + "<origin xyz=\"0 1\"/>")), "F208", 4, 78},
      {robot(a + b + j(ends + "<origin rpy=\"0 1 nan\"/>")), "F206", 4, 78},
      {robot(a + b + "<joint name=\"j\" type=\"revolute\">" + ends + "<axis xyz=\"0 0 0\"/></joint>\n"), "F206", 4, 79},
      {robot(a + b + "<joint name=\"j\" type=\"revolute\">" + ends + "<limit lower=\"2\" upper=\"1\"/></joint>\n"),
       "F326", 4, 92},
      {robot(a + b + "<joint name=\"j\" type=\"revolute\">" + ends + "<mimic joint=\"i\"/></joint>\n"), "F604", 4, 82},
      {robot(a + b + "<joint name=\"j\" type=\"revolute\">" + ends + "<mimic joint=\"j\"/></joint>\n"), "F604", 4, 82},
      {robot("<link name=\"a\"><inertial/></link>"), "F202", 2, 17},
      {robot(
           "<link name=\"a\"><inertial><mass value=\"-1\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" "
           "izz=\"1\"/></inertial></link>"),
       "F311", 2, 39},
      {robot("<link name=\"a\"><inertial><mass value=\"1\"/><inertia ixx=\"1\"/></inertial></link>"), "F202", 2, 44},
      {robot(a + "<xacro:macro name=\"m\"/>"), "F602", 3, 2},
      {robot(a + b + j(ends) +
             "<loop name=\"l\" type=\"screw\"><predecessor link=\"a\"/><successor link=\"b\"/></loop>"),
       "F209", 5, 22},
      {robot(a + b + j(ends) + "<loop name=\"l\" type=\"fixed\"><predecessor link=\"a\"/></loop>"), "F202", 5, 2},
      {robot(a + b + j(ends) +
             "<coupling name=\"l\"><predecessor link=\"a\"/><successor link=\"b\"/><ratio value=\"2\"/>"
             "</coupling>"),
       "F605", 5, 2},
  };
  for (const Broken& one : all) {
    const ModelFile file = read(one.text);
    EXPECT_FALSE(file.read.model) << one.text;
    const auto& items = file.read.diagnostics.items();
    const bool found = std::any_of(items.begin(), items.end(), [&](const Diagnostic& d) {
      return d.severity == Severity::kError && d.code == one.code && d.at.line == one.line && d.at.column == one.column;
    });
    EXPECT_TRUE(found) << one.text << "wants " << one.code << " " << one.line << ":" << one.column << ", has\n"
                       << all_messages(file);
  }
}

TEST(UrdfTest, BrokenFilesOfClosuresAreToldWithTheirOwnPlaces) {
  const std::vector<std::pair<std::string, std::string>> all = {
      {"closed_loop: [[tip_A, tip_C]]\ntype: [6d]\n",
       "F604 0:0 robot.yaml:1:15: there is no link and no joint 'tip_C'"},
      {"closed_loop: [[tip_A]]\ntype: [6d]\n", "F208 0:0 robot.yaml:1:15: a closed loop is a pair of names, not 1"},
      {"closed_loop: [[tip_A, tip_B]]\ntype: [5d]\n", "F209 0:0 robot.yaml:2:8: '5d' is no type of closed loop"},
      {"closed_loop: [[tip_A, tip_B]]\ntype: []\n", "F208 0:0 robot.yaml:2:7: 'type' has 0 entries, not 1"},
      {"closed_loop: [[tip_A, tip_A_frame]]\ntype: [6d]\n", "are frames of one link"},
      {"closed_loop: {a: b}\n", "F203 0:0 robot.yaml:1:14: 'closed_loop' is a list of pairs of names"},
      {"closed_loop: [\n", "robot.yaml:"},
      {"name_mot: [nothing]\n", "F604 0:0 robot.yaml:1:12: there is no joint 'nothing' for a motor"},
      {"name_mot: [tip_A_frame]\n", "the fixed joint 'tip_A_frame' has no single coordinate for a motor"},
      {"joint_name: [a_pin]\n", "F202 0:0 robot.yaml:1:13: 'joint_name' needs 'joint_type' beside it"},
      {"joint_name: [a_pin]\njoint_type: [UJOINT_XX]\n",
       "F209 0:0 robot.yaml:2:14: 'UJOINT_XX' is no type of joint here"},
      {"joint_name: [x]\njoint_type: [FIXED]\n", "F604 0:0 robot.yaml:1:14: there is no joint 'x'"},
  };
  for (const auto& [closures, message] : all) {
    const ModelFile file = read_closed(two_arms(), closures);
    EXPECT_FALSE(file.read.model) << closures;
    EXPECT_THAT(all_messages(file), HasSubstr(message)) << closures;
  }
  ImportOptions import;
  import.closures = "missing.yaml";
  EXPECT_THAT(all_messages(read(two_arms(), import)), HasSubstr("F606"));
}

struct Published {
  std::string file;
  int mobility, redundant;
};

/// Files of others, with figures of an independent program; not part of the project. Which joint of a loop is cut, and
/// so how many rows close it, is each program's choice.
TEST(UrdfTest, FilesOfOthersHaveThePublishedFigures) {
  const std::vector<Published> all = {
      {"example-parallel-robots/5bar_linkage/robot.urdf", 3, 3},
      {"example-parallel-robots/5bar_linkage_iso3d/robot.urdf", 2, 0},
      {"example-parallel-robots/5bar_linkage_iso6d/robot.urdf", 2, 0},
      {"example-parallel-robots/wl16_like/robot.urdf", 12, 0},
      {"generalized_rbda/four_bar.urdf", 2, 4},            // as drawn: all bars in one line
      {"generalized_rbda/planar_leg_linkage.urdf", 3, 4},  // as drawn
  };
  for (const Published& one : all) {
    const auto path = witness::third_party(one.file);
    if (!path) GTEST_SKIP() << witness::kNoThirdPartyModels;
    const ModelFile file = read_any_model_file(*path);
    ASSERT_TRUE(file.read.model) << one.file << "\n" << all_messages(file);
    const MechanismAnalysis a = analysis(file);
    ASSERT_TRUE(a.is_assembled()) << one.file;
    EXPECT_EQ(a.redundancy->mobility, one.mobility) << one.file;
    EXPECT_EQ(a.redundancy->redundant, one.redundant) << one.file;
  }
}

/// Away from the line the two linkages of URDF+ have rank 2 of 5 rows.
TEST(UrdfTest, LinkagesOfOthersHaveThePublishedFiguresAwayFromTheirSingularStart) {
  struct Started {
    std::string file;
    std::vector<std::pair<std::string, double>> guesses;
    int mobility;
  };
  const std::vector<Started> all = {
      {"generalized_rbda/four_bar.urdf", {{"joint1", -0.467}, {"joint2", 1.239}, {"joint3", 1.239}}, 1},
      {"generalized_rbda/planar_leg_linkage.urdf",
       {{"thigh_to_driver", 0.6}, {"driver_to_foot", -0.6}, {"thigh_to_support", 0.6}},
       2},
  };
  for (const Started& one : all) {
    const auto path = witness::third_party(one.file);
    if (!path) GTEST_SKIP() << witness::kNoThirdPartyModels;
    ModelSpec spec = read_any_model_file(*path).read.spec;
    for (const auto& [joint, position] : one.guesses) {
      InitialSpec initial;
      initial.joint = joint;
      initial.position = {Number(position)};
      initial.guess = true;
      spec.initial.push_back(initial);
    }
    const ModelBuildResult built = build_model(spec);
    ASSERT_TRUE(built.model) << one.file;
    const MechanismAnalysis a = analyze_mechanism(*make_system(*built.model));
    ASSERT_TRUE(a.is_assembled()) << one.file;
    EXPECT_EQ(a.redundancy->closure_rows, 5) << one.file;
    EXPECT_EQ(a.redundancy->closure_rank, 2) << one.file;
    EXPECT_EQ(a.redundancy->mobility, one.mobility) << one.file;
    EXPECT_EQ(a.redundancy->redundant, 3) << one.file;
  }
}

}  // namespace
}  // namespace ferrers
