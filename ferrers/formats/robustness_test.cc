// Readers of other programs' files meet what is broken: cut short, with bytes turned, nested without end, with numbers
// beyond all bounds. Whatever it is, they end in a model or in errors that have a place. (`./run fuzz` goes further.)

#include <gtest/gtest.h>

#include <cctype>
#include <string>
#include <vector>

#include "ferrers/formats/formats.h"
#include "ferrers/testing/asmt_text.h"

namespace ferrers {
namespace {

struct Sample {
  ModelFormat format;
  std::string name;
  std::string text;
};

std::string assembly() {
  witness::AsmtText file;
  file.marker("base");
  file.part("crank", {Eigen::Matrix3d::Identity(), {100, 20, 0}}, 2);
  file.part_marker("crank", "pin", {Eigen::Matrix3d::Identity(), {10, 0, 0}});
  file.part_marker("crank", "end", {Eigen::Matrix3d::Identity(), {60, 0, 0}});
  file.part("rod", {Eigen::Matrix3d::Identity(), {160, 20, 0}});
  file.part_marker("rod", "start", {Eigen::Matrix3d::Identity(), {0, 0, 0}});
  file.joint("RevoluteJoint", "turn", "base", "crank/pin");
  file.joint("SphericalJoint", "ball", "crank/end", "rod/start");
  return file.text();
}

const std::vector<Sample>& samples() {
  static const std::vector<Sample> all = {{ModelFormat::kUrdf, "URDF", R"(<?xml version="1.0"?>
<robot name="r">
  <link name="base"/>
  <link name="arm">
    <inertial> <origin xyz="0 0 0.5" rpy="0.1 0 0"/> <mass value="1.5"/>
      <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.01"/> </inertial>
    <visual> <geometry> <box size="0.1 0.1 1"/> </geometry> </visual>
  </link>
  <link name="tip"> <inertial> <mass value="0.2"/> <inertia ixx="1e-3" ixy="0" ixz="0" iyy="1e-3" iyz="0" izz="1e-3"/> </inertial> </link>
  <joint name="shoulder" type="revolute">
    <parent link="base"/> <child link="arm"/> <origin xyz="0 0 1" rpy="0 0.3 0"/> <axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" effort="10" velocity="2"/> <dynamics damping="0.1" friction="0"/>
  </joint>
  <joint name="slide" type="prismatic">
    <parent link="arm"/> <child link="tip"/> <origin xyz="0 0 1"/> <axis xyz="0 0 1"/>
    <limit lower="0" upper="0.1" effort="10" velocity="2"/> <mimic joint="shoulder" multiplier="0.1" offset="0"/>
  </joint>
</robot>
)"},
                                          {ModelFormat::kMjcf, "MJCF", R"(<mujoco model="m">
  <compiler angle="degree" eulerseq="xyz"/>
  <option gravity="0 0 -9.81"/>
  <default> <joint damping="0.1"/> <default class="big"> <geom size="0.2"/> </default> </default>
  <worldbody>
    <body name="a" pos="0 0 1" euler="0 30 0">
      <joint name="ja" type="hinge" axis="0 1 0" range="-90 90" armature="0.01"/>
      <geom type="capsule" size="0.05 0.5" mass="1"/>
      <body name="b" pos="0 0 1">
        <joint name="jb" type="slide" axis="0 0 1"/>
        <inertial pos="0 0 0" mass="0.5" diaginertia="0.01 0.01 0.01"/>
      </body>
    </body>
    <body name="c" pos="1 0 1"> <freejoint/> <geom class="big" type="sphere" mass="2"/> </body>
  </worldbody>
  <equality>
    <connect body1="b" body2="c" anchor="0 0 0.5"/>
    <joint joint1="ja" joint2="jb" polycoef="0 1 0 0 0"/>
  </equality>
  <actuator> <motor joint="ja" gear="10"/> </actuator>
</mujoco>
)"},
                                          {ModelFormat::kSdf, "SDF", R"(<?xml version="1.0"?>
<sdf version="1.9">
  <world name="w">
    <gravity>0 0 -9.8</gravity>
    <frame name="f"> <pose degrees="true">1 0 0 0 0 45</pose> </frame>
    <model name="m" placement_frame="g">
      <pose relative_to="f" rotation_format="quat_xyzw">0 0 1 0 0 0 1</pose>
      <frame name="g" attached_to="a"> <pose>0.1 0 0 0 0 0</pose> </frame>
      <link name="a">
        <inertial> <pose>0 0 0.1 0 0 0</pose> <mass>2</mass>
          <inertia> <ixx>1</ixx> <iyy>1</iyy> <izz>1</izz> <ixy>0</ixy> <ixz>0</ixz> <iyz>0</iyz> </inertia> </inertial>
      </link>
      <model name="n"> <link name="b"/> <pose relative_to="g"/> </model>
      <joint name="j" type="revolute"> <parent>world</parent> <child>a</child>
        <axis> <xyz expressed_in="__model__">0 0 1</xyz> <limit> <lower>-1</lower> <upper>1</upper> </limit>
          <dynamics> <damping>0.1</damping> <spring_stiffness>1</spring_stiffness> </dynamics> </axis> </joint>
      <joint name="k" type="screw"> <parent>g</parent> <child>n::b</child> <thread_pitch>-3</thread_pitch>
        <axis> <xyz>1 0 0</xyz> <mimic joint="j"> <multiplier>2</multiplier> <offset>0.1</offset> </mimic> </axis> </joint>
    </model>
  </world>
</sdf>
)"},
                                          {ModelFormat::kAsmt, "ASMT", assembly()}};
  return all;
}

/// Reads and judges. Further files are the text itself, so that what includes anything includes itself.
void expect_an_answer(const Sample& sample, const std::string& text, const std::string& what) {
  const FileLoader load = [&](const std::string&) -> std::optional<std::string> { return text; };
  const ModelFile file = read_any_model_text(text, "sample", sample.format, load);
  const Diagnostics& told = file.read.diagnostics;
  ASSERT_NE(file.read.model.has_value(), told.has_errors()) << sample.name << ", " << what;
  for (const Diagnostic& one : told.items()) {
    ASSERT_FALSE(format_diagnostic(one, "sample", file.read.source).empty());
  }
}

TEST(RobustnessTest, TheSamplesThemselvesAreModels) {
  const FileLoader load = [](const std::string&) { return std::nullopt; };
  for (const Sample& sample : samples()) {
    const ModelFile file = read_any_model_text(sample.text, "sample", sample.format, load);
    std::string told;
    for (const Diagnostic& one : file.read.diagnostics.items()) {
      told += format_diagnostic(one, "sample", file.read.source) + "\n";
    }
    EXPECT_TRUE(file.read.model.has_value()) << sample.name << "\n" << told;
  }
}

TEST(RobustnessTest, FilesThatIncludeThemselvesEndInErrors) {
  for (Sample sample : samples()) {
    const std::string include = sample.format == ModelFormat::kMjcf
                                    ? "<include file='x.xml'/>"
                                    : "<model name='i'><include><uri>x.sdf</uri></include></model>";
    const std::size_t end = sample.text.rfind("</");
    if (end == std::string::npos) continue;
    expect_an_answer(sample, sample.text.insert(end, include), "includes itself");
  }
}

TEST(RobustnessTest, FilesCutShortAnywhereEndInAModelOrInErrors) {
  for (const Sample& sample : samples()) {
    for (std::size_t length = 0; length <= sample.text.size(); length += 3) {
      expect_an_answer(sample, sample.text.substr(0, length), "cut after " + std::to_string(length));
    }
  }
}

TEST(RobustnessTest, FilesWithOneByteTurnedEndInAModelOrInErrors) {
  for (const Sample& sample : samples()) {
    for (std::size_t at = 0; at < sample.text.size(); ++at) {
      std::string text = sample.text;
      constexpr std::string_view others = "0-<\"/ x\n";
      text[at] = others[at % others.size()];
      expect_an_answer(sample, text, "byte " + std::to_string(at));
    }
  }
}

TEST(RobustnessTest, FilesWithAPieceTwiceOrAPieceLostEndInAModelOrInErrors) {
  for (const Sample& sample : samples()) {
    for (std::size_t at = 0; at + 60 < sample.text.size(); at += 7) {
      std::string doubled = sample.text, without = sample.text;
      doubled.insert(at, sample.text.substr(at, 60));
      without.erase(at, 23);
      expect_an_answer(sample, doubled, "doubled at " + std::to_string(at));
      expect_an_answer(sample, without, "lost at " + std::to_string(at));
    }
  }
}

/// Where the numbers of a text begin.
std::vector<std::size_t> starts_of_numbers(const std::string& text) {
  const auto is_word = [&](std::size_t at) {
    return std::isalnum(static_cast<unsigned char>(text[at])) != 0 || text[at] == '.';
  };
  std::vector<std::size_t> starts;
  for (std::size_t at = 1; at < text.size(); ++at) {
    if (std::isdigit(static_cast<unsigned char>(text[at])) != 0 && !is_word(at - 1)) starts.push_back(at);
  }
  return starts;
}

TEST(RobustnessTest, NumbersBeyondAllBoundsEndInAModelOrInErrors) {
  const std::vector<std::string> numbers = {
      "1e308", "-1e308", "1e-320", "1e999", "nan", "inf", "0", "1e16", "1" + std::string(400, '0')};
  for (const Sample& sample : samples()) {
    for (const std::string& number : numbers) {
      for (const std::size_t at : starts_of_numbers(sample.text)) {
        std::string text = sample.text;
        text.replace(at, sample.text.find_first_not_of("0123456789.e-", at) - at, number);
        expect_an_answer(sample, text, "number " + number + " at " + std::to_string(at));
      }
    }
  }
}

TEST(RobustnessTest, ElementsNestedWithoutEndAreRefused) {
  for (const Sample& sample : samples()) {
    for (const std::string element : {"model name='m'", "body name='b'", "link name='l'", "default", "world", "x"}) {
      std::string text = sample.text.substr(0, sample.text.find('\n') + 1);
      for (int i = 0; i < 20000; ++i) text += "<" + element + ">";
      expect_an_answer(sample, text, element);
      const std::string word = element.substr(0, element.find(' '));
      for (int i = 0; i < 20000; ++i) text += "</" + word + ">";
      expect_an_answer(sample, text, element);
    }
  }
}

TEST(RobustnessTest, TextOfAnotherKindIsRefused) {
  for (const Sample& sample : samples()) {
    for (const Sample& other : samples()) {
      if (other.format != sample.format) expect_an_answer(sample, other.text, "the sample of " + other.name);
    }
    for (const std::string text :
         {"", " ", "\n\n", "<", "<a/>", "<sdf/>", "<robot/>", "<mujoco/>", "Assembly", "{}", "\t\t\t"}) {
      expect_an_answer(sample, text, text);
    }
  }
}

}  // namespace
}  // namespace ferrers
