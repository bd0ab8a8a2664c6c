#include "ferrers/io/parameter_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>

#include "ferrers/io/model_reader.h"
#include "ferrers/testing/random_source.h"

namespace ferrers {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Model a_model() {
  ModelReadResult read = read_model_text(R"(ferrers: 1
name: slide
parameters:
  mass: 2 kg
  length: {value: 1 m, max: 3 m}
  factor: 1
bodies: {b: {mass: = mass, com: [= length*factor, 0, 0]}}
joints: {g: {type: prismatic, bodies: [ground, b], at: [0, 0, 0], axis: x}}
)",
                                         "slide.yaml");
  return std::move(*read.model);
}

ParameterTableResult read(const std::string& text) { return read_parameter_table_text(text, "t.csv", a_model()); }

/// "code line:column message" of every diagnostic.
std::vector<std::string> told(const ParameterTableResult& result) {
  std::vector<std::string> all;
  for (const Diagnostic& one : result.diagnostics.items()) {
    all.push_back(one.code + " " + std::to_string(one.at.line) + ":" + std::to_string(one.at.column) + " " +
                  one.message + (one.hint.empty() ? "" : "; " + one.hint));
  }
  return all;
}

TEST(ParameterTableTest, EveryLineBelowTheNamesIsASetOfValues) {
  const ParameterTableResult result = read("mass,length\n1,0.5\n2.5,1e-3\n");
  ASSERT_TRUE(result.table) << testing::PrintToString(told(result));
  EXPECT_THAT(result.table->names, ElementsAre("mass", "length"));
  ASSERT_EQ(result.table->rows(), 2u);
  EXPECT_THAT(result.table->row(0), ElementsAre(1, 0.5));
  EXPECT_THAT(result.table->row(1), ElementsAre(2.5, 1e-3));
}

TEST(ParameterTableTest, NumbersMayCarryUnitsOfTheirParameter) {
  const ParameterTableResult result = read("length,mass\n120 mm,500 g\n\"2 m\",1\n");
  ASSERT_TRUE(result.table) << testing::PrintToString(told(result));
  EXPECT_DOUBLE_EQ(result.table->row(0)[0], 0.12);
  EXPECT_DOUBLE_EQ(result.table->row(0)[1], 0.5);
  EXPECT_THAT(result.table->row(1), ElementsAre(2, 1));
  EXPECT_THAT(told(read("length\n3 kg\n")), ElementsAre("F204 2:1 'length' wants m, got kg"));
}

TEST(ParameterTableTest, SeparatorsCommentsAndLineEndsMayBeThoseOfAnyProgram) {
  for (const char* text : {"mass;length\r\n1;2\r\n", "mass\tlength\n1\t2", "# ours\n\nmass , length\n#\n 1 , 2\n\n\n",
                           "\"mass\",\"length\"\n\"1\",\"2\"\n"}) {
    const ParameterTableResult result = read(text);
    ASSERT_TRUE(result.table) << text << testing::PrintToString(told(result));
    EXPECT_THAT(result.table->names, ElementsAre("mass", "length")) << text;
    EXPECT_THAT(result.table->values, ElementsAre(1, 2)) << text;
  }
}

TEST(ParameterTableTest, UnknownParametersAreToldWithTheOneMeant) {
  EXPECT_THAT(told(read("mas,length\n1,2\n")),
              ElementsAre("F216 1:1 the model has no parameter 'mas'; did you mean 'mass'?"));
  EXPECT_THAT(told(read("1,2\n3,4\n")),
              ElementsAre("F216 1:1 the model has no parameter '1'; the first line names the parameters",
                          "F216 1:3 the model has no parameter '2'; the first line names the parameters"));
  EXPECT_THAT(told(read("mass,,length,mass\n1,2,3,4\n")),
              ElementsAre("F212 1:6 column 2 has no name; it is a parameter of the model",
                          "F216 1:14 the parameter 'mass' has a column already"));
}

TEST(ParameterTableTest, NothingIsRepairedAndEveryErrorIsToldWithItsPlace) {
  const ParameterTableResult result = read(
      "mass,length\n"
      "1,\n"
      "1,2,3\n"
      "1\n"
      "\n"
      "nan,2\n"
      "1,inf\n"
      "1,1.5x\n"
      "a half,2\n"
      "1e999,2\n"
      "\"1,2\n"
      "1,2\n");
  EXPECT_FALSE(result.table);
  EXPECT_THAT(told(result), ElementsAre("F212 2:3 'length' has no value here; every row gives every value",
                                        "F116 3:1 this row has 3 cells, but the table 2 columns",
                                        "F116 4:1 this row has 1 cell, but the table 2 columns",
                                        "F116 5:1 this line is empty; a comment starts with '#'",
                                        "F206 6:1 'mass' wants a finite number, got 'nan'",
                                        "F206 7:3 'length' wants a finite number, got 'inf'",
                                        HasSubstr("F205 8:3 'x' is no unit in 'length'"),
                                        HasSubstr("F203 9:1 'mass' wants a number, got the text 'a half'"),
                                        HasSubstr("F207 10:1 '1e999' is beyond"),
                                        HasSubstr("F116 11:1 this quote begins a cell that no quote ends")));
}

TEST(ParameterTableTest, ADecimalCommaIsNoSeparatorThatIsGuessed) {
  EXPECT_THAT(told(read("mass;length\n1,5;2\n")),
              ElementsAre("F206 2:1 '1,5' is no decimal number; the decimal sign is a point: 1.5"));
}

TEST(ParameterTableTest, TextThatIsNoTableIsRefused) {
  EXPECT_THAT(told(read("")), ElementsAre(HasSubstr("F103 0:0 this table is empty")));
  EXPECT_THAT(told(read("# nothing\n\n")), ElementsAre(HasSubstr("F103 0:0 this table is empty")));
  EXPECT_THAT(told(read("mass\n")), ElementsAre(HasSubstr("F103 0:0 this table has no rows")));
  EXPECT_THAT(told(read("\xEF\xBB\xBFmass\n1\n")), ElementsAre(HasSubstr("F105 1:1")));
  EXPECT_THAT(told(read(std::string("mass\n1\0\n", 8))), ElementsAre(HasSubstr("F106 2:2")));
  EXPECT_THAT(told(read("m\xFFss\n1\n")), ElementsAre(HasSubstr("F104 1:2")));
}

TEST(ParameterTableTest, AFewHundredErrorsAreEnough) {
  std::string rows = "mass\n";
  for (int i = 0; i < 100000; ++i) rows += "x\n";
  const ParameterTableResult long_one = read(rows);
  EXPECT_EQ(long_one.diagnostics.items().size(), kMostTableErrors + 1);
  EXPECT_EQ(long_one.diagnostics.items().back().code, "F218");
  EXPECT_THAT(told(read(std::string(1000000, ',') + "\n1\n")), ElementsAre(HasSubstr("F102 1:1")));
  EXPECT_LE(read("a" + std::string(1000000, 'a') + "\n1\n").diagnostics.items().front().message.size(), 200u);
}

TEST(ParameterTableTest, FilesThatCannotBeReadAreToldSo) {
  namespace fs = std::filesystem;
  const Model model = a_model();
  EXPECT_THAT(told(read_parameter_table("no/such.csv", model)), ElementsAre("F101 0:0 this file does not exist"));
  EXPECT_THAT(told(read_parameter_table(fs::temp_directory_path(), model)), ElementsAre("F101 0:0 this is no file"));
  const fs::path large = fs::temp_directory_path() / ("ferrers-table-" + std::to_string(getpid()));
  std::ofstream(large) << "mass\n";
  fs::resize_file(large, 65u << 20U);  // sparse
  EXPECT_THAT(told(read_parameter_table(large, model)), ElementsAre("F102 0:0 this table has more than 64 MiB"));
  fs::resize_file(large, 5);
  std::ofstream(large, std::ios::app) << "3\n";
  const ParameterTableResult good = read_parameter_table(large, model);
  ASSERT_TRUE(good.table);
  EXPECT_THAT(good.table->values, ElementsAre(3));
  EXPECT_EQ(good.diagnostics.file(), large.string());
  fs::remove(large);
}

TEST(ParameterTableTest, AnyTextIsATableOrHasErrors) {
  const Model model = a_model();
  const std::vector<std::string> pieces = {"1",  "2.5", "3 kg", "1e-3", ",",    ",",   "\n",     "\n", "\r\n", " ",
                                           "\"", ";",   "\t",   "#",    "mass", "nan", "length", "-",  "=",    "."};
  witness::RandomSource random(7);
  int good = 0;
  for (int i = 0; i < 3000; ++i) {
    std::string text = random.chance(0.3) ? "" : random.chance(0.5) ? "mass\n1" : "mass,length\n1,2";
    for (int length = random.below(8); length > 0; --length) {
      text += pieces[static_cast<std::size_t>(random.below(static_cast<int>(pieces.size())))];
    }
    const ParameterTableResult result = read_parameter_table_text(text, "t.csv", model);
    ASSERT_EQ(result.table.has_value(), !result.diagnostics.has_errors()) << text;
    if (!result.table) continue;
    ++good;
    ASSERT_GT(result.table->rows(), 0u) << text;
    ASSERT_EQ(result.table->values.size(), result.table->rows() * result.table->names.size()) << text;
    for (const double value : result.table->values) ASSERT_TRUE(std::isfinite(value)) << text;
  }
  EXPECT_GT(good, 5);
}

// ---- grids

ParameterTableResult grid(const std::vector<std::string>& ranges) { return make_parameter_grid(ranges, a_model()); }

TEST(ParameterGridTest, AllCombinationsComeWithTheLastOneChangingFirst) {
  const ParameterTableResult result = grid({"mass=1:2:2", "length=100 mm:300 mm:3"});
  ASSERT_TRUE(result.table) << testing::PrintToString(told(result));
  EXPECT_THAT(result.table->names, ElementsAre("mass", "length"));
  ASSERT_EQ(result.table->rows(), 6u);
  EXPECT_THAT(result.table->row(0), ElementsAre(1, 0.1));
  EXPECT_THAT(result.table->row(1)[1], testing::DoubleEq(0.2));
  EXPECT_THAT(result.table->row(2)[1], testing::DoubleEq(0.3));
  EXPECT_THAT(result.table->row(3), ElementsAre(2, 0.1));
}

TEST(ParameterGridTest, TheEndsAreHitExactly) {
  const ParameterTableResult result = grid({"mass=0.1:0.7:7"});
  ASSERT_TRUE(result.table);
  EXPECT_EQ(result.table->values.front(), 0.1);
  EXPECT_EQ(result.table->values.back(), 0.7);
  EXPECT_EQ(grid({"length=50 mm:400 mm:8"}).table->values[5], 0.3);
  EXPECT_EQ(grid({"mass=0:1:11"}).table->values[3], 0.3);
  EXPECT_EQ(grid({"mass=1e308:-1e308:3"}).table->values[1], 0);
  EXPECT_THAT(grid({"mass=3:3:1"}).table->values, ElementsAre(3));
  EXPECT_THAT(grid({"mass=2:1:3"}).table->values, ElementsAre(2, 1.5, 1));
}

TEST(ParameterGridTest, WhatIsNoRangeIsToldAllAtOnce) {
  EXPECT_THAT(
      told(grid({"mass", "mass=1:2", "=1:2:3", "mas=1:2:3", "mass=1:2:0", "mass=1:2:1", "mass=1:2:2.5", "mass=a:2:3",
                 "length=1 kg:2:3", "factor=1:2:2", "factor=1:2:2"})),
      ElementsAre(HasSubstr("'mass' is not name=from:to:count"), HasSubstr("'mass=1:2' is not name=from:to:count"),
                  HasSubstr("'=1:2:3' is not name=from:to:count"),
                  "F216 0:0 the model has no parameter 'mas'; did you mean 'mass'?",
                  HasSubstr("'0' is not how many values 'mass' takes"),
                  HasSubstr("one value of 'mass' cannot be both ends of 'mass=1:2:1'"),
                  HasSubstr("'2.5' is not how many values 'mass' takes"), HasSubstr("'mass' wants a number"),
                  HasSubstr("F204 0:0 'length' wants m, got kg"), "F216 0:0 the parameter 'factor' is varied twice"));
  EXPECT_THAT(told(grid({})), ElementsAre("F216 0:0 no parameter is varied"));
  EXPECT_THAT(told(grid({"mass=1:2:100000", "length=1:2:100000"})), ElementsAre(HasSubstr("more than 10000000")));
  EXPECT_THAT(told(grid({"mass=1:2:18446744073709551615", "length=1:2:18446744073709551615"})),
              ElementsAre(HasSubstr("more than 10000000")));
}

}  // namespace
}  // namespace ferrers
