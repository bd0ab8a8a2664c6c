#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "ferrers/testing/run_probe.h"
#include "ferrers/testing/zoo.h"

/// The rigid benchmarks A01 to A05 of the IFToMM multibody library [gonzalez2006] with the default accuracy.
namespace ferrers::witness {
namespace {

constexpr double kGravity = 9.81;

struct PointAt {
  double t, x, y, z;
};

void expect_points(const ProbedRun& run, const std::string& name, const std::vector<PointAt>& wanted,
                   double tolerance) {
  for (const PointAt& p : wanted) {
    const Vector3d error = run.point(p.t, name) - Vector3d(p.x, p.y, p.z);
    EXPECT_LT(error.cwiseAbs().maxCoeff(), tolerance) << name << " at t = " << p.t << ": off by " << error.transpose();
  }
}

// Closed form, with the Jacobi function cd of parameter 1/2: sin(φ/2) = √½ cd(√g t), P = (sin φ, −cos φ).
TEST(BenchmarksTest, A01ThePendulumFollowsItsEllipticFunctions) {
  const ProbedRun run = probe_run(make_pendulum(), plain_run(10, 0.5));
  ASSERT_EQ(run.summary.status, RunStatus::kFinished) << run.summary.message;
  expect_points(run, "P",
                {{1, -0.9862917511318753, -0.1650108531255412, 0},
                 {5, 0.9423054350437573, -0.3347543384140006, 0},
                 {10, 0.2750874625761169, -0.9614192050991251, 0}},
                1e-9);
  EXPECT_LT(run.energy_drift(), 1e-9);
}

// Closed form on the parallelogram branch: θ'' = (G/I) sin θ, I = (N+1)/3 + N, G = ((N+1)/2 + N) g, integrated to full
// precision from θ = 0, θ' = 1. The cranks pass the horizontal pose, where N more motions open.
TEST(BenchmarksTest, A02TwoFourBarsStayOnTheParallelogramBranch) {
  const ProbedRun run = probe_run(make_n_four_bar(2, 0, 1), plain_run(10, 0.25));
  ASSERT_EQ(run.summary.status, RunStatus::kFinished) << run.summary.message;
  expect_points(run, "B0", {{1, -0.1950203019494351, -0.9807992056621738, 0}}, 1e-8);
  // The upright pose is unstable: errors grow e-fold every 0.26 s near it.
  expect_points(run, "B0",
                {{5, -0.8113104610051074, -0.5846155453489755, 0}, {10, 0.3284581115408154, 0.9445185381786010, 0}},
                1e-6);
  EXPECT_LT(run.energy_drift(), 1e-7);
}

TEST(BenchmarksTest, A02FortyFourBarsPassTheHorizontalPose) {
  const ProbedRun run = probe_run(make_n_four_bar(40, 0, 1), plain_run(1, 0.25));
  ASSERT_EQ(run.summary.status, RunStatus::kFinished) << run.summary.message;
  expect_points(run, "B0", {{1, -0.1153568806321099, -0.9933241113004502, 0}}, 1e-6);
}

// The seven angles of Andrews' mechanism from the joints' angles, which are zero as drawn.
std::array<double, 7> andrews_angles(const ProbedRun& run, double t) {
  const auto angle = [&](const std::string& joint) { return run.at(t, joint + ".angle"); };
  return {-0.0617138900142764496 + angle("O"), angle("F"),
          0.455279819163070380 + angle("B"),   0.222668390165885885 - angle("G"),
          0.487364979543842550 + angle("A5"),  -0.222668390165885885 - angle("H"),
          1.23054744454982120 + angle("A7")};
}

// Converged integrations at two step sizes, good to 1e-12 rad; the published figures at 0.03 s are good to 1e-9.
TEST(BenchmarksTest, A03AndrewsMechanismTurnsAsConverged) {
  const ProbedRun run = probe_run(make_andrews(), plain_run(0.03, 0.01));
  ASSERT_EQ(run.summary.status, RunStatus::kFinished) << run.summary.message;
  const std::array<double, 7> early = {2.160113131531,  -1.883364231107, 0.1585167580012, -0.3286410751747,
                                       0.5251547747977, 0.3286410751747, 1.0684272046324};
  const std::array<double, 7> late = {15.810771195154, -15.756371058412, 0.0408222401196, -0.5347301163421,
                                      0.5244099658800, 0.5347301163421,  1.0480807410419};
  const std::array<double, 7> at_early = andrews_angles(run, 0.01), at_late = andrews_angles(run, 0.03);
  for (int i = 0; i < 7; ++i) {
    EXPECT_NEAR(at_early[i], early[i], 1e-9) << "angle " << i << " at 0.01 s";
    EXPECT_NEAR(at_late[i], late[i], 1e-7) << "angle " << i << " at 0.03 s";
  }
}

// Converged integrations of the loop's exact equation; twelve digits. The bodies are bricks.
TEST(BenchmarksTest, A04TheBricardLoopMovesAndKeepsItsEnergy) {
  const ProbedRun run = probe_run(make_bricard(BricardRods::kBricks), plain_run(10, 0.1));
  ASSERT_EQ(run.summary.status, RunStatus::kFinished) << run.summary.message;
  expect_points(run, "P3",
                {{0.5, 0.774717808039, -0.979815047656, -0.199906158953},
                 {1, 0.274481319265, -0.886707938735, -0.462330002687},
                 {1.5, -0.279017575416, -0.887361378832, -0.461074596305},
                 {2, -0.778135373033, -0.980352683443, -0.197252670617},
                 {5, 0.999932742303, -0.999999997738, -0.000067255435},
                 {10, 0.999730987305, -0.999999963826, -0.000268976511}},
                1e-9);
  EXPECT_LT(run.energy_drift(), 1e-9);
  EXPECT_LT(run.summary.max_constraint_residual, 1e-10);
  ASSERT_FALSE(run.summary.decisions.empty());
  EXPECT_EQ(run.summary.decisions.front().mobility, 1);
  EXPECT_EQ(run.summary.decisions.front().excluded_rows.size(), 1u);
}

TEST(BenchmarksTest, A04ThinRodsMoveALittleFaster) {
  const ProbedRun run = probe_run(make_bricard(BricardRods::kThin), plain_run(10, 0.2));
  ASSERT_EQ(run.summary.status, RunStatus::kFinished) << run.summary.message;
  expect_points(run, "P3",
                {{0.2, 0.96127326395, -0.99927861901, -0.03797685600},
                 {1, 0.273333915810, -0.886544000792, -0.462644285234},
                 {5, 0.99981611871, -0.99999998310, -0.00018386439},
                 {10, 0.99926461009, -0.99999972980, -0.00073511951}},
                1e-9);
  EXPECT_NEAR(std::abs(run.at(0, "J1.angle.acceleration")), 0.2 * kGravity, 1e-10);
}

// Converged integrations; the angular momentum about the free vertical shaft is conserved.
TEST(BenchmarksTest, A05TheFlyballGovernorKeepsItsAngularMomentum) {
  const ModelSpec spec = make_flyball();
  const ProbedRun run = probe_run(spec, plain_run(0.5, 0.1));
  ASSERT_EQ(run.summary.status, RunStatus::kFinished) << run.summary.message;
  EXPECT_NEAR(run.at(0.1, "S.z"), 0.5238364756, 1e-9);
  EXPECT_NEAR(run.at(0.5, "S.z"), 0.7432494248, 1e-9);

  EngineProbe engine(spec);
  const std::array<std::pair<const char*, const char*>, 4> coordinates = {
      {{"spin", ".angle"}, {"hinge_right", ".angle"}, {"hinge_left", ".angle"}, {"slide", ".displacement"}}};
  for (const double t : {0.0, 0.1, 0.2, 0.3, 0.4, 0.5}) {
    State state = make_drawn_state(*engine.system);
    for (const auto& [joint, suffix] : coordinates) {
      const CoordinateAccess access = engine.system->access({*engine.model().find_joint(joint), 0});
      state.q[access.q] = run.at(t, std::string(joint) + suffix);
      state.v[access.v] = run.at(t, std::string(joint) + suffix + ".velocity");
    }
    engine.evaluate(state);
    const int spin = engine.system->access({*engine.model().find_joint("spin"), 0}).v;
    EXPECT_NEAR(engine.eq.M.row(spin) * state.v, 53.868998658418, 1e-9) << t;
  }
}

}  // namespace
}  // namespace ferrers::witness
