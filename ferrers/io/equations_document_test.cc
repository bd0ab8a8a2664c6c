#include "ferrers/io/equations_document.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>

#include "ferrers/testing/engine_probe.h"
#include "ferrers/testing/json_schema.h"
#include "ferrers/testing/zoo.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers {
namespace {

using nlohmann::ordered_json;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

const witness::JsonSchema& schema() {
  static const witness::JsonSchema read = [] {
    std::ifstream stream(std::string(FERRERS_SOURCE_DIR) + "/schemas/equations.schema.json");
    return witness::JsonSchema(nlohmann::json::parse(stream));
  }();
  return read;
}

struct Told {
  EquationsReport report;
  ordered_json json;
  std::string latex;
};

Told tell(const ModelSpec& spec, EquationsProblem problem = EquationsProblem::kForward) {
  const witness::EngineProbe probe(spec);
  Told told;
  told.report = analyze_equations(probe.dynamics, probe.start(), problem);
  EquationsDocument document;
  document.model = spec.name;
  document.dynamics = probe.dynamics.get();
  document.report = &told.report;
  const std::string text = write_equations_json(document);
  EXPECT_EQ(text.back(), '\n');
  EXPECT_THAT(schema().faults(nlohmann::json::parse(text)), IsEmpty());
  told.json = ordered_json::parse(text);
  told.latex = write_equations_latex(document);
  return told;
}

TEST(EquationsDocumentTest, WhatIsNotKnownIsNull) {
  Diagnostics diagnostics;
  diagnostics.error("F101", {}, "no such file");
  EquationsDocument document;
  document.diagnostics = &diagnostics;
  const std::string text = write_equations_json(document);
  EXPECT_THAT(schema().faults(nlohmann::json::parse(text)), IsEmpty());
  const ordered_json json = ordered_json::parse(text);
  EXPECT_EQ(json.at("ok"), false);
  for (const char* key : {"model", "status", "n", "G", "M", "lambda", "residuals", "certainty"}) {
    EXPECT_TRUE(json.at(key).is_null()) << key;
  }
  EXPECT_EQ(json.at("diagnostics").at(0).at("code"), "F101");
}

TEST(EquationsDocumentTest, TheObjectHoldsTheReportNumberByNumber) {
  const Told told = tell(witness::make_driven_four_bar(), EquationsProblem::kInverse);
  const ordered_json& json = told.json;
  const EquationsReport& report = told.report;
  EXPECT_EQ(json.at("schema"), "ferrers.equations/1");
  EXPECT_EQ(json.at("ok"), true);
  EXPECT_EQ(json.at("problem"), "inverse");
  EXPECT_EQ(json.at("status"), "solved");
  EXPECT_EQ(json.at("n"), 3);
  EXPECT_EQ(json.at("m"), 5);
  EXPECT_EQ(json.at("r"), 2);
  EXPECT_EQ(json.at("w"), 1);
  EXPECT_EQ(json.at("equations"), 9);
  EXPECT_EQ(json.at("certainty").at("confident"), true);
  EXPECT_EQ(json.at("excluded_rows").size(), 3u);
  ASSERT_EQ(json.at("G").size(), 5u);
  for (int i = 0; i < 5; ++i) {
    for (int k = 0; k < 3; ++k) EXPECT_EQ(json.at("G").at(i).at(k), report.equations.constraints.G(i, k));
  }
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) EXPECT_EQ(json.at("M").at(i).at(k), report.equations.M(i, k));
    EXPECT_EQ(json.at("h").at(i), report.equations.h[i]);
    EXPECT_EQ(json.at("B").at(i).at(0), report.equations.B_transposed(0, i));
    EXPECT_EQ(json.at("vdot").at(i), report.vdot[i]);
  }
  EXPECT_EQ(json.at("u").at(0), report.u[0]);
  EXPECT_EQ(json.at("drives").at(0).at("from"), "found");
  EXPECT_EQ(json.at("drives").at(0).at("unit"), "N·m");
  ASSERT_EQ(json.at("residuals").size(), 4u);
  EXPECT_EQ(json.at("residuals").at(3).at("says"), "M vdot + h = tau + B u + G^T lambda");
}

TEST(EquationsDocumentTest, AnUndeterminedMultiplierHasNoValueAnywhereButUnderItsOwnName) {
  const Told told = tell(witness::make_parallel_cranks());
  int undetermined = 0;
  for (const ordered_json& one : told.json.at("lambda")) {
    EXPECT_EQ(one.at("value").is_null(), one.at("status") == "undetermined") << one;
    undetermined += one.at("status") == "undetermined" ? 1 : 0;
  }
  EXPECT_EQ(undetermined, told.report.m);
  EXPECT_EQ(told.json.at("lambda_of_independent_rows_with_excluded_zero").size(), 10u);
  EXPECT_THAT(told.latex, HasSubstr("\\texttt{tip2/force\\_y} & $\\text{?}$"));
  EXPECT_THAT(told.latex, HasSubstr("one choice of many"));
}

TEST(EquationsDocumentTest, EveryStatusFitsTheSchema) {
  const Told undriven = tell(witness::make_four_bar(witness::FourBarJoints::kRevolute), EquationsProblem::kInverse);
  EXPECT_EQ(undriven.json.at("status"), "bad_motion");
  EXPECT_EQ(undriven.json.at("ok"), false);
  EXPECT_TRUE(undriven.json.at("M").is_null());
  EXPECT_FALSE(undriven.json.at("message").is_null());
  ModelSpec weightless;
  weightless.name = "weightless";
  weightless.bodies = {witness::rod_body("rod", witness::Point::Zero(), witness::Point(1, 0, 0), 0)};
  weightless.joints = {witness::joint(JointType::kRevolute, "pivot", "ground", "rod", witness::Point::Zero())};
  const Told singular = tell(weightless);
  EXPECT_EQ(singular.json.at("status"), "singular_mass");
  EXPECT_TRUE(singular.json.at("vdot").is_null());
  EXPECT_EQ(singular.json.at("M").size(), 1u);
  EXPECT_THAT(singular.latex, HasSubstr("No solution"));
}

TEST(EquationsDocumentTest, TheSchemaRefusesWhatIsNotOfIt) {
  nlohmann::json json = nlohmann::json::parse(tell(witness::make_driven_four_bar()).json.dump());
  EXPECT_THAT(schema().faults(json), IsEmpty());
  for (const auto& [key, value] : std::map<std::string, nlohmann::json>{
           {"n", 1.5}, {"G", "none"}, {"status", "fine"}, {"extra", 1}, {"lambda", nlohmann::json::array({1})}}) {
    nlohmann::json wrong = json;
    wrong[key] = value;
    EXPECT_THAT(schema().faults(wrong), Not(IsEmpty())) << key;
  }
  json.erase("tau");
  EXPECT_THAT(schema().faults(json), Not(IsEmpty()));
}

// What LaTeX would stumble over: braces and environments that do not match, rows of another length, bare underscores.
TEST(EquationsDocumentTest, TheLatexIsBalanced) {
  for (const ModelSpec& spec : {witness::make_parallel_cranks(), witness::make_excavator()}) {
    const std::string latex = tell(spec).latex;
    EXPECT_THAT(latex, HasSubstr("\\begin{document}"));
    std::vector<std::string> open;
    static const std::regex mark("\\\\(begin|end)\\{(\\w+)\\}");
    for (std::sregex_iterator it(latex.begin(), latex.end(), mark), last; it != last; ++it) {
      if ((*it)[1] == "begin") {
        open.push_back((*it)[2]);
      } else {
        ASSERT_FALSE(open.empty());
        EXPECT_EQ(open.back(), (*it)[2]);
        open.pop_back();
      }
    }
    EXPECT_THAT(open, IsEmpty());
    int depth = 0;
    for (std::size_t i = 0; i < latex.size(); ++i) {
      const bool escaped = i > 0 && latex[i - 1] == '\\';
      if (escaped) continue;
      depth += latex[i] == '{' ? 1 : latex[i] == '}' ? -1 : 0;
      ASSERT_GE(depth, 0);
    }
    EXPECT_EQ(depth, 0);
    static const std::regex matrix("\\\\begin\\{bmatrix\\}\n([^\\[]*?)\\\\end\\{bmatrix\\}");
    int matrices = 0;
    for (std::sregex_iterator it(latex.begin(), latex.end(), matrix), last; it != last; ++it, ++matrices) {
      std::istringstream rows((*it)[1].str());
      std::ptrdiff_t columns = -1;
      for (std::string row; std::getline(rows, row);) {
        const std::ptrdiff_t here = std::count(row.begin(), row.end(), '&') + 1;
        EXPECT_LE(here, 10);
        EXPECT_TRUE(columns < 0 || here == columns) << row;
        columns = here;
      }
    }
    EXPECT_GE(matrices, 2);
  }
}

TEST(EquationsDocumentTest, AFragmentIsTheDocumentsBody) {
  const witness::EngineProbe probe(witness::make_driven_four_bar());
  const EquationsReport report = analyze_equations(probe.dynamics, probe.start());
  EquationsDocument document;
  document.model = "four_bar";
  document.dynamics = probe.dynamics.get();
  document.report = &report;
  const std::string fragment = write_equations_latex(document, false), whole = write_equations_latex(document);
  EXPECT_THAT(whole, HasSubstr(fragment));
  EXPECT_THAT(fragment, Not(HasSubstr("documentclass")));
  EXPECT_THAT(fragment, HasSubstr("four\\_bar"));
}

}  // namespace
}  // namespace ferrers
