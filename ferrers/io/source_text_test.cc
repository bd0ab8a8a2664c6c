#include "ferrers/io/source_text.h"

#include <gtest/gtest.h>

namespace ferrers {
namespace {

TEST(SourceTextTest, OffsetsBecomeLinesAndColumns) {
  const SourceText source("ab\ncd\r\n\ne");
  EXPECT_EQ(source.range(0, 1), (SourceRange{1, 1, 1}));
  EXPECT_EQ(source.range(4, 1), (SourceRange{2, 2, 1}));
  EXPECT_EQ(source.range(8, 1), (SourceRange{4, 1, 1}));
  EXPECT_EQ(source.range(99, 5), (SourceRange{4, 2, 0}));
}

TEST(SourceTextTest, RangesEndWithTheirLine) {
  const SourceText source("ab\ncd\r\nef");
  EXPECT_EQ(source.range(1, 100).length, 1);
  EXPECT_EQ(source.range(3, 100).length, 2);
  EXPECT_EQ(source.range(7, 100).length, 2);
}

TEST(SourceTextTest, TheStartOfALineIsFound) {
  const SourceText source("ab\n  cd");
  EXPECT_EQ(source.before_on_line(5), "  ");
  EXPECT_EQ(source.before_on_line(1), "a");
}

TEST(SourceTextTest, EachKindOfWrongCharacterIsReportedOnce) {
  Diagnostics diagnostics;
  EXPECT_FALSE(check_characters(SourceText("\xEF\xBB\xBF"
                                           "a\x01\x02"),
                                diagnostics));
  ASSERT_EQ(diagnostics.items().size(), 2U);
  EXPECT_EQ(diagnostics.items()[0].code, "F105");
  EXPECT_EQ(diagnostics.items()[1].code, "F106");
  EXPECT_EQ(diagnostics.items()[1].at.column, 5);
}

}  // namespace
}  // namespace ferrers
