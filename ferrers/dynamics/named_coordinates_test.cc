#include "ferrers/dynamics/named_coordinates.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <map>

#include "ferrers/testing/engine_probe.h"
#include "ferrers/testing/zoo.h"

namespace ferrers {
namespace {

TEST(NamedCoordinatesTest, AllJointsAreMeasuredThoseThatCloseLoopsToo) {
  witness::EngineProbe probe(witness::make_scissor_lift(1));
  const State start = probe.start();
  probe.evaluate(start);
  const int driver = probe.selection.independent.at(0);
  VectorXd v = VectorXd::Zero(probe.system->nv);
  v[driver] = 1;
  v(probe.selection.dependent) =
      -VectorXd(probe.eq.constraints.G(probe.selection.rows, probe.selection.dependent)
                    .partialPivLu()
                    .solve(VectorXd(probe.eq.constraints.G(probe.selection.rows, {driver}))));
  std::map<std::string, double> rates;
  for (const NamedCoordinate& one : measure_rates(*probe.system, start, v)) rates[one.name] = one.value;
  EXPECT_EQ(rates.size(), 7u);
  // x = 2 cos θ: the roller goes by −2 sin θ per turn of the first bar, and the upper one alike.
  EXPECT_NEAR(rates.at("bottom_track.displacement") / rates.at("bottom_pin.angle"), -2 * std::sin(0.5), 1e-12);
  EXPECT_NEAR(rates.at("top_track.displacement"), rates.at("bottom_track.displacement"), 1e-12);
  EXPECT_NEAR(rates.at("middle1.angle"), -2 * rates.at("bottom_pin.angle"), 1e-12);
  const std::string named = name_motion(*probe.system, probe.scaling, start, v, "/s");
  EXPECT_NE(named.find("middle1.angle ("), std::string::npos) << named;
  EXPECT_NE(named.find(" rad/s)"), std::string::npos) << named;
}

TEST(NamedCoordinatesTest, PositionsOfABallAreAQuaternion) {
  witness::EngineProbe probe(witness::make_shaft_determinate());
  const auto positions = measure_positions(*probe.system, probe.start());
  ASSERT_GE(positions.size(), 4u);
  EXPECT_EQ(positions[0].name, "fixed.qw");
  EXPECT_EQ(positions[0].value, 1);
  EXPECT_EQ(positions[0].unit, NamedCoordinate::Unit::kNone);
}

}  // namespace
}  // namespace ferrers
