#include "ferrers/formats/urdf_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ferrers/formats/formats.h"
#include "ferrers/kinematics/system.h"
#include "ferrers/redundancy/mechanism_analysis.h"

namespace ferrers {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

ModelFile read(const std::string& urdf, const std::string& closures = {}) {
  ImportOptions import;
  import.merge_revolute_rows = false;
  if (!closures.empty()) import.closures = "r.yaml";
  const FileLoader load = [&](const std::string&) { return std::optional(closures); };
  return read_any_model_text(urdf, "r.urdf", ModelFormat::kUrdf, load, {}, import);
}

std::string messages(const Diagnostics& diagnostics) {
  std::string text;
  for (const Diagnostic& one : diagnostics.items()) text += one.code + " " + one.message + "\n";
  return text;
}

void expect_same_pose(const Pose& a, const Pose& b, const std::string& what) {
  EXPECT_TRUE(a.R.isApprox(b.R, 1e-12)) << what;
  EXPECT_LT((a.p - b.p).norm(), 1e-12) << what;
}

/// Masses, poses as drawn, joints and their axes in the world are the same, each by name.
void expect_same(const Model& a, const Model& b) {
  ASSERT_EQ(a.bodies().size(), b.bodies().size());
  for (const Body& body : a.bodies()) {
    const auto found = b.find_body(body.name);
    ASSERT_TRUE(found) << body.name;
    const Body& other = b.body(*found);
    EXPECT_EQ(body.mass_kg, other.mass_kg);
    EXPECT_LT((body.X_WB * body.com_m - other.X_WB * other.com_m).norm(), 1e-12) << body.name;
    const Eigen::Matrix3d I = body.X_WB.R * body.inertia_kgm2 * body.X_WB.R.transpose();
    const Eigen::Matrix3d J = other.X_WB.R * other.inertia_kgm2 * other.X_WB.R.transpose();
    EXPECT_TRUE(I.isApprox(J, 1e-12) || I == J) << body.name;
  }
  ASSERT_EQ(a.joints().size(), b.joints().size());
  for (const Joint& joint : a.joints()) {
    const auto found = b.find_joint(joint.name);
    ASSERT_TRUE(found) << joint.name;
    const Joint& other = b.joint(*found);
    EXPECT_EQ(joint.type, other.type) << joint.name;
    EXPECT_EQ(a.body(joint.first).name, b.body(other.first).name);
    EXPECT_EQ(a.body(joint.second).name, b.body(other.second).name);
    EXPECT_EQ(joint.limits, other.limits);
    const Pose F = a.body(joint.first).X_WB * joint.X_1F, G = b.body(other.first).X_WB * other.X_1F;
    EXPECT_LT((F.p - G.p).norm(), 1e-12) << joint.name;
    if (joint.type != JointType::kWeld) {
      EXPECT_LT((F.R.col(2) - G.R.col(2)).norm(), 1e-12) << joint.name;
    }
  }
  ASSERT_EQ(a.couplings().size(), b.couplings().size());
  ASSERT_EQ(a.forces().size(), b.forces().size());
  ASSERT_EQ(a.drives().size(), b.drives().size());
}

constexpr const char* kTree = R"(<robot name="tree">
  <link name="base"><inertial><origin xyz="0.1 0 0"/><mass value="3"/>
    <inertia ixx="0.1" ixy="0.01" ixz="0" iyy="0.2" iyz="0.02" izz="0.25"/></inertial></link>
  <link name="arm"><inertial><origin xyz="0 0.2 0" rpy="0.1 0.2 0.3"/><mass value="1.5"/>
    <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.2" iyz="0" izz="0.25"/></inertial></link>
  <link name="rod"/><link name="tool"/><link name="plate"/><link name="ball"/>
  <joint name="hinge" type="revolute"><parent link="base"/><child link="arm"/>
    <origin xyz="0.5 -0.25 0.125" rpy="0.3 -0.4 0.5"/><axis xyz="1 2 2"/><limit lower="-1" upper="2.5"/>
    <dynamics damping="0.3"/></joint>
  <joint name="slide" type="prismatic"><parent link="arm"/><child link="rod"/>
    <origin xyz="0 0 1" rpy="0 1.5707963267948966 0.2"/><axis xyz="0 0 -1"/></joint>
  <joint name="turn" type="continuous"><parent link="rod"/><child link="tool"/><axis xyz="0 1 0"/>
    <mimic joint="hinge" multiplier="-2" offset="0.25"/></joint>
  <joint name="glide" type="planar"><parent link="base"/><child link="plate"/><axis xyz="0 1 1"/></joint>
  <joint name="loose" type="floating"><parent link="base"/><child link="ball"/><origin xyz="0 3 0"/></joint>
  <transmission name="t"><joint name="hinge"/><actuator name="motor"/></transmission>
</robot>)";

TEST(UrdfWriterTest, ATreeComesBackAsItWas) {
  const ModelFile first = read(kTree);
  ASSERT_TRUE(first.read.model) << messages(first.read.diagnostics);
  Diagnostics told;
  const UrdfText text = write_urdf(*first.read.model, {}, told);
  EXPECT_THAT(told.items(), IsEmpty()) << messages(told);
  EXPECT_TRUE(text.closures.empty());
  const ModelFile second = read(text.urdf);
  ASSERT_TRUE(second.read.model) << messages(second.read.diagnostics) << text.urdf;
  expect_same(*first.read.model, *second.read.model);
  EXPECT_EQ(first.read.spec.constraints[0].formula.to_string(), second.read.spec.constraints[0].formula.to_string());
  // Written and read again, it has not drifted.
  const ModelFile third = read(write_urdf(*second.read.model, {}, told).urdf);
  ASSERT_TRUE(third.read.model);
  expect_same(*first.read.model, *third.read.model);
}

// A parallelogram: the loop joint is cut and closed by the file of closures [one freedom, three redundant rows].
TEST(UrdfWriterTest, LoopsAreClosedByTheSecondFile) {
  const std::string bar = R"(<inertial><mass value="1"/>
    <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>)";
  const auto link = [&](const std::string& name) { return "<link name=\"" + name + "\">" + bar + "</link>"; };
  const auto pin = [](const std::string& name, const std::string& parent, const std::string& child,
                      const std::string& at) {
    return "<joint name=\"" + name + "\" type=\"continuous\"><parent link=\"" + parent + "\"/><child link=\"" + child +
           "\"/><origin xyz=\"" + at + "\"/><axis xyz=\"0 0 1\"/></joint>";
  };
  for (const std::string type : {"revolute", "prismatic", "planar", "fixed"}) {
    const std::string robot = "<robot name=\"r\"><link name=\"world\"/>" + link("a") + link("b") + link("c") +
                              pin("ja", "world", "a", "0 0 0") + pin("jb", "a", "b", "1 0 0") +
                              pin("jc", "world", "c", "0 1 0") + "<loop name=\"shut\" type=\"" + type +
                              "\"><predecessor link=\"b\"><origin xyz=\"0 1 0\"/></predecessor><successor link=\"c\">"
                              "<origin xyz=\"1 0 0\"/></successor><axis xyz=\"0 0 1\"/></loop></robot>";
    const ModelFile first = read(robot);
    ASSERT_TRUE(first.read.model) << type << messages(first.read.diagnostics);
    Diagnostics told;
    const UrdfText text = write_urdf(*first.read.model, {}, told);
    EXPECT_THAT(text.closures, HasSubstr("closed_loop: [['shut_A', 'shut_B']]\ntype: ['6d']")) << type;
    const ModelFile second = read(text.urdf, text.closures);
    ASSERT_TRUE(second.read.model) << type << messages(second.read.diagnostics);
    const MechanismAnalysis a = analyze_mechanism(*make_system(*first.read.model));
    const MechanismAnalysis b = analyze_mechanism(*make_system(*second.read.model));
    ASSERT_TRUE(a.redundancy && b.redundancy) << type;
    EXPECT_EQ(a.redundancy->mobility, b.redundancy->mobility) << type;
    EXPECT_EQ(a.redundancy->redundant, b.redundancy->redundant) << type;
  }
}

TEST(UrdfWriterTest, JointsOfSeveralCoordinatesBecomeRows) {
  constexpr const char* kNative = R"yaml(ferrers: 1
gravity: [0, -9.81, 0]
bodies: {a: {mass: 1, com: [0, 0, 0]}, b: {mass: 1, com: [0, 0, 1]}}
joints:
  main: {type: revolute, bodies: [ground, a], at: [0, 0, 0], axis: z}
  nut: {type: screw, bodies: [a, b], at: [0, 0, 1], axis: z, lead: 0.1}
forces: {s: {type: spring, bodies: [a, b], points: [[0, 0, 0], [0, 0, 1]], stiffness: 1}}
drives: {motor: {joint: main, effort: "= sin(t)"}}
initial: {main: {position: 0.3}}
)yaml";
  const ModelReadResult native = read_model_text(kNative, "n.yaml");
  ASSERT_TRUE(native.model) << messages(native.diagnostics);
  Diagnostics told;
  write_urdf(*native.model, {}, told);
  for (const char* what :
       {"the screw joint 'nut' is left out", "the force element 's' is left out", "gravity is left out",
        "initial values left out: 1", "the laws of the drive 'motor' are left out"}) {
    EXPECT_THAT(messages(told), HasSubstr(what));
  }
}

TEST(UrdfWriterTest, ShapesComeBack) {
  const ModelFile first = read(R"(<robot name="r"><link name="a"><visual><origin xyz="1 2 3" rpy="0 0 1"/><geometry>
    <box size="1 2 3"/></geometry><material name="m"><color rgba="1 0 0 0.5"/></material></visual></link></robot>)");
  Diagnostics told;
  const UrdfText text = write_urdf(*first.read.model, first.visuals, told);
  const ModelFile second = read(text.urdf);
  ASSERT_EQ(second.visuals.size(), 1U);
  EXPECT_EQ(second.visuals[0].size, first.visuals[0].size);
  EXPECT_EQ(second.visuals[0].rgba, first.visuals[0].rgba);
  expect_same_pose(second.visuals[0].X_BS, first.visuals[0].X_BS, "box");
}

}  // namespace
}  // namespace ferrers
