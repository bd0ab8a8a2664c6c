// Files of other programs through the command: analyzed as they are, converted, made consistent.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "command_probe.h"

namespace ferrers::command_testing {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

const fs::path kFormats = fs::path(FERRERS_SOURCE_DIR) / "tests/models/formats";
const std::string kAssembly = (kExamples / "freecad-four-bar/assembly.asmt").string();
const std::string kArms = (kFormats / "urdf/two-arms.urdf").string();
const std::string kFourBar = (kFormats / "mjcf/four-bar.xml").string();

// A crank of three parts, one of them a sensor's frame, and a rocker.
constexpr const char* kParts = R"(<robot name="parts">
  <link name="base"/>
  <link name="crank"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="plate"><inertial><mass value="2"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="imu-frame"/>
  <link name="rocker"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="main" type="continuous"><parent link="base"/><child link="crank"/><axis xyz="0 1 0"/></joint>
  <joint name="bolt" type="fixed"><parent link="crank"/><child link="plate"/><origin xyz="0.5 0 0"/></joint>
  <joint name="imu" type="fixed"><parent link="plate"/><child link="imu-frame"/><origin xyz="0.1 0 0"/></joint>
  <joint name="elbow" type="continuous"><parent link="plate"/><child link="rocker"/><origin xyz="0.5 0 0"/><axis xyz="0 1 0"/></joint>
</robot>
)";

// Pins along z to a millionth of a radian, cranks of equal length to a micrometre.
constexpr const char* kNoisy = R"(ferrers: 1
name: noisy
bodies:
  a: {mass: 1, com: [0, 0.5, 0]}
  b: {mass: 1, com: [1, 1, 0]}
  c: {mass: 1, com: [2, 0.5, 0]}
joints:
  O: {type: revolute, bodies: [ground, a], at: [0, 0, 0], axis: [1e-6, 0, 1]}
  A: {type: revolute, bodies: [a, b], at: [0, 1.000001, 0], axis: [0, 2e-6, 1]}
  B: {type: revolute, bodies: [b, c], at: [2, 1, 0], axis: z}
  C: {type: revolute, bodies: [ground, c], at: [2, 0, 0], axis: z}
)";

// ---------------------------------------------------------------------------------------------------------------------
// Verbs on them

TEST_F(CommandTest, AFileOfAnotherProgramIsAnalyzedAsItIs) {
  const std::map<std::string, int> redundant = {{kAssembly, 3}, {kFourBar, 1}};  // MJCF joins points only
  for (const auto& [file, wanted] : redundant) {
    const ordered_json report = run({"analyze", file, "--json"}).json();
    EXPECT_EQ(report.at("ok"), true) << file;
    EXPECT_EQ(report.at("mobility"), 1) << file;
    EXPECT_EQ(report.at("redundant"), wanted) << file;
  }
}

TEST_F(CommandTest, RigidGroupsAreToldWithTheirParts) {
  write("parts.urdf", kParts);
  const Result text = run({"analyze", "parts.urdf"});
  EXPECT_THAT(text.output, HasSubstr("5 bodies, 5 joints"));
  EXPECT_THAT(text.output, HasSubstr("3 parts are 1 rigid group"));
  EXPECT_THAT(text.output, HasSubstr("3 parts: crank, plate, imu_frame"));
  const ordered_json report = run({"analyze", "parts.urdf", "--json"}).json();
  ASSERT_EQ(report.at("rigid_groups").size(), 1u);
  EXPECT_EQ(report["rigid_groups"][0]["name"], "crank");
  EXPECT_EQ(report["rigid_groups"][0]["parts"], ordered_json({"crank", "plate", "imu_frame"}));
  EXPECT_EQ(report["rigid_groups"][0]["welds"], ordered_json({"bolt", "imu"}));
}

TEST_F(CommandTest, WeldsThatAreKeptBearReactions) {
  write("parts.urdf", kParts);
  const ordered_json kept = run({"analyze", "parts.urdf", "--welds", "keep", "--json"}).json();
  EXPECT_EQ(kept.at("bodies"), 5);
  EXPECT_EQ(kept.at("joints"), 5);
  EXPECT_FALSE(kept.contains("rigid_groups"));
  run({"simulate", "parts.urdf", "--end", "0.1", "-o", "merged"});
  run({"simulate", "parts.urdf", "--end", "0.1", "-o", "kept", "--welds", "keep"});
  const std::string merged_file = read_text(folder_ / "merged/reactions.csv"),
                    kept_file = read_text(folder_ / "kept/reactions.csv");
  EXPECT_THAT(merged_file, Not(HasSubstr(",bolt,")));
  EXPECT_THAT(kept_file, HasSubstr(",bolt,"));
  const auto elbow = [](const fs::path& file) {
    std::map<std::string, double> values;
    for (const std::string& line : lines_of(file)) {
      const std::size_t at = line.find(",elbow,force_z,");
      if (at != std::string::npos) values[line.substr(0, at)] = std::stod(line.substr(at + 15));
    }
    return values;
  };
  const auto a = elbow(folder_ / "merged/reactions.csv"), b = elbow(folder_ / "kept/reactions.csv");
  ASSERT_GT(a.size(), 5u);
  ASSERT_EQ(a.size(), b.size());
  for (const auto& [t, value] : a) EXPECT_NEAR(value, b.at(t), 1e-7 * (1 + std::abs(value))) << t;
}

TEST_F(CommandTest, WhatARunLeavesInItsFolderHasTheWeldsThatWereKept) {
  write("parts.urdf", kParts);
  run({"convert", "parts.urdf", "-o", "parts.yaml"});
  run({"simulate", "parts.yaml", "--end", "0.1", "-o", "merged"});
  run({"simulate", "parts.yaml", "--end", "0.1", "-o", "kept", "--welds", "keep"});
  EXPECT_THAT(read_text(folder_ / "merged/model.yaml"), HasSubstr("merge: true"));
  EXPECT_THAT(read_text(folder_ / "kept/model.yaml"), Not(HasSubstr("merge: true")));
}

TEST_F(CommandTest, ShapesThatAreNotWrittenAreTold) {
  const Result native = run({"convert", kArms, "-o", "arms.yaml"});
  EXPECT_THAT(native.errors, HasSubstr("2 shapes of bodies"));
  const Result urdf = run({"convert", kArms, "-o", "arms.urdf"});
  EXPECT_THAT(urdf.errors, Not(HasSubstr("shapes of bodies")));
  EXPECT_THAT(read_text(folder_ / "arms.urdf"), HasSubstr("package://two/b.stl"));
}

TEST_F(CommandTest, NamesThatHadToChangeAreTold) {
  write("parts.urdf", kParts);
  EXPECT_THAT(run({"analyze", "parts.urdf"}).errors, HasSubstr("'imu-frame' is 'imu_frame'"));
}

TEST_F(CommandTest, MeshesThatAreNotThereAreOneNotice) {
  const auto link = [](const std::string& name, const std::string& mesh) {
    return "<link name='" + name + "'><visual><geometry><mesh filename='" + mesh + "'/></geometry></visual></link>";
  };
  const std::string joints =
      "<joint name='j' type='continuous'><parent link='a'/><child link='b'/></joint>"
      "<joint name='k' type='continuous'><parent link='b'/><child link='c'/></joint>";
  write("there.stl", "");
  write("r.urdf", "<robot name='r'>" + link("a", "package://mine/there.stl") + link("b", "package://mine/gone.stl") +
                      link("c", "gone_too.stl") + joints + "</robot>");
  const Result result = run({"analyze", "r.urdf"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.errors, HasSubstr("2 files of shapes cannot be found, 'gone_too.stl' first"));
}

TEST_F(CommandTest, AFileIsKnownByWhatItBeginsWithWhereItsEndingSaysNothing) {
  write("parts.bak", kParts);
  write("assembly.txt", read_text(kAssembly));
  EXPECT_EQ(run({"analyze", "parts.bak", "--json"}).json().at("bodies"), 5);
  EXPECT_EQ(run({"analyze", "assembly.txt", "--json"}).json().at("redundant"), 3);
}

TEST_F(CommandTest, AFileOfClosuresThatIsNamedMustBeOne) {
  write("parts.urdf", kParts);
  write("other.yaml", "hinges: 3\n");
  const Result named = run({"analyze", "parts.urdf", "--closures", "other.yaml"});
  EXPECT_EQ(named.exit_code, 3);
  EXPECT_THAT(named.errors, HasSubstr("'other.yaml' is no file of closures"));
  write("parts.yaml", "hinges: 3\n");  // beside it by chance
  EXPECT_EQ(run({"analyze", "parts.urdf"}).exit_code, 0);
}

TEST_F(CommandTest, AnAssemblyThatWasCutOffIsRefused) {
  const std::string whole = read_text(kAssembly);
  for (const double share : {0.1, 0.25, 0.5, 0.8, 0.9}) {
    write("cut.asmt", whole.substr(0, static_cast<std::size_t>(share * static_cast<double>(whole.size()))));
    const Result result = run({"analyze", "cut.asmt"});
    EXPECT_EQ(result.exit_code, 3) << share << result.output;
  }
}

TEST_F(CommandTest, NumbersBeyondAllBoundsAreRefusedInEveryFormat) {
  write("far.urdf",
        "<robot name='r'><link name='a'/><link name='b'/><joint name='j' type='continuous'><origin xyz='0 1e160 0'/>"
        "<parent link='a'/><child link='b'/></joint></robot>");
  write("far.xml",
        "<mujoco><worldbody><body name='b' pos='0 1e160 0'><joint/><geom size='1'/></body></worldbody></mujoco>");
  for (const char* file : {"far.urdf", "far.xml"}) {
    const Result result = run({"analyze", file});
    EXPECT_EQ(result.exit_code, 3);
    EXPECT_THAT(result.errors, HasSubstr("F338"));
  }
}

TEST_F(CommandTest, ABrokenFileHasLineAndColumn) {
  write("broken.urdf", "<robot name='r'>\n  <link name='a'>\n</robot>\n");
  const Result result = run({"analyze", "broken.urdf"});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.errors, testing::MatchesRegex("broken.urdf:3:[0-9]+: error.F107.*"));
}

// ---------------------------------------------------------------------------------------------------------------------
// Geometry that is good to a tolerance

TEST_F(CommandTest, NoisyGeometryIsMadeConsistentWhereAskedAndToldEverywhere) {
  write("noisy.yaml", kNoisy);
  const ordered_json exact = run({"analyze", "noisy.yaml", "--json"}).json();
  EXPECT_FALSE(exact.contains("geometry"));
  EXPECT_EQ(exact.at("certainty").at("confident"), false);
  const ordered_json report = run({"analyze", "noisy.yaml", "--geometric-tolerance", "1e-5", "--json"}).json();
  EXPECT_EQ(report.at("redundant"), 3);
  EXPECT_EQ(report.at("certainty").at("confident"), true);
  EXPECT_EQ(report.at("permanence").at("kind"), "permanent");
  const ordered_json& geometry = report.at("geometry");
  EXPECT_EQ(geometry.at("verdict"), "made consistent");
  EXPECT_EQ(geometry.at("tolerance"), 1e-5);
  EXPECT_EQ(geometry.at("parallel_axes").size(), 1u);
  EXPECT_EQ(geometry["parallel_axes"][0]["joints"].size(), 4u);
  EXPECT_FALSE(geometry.at("moves").empty());
  const Result text = run({"analyze", "noisy.yaml", "--geometric-tolerance", "1e-5"});
  EXPECT_THAT(text.output, HasSubstr("The numbers are taken as exact within the geometric tolerance"));
  EXPECT_THAT(text.output, HasSubstr("treated as parallel"));
  EXPECT_THAT(run({"kinematics", "noisy.yaml", "--geometric-tolerance", "1e-5", "-o", "k"}).errors,
              HasSubstr("notice[F515]"));
}

TEST_F(CommandTest, ParameterValuesOutliveConsistentGeometry) {
  std::string text = kNoisy;
  text.insert(text.find("bodies:"), "parameters:\n  m: 1\n");
  text.replace(text.find("mass: 1"), 7, "mass: = m");
  write("noisy.yaml", text);
  EXPECT_EQ(
      run({"convert", "noisy.yaml", "-p", "m=5", "--snap", "--geometric-tolerance", "1e-5", "-o", "m.yaml"}).exit_code,
      0);
  EXPECT_THAT(read_text(folder_ / "m.yaml"), HasSubstr("m: 5"));
  const std::vector<std::string> common = {"--geometric-tolerance", "1e-5", "--end", "0.1"};
  const auto energy = [&](const std::vector<std::string>& more, const std::string& folder) {
    std::vector<std::string> arguments = {"simulate", "noisy.yaml", "-o", folder};
    arguments.insert(arguments.end(), common.begin(), common.end());
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Result result = run(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    return read_text(folder_ / folder / "result.csv");
  };
  const std::string light = energy({}, "light"), heavy = energy({"-p", "m=5"}, "heavy");
  EXPECT_NE(light, heavy);
}

TEST_F(CommandTest, SnappedGeometryIsExactAndEveryMoveIsTold) {
  write("noisy.yaml", kNoisy);
  const Result result = run({"convert", "noisy.yaml", "-o", "exact.yaml", "--snap", "--geometric-tolerance", "1e-5"});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.errors, HasSubstr("the seats of 'A' moved by"));
  const ordered_json report = run({"analyze", "exact.yaml", "--json"}).json();
  EXPECT_EQ(report.at("redundant"), 3);
  EXPECT_EQ(report.at("certainty").at("confident"), true);
  EXPECT_EQ(report.at("permanence").at("kind"), "permanent");
}

// ---------------------------------------------------------------------------------------------------------------------
// convert

TEST_F(CommandTest, ConvertedToTheNativeFormatItIsTheSameMechanism) {
  for (const std::string& file : {kAssembly, kFourBar, kArms, (kFormats / "mjcf/every-joint.xml").string()}) {
    const Result result = run({"convert", file, "-o", "native.yaml", "--force"});
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_THAT(result.output, HasSubstr("wrote native.yaml (native)"));
    ordered_json before = run({"analyze", file, "--json"}).json(),
                 after = run({"analyze", "native.yaml", "--json"}).json();
    for (const char* key : {"mobility", "redundant", "bodies", "joints", "rank", "permanence", "rigid_groups"}) {
      EXPECT_EQ(before.contains(key) ? before[key] : ordered_json(), after.contains(key) ? after[key] : ordered_json())
          << file << " " << key;
    }
  }
}

TEST_F(CommandTest, WhatUrdfAndMjcfCanSayComesBack) {
  for (const std::vector<std::string>& to : {std::vector<std::string>{"back.urdf"}, {"back.xml", "--to", "mjcf"}}) {
    std::vector<std::string> arguments = {"convert", kFourBar, "--force", "-o"};
    arguments.insert(arguments.end(), to.begin(), to.end());
    const Result result = run(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    const ordered_json report = run({"analyze", to[0], "--json"}).json();
    EXPECT_EQ(report.at("mobility"), 1) << to[0];
    EXPECT_THAT(result.output, HasSubstr(to[0]));
  }
  EXPECT_TRUE(fs::exists(folder_ / "back.closures.yaml"));
}

TEST_F(CommandTest, WhatTheTargetCannotSayIsListed) {
  const Result result = run({"convert", (kExamples / "scissor-lift/model.yaml").string(), "--to", "urdf"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.output, HasSubstr("<robot"));
  EXPECT_THAT(result.errors, HasSubstr("F607"));
}

TEST_F(CommandTest, ConvertReplacesAFileOnlyWhereItIsTold) {
  write("there.yaml", "mine\n");
  const Result refused = run({"convert", kFourBar, "-o", "there.yaml"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_EQ(read_text(folder_ / "there.yaml"), "mine\n");
  EXPECT_EQ(run({"convert", kFourBar, "-o", "there.yaml", "--force"}).exit_code, 0);
  EXPECT_THAT(read_text(folder_ / "there.yaml"), HasSubstr("ferrers: 1"));
}

TEST_F(CommandTest, NoisyNumbersAreWarnedAboutWhenTheyAreConvertedAsTheyAre) {
  write("noisy.yaml", kNoisy);
  const std::vector<std::string> noisy = {"convert", "noisy.yaml", "--geometric-tolerance", "1e-5", "-o", "as-is.yaml"};
  EXPECT_THAT(run(noisy).errors, HasSubstr("warning[F515]"));
  EXPECT_THAT(run({"convert", kAssembly, "-o", "exact.yaml"}).errors, Not(HasSubstr("warning[F515]")));
}

TEST_F(CommandTest, ClosuresOfAnotherModelDoNotStayBesideAWrittenOne) {
  const std::string closed = (kExamples / "four-bar/model.yaml").string(),
                    open = (kExamples / "arm-path/model.yaml").string();
  EXPECT_EQ(run({"convert", closed, "-o", "m.urdf"}).exit_code, 0);
  fs::remove(folder_ / "m.urdf");
  const Result refused = run({"convert", open, "-o", "m.urdf"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.errors, HasSubstr("m.closures.yaml"));
  EXPECT_EQ(run({"convert", open, "-o", "m.urdf", "--force"}).exit_code, 0);
  EXPECT_FALSE(fs::exists(folder_ / "m.closures.yaml"));
  EXPECT_EQ(run({"analyze", "m.urdf"}).exit_code, 0);
}

TEST_F(CommandTest, AWrittenUrdfStartsWhereTheModelIsDrawn) {
  const Result told = run({"convert", kAssembly, "-o", "a.urdf"});
  EXPECT_THAT(told.errors,
              HasSubstr("those of Revolute, Revolute001, Revolute002, Revolute003 are zero where the model is"));
  const auto start = [&](const std::string& file) {
    EXPECT_EQ(run({"convert", file, "-o", "start.xml", "--to", "mjcf", "--force"}).exit_code, 0);
    return read_text(folder_ / "start.xml");
  };
  const ordered_json before = run({"analyze", kAssembly, "--json"}).json(),
                     after = run({"analyze", "a.urdf", "--json"}).json();
  EXPECT_EQ(after.at("mobility"), before.at("mobility"));
  EXPECT_EQ(after.at("permanence").at("kind"), before.at("permanence").at("kind"));
  EXPECT_THAT(start("a.urdf"), Not(HasSubstr("<key")));  // it closes as it stands
  EXPECT_THAT(run({"convert", (kExamples / "four-bar/model.yaml").string(), "-o", "b.urdf"}).errors,
              Not(HasSubstr("zero")));
  const std::string open = (kFormats / "sdf/four_bar_open.sdf").string();
  const std::string errors = run({"convert", open, "-o", "open.urdf"}).errors, said = "loops are open at the start";
  EXPECT_THAT(errors, HasSubstr(said));
  EXPECT_EQ(errors.find(said), errors.rfind(said));  // once
}

TEST_F(CommandTest, ConvertTellsInJsonWhatItDid) {
  write("parts.urdf", kParts);
  const ordered_json told = run({"convert", "parts.urdf", "-o", "parts.yaml", "--json"}).json();
  EXPECT_EQ(told.at("schema"), "ferrers.convert/1");
  EXPECT_EQ(told.at("ok"), true);
  EXPECT_EQ(told.at("from"), "URDF");
  EXPECT_EQ(told.at("written"), ordered_json({"parts.yaml"}));
  EXPECT_EQ(told.at("renamed").at(0).at("original"), "imu-frame");
  EXPECT_EQ(run({"convert", "parts.urdf", "--json"}).exit_code, 2);
  EXPECT_EQ(run({"convert", "missing.urdf"}).exit_code, 3);
}

TEST_F(CommandTest, ANativeFileKeepsItsPartsWhenItIsConverted) {
  write("parts.urdf", kParts);
  EXPECT_EQ(run({"convert", "parts.urdf", "-o", "parts.yaml"}).exit_code, 0);
  EXPECT_THAT(read_text(folder_ / "parts.yaml"), HasSubstr("merge: true"));
  const ordered_json kept = run({"analyze", "parts.yaml", "--welds", "keep", "--json"}).json();
  EXPECT_EQ(kept.at("bodies"), 5);
  EXPECT_EQ(run({"convert", "parts.yaml", "-o", "again.urdf"}).exit_code, 0);
  EXPECT_THAT(read_text(folder_ / "again.urdf"), HasSubstr("imu_frame"));
}

}  // namespace
}  // namespace ferrers::command_testing
