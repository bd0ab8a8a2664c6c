#include <gtest/gtest.h>

#include <cmath>

#include "ferrers/simulate/run.h"
#include "ferrers/testing/run_probe.h"
#include "ferrers/testing/zoo.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers::witness {
namespace {

EventSpec event(const std::string& name, const std::string& when, EventSpec::Action action,
                const std::string& drive = "") {
  EventSpec spec;
  spec.name = name;
  spec.when = *law(when).expression;
  spec.action = action;
  if (!drive.empty()) spec.drive = NameRef(drive);
  return spec;
}

TEST(EventsTest, ARunStopsWhereTheFormulaPassesZero) {
  ModelSpec spec = make_pendulum();  // falls from the horizontal: lowest at a quarter of its period
  spec.events = {event("lowest", "pivot.angle + pi/2", EventSpec::Action::kStop)};
  const ProbedRun run = probe_run(spec, plain_run(5, 0.1));
  EXPECT_EQ(run.summary.status, RunStatus::kStoppedByEvent);
  EXPECT_NEAR(run.samples.back().t, 2.367841947576237 / 4, 1e-10);
  EXPECT_NEAR(run.last("P.y"), -1, 1e-15);
  ASSERT_EQ(run.summary.events.size(), 1u);
  EXPECT_EQ(run.summary.events[0].name, "lowest");
}

TEST(EventsTest, EveryPassageIsRecordedWithARowOfItsOwn) {
  ModelSpec spec = make_pendulum();
  spec.events = {event("passing", "pivot.angle + pi/2", EventSpec::Action::kRecord)};
  const ProbedRun run = probe_run(spec, plain_run(10, 1));
  ASSERT_EQ(run.summary.status, RunStatus::kFinished) << run.summary.message;
  ASSERT_EQ(run.summary.events.size(), 8u);
  for (int k = 0; k < 8; ++k) {
    EXPECT_NEAR(run.summary.events[static_cast<std::size_t>(k)].t, 2.367841947576237 * (2 * k + 1) / 4, 1e-9) << k;
  }
  EXPECT_EQ(run.samples.size(), 11u + 8u);
  for (std::size_t i = 1; i < run.samples.size(); ++i) EXPECT_GT(run.samples[i].t, run.samples[i - 1].t);
}

TEST(EventsTest, ADriveIsSwitchedOffAndTheWheelTurnsOn) {
  ModelSpec spec = make_pendulum();
  spec.gravity = number3(0, 0, 0);
  spec.drives = {coordinate_drive("motor", "pivot", "", "2")};  // angular acceleration 2 rad/s² for 1 s
  spec.events = {event("enough", "t - 1", EventSpec::Action::kSwitch, "motor")};
  const ProbedRun run = probe_run(spec, plain_run(2, 0.25));
  ASSERT_EQ(run.summary.status, RunStatus::kFinished) << run.summary.message;
  EXPECT_NEAR(run.last("pivot.angle"), 1 + 2, 1e-9);
  EXPECT_NEAR(run.last("pivot.angle.velocity"), 2, 1e-9);
  EXPECT_EQ(run.at(1.25, "motor.effort"), 0);
  ASSERT_EQ(run.summary.events.size(), 1u);
  EXPECT_EQ(run.summary.events[0].message, "drive 'motor' off");
}

TEST(EventsTest, EventsFindTheSamePlaceWithEveryIntegrator) {
  ModelSpec spec = make_pendulum();
  spec.events = {event("lowest", "pivot.angle + pi/2", EventSpec::Action::kStop)};
  for (const std::string& name : integrator_names()) {
    SimulationOptions options = plain_run(5, 0.1);
    options.integrator = find_integrator(name);
    if (name == "constant-acceleration") options.step = 1e-5;
    const ProbedRun run = probe_run(spec, options);
    ASSERT_EQ(run.summary.status, RunStatus::kStoppedByEvent) << name << ": " << run.summary.message;
    EXPECT_NEAR(run.samples.back().t, 2.367841947576237 / 4, name == "constant-acceleration" ? 1e-4 : 1e-6) << name;
  }
}

// A block of 2 kg on a guide, pushed with 4 N: x = t² until the push ends.
ModelSpec pushed_block(std::vector<EventSpec> events) {
  ModelSpec spec;
  spec.name = "pushed-block";
  spec.gravity = number3(0, 0, 0);
  spec.bodies = {box_body("block", {0, 0, 0}, {0.1, 0.1, 0.1}, 2)};
  spec.joints = {joint(JointType::kPrismatic, "guide", "ground", "block", {0, 0, 0})};
  spec.joints[0].axis.drawn = number3(1, 0, 0);
  spec.drives = {coordinate_drive("push", "guide", "", "4")};
  spec.events = std::move(events);
  return spec;
}

TEST(EventsTest, TheWorkIsKnownThoughEventsCutSteps) {
  const auto off = event("off", "guide.displacement - 0.25", EventSpec::Action::kSwitch, "push");
  const auto far = event("far", "guide.displacement - 1", EventSpec::Action::kStop);
  const ProbedRun run = probe_run(pushed_block({off, far}), plain_run(9, 0.1));
  ASSERT_EQ(run.summary.status, RunStatus::kStoppedByEvent) << run.summary.message;
  EXPECT_NEAR(run.summary.t_reached, 0.5 + 0.75, 1e-12);
  EXPECT_NEAR(run.last("guide.displacement"), 1, 1e-12);
  ASSERT_TRUE(run.summary.work.has_value());
  EXPECT_NEAR(run.summary.work->drives, 4 * 0.25, 1e-11);
  EXPECT_NEAR(run.summary.balance_error, 0, 1e-11);
}

TEST(EventsTest, ASwitchAtTheVeryEndOfAStepIsOneEvent) {
  const auto off = event("off", "t - 0.5", EventSpec::Action::kSwitch, "push");
  const auto far = event("far", "guide.displacement - 12", EventSpec::Action::kStop);
  SimulationOptions options = plain_run(2, 0.25);
  options.step = 0.01;
  const ProbedRun run = probe_run(pushed_block({off, far}), options);
  ASSERT_EQ(run.summary.status, RunStatus::kFinished) << run.summary.message;
  EXPECT_EQ(run.summary.events.size(), 1u);
  EXPECT_NEAR(run.last("guide.displacement"), 1.75, 1e-12);
  EXPECT_NEAR(run.summary.energy_end, 1, 1e-12);
}

TEST(EventsTest, EventsOfOneInstantAllAct) {
  const auto off = event("off", "t - 0.5", EventSpec::Action::kSwitch, "push");
  const auto half = event("half", "guide.displacement - 0.25", EventSpec::Action::kRecord);
  for (const auto& both : {std::vector<EventSpec>{off, half}, std::vector<EventSpec>{half, off}}) {
    const ProbedRun run = probe_run(pushed_block(both), plain_run(1, 0.3));
    EXPECT_EQ(run.summary.events.size(), 2u);
    EXPECT_NEAR(run.last("guide.displacement"), 0.75, 1e-12);
  }
}

TEST(EventsTest, AnEventOnTheGridHasTheRowOfTheGrid) {
  for (const auto action : {EventSpec::Action::kRecord, EventSpec::Action::kStop}) {
    const ProbedRun run = probe_run(pushed_block({event("half", "t - 0.3", action)}), plain_run(0.6, 0.1));
    const bool stops = action == EventSpec::Action::kStop;
    ASSERT_EQ(run.samples.size(), stops ? 4u : 7u);
    for (std::size_t i = 0; i < run.samples.size(); ++i) EXPECT_EQ(run.samples[i].t, 0.1 * static_cast<double>(i));
  }
}

TEST(EventsTest, AFormulaThatIsNoNumberEndsTheRunWithItsName) {
  const ProbedRun run =
      probe_run(pushed_block({event("root", "sqrt(0.5 - t)", EventSpec::Action::kRecord)}), plain_run(1, 0.1));
  EXPECT_EQ(run.summary.status, RunStatus::kBadMotion);
  EXPECT_NE(run.summary.message.find("'root'"), std::string::npos) << run.summary.message;
}

TEST(EventsTest, AFormulaThatReadsTooMuchIsRefused) {
  ModelSpec spec = make_pendulum();
  std::string sum = "0";
  for (int i = 1; i < 80; ++i) {
    const std::string name = "more" + std::to_string(i);
    spec.bodies.push_back(box_body(name, {double(i), 0, 0}, {0.1, 0.1, 0.1}, 1));
    spec.joints.push_back(joint(JointType::kRevolute, "j" + std::to_string(i), "ground", name, {double(i), 0, 0}));
    sum += " + j" + std::to_string(i) + ".angle";
  }
  spec.events = {event("many", sum, EventSpec::Action::kRecord)};
  const RunSummary summary = probe_run(spec, plain_run(0.1, 0.1)).summary;
  EXPECT_EQ(summary.status, RunStatus::kUnsupported);
  EXPECT_NE(summary.message.find("more than 64 quantities"), std::string::npos) << summary.message;
}

TEST(EventsTest, AMotionIsSwitchedOnWhereItIsMetOnly) {
  const auto off = event("off", "t - 1", EventSpec::Action::kSwitch, "push");
  const auto on = event("on", "t - 2", EventSpec::Action::kSwitch, "push");
  SimulationOptions options = plain_run(3, 0.5);
  options.driven = true;
  // Left alone at t = 1 with speed 1 and met at x = 2: at that speed, or standing.
  for (const bool same_speed : {true, false}) {
    ModelSpec spec = pushed_block({off, on});
    spec.drives = {coordinate_drive("push", "guide", same_speed ? "t" : "t + (t - 1)*(t - 2)*(1 - t)", "")};
    const ProbedRun run = probe_run(spec, options);
    EXPECT_EQ(run.summary.status, same_speed ? RunStatus::kFinished : RunStatus::kBadMotion) << run.summary.message;
    if (!same_speed) {
      EXPECT_NE(run.summary.message.find("speed"), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace ferrers::witness
