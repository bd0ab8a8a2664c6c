#include "ferrers/io/rest_report.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "ferrers/testing/engine_probe.h"
#include "ferrers/testing/zoo.h"

namespace ferrers {
namespace {

using nlohmann::ordered_json;

TEST(RestReportTest, WhatIsNotKnownIsNull) {
  Diagnostics diagnostics;
  diagnostics.error("F101", {}, "no such file");
  RestDocument rest;
  rest.diagnostics = &diagnostics;
  LinearizationDocument linear;
  linear.diagnostics = &diagnostics;
  for (const std::string& text : {write_rest_json(rest), write_linearization_json(linear)}) {
    const ordered_json json = ordered_json::parse(text);
    EXPECT_EQ(json.at("ok"), false);
    EXPECT_TRUE(json.at("model").is_null());
    EXPECT_TRUE(json.at("status").is_null());
    EXPECT_TRUE(json.at("stability").is_null());
    EXPECT_EQ(json.at("diagnostics").at(0).at("code"), "F101");
    EXPECT_EQ(text.back(), '\n');
  }
}

TEST(RestReportTest, AnEquilibriumIsToldWithItsReactions) {
  const witness::EngineProbe probe(witness::make_door(2));
  const EquilibriumResult rest = solve_equilibrium(*probe.dynamics, probe.start());
  const auto reactions = compute_rest_reactions(probe.dynamics, rest, ReactionAxes::kWorld, {});
  RestDocument document;
  document.model = "door";
  document.dynamics = probe.dynamics.get();
  document.equilibrium = &rest;
  document.reactions = &reactions;
  const ordered_json json = ordered_json::parse(write_rest_json(document));
  EXPECT_EQ(json.at("schema"), "ferrers.equilibrium/1");
  EXPECT_EQ(json.at("ok"), true);
  EXPECT_EQ(json.at("stability").at("verdict"), "neutral");
  EXPECT_EQ(json.at("independent_coordinates").at(0), "hinge1.angle");
  const ordered_json& hinge = json.at("reactions").at(0).at("components");
  EXPECT_EQ(hinge.at("force_z").at("status"), "undetermined");
  EXPECT_TRUE(hinge.at("force_z").at("value").is_null());
}

TEST(RestReportTest, ALinearSystemIsToldInFull) {
  const witness::EngineProbe probe(witness::make_scissor_lift(1));
  const Linearization linear = linearize(*probe.dynamics, probe.start());
  LinearizationDocument document;
  document.model = "lift";
  document.dynamics = probe.dynamics.get();
  document.linear = &linear;
  const ordered_json json = ordered_json::parse(write_linearization_json(document));
  EXPECT_EQ(json.at("ok"), true);
  EXPECT_EQ(json.at("A").size(), 2u);
  EXPECT_EQ(json.at("A").at(0), ordered_json::array({0.0, 1.0}));
  EXPECT_EQ(json.at("eigenvalues").size(), 2u);
  EXPECT_EQ(json.at("modes").size(), json.at("frequencies_hz").size());
  EXPECT_EQ(json.at("modes").at(0).at("shape").size(), 7u);
  EXPECT_EQ(json.at("in_equilibrium"), false);
  EXPECT_TRUE(json.at("stability").is_null());
}

}  // namespace
}  // namespace ferrers
