// The verb `sweep` as its users meet it: tables and grids, what stands in the folder, sweeps that are interrupted.

#include <gmock/gmock.h>

#include <algorithm>
#include <map>
#include <sstream>

#include "command_probe.h"
#include "ferrers/testing/json_schema.h"

namespace ferrers {
namespace {

using namespace command_testing;  // NOLINT(google-build-using-namespace)
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// A mass on a slide that is pushed.
constexpr const char* kPushed = R"(ferrers: 1
name: pushed
gravity: [0, 0, 0]
parameters: {m: 2 kg, f: 4 N}
bodies: {b: {mass: = m, com: [0, 0, 0]}}
joints: {g: {type: prismatic, bodies: [ground, b], at: [0, 0, 0], axis: x}}
drives: {push: {joint: g, effort: = f}}
)";

using Row = std::map<std::string, std::string>;

class SweepCommandTest : public CommandTest {
 protected:
  std::string pushed() const { return write("pushed.yaml", kPushed).string(); }

  /// Rows of a file without quotes, by their columns.
  std::vector<Row> rows_of(const fs::path& file) const {
    const std::vector<std::string> lines = lines_of(folder_ / file);
    std::vector<Row> rows;
    for (std::size_t i = 1; i < lines.size(); ++i) {
      std::istringstream names(lines[0]), cells(lines[i]);
      Row& row = rows.emplace_back();
      for (std::string name, cell; std::getline(names, name, ','); cell.clear()) {
        std::getline(cells, cell, ',');
        row[name] = cell;
      }
    }
    return rows;
  }

  static std::vector<std::string> faults(const std::string& json) {
    static const witness::JsonSchema schema(
        nlohmann::json::parse(read_text(fs::path(FERRERS_SOURCE_DIR) / "schemas/sweep.schema.json")));
    return schema.faults(nlohmann::json::parse(json, nullptr, false));
  }
};

TEST_F(SweepCommandTest, AVariantIsTheSimulationWithItsParameters) {
  const Result sweep = run({"sweep", bricard(), "--vary", "c=50 mm:200 mm:4", "-p", "m=2", "--end", "2", "-o", "many"});
  ASSERT_EQ(sweep.exit_code, 0) << sweep.errors;
  EXPECT_THAT(sweep.errors, IsEmpty());
  const std::vector<Row> rows = rows_of("many/sweep.csv");
  ASSERT_EQ(rows.size(), 4u);
  for (const Row& row : rows) {
    const Result one =
        run({"simulate", bricard(), "-p", "m=2", "-p", "c=" + row.at("c"), "--end", "2", "--every", "2", "-o", "one"});
    ASSERT_EQ(one.exit_code, 0) << one.errors;
    const Row last = rows_of("one/result.csv").back();
    for (const auto& [name, cell] : last) EXPECT_EQ(row.at(name), cell) << name << " of variant " << row.at("index");
    const ordered_json summary = ordered_json::parse(read_text(folder_ / "one/summary.json"));
    EXPECT_EQ(std::stod(row.at("energy_start")), summary.at("energy").at("start"));
    EXPECT_EQ(std::stod(row.at("energy_end")), summary.at("energy").at("end"));
    EXPECT_EQ(std::stod(row.at("balance_error")), summary.at("balance").at("error_J"));
    EXPECT_EQ(std::stol(row.at("steps")), summary.at("steps"));
    EXPECT_EQ(std::stol(row.at("rank")), summary.at("decisions").at(0).at("rank"));
    EXPECT_EQ(row.at("mobility") + row.at("redundant"), "11");
    // Rows between change nothing but the last digits.
    ASSERT_EQ(run({"simulate", bricard(), "-p", "m=2", "-p", "c=" + row.at("c"), "--end", "2", "-o", "one"}).exit_code,
              0);
    const Row other = rows_of("one/result.csv").back();
    for (const auto& [name, cell] : other) {
      EXPECT_NEAR(std::stod(row.at(name)), std::stod(cell), 1e-9) << name;
    }
  }
}

TEST_F(SweepCommandTest, TheFolderIsTheSameForAnyNumberOfThreads) {
  const auto sweep = [this](const std::string& threads) {
    EXPECT_EQ(run({"sweep", bricard(), "--vary", "c=0.05:0.2:9", "--vary", "m=1:2:2", "--end", "0.5", "--jobs", threads,
                   "-o", "on-" + threads})
                  .exit_code,
              0);
    return read_text(folder_ / ("on-" + threads) / "sweep.csv");
  };
  const std::string one = sweep("1");
  EXPECT_EQ(std::count(one.begin(), one.end(), '\n'), 19);
  EXPECT_EQ(sweep("2"), one);
  EXPECT_EQ(sweep("5"), one);
}

TEST_F(SweepCommandTest, ATableSetsParametersRowByRow) {
  const std::string table = write("t.csv", "m,f\n# two\n1,\"2 N\"\n500 g,3\n").string();
  const Result result = run({"sweep", pushed(), "--table", table, "--end", "2", "-o", "out", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(faults(result.output), IsEmpty());
  EXPECT_EQ(result.output, read_text(folder_ / "out/sweep.json"));
  EXPECT_EQ(result.json().at("variants"), 2);
  EXPECT_EQ(read_text(folder_ / "out/model.yaml"), kPushed);
  const std::vector<Row> rows = rows_of("out/sweep.csv");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_NEAR(std::stod(rows[0].at("g.displacement")), 4, 1e-9);  // f t² / (2 m)
  EXPECT_NEAR(std::stod(rows[1].at("g.displacement")), 12, 1e-9);
}

TEST_F(SweepCommandTest, VariantsThatFailHaveTheirReasonAndTheOthersTheirResults) {
  const std::string table = write("t.csv", "m\n1\n-1\n2\n").string();
  const Result result = run({"sweep", pushed(), "--table", table, "--end", "1", "-o", "out"});
  EXPECT_EQ(result.exit_code, 6) << result.errors;
  EXPECT_THAT(result.output, HasSubstr("model_error    1"));
  EXPECT_THAT(result.output, HasSubstr("1: model_error: 'mass' of 'b' is -1, but cannot be negative"));
  const std::vector<Row> rows = rows_of("out/sweep.csv");
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0].at("status"), "finished");
  EXPECT_EQ(rows[1].at("status"), "model_error");
  EXPECT_EQ(rows[1].at("t"), "");
  EXPECT_EQ(rows[2].at("status"), "finished");
  const std::string json = read_text(folder_ / "out/sweep.json");
  EXPECT_THAT(faults(json), IsEmpty());
  EXPECT_EQ(ordered_json::parse(json).at("failed"), 1);
  EXPECT_EQ(ordered_json::parse(json).at("ok"), false);
}

// A four-bar linkage whose rod does not reach.
TEST_F(SweepCommandTest, AVariantThatCannotBeAssembledIsOneThatFails) {
  const std::string model = write("bars.yaml", R"(ferrers: 1
gravity: [0, -9.81, 0]
parameters: {rod: 2 m}
bodies:
  a: {mass: 1, com: [0, 0.5, 0], inertia: {moments: [1, 1, 1]}}
  b: {mass: 1, com: [2, 0.5, 0], inertia: {moments: [1, 1, 1]}}
joints:
  A: {type: revolute, bodies: [ground, a], at: [0, 0, 0], axis: z}
  B: {type: revolute, bodies: [ground, b], at: [2, 0, 0], axis: z}
  R: {type: distance, bodies: [a, b], points: [[0, 1, 0], [2, 1, 0]], length: = rod}
)")
                                .string();
  const Result result = run({"sweep", model, "--vary", "rod=2:6:2", "--end", "0.1", "-o", "out"});
  EXPECT_EQ(result.exit_code, 6) << result.errors;
  const std::vector<Row> rows = rows_of("out/sweep.csv");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].at("status"), "finished");
  EXPECT_EQ(rows[1].at("status"), "not_assembled");
  EXPECT_EQ(rows[1].at("energy_start"), "");
}

TEST_F(SweepCommandTest, ATableWithErrorsIsToldWithEveryPlace) {
  const std::string table = write("t.csv", "m,g\n1,2\n,3\n1\nx,1\n").string();
  const Result result = run({"sweep", pushed(), "--table", table, "-o", "out", "--json"});
  EXPECT_EQ(result.exit_code, 3);
  for (const char* told : {"t.csv:1:3: error[F216]: the model has no parameter 'g'", "t.csv:3:1: error[F212]",
                           "t.csv:4:1: error[F116]", "t.csv:5:1: error[F203]"}) {
    EXPECT_THAT(result.errors, HasSubstr(told));
  }
  EXPECT_THAT(faults(result.output), IsEmpty());
  EXPECT_EQ(result.json().at("table_diagnostics").size(), 4u);
  EXPECT_FALSE(fs::exists(folder_ / "out"));
  const Result missing = run({"sweep", pushed(), "--table", "nowhere.csv"});
  EXPECT_EQ(missing.exit_code, 3);
  EXPECT_THAT(missing.errors, HasSubstr("nowhere.csv: error[F101]: this file does not exist"));
}

TEST_F(SweepCommandTest, AModelWithErrorsIsToldAsByAnyVerb) {
  const Result result = run({"sweep", write("wrong.yaml", kWrongModel).string(), "--vary", "m=1:2:2", "--json"});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.errors, HasSubstr("wrong.yaml:"));
  EXPECT_THAT(faults(result.output), IsEmpty());
}

TEST_F(SweepCommandTest, WhatIsAskedForTwiceOrNotAtAllIsRefused) {
  EXPECT_EQ(run({"sweep", pushed()}).exit_code, 2);
  EXPECT_THAT(run({"sweep", pushed(), "--vary", "m=1:2:2", "--table", "t.csv"}).errors, HasSubstr("take one of them"));
  EXPECT_THAT(run({"sweep", pushed(), "--vary", "m=1:2:2", "--step", "0.1", "--tolerance", "1e-6"}).errors,
              HasSubstr("--step fixes the step"));
  EXPECT_EQ(run({"sweep", pushed(), "--vary", "m=1:2:2", "--jobs", "0"}).exit_code, 2);
  const Result twice = run({"sweep", pushed(), "--vary", "m=1:2:2", "-p", "m=1"});
  EXPECT_EQ(twice.exit_code, 3);
  EXPECT_THAT(twice.errors, HasSubstr("the parameter 'm' is varied, but -p sets it"));
  const Result ranges = run({"sweep", pushed(), "--vary", "m=1:2", "--vary", "n=1:2:3"});
  EXPECT_EQ(ranges.exit_code, 3);
  EXPECT_THAT(ranges.errors, HasSubstr("'m=1:2' is not name=from:to:count"));
  EXPECT_THAT(ranges.errors, HasSubstr("the model has no parameter 'n'"));
}

TEST_F(SweepCommandTest, AFolderOfSomethingElseIsNotWrittenTo) {
  ASSERT_EQ(run({"simulate", pushed(), "--end", "0.1", "-o", "run"}).exit_code, 0);
  const Result result = run({"sweep", pushed(), "--vary", "m=1:2:2", "-o", "run"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.errors, HasSubstr("holds a model, but no sweep.csv"));
  EXPECT_FALSE(fs::exists(folder_ / "run/sweep.csv"));
}

// ---------------------------------------------------------------------------------------------------------------------
// Sweeps that end early

class InterruptedSweepTest : public SweepCommandTest {
 protected:
  const std::vector<std::string> kArguments = {"sweep", bricard(), "--vary", "c=0.05:0.2:100000", "--end", "1",
                                               "-o",    "many",    "--json"};

  /// Starts a sweep of minutes, waits for some rows and sends a signal.
  Result cut(int signal) const {
    const pid_t child = start(kArguments);
    for (int i = 0; i < 600 && lines_of(folder_ / "many/sweep.csv").size() < 20; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    kill(child, signal);
    return wait_for(child);
  }

  std::vector<std::string> resume(const std::string& vary) const {
    std::vector<std::string> arguments = kArguments;
    arguments[3] = vary;
    arguments.emplace_back("--resume");
    return arguments;
  }
};

TEST_F(InterruptedSweepTest, AnInterruptKeepsWhatIsDone) {
  const Result result = cut(SIGINT);
  EXPECT_EQ(result.exit_code, 130) << result.errors;
  EXPECT_THAT(faults(result.output), IsEmpty());
  EXPECT_EQ(result.json().at("status"), "interrupted");
  const std::vector<std::string> lines = lines_of(folder_ / "many/sweep.csv");
  EXPECT_GE(lines.size(), 20u);
  EXPECT_EQ(result.json().at("done"), lines.size() - 1);
}

TEST_F(InterruptedSweepTest, AKilledSweepGoesOnToWhatItWouldHaveBeen) {
  EXPECT_EQ(cut(SIGKILL).signal, SIGKILL);
  EXPECT_EQ(ordered_json::parse(read_text(folder_ / "many/sweep.json")).at("status"), "running");
  // The same values as the table would have had, but fewer of them.
  const std::vector<Row> done = rows_of("many/sweep.csv");
  std::string text = "c\n";
  for (std::size_t i = 0; i + 1 < done.size(); ++i) text += done[i].at("c") + "\n";
  text += done[done.size() - 2].at("c") + "\n0.1\n0.11\n";
  const std::string table = write("t.csv", text).string();
  const std::string csv = read_text(folder_ / "many/sweep.csv");
  const std::size_t last = csv.rfind('\n', csv.size() - 2) + 1;
  std::ofstream(folder_ / "many/sweep.csv") << csv.substr(0, last) << csv.substr(last, 30);  // half a row
  std::vector<std::string> arguments = {"sweep", bricard(), "--table", table, "--end", "1", "-o", "many", "--json"};
  arguments.emplace_back("--resume");
  const Result rest = run(arguments);
  EXPECT_EQ(rest.exit_code, 0) << rest.errors;
  EXPECT_THAT(faults(rest.output), IsEmpty());
  EXPECT_EQ(rest.json().at("resumed"), done.size() - 1);
  arguments.pop_back();
  arguments[7] = "whole";
  ASSERT_EQ(run(arguments).exit_code, 0);
  EXPECT_EQ(read_text(folder_ / "many/sweep.csv"), read_text(folder_ / "whole/sweep.csv"));
}

TEST_F(InterruptedSweepTest, ASweepOfAnotherKindIsNotGoneOnWith) {
  const Result nothing = run(resume("c=0.05:0.2:3"));
  EXPECT_EQ(nothing.exit_code, 2);
  EXPECT_THAT(nothing.errors, HasSubstr("--resume: there is no sweep in 'many'"));
  ASSERT_EQ(run({"sweep", bricard(), "--vary", "c=0.05:0.2:3", "--end", "1", "-o", "many"}).exit_code, 0);
  const std::string before = read_text(folder_ / "many/sweep.csv");
  EXPECT_EQ(run(resume("c=0.05:0.2:3")).exit_code, 0);
  EXPECT_THAT(run(resume("c=0.05:0.3:3")).errors, HasSubstr("sweep.csv:3: this row has c = "));
  EXPECT_THAT(run(resume("m=0.05:0.2:3")).errors, HasSubstr("the columns of"));
  std::vector<std::string> other = resume("c=0.05:0.2:3");
  other[5] = "2";
  EXPECT_THAT(run(other).errors, HasSubstr("it was made with 'end' 1.0 instead of 2.0"));
  other = resume("c=0.05:0.2:3");
  other.insert(other.end(), {"-p", "m=2"});
  const Result another = run(other);
  EXPECT_EQ(another.exit_code, 2);
  EXPECT_THAT(another.errors, HasSubstr("is another model"));
  EXPECT_EQ(read_text(folder_ / "many/sweep.csv"), before);
}

}  // namespace
}  // namespace ferrers
