#include <gtest/gtest.h>

#include <cmath>

#include "ferrers/testing/run_probe.h"
#include "ferrers/testing/zoo.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers::witness {
namespace {

ProbedRun probe_prescribed(const ModelSpec& spec, const PrescribedOptions& options) {
  const EngineProbe engine(spec);
  ProbedRun run;
  const RunControl control = keep_rows(*engine.dynamics, run);
  run.summary = run_prescribed(engine.dynamics, options, control);
  return run;
}

PrescribedOptions grid(double t_end, double every) {
  PrescribedOptions options;
  options.grid = {t_end, every};
  return options;
}

bool mentions(const std::vector<std::string>& notices, const std::string& words) {
  for (const std::string& notice : notices) {
    if (notice.find(words) != std::string::npos) return true;
  }
  return false;
}

TEST(PrescribedRunTest, KinematicsNeedsNoMassesAndShowsNoEnergyThen) {
  ModelSpec spec = make_driven_four_bar();
  for (BodySpec& body : spec.bodies) {
    body.mass.reset();
    body.com.reset();
    body.inertia = {};
  }
  PrescribedOptions options = grid(1, 0.5);
  options.with_efforts = false;
  const ProbedRun run = probe_prescribed(spec, options);
  EXPECT_EQ(run.summary.status, RunStatus::kFinished) << run.summary.message;
  EXPECT_FALSE(run.summary.has_energy);
  EXPECT_EQ(run.samples.size(), 3U);
  EXPECT_NEAR(run.at(1, "O.angle"), 1.2 * (1 - std::cos(2)), 1e-12);
  EXPECT_TRUE(run.summary.effort_is_shared.empty());
}

TEST(PrescribedRunTest, EnergyIsShownWhereMassesAreKnown) {
  const ProbedRun run = probe_prescribed(make_driven_four_bar(), grid(1, 0.5));
  EXPECT_TRUE(run.summary.has_energy);
  EXPECT_NE(run.summary.energy_start, run.summary.energy_end);
}

TEST(PrescribedRunTest, SharedEffortsTablesAndLimitsAreTold) {
  ModelSpec spec = make_driven_four_bar();
  LawSpec table;
  table.samples.emplace();
  for (int i = 0; i <= 50; ++i) {
    table.samples->first.push_back(0.02 * i);
    table.samples->second.push_back(0.3 * (1 - std::cos(0.04 * i)));
  }
  spec.drives[0].motion = {table};
  spec.drives.push_back(coordinate_drive("helper", "B", ""));
  spec.joints[0].limits = {Number(-0.1), Number(0.2)};
  const ProbedRun run = probe_prescribed(spec, grid(1.2, 0.1));
  EXPECT_EQ(run.summary.status, RunStatus::kFinished) << run.summary.message;
  EXPECT_EQ(run.summary.effort_is_shared, (std::vector<bool>{true, true}));
  for (const char* words : {"natural cubic spline through 51 samples", "the run leaves the times of that table",
                            "these drives help: 'helper'", "the efforts of 'motor', 'helper' are not unique",
                            "crosses its upper limit 0.2"}) {
    EXPECT_TRUE(mentions(run.summary.notices, words)) << words;
  }
}

// --- from efforts to a motion, and back -----------------------------------------------------------------------------

/// Largest difference between the efforts that drove a simulated motion and those that inverse dynamics finds for the
/// splines through its rows, relative to the largest effort; away from the ends, where natural splines bend less.
double lost_on_the_way(ModelSpec spec, const std::vector<std::pair<std::string, std::string>>& columns, double every) {
  constexpr double t_end = 1.5;
  const ProbedRun forward = probe_run(spec, plain_run(t_end, every));
  EXPECT_EQ(forward.summary.status, RunStatus::kFinished) << forward.summary.message;
  for (std::size_t d = 0; d < columns.size(); ++d) {
    LawSpec table;
    table.samples.emplace();
    for (const RunSample& sample : forward.samples) {
      table.samples->first.push_back(sample.t);
      table.samples->second.push_back(sample.values.at(forward.columns.at(columns[d].first)));
    }
    spec.drives[d].effort.clear();
    spec.drives[d].motion = {table};
  }
  const ProbedRun back = probe_prescribed(spec, grid(t_end, every));
  EXPECT_EQ(back.summary.status, RunStatus::kFinished) << back.summary.message;
  double error = 0, size = 0;
  for (std::size_t i = 0; i < back.samples.size(); ++i) {
    const double t = back.samples[i].t;
    if (t < 0.3 || t > t_end - 0.3) continue;
    for (const auto& [coordinate, effort] : columns) {
      const double wanted = forward.samples[i].values.at(forward.columns.at(effort));
      size = std::max(size, std::abs(wanted));
      error = std::max(error, std::abs(back.samples[i].values.at(back.columns.at(effort)) - wanted));
    }
  }
  return error / size;
}

void expect_second_order(const ModelSpec& spec, const std::vector<std::pair<std::string, std::string>>& columns,
                         double every, double bound) {
  const double coarse = lost_on_the_way(spec, columns, every), fine = lost_on_the_way(spec, columns, every / 2);
  EXPECT_LT(fine, bound);
  EXPECT_GT(coarse / fine, 3.2);  // (h²/12) of the fourth derivative
  EXPECT_LT(coarse / fine, 5);
}

TEST(PrescribedRunTest, InverseOfASimulatedFourBarReturnsItsTorque) {
  ModelSpec spec = make_driven_four_bar();
  spec.drives[0] = coordinate_drive("motor", "O", "", "40 + 20*sin(3*t)");
  expect_second_order(spec, {{"O.angle", "motor.effort"}}, 0.01, 0.03);
}

TEST(PrescribedRunTest, InverseOfASimulatedSliderCrankReturnsItsTorque) {
  ModelSpec spec = make_slider_crank(SliderCrankJoints::kRevolutePrismatic);
  spec.initial = {initial_velocity("O", 5)};
  spec.drives[0] = coordinate_drive("motor", "O", "", "3*cos(2*t)");
  expect_second_order(spec, {{"O.angle", "motor.effort"}}, 0.002, 0.1);
}

TEST(PrescribedRunTest, InverseOfASimulatedArmReturnsBothTorques) {
  ModelSpec spec;
  spec.name = "arm";
  spec.bodies = {box_body("upper", {0.4, 0, 0}, {0.8, 0.1, 0.1}, 2),
                 box_body("lower", {1.1, 0, 0}, {0.6, 0.1, 0.1}, 1)};
  spec.joints = {joint(JointType::kRevolute, "shoulder", "ground", "upper", {0, 0, 0}, {0, 0, 1}),
                 joint(JointType::kRevolute, "elbow", "upper", "lower", {0.8, 0, 0}, {0, 0.3, 1})};
  spec.drives = {coordinate_drive("m1", "shoulder", "", "2*sin(2*t)"),
                 coordinate_drive("m2", "elbow", "", "0.5*cos(3*t)")};
  expect_second_order(spec, {{"shoulder.angle", "m1.effort"}, {"elbow.angle", "m2.effort"}}, 0.01, 0.01);
}

}  // namespace
}  // namespace ferrers::witness
