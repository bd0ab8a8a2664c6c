#include "ferrers/io/run_restart.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "ferrers/io/run_folder.h"
#include "ferrers/testing/run_probe.h"
#include "ferrers/testing/zoo.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers::witness {
namespace {

namespace fs = std::filesystem;

/// Runs that are written to a folder and gone on with from there.
class RunRestartTest : public testing::Test {
 protected:
  RunRestartTest()
      : folder_(fs::temp_directory_path() / ("ferrers-run-restart-" + std::to_string(getpid())) /
                testing::UnitTest::GetInstance()->current_test_info()->name()) {
    fs::remove_all(folder_);
  }
  ~RunRestartTest() override {
    fs::remove_all(folder_);
    std::error_code ignored;
    fs::remove(folder_.parent_path(), ignored);
  }

  ProbedRun write(const ModelSpec& spec, const SimulationOptions& options) const {
    const EngineProbe engine(spec);
    ProbedRun run;
    RunFolder rows;
    EXPECT_EQ(rows.open(folder_, run_columns(*engine.dynamics), {}), "");
    RunControl control = keep_rows(*engine.dynamics, run);
    control.on_sample = [&](const RunSample& sample) {
      run.samples.push_back(sample);
      rows.add(sample);
    };
    run.summary = simulate(engine.dynamics, options, control);
    EXPECT_EQ(rows.close(), "");
    RunDocument document;
    document.summary = &run.summary;
    document.with_reactions = false;
    EXPECT_EQ(write_file_whole(folder_ / "summary.json", write_summary_json(document)), "");
    return run;
  }

  ProbedRun go_on(const ModelSpec& spec, SimulationOptions options) const {
    const EngineProbe engine(spec);
    RestartResult restart = read_restart(*engine.system, folder_);
    EXPECT_TRUE(restart.state.has_value()) << restart.error;
    options.start = std::move(restart.state);
    options.drives_off = std::move(restart.drives_off);
    options.events_acted = std::move(restart.events_acted);
    ProbedRun run;
    const RunControl control = keep_rows(*engine.dynamics, run);
    run.summary = simulate(engine.dynamics, options, control);
    return run;
  }

  static void expect_same_end(const ProbedRun& whole, const ProbedRun& rest) {
    ASSERT_EQ(rest.summary.status, RunStatus::kFinished) << rest.summary.message;
    ASSERT_EQ(whole.samples.back().t, rest.samples.back().t);
    for (const auto& [name, column] : whole.columns) {
      EXPECT_NEAR(whole.samples.back().values[column], rest.samples.back().values[column], 1e-8) << name;
    }
  }

  fs::path folder_;
};

/// Two bodies that turn against each other and fall, tied to nothing.
ModelSpec make_falling_pair() {
  ModelSpec spec;
  spec.name = "falling-pair";
  spec.bodies = {box_body("a", {0, 0, 0}, {0.5, 0.2, 0.1}, 1), box_body("b", {1, 0, 0}, {0.3, 0.3, 0.1}, 1)};
  spec.joints = {joint(JointType::kRevolute, "j", "a", "b", {0.5, 0, 0}, {0, 0.6, 0.8})};
  spec.initial = {initial_velocity("j", 2)};
  spec.records = {record("P", "a", {0, 0, 0})};
  return spec;
}

TEST_F(RunRestartTest, AFloatingBodyGoesOnFromWhereItWas) {
  const ModelSpec spec = make_falling_pair();
  const ProbedRun whole = probe_run(spec, plain_run(1, 0.25));
  write(spec, plain_run(0.5, 0.25));
  const ProbedRun rest = go_on(spec, plain_run(1, 0.25));
  ASSERT_EQ(rest.samples.size(), 3U);
  EXPECT_NEAR(rest.samples.front().values[rest.columns.at("energy")], whole.at(0, "energy"), 1e-9);
  EXPECT_NEAR(rest.at(0.5, "P.z"), whole.at(0.5, "P.z"), 1e-12);
  expect_same_end(whole, rest);
}

TEST_F(RunRestartTest, AnyRowTellsAStateTheNearestInTimeIsTaken) {
  const ModelSpec spec = make_driven_four_bar();
  SimulationOptions options;
  options.grid = {.t_end = 0.2, .every = 0.05};
  const ProbedRun run = write(spec, options);
  const EngineProbe engine(spec);
  for (const auto& [t, row] : {std::pair{-1.0, 0}, {0.05, 1}, {0.08, 2}, {0.07, 1}, {7.0, 4}}) {
    const RestartResult stored = read_stored_state(*engine.system, folder_, t);
    ASSERT_TRUE(stored.state.has_value()) << stored.error;
    EXPECT_EQ(stored.state->t, run.samples[static_cast<std::size_t>(row)].t) << t;
  }
  const RestartResult last = read_restart(*engine.system, folder_),
                      at_end = read_stored_state(*engine.system, folder_, 0.2);
  ASSERT_TRUE(last.state && at_end.state);
  EXPECT_EQ(last.state->q, at_end.state->q);
  EXPECT_EQ(last.state->v, at_end.state->v);
  EXPECT_FALSE(read_stored_state(*engine.system, folder_ / "nowhere", 0).error.empty());
}

TEST_F(RunRestartTest, AFloatingBodyFallsFreelyInItsColumns) {
  ModelSpec spec = make_falling_pair();
  spec.initial.clear();
  const ProbedRun run = probe_run(spec, plain_run(1, 0.5));
  EXPECT_NEAR(run.last("a.z"), -9.81 / 2, 1e-9);
  EXPECT_NEAR(run.last("a.v_z.velocity"), -9.81, 1e-9);
  EXPECT_NEAR(run.last("a.v_z.acceleration"), -9.81, 1e-9);
  EXPECT_NEAR(run.last("a.qw"), 1, 1e-12);
}

TEST_F(RunRestartTest, ColumnsOfAFloatingBodyDifferFromAllOthers) {
  ModelSpec spec = make_falling_pair();
  spec.records = {record("a", "b", {0, 0, 0})};
  const ProbedRun run = probe_run(spec, plain_run(0.5, 0.5));
  EXPECT_EQ(run.columns.size(), run.samples.back().values.size());
  EXPECT_EQ(run.columns.count("body_a.x"), 1U);
  write(spec, plain_run(0.25, 0.25));
  expect_same_end(run, go_on(spec, plain_run(0.5, 0.5)));
}

EventSpec event(const std::string& name, const std::string& when, EventSpec::Action action) {
  EventSpec spec;
  spec.name = name;
  spec.when = *law(when).expression;
  spec.action = action;
  if (action == EventSpec::Action::kSwitch) spec.drive = NameRef("push");
  return spec;
}

/// A mass on a rail that is pushed until t = 0.5 s.
ModelSpec make_pushed_mass() {
  ModelSpec spec;
  spec.name = "pushed";
  spec.gravity = number3(0, 0, 0);
  spec.bodies = {box_body("m", {0, 0, 0}, {1, 1, 1}, 2)};
  spec.joints = {joint(JointType::kPrismatic, "g", "ground", "m", {0, 0, 0}, {1, 0, 0})};
  spec.drives = {coordinate_drive("push", "g", "", "4")};
  spec.events = {event("off", "t - 0.5", EventSpec::Action::kSwitch)};
  return spec;
}

TEST_F(RunRestartTest, ADriveThatWasSwitchedOffStaysOff) {
  const ModelSpec spec = make_pushed_mass();
  for (const double pause : {0.25, 0.5, 1.0}) {  // before, at and after the event
    write(spec, plain_run(pause, 0.25));
    const ProbedRun rest = go_on(spec, plain_run(2, 0.25));
    ASSERT_EQ(rest.summary.status, RunStatus::kFinished) << rest.summary.message;
    EXPECT_NEAR(rest.last("g.displacement.velocity"), 1, 1e-12) << pause;  // 4 N on 2 kg for 0.5 s
    EXPECT_NEAR(rest.last("g.displacement"), 0.25 + 1.5, 1e-12) << pause;
    EXPECT_EQ(rest.last("push.effort"), 0) << pause;
    EXPECT_EQ(rest.summary.drives_off, std::vector<std::string>{"push"}) << pause;
  }
}

TEST_F(RunRestartTest, ADriveIsOnAgainAfterTwoSwitches) {
  ModelSpec spec = make_pushed_mass();
  spec.events.push_back(event("on", "t - 1.5", EventSpec::Action::kSwitch));
  write(spec, plain_run(1, 0.25));
  const ProbedRun rest = go_on(spec, plain_run(2, 0.25));
  EXPECT_NEAR(rest.last("g.displacement.velocity"), 2, 1e-12);
  EXPECT_TRUE(rest.summary.drives_off.empty());
}

TEST_F(RunRestartTest, APrescribedMotionThatWasSwitchedOffDoesNotComeBack) {
  ModelSpec spec = make_pushed_mass();
  spec.drives = {coordinate_drive("push", "g", "t*t")};
  SimulationOptions options = plain_run(1, 0.25);
  options.driven = true;
  write(spec, options);
  options.grid.t_end = 2;
  const ProbedRun rest = go_on(spec, options);
  ASSERT_EQ(rest.summary.status, RunStatus::kFinished) << rest.summary.message;
  EXPECT_NEAR(rest.last("g.displacement"), 0.25 + 1.5, 1e-9);  // with the speed 1 that it has at 0.5 s
}

TEST_F(RunRestartTest, ARunThatAnEventStoppedGoesOnBeyondIt) {
  ModelSpec spec = make_pushed_mass();
  spec.events = {event("there", "g.displacement - 0.3", EventSpec::Action::kStop)};
  const ProbedRun stopped = write(spec, plain_run(2, 0.25));
  ASSERT_EQ(stopped.summary.status, RunStatus::kStoppedByEvent);
  const ProbedRun rest = go_on(spec, plain_run(2, 0.25));
  EXPECT_EQ(rest.summary.status, RunStatus::kFinished) << rest.summary.message;
  EXPECT_NEAR(rest.last("g.displacement"), 4, 1e-9);
}

TEST_F(RunRestartTest, WithoutASummaryARunWithSwitchesIsNotGoneOnWith) {
  const ModelSpec spec = make_pushed_mass();
  write(spec, plain_run(1, 0.25));
  const EngineProbe engine(spec);
  for (const char* text : {"", "{\"t_reached\": 0.75, \"drives_off\": []}", "{\"t_reached\": 1.0, \"events\": []}"}) {
    std::ofstream(folder_ / "summary.json") << text;
    const RestartResult refused = read_restart(*engine.system, folder_);
    EXPECT_FALSE(refused.state.has_value()) << text;
    EXPECT_NE(refused.error.find("which drives"), std::string::npos) << refused.error;
    EXPECT_NE(refused.error.find("from the start"), std::string::npos) << refused.error;
  }
  fs::remove(folder_ / "summary.json");
  EXPECT_FALSE(read_restart(*engine.system, folder_).state.has_value());
  ModelSpec without = spec;
  without.events.clear();
  const EngineProbe plain(without);
  EXPECT_TRUE(read_restart(*plain.system, folder_).state.has_value());
}

TEST_F(RunRestartTest, ADriveOfAnotherModelIsTold) {
  const ModelSpec spec = make_pushed_mass();
  write(spec, plain_run(1, 0.25));
  std::ofstream(folder_ / "summary.json") << R"({"t_reached": 1.0, "drives_off": ["pull"], "events": []})";
  const EngineProbe engine(spec);
  const RestartResult refused = read_restart(*engine.system, folder_);
  EXPECT_FALSE(refused.state.has_value());
  EXPECT_NE(refused.error.find("'pull'"), std::string::npos) << refused.error;
}

}  // namespace
}  // namespace ferrers::witness
