#include "ferrers/formats/asmt_document.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "ferrers/testing/build_checks.h"

namespace ferrers {
namespace {

using testing::HasSubstr;

constexpr std::string_view kSmall =
    "OndselSolver\r\nAssembly\n\tName\n\t\tcrank one "
    "\n\tEmpty\n\t\t\n\tPosition3D\n\t\t1\t2\t3\t\n\n\tMore\n\t\ta\n\t\tb\n";

TEST(AsmtDocumentTest, DepthIsTheNumberOfTabs) {
  Diagnostics diagnostics;
  const auto document = AsmtDocument::parse(kSmall, diagnostics);
  ASSERT_TRUE(document) << witness::messages(diagnostics);
  const std::vector<AsmtRecord> top = document->top();
  ASSERT_EQ(top.size(), 2U);
  EXPECT_EQ(top[0].name(), "OndselSolver");
  const AsmtRecord name = top[1].child("Name");
  EXPECT_EQ(name.value(diagnostics), "crank one");
  EXPECT_EQ(name.value_at(), (SourceRange{4, 3, 9}));
  EXPECT_EQ(name.at(), (SourceRange{3, 2, 4}));
  EXPECT_EQ(top[1].child("Position3D").value(diagnostics), "1\t2\t3");
  EXPECT_FALSE(top[1].child("Velocity3D"));
  EXPECT_TRUE(diagnostics.empty());
}

TEST(AsmtDocumentTest, AnEmptyLineOneLevelDeeperIsAnEmptyValue) {
  Diagnostics diagnostics;
  const auto document = AsmtDocument::parse(kSmall, diagnostics);
  const AsmtRecord empty = document->top()[1].child("Empty");
  EXPECT_TRUE(empty.empty());
  EXPECT_EQ(empty.value(diagnostics), "");
  EXPECT_EQ(empty.value_at().line, 5);
}

TEST(AsmtDocumentTest, ASecondValueIsAnError) {
  Diagnostics diagnostics;
  const auto document = AsmtDocument::parse(kSmall, diagnostics);
  EXPECT_EQ(document->top()[1].child("More").value(diagnostics), "a");
  EXPECT_EQ(witness::codes(diagnostics), witness::Codes{"F605"});
  EXPECT_EQ(diagnostics.items()[0].at.line, 12);
}

TEST(AsmtDocumentTest, WhatNobodyAskedForIsToldOnceByKind) {
  Diagnostics diagnostics;
  const auto document =
      AsmtDocument::parse("A\n\tPart\n\t\tExtra\n\t\t\tdeep\n\tPart\n\t\tExtra\n\t\tName\n\t\t\tx\n", diagnostics);
  document->top()[0].mark_read();
  for (const AsmtRecord& part : document->top()[0].children()) {
    part.mark_read();
    if (const AsmtRecord name = part.child("Name")) (void)name.values();
  }
  document->report_unread(diagnostics);
  ASSERT_EQ(diagnostics.items().size(), 1U);
  EXPECT_EQ(diagnostics.items()[0].code, "F601");
  EXPECT_THAT(diagnostics.items()[0].message, HasSubstr("'Extra' in 'Part' is not read, nor are 1 more like it"));
  EXPECT_EQ(diagnostics.items()[0].at.line, 3);
}

struct Broken {
  std::string text, code;
  int line, column;
};

TEST(AsmtDocumentTest, BrokenFilesAreRefusedAtTheirPlace) {
  const std::vector<Broken> all = {
      {"", "F103", 0, 0},
      {" \n\t\n", "F103", 0, 0},
      {"A\n\t\tb\n", "F605", 2, 3},
      {"A\n  b\n", "F605", 2, 1},
      {"A\n\t b\n", "F605", 2, 2},
      {"\tA\n", "F605", 1, 2},
      {"A\n\tb\xff\n", "F104", 2, 3},
      {"A\n\tb\x01\n", "F106", 2, 3},
  };
  for (const Broken& one : all) {
    Diagnostics diagnostics;
    EXPECT_FALSE(AsmtDocument::parse(one.text, diagnostics)) << one.text;
    ASSERT_EQ(witness::codes(diagnostics), witness::Codes{one.code}) << one.text;
    EXPECT_EQ(diagnostics.items()[0].at.line, one.line) << one.text;
    EXPECT_EQ(diagnostics.items()[0].at.column, one.column) << one.text;
  }
}

TEST(AsmtDocumentTest, NestingHasABound) {
  std::string deep;
  for (int i = 0; i < 70; ++i) deep += std::string(static_cast<std::size_t>(i), '\t') + "x\n";
  Diagnostics diagnostics;
  EXPECT_FALSE(AsmtDocument::parse(deep, diagnostics));
  EXPECT_EQ(witness::codes(diagnostics), witness::Codes{"F108"});
}

}  // namespace
}  // namespace ferrers
