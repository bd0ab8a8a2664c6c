#include <algorithm>

#include "ferrers/formats/mjcf_test_model.h"

namespace ferrers {
namespace {

using mjcf_testing::messages;
using mjcf_testing::places;
using mjcf_testing::read_text;
using testing::Contains;

struct Broken {
  const char* what;
  const char* text;
  const char* place;  ///< Code, line and column of the first error.
};

const Broken kBroken[] = {
    {"nothing", "", "F103:0:0"},
    {"no XML", "<mujoco><worldbody></mujoco>", "F107:1:22"},
    {"another root", "<robot/>", "F605:1:2"},
    {"an attribute twice", "<mujoco model='a' model='b'/>", "F109:1:19"},
    {"words for numbers", "<mujoco><worldbody>\n<body pos='a b c'/></worldbody></mujoco>", "F206:2:12"},
    {"infinite numbers", "<mujoco><worldbody>\n<body pos='1 inf 0'/></worldbody></mujoco>", "F206:2:12"},
    {"too few numbers", "<mujoco><worldbody>\n<body pos='1 2'/></worldbody></mujoco>", "F208:2:12"},
    {"an unknown type", "<mujoco><worldbody><body>\n<joint type='screw'/></body></worldbody></mujoco>", "F209:2:14"},
    {"an unknown class", "<mujoco><worldbody><body>\n<joint class='x'/></body></worldbody></mujoco>", "F604:2:15"},
    {"an unknown childclass", "<mujoco><worldbody>\n<body childclass='x'/></worldbody></mujoco>", "F604:2:19"},
    {"a class twice", "<mujoco><default>\n<default class='x'/>\n<default class='x'/></default></mujoco>", "F302:3:17"},
    {"two bodies of a name", "<mujoco><worldbody><body name='a'/>\n<body name='a'/></worldbody></mujoco>", "F302:2:13"},
    {"an axis without a length", "<mujoco><worldbody><body>\n<joint axis='0 0 0'/></body></worldbody></mujoco>",
     "F318:2:14"},
    {"two orientations", "<mujoco><worldbody>\n<body quat='1 0 0 0' euler='1 2 3'/></worldbody></mujoco>", "F211:2:29"},
    {"a quaternion of no length", "<mujoco><worldbody>\n<body quat='0 0 0 0'/></worldbody></mujoco>", "F318:2:13"},
    {"parallel axes", "<mujoco><worldbody>\n<body xyaxes='1 0 0 2 0 0'/></worldbody></mujoco>", "F318:2:15"},
    {"limits in the wrong order", "<mujoco><worldbody><body>\n<joint range='2 1'/></body></worldbody></mujoco>",
     "F326:2:15"},
    {"a geom without a size", "<mujoco><worldbody><body>\n<geom type='box'/></body></worldbody></mujoco>", "F202:2:2"},
    {"a size that is negative", "<mujoco><worldbody><body>\n<geom size='-1'/></body></worldbody></mujoco>",
     "F311:2:13"},
    {"a joint of the world", "<mujoco><worldbody>\n<joint/></worldbody></mujoco>", "F605:2:2"},
    {"a free joint inside", "<mujoco><worldbody><body><body>\n<freejoint/></body></body></worldbody></mujoco>",
     "F605:2:2"},
    {"a free joint beside another", "<mujoco><worldbody><body><joint/>\n<freejoint/></body></worldbody></mujoco>",
     "F605:2:2"},
    {"an inertia without a mass",
     "<mujoco><worldbody><body>\n<inertial pos='0 0 0' diaginertia='1 1 1'/></body>"
     "</worldbody></mujoco>",
     "F202:2:2"},
    {"an inertia that nothing has",
     "<mujoco><worldbody>\n<body><joint/><inertial pos='0 0 0' mass='1' diaginertia='1 1 9'/></body></worldbody>"
     "</mujoco>",
     "F314:2:2"},
    {"an unknown body", "<mujoco><equality>\n<connect body1='x' anchor='0 0 0'/></equality></mujoco>", "F604:2:17"},
    {"an unknown joint", "<mujoco><equality>\n<joint joint1='x'/></equality></mujoco>", "F604:2:16"},
    {"a flex in constraints", "<mujoco><equality>\n<flex flex='x'/></equality></mujoco>", "F602:2:2"},
    {"a composite", "<mujoco><worldbody><body>\n<composite/></body></worldbody></mujoco>", "F602:2:2"},
    {"an attached model", "<mujoco><worldbody>\n<attach model='x' body='y' prefix='z'/></worldbody></mujoco>",
     "F602:2:2"},

    {"a spring by its time on a mass that is not known",
     "<mujoco><worldbody><body>\n<joint springdamper='1 1'/><geom type='mesh' mesh='m'/></body></worldbody></mujoco>",
     "F602:2:2"},
    {"world coordinates", "<mujoco>\n<compiler coordinate='global'/></mujoco>", "F602:2:23"},
    {"copies without a count", "<mujoco><worldbody>\n<replicate count='0'/></worldbody></mujoco>", "F605:2:19"},
    {"a missing file", "<mujoco>\n<include file='x.xml'/></mujoco>", "F606:2:16"},
    {"a key of another model", "<mujoco><keyframe>\n<key qpos='1'/></keyframe></mujoco>", "F208:2:12"},
};

TEST(MjcfBrokenTest, EveryMistakeIsToldWithItsPlace) {
  for (const Broken& one : kBroken) {
    SCOPED_TRACE(one.what);
    const ModelFile file =
        read_any_model_text(one.text, "model.xml", ModelFormat::kMjcf, [](const std::string&) { return std::nullopt; });
    EXPECT_TRUE(file.read.diagnostics.has_errors());
    EXPECT_THAT(places(file.read.diagnostics), Contains(one.place)) << messages(file.read.diagnostics);
  }
}

TEST(MjcfBrokenTest, FilesThatIncludeEachOtherEnd) {
  const auto circle = read_text(
      "<mujoco><include file='a.xml'/></mujoco>", {},
      {{"a.xml", "<mujoco><include file='b.xml'/></mujoco>"}, {"b.xml", "<mujoco><include file='a.xml'/></mujoco>"}});
  EXPECT_THAT(messages(circle.diagnostics), testing::HasSubstr("'a.xml' is included twice"));
}

TEST(MjcfBrokenTest, CopiesOfCopiesAreBounded) {
  std::string open, close;
  for (int i = 0; i < 20; ++i) open += "<replicate count='9999'>", close += "</replicate>";
  const auto read =
      read_text("<mujoco><worldbody>" + open + "<body><geom size='1'/></body>" + close + "</worldbody></mujoco>");
  EXPECT_THAT(places(read.diagnostics), Contains(testing::StartsWith("F605")));
}

TEST(MjcfBrokenTest, WhatIsNotReadIsTold) {
  const auto read = read_text(
      "<mujoco><contact><exclude body1='a' body2='b'/></contact><sensor><gyro/></sensor>"
      "<worldbody><body strange='1'><joint frictionloss='2'/><geom size='1'/></body></worldbody></mujoco>");
  EXPECT_FALSE(read.diagnostics.has_errors());
  const std::string all = messages(read.diagnostics);
  for (const char* word : {"<contact>", "<sensor>", "'strange'", "'frictionloss'"}) {
    EXPECT_THAT(all, testing::HasSubstr(word));
  }
}

}  // namespace
}  // namespace ferrers
