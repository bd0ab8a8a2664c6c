#include "ferrers/formats/name_map.h"

#include <gtest/gtest.h>

namespace ferrers {
namespace {

TEST(NameMapTest, WhatTheFormatAllowsStaysAndTheRestIsChangedAndListed) {
  NameMap names;
  EXPECT_EQ(names.add("bodies", "body", "arm_1"), "arm_1");
  EXPECT_TRUE(names.renamed().empty());
  EXPECT_EQ(names.add("bodies", "body", "arm-2"), "arm_2");
  EXPECT_EQ(names.add("bodies", "body", "3rd"), "_3rd");
  EXPECT_EQ(names.add("bodies", "body", ""), "body");
  EXPECT_EQ(names.add("bodies", "body", "sin"), "sin_");
  EXPECT_EQ(names.add("bodies", "body", "ground"), "ground_");
  EXPECT_EQ(names.add("bodies", "body", "null"), "null_");
  ASSERT_EQ(names.renamed().size(), 6u);
  EXPECT_EQ(names.renamed()[0].original, "arm-2");
  EXPECT_EQ(names.renamed()[0].name, "arm_2");
}

TEST(NameMapTest, NamesAreUniqueInTheirSpaceOnly) {
  NameMap names;
  EXPECT_EQ(names.add("bodies", "body", "a b"), "a_b");
  EXPECT_EQ(names.add("bodies", "body", "a-b"), "a_b_2");
  EXPECT_EQ(names.add("bodies", "body", "a.b"), "a_b_3");
  EXPECT_EQ(names.add("joints", "joint", "a.b"), "a_b");
}

TEST(NameMapTest, NamesThatAreKeptGoToNobodyElse) {
  NameMap names;
  for (const char* original : {"a b", "a_b", "a-b", "a_b_2"}) names.keep("bodies", original);
  EXPECT_EQ(names.add("bodies", "body", "a b"), "a_b_3");
  EXPECT_EQ(names.add("bodies", "body", "a_b"), "a_b");
  EXPECT_EQ(names.add("bodies", "body", "a-b"), "a_b_4");
  EXPECT_EQ(names.add("bodies", "body", "a_b_2"), "a_b_2");
  EXPECT_EQ(names.add("bodies", "body", "a_b"), "a_b_5");  // twice in the file
}

TEST(NameMapTest, ThousandsOfEqualNamesTakeNoTime) {
  NameMap names;
  for (int i = 0; i < 20000; ++i) names.add("bodies", "body", "bolt-1");
  EXPECT_EQ(names.add("bodies", "body", "bolt-1"), "bolt_1_20001");
}

}  // namespace
}  // namespace ferrers
