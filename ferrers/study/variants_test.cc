#include "ferrers/study/variants.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <thread>

#include "ferrers/io/model_reader.h"

namespace ferrers {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Model read_model(const std::string& text) {
  ModelReadResult read = read_model_text(text, "m.yaml");
  if (!read.model) throw std::invalid_argument(read.diagnostics.items().front().message);
  return std::move(*read.model);
}

Model bricard() {
  return std::move(*read_model_file(std::string(FERRERS_SOURCE_DIR) + "/examples/bricard-a04/model.yaml").model);
}

/// A mass on a slide that is pushed: x = f t² / (2 m) from rest.
constexpr const char* kPushed = R"(ferrers: 1
gravity: [0, 0, 0]
parameters: {m: 2 kg, f: 4 N}
bodies: {b: {mass: = m, com: [0, 0, 0]}}
joints: {g: {type: prismatic, bodies: [ground, b], at: [0, 0, 0], axis: x}}
drives: {push: {joint: g, effort: = f}}
)";

VariantsOptions options(double t_end, int threads = 1) {
  VariantsOptions out;
  out.simulation.grid = {t_end, t_end};
  out.threads = threads;
  return out;
}

std::vector<VariantResult> all_of(const Model& model, const ParameterTable& table, const VariantsOptions& how) {
  std::vector<VariantResult> results;
  VariantsControl control;
  control.on_result = [&results](const VariantResult& one) { results.push_back(one); };
  const std::size_t told = simulate_variants(model, table, how, control);
  EXPECT_EQ(told, results.size());
  return results;
}

/// Every number with all its bits.
std::string bits_of(const VariantResult& one) {
  std::string out = std::to_string(one.index) + "/" + std::to_string(one.run ? static_cast<int>(*one.run) : -1) + "/" +
                    one.message + "/" + std::to_string(one.steps) + "/" + std::to_string(one.evaluations);
  std::vector<double> numbers = one.values;
  numbers.insert(numbers.end(), {one.energy_start, one.energy_end, one.balance_error});
  for (const double number : numbers) out.append(reinterpret_cast<const char*>(&number), sizeof number);
  return out;
}

TEST(VariantsTest, EachVariantIsTheMotionOfItsOwnParameters) {
  const Model model = read_model(kPushed);
  const std::vector<VariantResult> results = all_of(model, {{"m", "f"}, {1, 2, 2, 2, 4, 8}}, options(2));
  ASSERT_EQ(results.size(), 3u);
  const auto columns = run_columns(*make_dynamics_model(make_system(std::make_shared<Model>(model))));
  ASSERT_THAT(columns, testing::Contains("g.displacement"));
  const auto x =
      static_cast<std::size_t>(std::find(columns.begin(), columns.end(), "g.displacement") - columns.begin());
  const double mass[] = {1, 2, 4}, force[] = {2, 2, 8};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(results[i].index, i);
    EXPECT_EQ(results[i].run, RunStatus::kFinished);
    ASSERT_EQ(results[i].values.size(), columns.size());
    EXPECT_EQ(results[i].values[0], 2.0);
    EXPECT_NEAR(results[i].values[x], force[i] * 4 / (2 * mass[i]), 1e-9);
    EXPECT_NEAR(results[i].energy_end - results[i].energy_start, 2 * force[i] * force[i] / mass[i], 1e-9);
    EXPECT_NEAR(results[i].balance_error, 0, 1e-9);
    ASSERT_TRUE(results[i].decision);
    EXPECT_EQ(*results[i].decision, (VariantResult::Decision{0, 1, 0}));
  }
}

TEST(VariantsTest, ParametersThatTheTableLeavesOutKeepTheModelsValues) {
  const std::vector<VariantResult> results = all_of(read_model(kPushed), {{"m"}, {4}}, options(1));
  ASSERT_EQ(results.size(), 1u);
  EXPECT_NEAR(results[0].energy_end, 4.0 * 4.0 / (2 * 4.0), 1e-9);  // (f t)² / (2 m)
}

TEST(VariantsTest, ResultsAreTheSameToTheBitForAnyNumberOfThreads) {
  const Model model = bricard();
  ParameterTable table;
  table.names = {"c", "m"};
  for (int i = 0; i < 12; ++i) {
    table.values.push_back(i % 5 == 4 ? 0.9 : 0.05 + 0.01 * i);  // 0.9 m is beyond its 'max'
    table.values.push_back(1 + 0.5 * i);
  }
  const std::vector<VariantResult> one = all_of(model, table, options(0.5, 1));
  ASSERT_EQ(one.size(), 12u);
  EXPECT_FALSE(one[4].run);
  ASSERT_TRUE(one[5].decision);
  EXPECT_EQ(*one[5].decision, (VariantResult::Decision{4, 1, 1}));
  for (const int threads : {2, 3, 8}) {
    const std::vector<VariantResult> several = all_of(model, table, options(0.5, threads));
    ASSERT_EQ(several.size(), one.size());
    for (std::size_t i = 0; i < one.size(); ++i) EXPECT_EQ(bits_of(several[i]), bits_of(one[i])) << i;
  }
}

TEST(VariantsTest, AVariantIsTheSimulationOfTheModelWithItsParameters) {
  const Model model = bricard();
  const VariantsOptions how = options(0.5);
  const std::vector<VariantResult> results = all_of(model, {{"c"}, {0.07}}, how);
  const ModelBuildResult built = model.with_parameters({{"c", 0.07}});
  std::vector<double> last;
  RunControl control;
  control.on_sample = [&last](const RunSample& sample) { last = sample.values; };
  const RunSummary run = simulate(make_dynamics_model(make_system(*built.model)), how.simulation, control);
  ASSERT_EQ(results.size(), 1u);
  EXPECT_EQ(results[0].values, last);  // reactions and all
  EXPECT_EQ(results[0].energy_end, run.energy_end);
  EXPECT_EQ(results[0].balance_error, run.balance_error);
  EXPECT_EQ(results[0].steps, run.steps);
  EXPECT_EQ(results[0].evaluations, run.evaluations);
}

TEST(VariantsTest, ValuesThatMakeNoModelAreThatVariantsAndNotTheEnd) {
  const std::vector<VariantResult> results = all_of(read_model(kPushed), {{"m"}, {1, -1, 2}}, options(1, 2));
  ASSERT_EQ(results.size(), 3u);
  EXPECT_TRUE(results[0].is_finished());
  EXPECT_FALSE(results[1].run);
  EXPECT_THAT(results[1].message, HasSubstr("negative"));
  EXPECT_THAT(results[1].values, IsEmpty());
  EXPECT_FALSE(results[1].decision);
  EXPECT_TRUE(results[2].is_finished());
}

TEST(VariantsTest, ResultsComeInOrderAlsoWhereTheFirstTakesLongest) {
  ParameterTable table;
  table.names = {"f"};
  for (int i = 0; i < 40; ++i) table.values.push_back(i == 0 ? 1 : -1);
  VariantsOptions how = options(1, 4);
  std::vector<std::size_t> order;
  VariantsControl control;
  control.on_result = [&order](const VariantResult& one) {
    if (one.index == 0) std::this_thread::sleep_for(std::chrono::milliseconds(50));
    order.push_back(one.index);
  };
  EXPECT_EQ(simulate_variants(read_model(kPushed), table, how, control), 40u);
  ASSERT_EQ(order.size(), 40u);
  for (std::size_t i = 0; i < order.size(); ++i) EXPECT_EQ(order[i], i);
}

TEST(VariantsTest, AStopKeepsWhatIsToldAndTellsNothingMore) {
  ParameterTable table;
  table.names = {"f"};
  table.values.assign(1000, 1);
  std::atomic<bool> stop = false;
  std::size_t told = 0;
  VariantsControl control;
  control.stop = &stop;
  control.on_result = [&](const VariantResult&) { stop = ++told >= 5; };
  const std::size_t done = simulate_variants(read_model(kPushed), table, options(1, 2), control);
  EXPECT_EQ(done, told);
  EXPECT_GE(done, 5u);
  EXPECT_LT(done, 20u);
}

// While the first variant swings, the others, which are no models, come as far ahead of it as they may.
TEST(VariantsTest, AStopEndsAlsoThoseThatWaitForAnEarlierVariant) {
  const Model model = read_model(R"(ferrers: 1
parameters: {m: 2 kg}
bodies: {b: {mass: = m, com: [1, 0, 0]}}
joints: {g: {type: revolute, bodies: [ground, b], at: [0, 0, 0], axis: y}}
)");
  ParameterTable table;
  table.names = {"m"};
  table.values.assign(20000, -1);
  table.values[0] = 1;
  std::atomic<bool> stop = false;
  VariantsControl control;
  control.stop = &stop;
  std::thread stopper([&stop] {
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    stop = true;
  });
  EXPECT_EQ(simulate_variants(model, table, options(1e6, 3), control), 0u);
  stopper.join();
}

TEST(VariantsTest, RowsBeforeTheFirstAreLeftOut) {
  VariantsOptions how = options(1);
  how.first = 2;
  const std::vector<VariantResult> results = all_of(read_model(kPushed), {{"f"}, {1, 2, 3, 4}}, how);
  ASSERT_EQ(results.size(), 2u);
  EXPECT_EQ(results[0].index, 2u);
  how.first = 4;
  EXPECT_THAT(all_of(read_model(kPushed), {{"f"}, {1, 2, 3, 4}}, how), IsEmpty());
  how.first = 5;
  EXPECT_THROW(simulate_variants(read_model(kPushed), {{"f"}, {1}}, how, {}), std::invalid_argument);
}

TEST(VariantsTest, WhatACallbackThrowsComesBackAndNoThreadWaitsForEver) {
  ParameterTable table;
  table.names = {"f"};
  table.values.assign(20000, 1);  // more than may wait for their turn
  VariantsControl control;
  control.on_result = [](const VariantResult&) { throw std::runtime_error("no room"); };
  EXPECT_THROW(simulate_variants(read_model(kPushed), table, options(0.001, 3), control), std::runtime_error);
}

TEST(VariantsTest, OnlyStepsThatAdaptDoWithoutRowsBetween) {
  const OutputGrid usual{10, 0.01};
  SimulationOptions simulation;
  EXPECT_EQ(last_row_grid(simulation, usual).every, 10);
  simulation.integrator = Integrator::kConstantAcceleration;
  EXPECT_EQ(last_row_grid(simulation, usual).every, 0.01);
  simulation.integrator = Integrator::kRungeKutta4;
  simulation.step = 0.001;
  EXPECT_EQ(last_row_grid(simulation, usual).every, 0.01);
  EXPECT_EQ(last_row_grid({}, {0, 0.01}).every, 0.01);
}

}  // namespace
}  // namespace ferrers
