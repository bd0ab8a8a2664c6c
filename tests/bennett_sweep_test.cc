// Bennett's linkage with an error of 10^-k m in one length, k = 1 … 15: where a mechanism ends and a contradiction or a
// structure begins cannot be told sharply, so the answer has to pass through a doubt, once, and in one direction.
//
// Two forms. Drawn: one point of the drawing is moved; the loop closes as drawn and is a structure that blends into the
// mechanism. Body-fixed: one link is longer by itself; the loop does not close.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "ferrers/io/model_reader.h"
#include "ferrers/redundancy/analysis.h"
#include "ferrers/redundancy/contradiction.h"

namespace ferrers {
namespace {

namespace fs = std::filesystem;

const fs::path kFolder = fs::path(FERRERS_SOURCE_DIR) / "examples" / "bennett";
constexpr int kLargest = 15;

enum class Form { kDrawn, kBodyFixed };

/// The model file and the parameter that make one perturbed linkage.
struct Perturbed {
  std::string file, parameter;
};

std::shared_ptr<const Model> read(const std::string& file, const std::string& parameter) {
  ReadModelOptions options;
  if (!parameter.empty()) options.parameter_texts = {parameter};
  ModelReadResult result = read_model_file(file, options);
  if (!result.model) {
    ADD_FAILURE() << file << " " << parameter;
    return nullptr;
  }
  return std::make_shared<const Model>(std::move(*result.model));
}

double parameter_value(const Model& model, const std::string& name) {
  for (const Parameter& parameter : model.parameters()) {
    if (parameter.name == name) return parameter.value;
  }
  ADD_FAILURE() << name;
  return 0;
}

Perturbed perturbed(Form form, double error) {
  if (form == Form::kBodyFixed) {
    return {(kFolder / "model-perturbed.yaml").string(), fmt::format("error={:.17g}", error)};
  }
  const std::string file = (kFolder / "model.yaml").string();
  return {file, fmt::format("x3={:.17g}", parameter_value(*read(file, ""), "x3") + error)};
}

enum class Reading { kStructureOrContradiction, kMechanism };

struct Outcome {
  Reading reading = Reading::kStructureOrContradiction, other = reading;
  bool confident = false;
  bool closes = false;
  std::string text() const {
    return fmt::format("{} {}, {}", closes ? "closes," : "open,", reading == Reading::kMechanism ? "mechanism" : "none",
                       confident ? "sure" : "in doubt");
  }
  /// 0 surely none, 1 in doubt, 2 surely a mechanism.
  int place() const { return confident ? (reading == Reading::kMechanism ? 2 : 0) : 1; }
};

Reading reading_of(const System& system, int rank) {
  return system.nv - rank > 0 ? Reading::kMechanism : Reading::kStructureOrContradiction;
}

Outcome judge(const System& system, const AssemblyResult& assembly) {
  const ContradictionReport contradiction = analyze_contradiction(system, assembly);
  Outcome out;
  EXPECT_NE(contradiction.verdict, ClosureVerdict::kNotFound);
  EXPECT_NE(contradiction.verdict, ClosureVerdict::kElastic);
  out.closes = contradiction.verdict == ClosureVerdict::kCloses;
  if (!out.closes) {
    out.confident = contradiction.confident;
    out.other = out.confident ? out.reading : reading_of(system, contradiction.if_closed.rank);
    return out;
  }
  const RedundancyReport report = analyze_redundancy(system, contradiction.state, {.blur = contradiction.blur});
  out.confident = contradiction.confident && report.decision.confident;
  out.reading = reading_of(system, report.decision.rank);
  out.other = reading_of(system, report.decision.other_rank);
  EXPECT_EQ(report.redundant, out.reading == Reading::kMechanism ? 3 : 2);
  return out;
}

std::shared_ptr<const System> make_perturbed(Form form, int k) {
  const Perturbed model = perturbed(form, std::pow(10.0, -k));
  return make_system(read(model.file, model.parameter));
}

class BennettSweepTest : public testing::TestWithParam<Form> {};

TEST_P(BennettSweepTest, PassesFromNoMechanismThroughDoubtToAMechanismAndNeverBack) {
  int doubts = 0, last = 0;
  for (int k = 1; k <= kLargest; ++k) {
    const auto system = make_perturbed(GetParam(), k);
    const Outcome outcome = judge(*system, assemble(*system));
    SCOPED_TRACE(fmt::format("k = {}: {}", k, outcome.text()));
    EXPECT_GE(outcome.place(), k == kLargest ? 2 : last);
    EXPECT_LE(outcome.place(), k <= 2 ? 0 : 2);
    last = outcome.place();
    doubts += outcome.confident ? 0 : 1;
    EXPECT_EQ(outcome.confident, outcome.reading == outcome.other);  // in doubt, both readings are given
    EXPECT_EQ(outcome.closes, GetParam() == Form::kDrawn || k >= 10);
  }
  EXPECT_GE(doubts, 1);
  EXPECT_LE(doubts, 6);
}

TEST_P(BennettSweepTest, TheErrorsSignAndTheCutMakeNoDifference) {
  for (int k = 1; k <= kLargest; ++k) {
    std::vector<int> places;
    for (const double sign : {1.0, -1.0}) {
      const Perturbed model = perturbed(GetParam(), sign * std::pow(10.0, -k));
      const auto made = read(model.file, model.parameter);
      for (int cut = 0; cut < 4; ++cut) {
        TopologyOptions options;
        options.cut.assign(4, false);
        options.cut[static_cast<std::size_t>(cut)] = true;
        const auto system = make_system(made, options);
        places.push_back(judge(*system, assemble(*system)).place());
      }
    }
    for (const int place : places) EXPECT_EQ(place, places.front()) << "k = " << k;
  }
}

// The crank is turned step by step and the loop follows as well as it can. The misclosure belongs to the geometry, not
// to the pose: told once, the reading is the same all the way, and what is sure at the start stays sure.
TEST_P(BennettSweepTest, TheReadingDoesNotFlickerAlongTheMotion) {
  for (int k = 8; k <= kLargest; ++k) {
    const auto system = make_perturbed(GetParam(), k);
    const AssemblyResult assembly = assemble(*system);
    const ContradictionReport contradiction = analyze_contradiction(*system, assembly);
    const Scaling& scaling = system->scaling;
    const CoordinateAccess crank = system->access({*system->model->find_joint("H1"), 0});
    ASSERT_TRUE(crank.in_tree);
    State state = assembly.state;
    const double start = state.q[crank.q];
    const bool sure = analyze_redundancy(*system, state, {.blur = contradiction.blur}).decision.confident;
    for (int step = 0; step <= 60; ++step) {
      state.q[crank.q] = start + 0.05 * step;
      int iterations = 0;
      const double residual = close_loops(*system, scaling, {crank.v}, 60, state, iterations);
      ASSERT_LT(residual, 10 * std::pow(10.0, -k) + 1e-14) << "k = " << k << " step " << step;
      const RedundancyReport report = analyze_redundancy(*system, state, {.blur = contradiction.blur});
      EXPECT_EQ(report.redundant, 3) << "k = " << k << " step " << step;
      EXPECT_TRUE(report.decision.confident || !sure) << "k = " << k << " step " << step;
    }
  }
}

struct CommandResult {
  int exit_code = -1;
  nlohmann::ordered_json report;
};

CommandResult run_analyze(const Perturbed& model) {
  const fs::path out = fs::temp_directory_path() / fmt::format("ferrers-sweep-{}.json", getpid());
  const std::string line = fmt::format("'{}' analyze '{}' -p {} --json >'{}' 2>/dev/null", FERRERS_COMMAND, model.file,
                                       model.parameter, out.string());
  const int status = std::system(line.c_str());
  CommandResult result;
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  std::ifstream in(out);
  result.report = nlohmann::ordered_json::parse(in, nullptr, /*allow_exceptions=*/false);
  fs::remove(out);
  return result;
}

TEST_P(BennettSweepTest, TheCommandTellsTheSame) {
  for (int k = 1; k <= kLargest; ++k) {
    SCOPED_TRACE(fmt::format("k = {}", k));
    const auto system = make_perturbed(GetParam(), k);
    const Outcome outcome = judge(*system, assemble(*system));
    const CommandResult run = run_analyze(perturbed(GetParam(), std::pow(10.0, -k)));
    ASSERT_EQ(run.exit_code, outcome.closes ? 0 : 4);
    ASSERT_TRUE(run.report.is_object());
    EXPECT_EQ(run.report.at("ok"), outcome.closes);
    if (!outcome.closes) {
      EXPECT_EQ(run.report.at("diagnostics").at(0).at("code"), "F510");
      EXPECT_EQ(run.report.at("assembly"), "contradictory");
    }
    EXPECT_EQ(run.report.at("certainty").at("confident"), outcome.confident);
    if (!outcome.closes) continue;  // its mobility is that of the best fit
    EXPECT_EQ(run.report.at("mobility"), outcome.reading == Reading::kMechanism ? 1 : 0);
  }
}

INSTANTIATE_TEST_SUITE_P(Forms, BennettSweepTest, testing::Values(Form::kDrawn, Form::kBodyFixed),
                         [](const auto& form) { return form.param == Form::kDrawn ? "Drawn" : "BodyFixed"; });

}  // namespace
}  // namespace ferrers
