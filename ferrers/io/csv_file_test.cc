#include "ferrers/io/csv_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace ferrers {
namespace {

using testing::ElementsAre;

TEST(CsvFileTest, CellsReadBackAreTheSame) {
  const std::vector<std::string> cells = {"plain", "", "a, b", "say \"so\"", "\"", ",", "\"\"", " spaces "};
  fmt::memory_buffer line;
  for (const std::string& cell : cells) {
    if (line.size() > 0) line.push_back(',');
    append_cell(line, cell);
  }
  EXPECT_EQ(read_cells(fmt::to_string(line)), cells);
}

TEST(CsvFileTest, ALineWithoutCellsIsOneEmptyCell) {
  EXPECT_THAT(read_cells(""), ElementsAre(""));
  EXPECT_THAT(read_cells(","), ElementsAre("", ""));
  EXPECT_THAT(read_cells("a,\"b"), ElementsAre("a", "b"));
}

TEST(CsvFileTest, NumbersAreWrittenWhereTheyAreFinite) {
  fmt::memory_buffer line;
  append_number(line, 0.1);
  append_text(line, ",");
  append_number(line, std::numeric_limits<double>::quiet_NaN());
  append_text(line, ",");
  append_number(line, std::numeric_limits<double>::infinity());
  EXPECT_EQ(fmt::to_string(line), "0.10000000000000001,,");
}

}  // namespace
}  // namespace ferrers
