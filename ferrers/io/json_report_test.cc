#include "ferrers/io/json_report.h"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "ferrers/io/model_reader.h"

namespace ferrers {
namespace {

using nlohmann::ordered_json;

/// The report of an example's model, as `ferrers analyze` makes it.
ordered_json report_of(const std::string& example) {
  ModelReadResult read = read_model_file(std::string(FERRERS_SOURCE_DIR) + "/examples/" + example);
  if (!read.model) return nullptr;
  const auto system = make_system(std::move(*read.model));
  const MechanismAnalysis analysis = analyze_mechanism(*system);
  AnalysisDocument document;
  document.model = system->model->name();
  document.analysis = &analysis;
  document.diagnostics = &read.diagnostics;
  return ordered_json::parse(write_analysis_json(document));
}

TEST(JsonReportTest, BricardLinkageIsToldAsPublished) {
  const ordered_json json = report_of("bricard-a04/model.yaml");
  EXPECT_EQ(json.at("schema"), "ferrers.analyze/1");
  EXPECT_EQ(json.at("ok"), true);
  EXPECT_EQ(json.at("bodies"), 5);
  EXPECT_EQ(json.at("constraint_rows"), 30);
  EXPECT_EQ(json.at("rank"), 29);
  EXPECT_EQ(json.at("redundant"), 1);
  EXPECT_EQ(json.at("mobility"), 1);
  EXPECT_EQ(json.at("grubler"), 0);
  EXPECT_EQ(json.at("closure"), ordered_json::parse(R"({"coordinates": 5, "rows": 5, "rank": 4})"));
  EXPECT_EQ(json.at("reactions").size(), 6u);
  for (const auto& reaction : json.at("reactions")) {
    EXPECT_EQ(reaction.at("rows"), 5);
    EXPECT_EQ(reaction.at("unique_rows").size(), 0u);
    EXPECT_EQ(reaction.at("unique_dimension"), 4);
    EXPECT_EQ(reaction.at("participates"), true);
  }
}

/// The self-stress of the linkage is a force (1, 1, 1) with the moment that balances it: two equal forces across every
/// hinge's axis and one along it, and no component that is zero stands in the list.
TEST(JsonReportTest, SelfStressesNameTheRowsThatTheyLoad) {
  const ordered_json json = report_of("bricard-a04/model.yaml");
  ASSERT_EQ(json.at("self_stresses").size(), 1u);
  const auto& rows = json.at("self_stresses").at(0).at("rows");
  for (const char* joint : {"J1", "J2", "J3", "J4", "J5", "J6"}) {
    const auto force = [&](const char* axis) {
      return std::abs(rows.at(std::string(joint) + "/force_" + axis).get<double>());
    };
    EXPECT_NEAR(force("x"), force("y"), 1e-12);
    EXPECT_NEAR(force("x"), force("z"), 1e-12);
    EXPECT_GT(force("x"), 0.01);
  }
  for (const auto& [name, value] : rows.items()) EXPECT_GT(std::abs(value.get<double>()), 1e-6) << name;
}

TEST(JsonReportTest, FullRankHasNoGap) {
  const ordered_json full = report_of("four-bar-rscr/model.yaml");
  EXPECT_EQ(full.at("redundant"), 0);
  EXPECT_TRUE(full.at("certainty").at("gap").is_null());
  const ordered_json deficient = report_of("bricard-a04/model.yaml");
  EXPECT_GT(deficient.at("certainty").at("gap").get<double>(), 1e4);
  EXPECT_LE(deficient.at("certainty").at("gap").get<double>(), 1e16);
}

TEST(JsonReportTest, WithoutAReportEveryFieldIsThereAndNull) {
  const ordered_json known = report_of("bricard-a04/model.yaml");
  Diagnostics diagnostics("file.yaml");
  diagnostics.error("F204", {31, 13, 7}, "'stiffness' wants N/m, got N*m", "a hint");
  diagnostics.warning("F333", {}, "a warning");
  AnalysisDocument document;
  document.diagnostics = &diagnostics;
  const ordered_json json = ordered_json::parse(write_analysis_json(document));
  for (const auto& [key, value] : known.items()) EXPECT_TRUE(json.contains(key)) << key;
  for (const auto& [key, value] : json.items()) {
    if (std::set<std::string>{"schema", "ok", "diagnostics"}.count(key)) continue;
    EXPECT_TRUE(value.is_null()) << key;
  }
  EXPECT_EQ(json.at("ok"), false);
  EXPECT_EQ(json.at("diagnostics"), ordered_json::parse(R"([
    {"code": "F204", "severity": "error", "line": 31, "column": 13,
     "message": "'stiffness' wants N/m, got N*m", "hint": "a hint"},
    {"code": "F333", "severity": "warning", "line": null, "column": null, "message": "a warning", "hint": null}])"));
}

TEST(JsonReportTest, BytesThatAreNoTextDoNotBreakTheObject) {
  Diagnostics diagnostics("file.yaml");
  diagnostics.error("F104", {}, "bad byte \xff here");
  AnalysisDocument document;
  document.diagnostics = &diagnostics;
  EXPECT_TRUE(ordered_json::accept(write_analysis_json(document)));
}

}  // namespace
}  // namespace ferrers
