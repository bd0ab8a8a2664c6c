#include "ferrers/io/run_folder.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

namespace ferrers {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

std::string read_text(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

class RunFolderTest : public testing::Test {
 protected:
  RunFolderTest()
      : folder_(fs::temp_directory_path() / ("ferrers-run-folder-" + std::to_string(getpid())) /
                testing::UnitTest::GetInstance()->current_test_info()->name()) {
    fs::remove_all(folder_);
  }
  ~RunFolderTest() override {
    fs::remove_all(folder_);
    std::error_code ignored;
    fs::remove(folder_.parent_path(), ignored);
  }

  RunSample sample(double t, double value) const {
    RunSample one;
    one.t = t;
    one.values = {t, value};
    return one;
  }

  fs::path folder_;
};

TEST_F(RunFolderTest, NumbersReadBackAreTheSame) {
  RunFolder run;
  ASSERT_EQ(run.open(folder_, {"t", "x"}, {}), "");
  const std::vector<double> values = {0.1, 1.0 / 3.0, -0.0, 5e-324, 1.7976931348623157e308, M_PI, 1e22};
  for (std::size_t i = 0; i < values.size(); ++i) run.add(sample(static_cast<double>(i), values[i]));
  ASSERT_EQ(run.close(), "");
  std::istringstream lines(read_text(folder_ / "result.csv"));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "t,x");
  for (const double value : values) {
    ASSERT_TRUE(std::getline(lines, line));
    const double back = std::strtod(line.c_str() + line.find(',') + 1, nullptr);
    EXPECT_EQ(back, value);
    EXPECT_EQ(std::signbit(back), std::signbit(value));
  }
  EXPECT_FALSE(std::getline(lines, line));
}

TEST_F(RunFolderTest, NumbersHaveSeventeenDigits) {
  RunFolder run;
  ASSERT_EQ(run.open(folder_, {"t", "x"}, {}), "");
  run.add(sample(0, 0.1));
  ASSERT_EQ(run.close(), "");
  EXPECT_EQ(read_text(folder_ / "result.csv"), "t,x\n0,0.10000000000000001\n");
}

TEST_F(RunFolderTest, UndeterminedReactionsHaveNoValueWhateverStandsInTheSample) {
  RunFolder run;
  ASSERT_EQ(run.open(folder_, {"t", "x"}, {{"J1"}, {}}), "");
  RunSample one = sample(0.5, 1);
  JointReaction reaction;
  reaction.value = {1, 2, 3, 4, 5, 6};
  reaction.status = {ReactionStatus::kUnique,       ReactionStatus::kUndetermined, ReactionStatus::kDistributed,
                     ReactionStatus::kUndetermined, ReactionStatus::kUnique,       ReactionStatus::kUnique};
  one.reactions = {reaction};
  run.add(one);
  ASSERT_EQ(run.close(), "");
  EXPECT_EQ(read_text(folder_ / "reactions.csv"),
            "t,joint,component,value,status\n"
            "0.5,J1,force_x,1,unique\n"
            "0.5,J1,force_y,,undetermined\n"
            "0.5,J1,force_z,3,distributed\n"
            "0.5,J1,moment_x,,undetermined\n"
            "0.5,J1,moment_y,5,unique\n"
            "0.5,J1,moment_z,6,unique\n");
}

TEST_F(RunFolderTest, RangesStandBesideTheirValuesWhereTheyAreAskedFor) {
  RunFolder run;
  ASSERT_EQ(run.open(folder_, {"t", "x"}, {{"J1"}, {}}, true), "");
  RunSample one = sample(0.5, 1);
  JointReaction reaction;
  reaction.value = reaction.low = reaction.high = {1, 2, 3, 4, 5, 6};
  reaction.low[2] = -3;
  reaction.high[2] = 30;
  reaction.status.fill(ReactionStatus::kUnique);
  reaction.status[1] = ReactionStatus::kUndetermined;
  reaction.status[2] = ReactionStatus::kDistributed;
  one.reactions = {reaction};
  run.add(one);
  ASSERT_EQ(run.close(), "");
  EXPECT_EQ(read_text(folder_ / "reactions.csv"),
            "t,joint,component,value,status,low,high\n"
            "0.5,J1,force_x,1,unique,1,1\n"
            "0.5,J1,force_y,,undetermined,,\n"
            "0.5,J1,force_z,3,distributed,-3,30\n"
            "0.5,J1,moment_x,4,unique,4,4\n"
            "0.5,J1,moment_y,5,unique,5,5\n"
            "0.5,J1,moment_z,6,unique,6,6\n");
}

TEST_F(RunFolderTest, ValuesThatAreNotFiniteAreEmptyCells) {
  RunFolder run;
  ASSERT_EQ(run.open(folder_, {"t", "x"}, {}), "");
  run.add(sample(1, std::numeric_limits<double>::quiet_NaN()));
  run.add(sample(2, std::numeric_limits<double>::infinity()));
  ASSERT_EQ(run.close(), "");
  EXPECT_EQ(read_text(folder_ / "result.csv"), "t,x\n1,\n2,\n");
}

TEST_F(RunFolderTest, WithoutJointsThereIsNoReactionsFile) {
  RunFolder run;
  ASSERT_EQ(run.open(folder_, {"t", "x"}, {}), "");
  ASSERT_EQ(run.close(), "");
  EXPECT_TRUE(fs::exists(folder_ / "result.csv"));
  EXPECT_FALSE(fs::exists(folder_ / "reactions.csv"));
}

TEST_F(RunFolderTest, FilesOfAnEarlierRunAreGone) {
  fs::create_directories(folder_);
  for (const char* name : {"summary.json", "reactions.csv"}) std::ofstream(folder_ / name) << "old";
  RunFolder run;
  ASSERT_EQ(run.open(folder_, {"t"}, {}), "");
  EXPECT_FALSE(fs::exists(folder_ / "summary.json"));
  EXPECT_FALSE(fs::exists(folder_ / "reactions.csv"));
}

TEST_F(RunFolderTest, RowsReachTheFileBeforeTheRunEnds) {
  RunFolder run;
  ASSERT_EQ(run.open(folder_, {"t", "x"}, {}), "");
  EXPECT_EQ(read_text(folder_ / "result.csv"), "t,x\n");
  run.add(sample(0, 1));
  std::this_thread::sleep_for(std::chrono::milliseconds(150));
  run.flush_if_due();
  EXPECT_EQ(read_text(folder_ / "result.csv"), "t,x\n0,1\n");
}

TEST_F(RunFolderTest, AFolderThatCannotBeIsAnErrorAndNotAThrow) {
  fs::create_directories(folder_.parent_path());
  std::ofstream(folder_) << "a file";
  RunFolder run;
  EXPECT_NE(run.open(folder_ / "run", {"t"}, {}), "");
  EXPECT_FALSE(run.is_open());
}

TEST_F(RunFolderTest, ASampleOfTheWrongSizeIsACallersBug) {
  RunFolder run;
  ASSERT_EQ(run.open(folder_, {"t", "x", "y"}, {}), "");
  EXPECT_THROW(run.add(sample(0, 1)), std::invalid_argument);
}

TEST_F(RunFolderTest, AFileIsReplacedWholeAndNothingIsLeftBeside) {
  fs::create_directories(folder_);
  const fs::path file = folder_ / "summary.json";
  ASSERT_EQ(write_file_whole(file, "first"), "");
  ASSERT_EQ(write_file_whole(file, "second"), "");
  EXPECT_EQ(read_text(file), "second");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 1);
  EXPECT_NE(write_file_whole(folder_ / "none" / "file", "text"), "");
}

RunDocument document_of(const RunSummary& summary) {
  RunDocument document;
  document.verb = "simulate";
  document.model = "m";
  document.summary = &summary;
  document.joints = {"a", "b", "c"};
  return document;
}

TEST(RunSummaryTest, UndeterminedLoadsAreNull) {
  RunSummary summary;
  summary.peaks.resize(3);
  summary.peaks[0].force = 5;
  summary.peaks[0].force_t = 0.25;
  summary.peaks[0].moment = 0;
  summary.peaks[1].force = 7;
  summary.peaks[1].moment_determined = false;
  summary.peaks[2].force_determined = summary.peaks[2].moment_determined = false;
  const ordered_json json = ordered_json::parse(write_summary_json(document_of(summary)));
  const auto& joints = json.at("joints");
  EXPECT_EQ(joints.at(0), ordered_json::parse(R"({"joint": "a", "max_force_N": 5.0, "max_force_t": 0.25,
             "max_moment_Nm": 0.0, "max_moment_t": 0.0, "status": "determined"})"));
  EXPECT_EQ(joints.at(1).at("max_force_N"), 7.0);
  EXPECT_TRUE(joints.at(1).at("max_moment_Nm").is_null());
  EXPECT_TRUE(joints.at(1).at("max_moment_t").is_null());
  EXPECT_EQ(joints.at(1).at("status"), "partly");
  EXPECT_TRUE(joints.at(2).at("max_force_N").is_null());
  EXPECT_EQ(joints.at(2).at("status"), "undetermined");
}

TEST(RunSummaryTest, WhatDividedTheLoadsIsNamed) {
  RunSummary summary;
  summary.peaks.resize(3);
  summary.peaks[0].force = summary.peaks[0].moment = 5;
  summary.peaks[0].force_distributed = true;
  EXPECT_TRUE(ordered_json::parse(write_summary_json(document_of(summary))).at("distribution").is_null());
  summary.distribution.used = true;
  summary.distribution.notices = {"mind the gap"};
  ordered_json json = ordered_json::parse(write_summary_json(document_of(summary)));
  EXPECT_EQ(json.at("joints").at(0).at("status"), "distributed");
  EXPECT_EQ(json.at("notices"), ordered_json::array({"mind the gap"}));
  EXPECT_EQ(json.at("distribution"), ordered_json::parse(R"({"by": "joint stiffness", "length_m": null,
             "stiffness_range": null, "bounds": null})"));
  summary.distribution.by = DistributionBy::kEqualStiffness;
  summary.distribution.length_m = 0.75;
  summary.distribution.range = StiffnessRange{0.5, 2};
  summary.distribution.bounds = BoundsMethod::kSearch;
  json = ordered_json::parse(write_summary_json(document_of(summary)));
  EXPECT_EQ(json.at("distribution"), ordered_json::parse(R"({"by": "equal stiffness", "length_m": 0.75,
             "stiffness_range": [0.5, 2.0], "bounds": "search"})"));
}

TEST(RunSummaryTest, OnlyARunThatCameToItsEndIsOk) {
  RunSummary summary;
  RunDocument document = document_of(summary);
  const auto ok = [&] { return ordered_json::parse(write_summary_json(document)).at("ok"); };
  EXPECT_EQ(ok(), true);
  summary.status = RunStatus::kStopped;
  EXPECT_EQ(ok(), true);  // an event of the model's own
  document.interrupted = true;
  EXPECT_EQ(ok(), false);
  EXPECT_EQ(ordered_json::parse(write_summary_json(document)).at("status"), "interrupted");
  document.interrupted = false;
  summary.status = RunStatus::kStepTooSmall;
  EXPECT_EQ(ok(), false);
  document.summary = nullptr;
  const ordered_json json = ordered_json::parse(write_summary_json(document));
  EXPECT_EQ(json.at("ok"), false);
  EXPECT_TRUE(json.at("energy").is_null());
  EXPECT_TRUE(json.at("joints").is_null());
}

TEST(RunSummaryTest, EnergyTellsItsDrift) {
  RunSummary summary;
  summary.energy_start = 2;
  summary.energy_end = 1.5;
  const ordered_json json = ordered_json::parse(write_summary_json(document_of(summary)));
  EXPECT_EQ(json.at("energy").at("drift"), -0.5);
  EXPECT_EQ(json.at("schema"), "ferrers.run/1");
}

TEST(RunSummaryTest, WithoutMassesThereIsNoEnergy) {
  RunSummary summary;
  summary.has_energy = false;
  EXPECT_TRUE(ordered_json::parse(write_summary_json(document_of(summary))).at("energy").is_null());
}

TEST(RunSummaryTest, SharedEffortsAreMarked) {
  RunSummary summary;
  summary.effort_is_shared = {false, true, true};
  RunDocument document = document_of(summary);
  document.drives = {{"alone", "N", 5.0, 0}, {"shared", "N·m", 3.0, 0}, {"unknown", "N", std::nullopt, 0}};
  const ordered_json json = ordered_json::parse(write_summary_json(document));
  EXPECT_EQ(json.at("drives").at(0).at("status"), "unique");
  EXPECT_EQ(json.at("drives").at(1).at("status"), "distributed");
  EXPECT_TRUE(json.at("drives").at(2).at("status").is_null());
}

}  // namespace
}  // namespace ferrers
