#include "ferrers/study/sweep_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

namespace ferrers {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string read_text(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

VariantResult result(std::size_t index) {
  VariantResult one;
  one.index = index;
  one.run = RunStatus::kFinished;
  one.decision = {4, 1, 1};
  one.values = {10, 1.0 / 3.0};
  one.energy_start = -1;
  one.energy_end = 2;
  one.balance_error = 1e-12;
  one.steps = 7;
  one.evaluations = 90;
  return one;
}

VariantResult no_model(std::size_t index) {
  VariantResult one;
  one.index = index;
  one.message = "'mass' of 'b' is -1,\nbut cannot be \"negative\"";
  return one;
}

class SweepFolderTest : public testing::Test {
 protected:
  SweepFolderTest()
      : folder_(fs::temp_directory_path() / ("ferrers-sweep-folder-" + std::to_string(getpid())) /
                testing::UnitTest::GetInstance()->current_test_info()->name()) {
    fs::remove_all(folder_);
  }
  ~SweepFolderTest() override {
    fs::remove_all(folder_);
    std::error_code ignored;
    fs::remove(folder_.parent_path(), ignored);
  }

  void write_two() const {
    SweepFolder sweep(table_, columns_);
    ASSERT_EQ(sweep.begin(folder_), "");
    sweep.add(result(0));
    sweep.add(no_model(1));
    ASSERT_EQ(sweep.close(), "");
  }
  std::string going_on(const ParameterTable& table, const std::vector<std::string>& columns) const {
    SweepTally tally;
    return SweepFolder(table, columns).go_on(folder_, tally);
  }

  fs::path file() const { return folder_ / "sweep.csv"; }

  fs::path folder_;
  ParameterTable table_ = {{"m", "c"}, {1, 0.1, -1, 0.2, 3, 0.30000000000000004}};
  std::vector<std::string> columns_ = {"t", "g.displacement"};
};

TEST_F(SweepFolderTest, ARowHasTheParametersTheOutcomeAndTheLastRowOfTheRun) {
  write_two();
  EXPECT_EQ(read_text(file()),
            "index,m,c,status,rank,mobility,redundant,t,g.displacement,energy_start,energy_end,balance_error,steps,"
            "evaluations,notices,message\n"
            "0,1,0.10000000000000001,finished,4,1,1,10,0.33333333333333331,-1,2,9.9999999999999998e-13,7,90,0,\n"
            "1,-1,0.20000000000000001,model_error,,,,,,,,,0,0,0,\"'mass' of 'b' is -1, but cannot be "
            "\"\"negative\"\"\"\n");
}

TEST_F(SweepFolderTest, ARowIsInTheFileAsSoonAsItIsAdded) {
  SweepFolder sweep(table_, columns_);
  ASSERT_EQ(sweep.begin(folder_), "");
  sweep.add(result(0));
  EXPECT_THAT(read_text(file()), HasSubstr("\n0,1,"));
  EXPECT_THROW(sweep.add(result(2)), std::invalid_argument);
}

TEST_F(SweepFolderTest, ASweepGoesOnBehindItsLastWholeRow) {
  write_two();
  const std::string whole = read_text(file());
  std::ofstream(file(), std::ios::app) << "2,3,0.3";  // killed while it wrote
  SweepFolder sweep(table_, columns_);
  SweepTally tally;
  ASSERT_EQ(sweep.go_on(folder_, tally), "");
  EXPECT_EQ(sweep.rows(), 2u);
  EXPECT_EQ(tally.count(), 2u);
  EXPECT_EQ(tally.failed(), 1u);
  EXPECT_EQ(tally.failures().front().message, "'mass' of 'b' is -1, but cannot be \"negative\"");
  EXPECT_EQ(read_text(file()), whole);
  sweep.add(result(2));
  EXPECT_EQ(sweep.close(), "");
  EXPECT_THAT(read_text(file()), HasSubstr(whole + "2,3,0.30000000000000004,finished,"));
}

TEST_F(SweepFolderTest, AFileOfAnotherTableOrModelIsRefusedWithTheReason) {
  EXPECT_THAT(going_on(table_, columns_), HasSubstr("cannot be read"));
  write_two();
  EXPECT_THAT(going_on(table_, {"t"}), HasSubstr("the columns of"));
  EXPECT_THAT(going_on({{"c", "m"}, table_.values}, columns_), HasSubstr("the columns of"));
  ParameterTable other = table_;
  other.values[3] = std::nextafter(0.2, 1);
  EXPECT_THAT(going_on(other, columns_), HasSubstr("sweep.csv:3: this row has c = 0.20000000000000001 where"));
  other = {table_.names, {1, 0.1}};
  EXPECT_THAT(going_on(other, columns_), HasSubstr(":3: this row is beyond the 1 rows of the table"));
  std::ofstream(file(), std::ios::app) << "5,3,0.3\n";
  EXPECT_THAT(going_on(table_, columns_), HasSubstr(":4: this row has another number of cells"));
  std::ofstream(file()) << "";
  EXPECT_THAT(going_on(table_, columns_), HasSubstr("has no header"));
}

TEST_F(SweepFolderTest, AFolderThatCannotBeMadeIsToldSo) {
  fs::create_directories(folder_);
  std::ofstream(folder_ / "file") << "x";
  EXPECT_THAT(SweepFolder(table_, columns_).begin(folder_ / "file"), HasSubstr("cannot be made"));
}

// ---- the summary

TEST(SweepTallyTest, StatusesAreCountedAndTheFirstFailuresAndNoticesKept) {
  SweepTally tally;
  for (std::size_t i = 0; i < 300; ++i) {
    VariantResult one = i % 2 == 0 ? result(i) : no_model(i);
    if (i % 2 == 0) one.notices = {"the same", i == 4 ? "another" : "the same again"};
    tally.add(one);
  }
  VariantResult stopped = result(300);
  stopped.run = RunStatus::kStoppedByEvent;
  tally.add(stopped);
  EXPECT_EQ(tally.count(), 301u);
  EXPECT_EQ(tally.failed(), 150u);
  EXPECT_THAT(tally.statuses(), ElementsAre(std::pair<std::string, std::size_t>("finished", 150),
                                            std::pair<std::string, std::size_t>("model_error", 150),
                                            std::pair<std::string, std::size_t>("stopped", 1)));
  EXPECT_EQ(tally.failures().size(), SweepTally::kMostFailures);
  ASSERT_EQ(tally.notices().size(), 3u);
  EXPECT_EQ(tally.notices()[0].variants, 150u);
  EXPECT_EQ(tally.notices()[2].first, 4u);
}

TEST_F(SweepFolderTest, OptionsOfAnotherSweepAreToldByTheirName) {
  SweepDocument document;
  document.table = &table_;
  fs::create_directories(folder_);
  const fs::path json = folder_ / "sweep.json";
  EXPECT_THAT(find_other_options(json, document), HasSubstr("does not tell with which options"));
  std::ofstream(json) << write_sweep_json(document);
  EXPECT_EQ(find_other_options(json, document), "");
  document.simulation.tolerance = 1e-6;
  EXPECT_EQ(find_other_options(json, document), "it was made with 'tolerance' null instead of 1e-06");
  document.simulation.grid.t_end = 5;
  EXPECT_EQ(find_other_options(json, document), "it was made with 'end' 10.0 instead of 5.0");
  std::ofstream(json) << "{";
  EXPECT_THAT(find_other_options(json, document), HasSubstr("does not tell with which options"));
}

TEST_F(SweepFolderTest, TheSummaryIsGoodOnlyWhereEveryVariantIs) {
  SweepDocument document;
  document.table = &table_;
  document.status = SweepStatus::kFinished;
  document.tally.add(result(0));
  EXPECT_EQ(nlohmann::json::parse(write_sweep_json(document)).at("ok"), true);
  document.status = SweepStatus::kInterrupted;
  EXPECT_EQ(nlohmann::json::parse(write_sweep_json(document)).at("ok"), false);
  document.status = SweepStatus::kFinished;
  document.tally.add(no_model(1));
  const nlohmann::json json = nlohmann::json::parse(write_sweep_json(document));
  EXPECT_EQ(json.at("ok"), false);
  EXPECT_EQ(json.at("failed"), 1);
  EXPECT_EQ(json.at("parameters").at(1).at("largest"), 0.30000000000000004);
  EXPECT_EQ(nlohmann::json::parse(write_sweep_json({})).at("ok"), false);
}

}  // namespace
}  // namespace ferrers
