#include "ferrers/redundancy/contradiction.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "ferrers/redundancy/joint_jacobian.h"
#include "ferrers/redundancy/preload.h"
#include "ferrers/testing/random_mechanism.h"
#include "ferrers/testing/transforms.h"
#include "ferrers/testing/zoo.h"
#include "ferrers/testing/zoo_contradictory.h"

namespace ferrers {
namespace {

using witness::make_arm_on_rods;
using witness::make_bennett_links;
using witness::make_door_with_odd_hinge;
using witness::make_plate_on_skew_guides;

std::shared_ptr<const System> built(const ModelSpec& spec, int cut = -1) {
  const ModelBuildResult result = build_model(spec);
  for (const Diagnostic& d : result.diagnostics.items()) {
    if (d.severity == Severity::kError) ADD_FAILURE() << spec.name << ": " << d.code << " " << d.message;
  }
  TopologyOptions options;
  if (cut >= 0) {
    options.cut.assign(spec.joints.size(), false);
    options.cut[static_cast<std::size_t>(cut)] = true;
  }
  return make_system(result.model.value(), options);
}

ContradictionReport judged(const System& system) { return analyze_contradiction(system, assemble(system)); }
ContradictionReport judged(const ModelSpec& spec, int cut = -1) { return judged(*built(spec, cut)); }

std::vector<std::string> joints_of(const Contradiction& contradiction) {
  std::vector<std::string> names;
  for (const JointGap& gap : contradiction.joints) names.push_back(gap.joint);
  return names;
}

const std::vector<std::string> kBennettJoints = {"J1", "J2", "J3", "J4"};

TEST(ContradictionTest, BennettsLinkageWithASideAMicrometreTooLongContradictsItself) {
  const ContradictionReport report = judged(make_bennett_links(1e-6));
  EXPECT_EQ(report.verdict, ClosureVerdict::kContradictory);
  EXPECT_TRUE(report.confident);
  ASSERT_EQ(report.contradictions.size(), 1u);
  EXPECT_EQ(joints_of(report.contradictions[0]), kBennettJoints);
  EXPECT_FALSE(report.contradictions[0].angular);
  // Nearly all of the error is missed where the loop is loaded most; the four joints share it in the least squares.
  EXPECT_GT(report.contradictions[0].misclosure, 5e-7);
  EXPECT_LT(report.contradictions[0].misclosure, 1e-6);
  EXPECT_GT(report.residual_m, 2e-7);
  EXPECT_LT(report.residual_m, 6e-7);
  // Closed it would be the mobile linkage.
  EXPECT_EQ(report.if_closed.rank, 2);
  EXPECT_TRUE(report.if_closed.confident);
  EXPECT_EQ(report.mobility_if_closed, 1);
  EXPECT_EQ(report.redundant_if_closed, 3);
  EXPECT_NE(report.text.find("'J1', 'J2', 'J3' and 'J4'"), std::string::npos) << report.text;
  EXPECT_NE(report.text.find(length_text(report.contradictions[0].misclosure)), std::string::npos) << report.text;
  EXPECT_FALSE(report.hint.empty());
}

TEST(ContradictionTest, TheMisclosureIsProportionalToTheError) {
  const double unit = judged(make_bennett_links(1e-6)).residual_m / 1e-6;
  for (const double error : {1e-3, 1e-4, 1e-5, 1e-7, -1e-6}) {
    EXPECT_NEAR(judged(make_bennett_links(error)).residual_m / std::abs(error) / unit, 1, 0.2 * std::abs(error) + 1e-5)
        << error;
  }
}

// The same number by another road: all joints' rows on the velocities of all bodies, no tree.
TEST(ContradictionTest, TheMisclosureIsWhatNoDisplacementOfTheBodiesRemoves) {
  const auto system = built(make_bennett_links(1e-6));
  const ContradictionReport report = judged(*system);
  const Scaling& scaling = system->scaling;
  const AllRows rows = make_all_rows(*system, scaling);
  const MatrixXd G = compute_scaled_joint_jacobian(*system, report.state, rows, scaling.length_m);
  const RankAnalysis analysis = analyze_rank(G, 0, report.blur);
  ASSERT_EQ(analysis.decision.rank, 17);
  VectorXd phi = VectorXd::Zero(rows.size());
  for (int r = 0; r < rows.size(); ++r) {
    if (rows.closure_row[r] >= 0) phi[r] = rows.scale[r] * report.misfit[rows.closure_row[r]];
  }
  EXPECT_NEAR((analysis.left_null.transpose() * phi).norm() / report.residual_m, 1, 1e-6);
  // and the self-stress is one, but for the blur
  const VectorXd z = rows.scale.cwiseInverse().cwiseProduct(report.contradictions[0].self_stress);
  EXPECT_LT((G.transpose() * z).norm() / z.norm(), 10 * report.blur);
  EXPECT_NEAR(z.dot(phi) / report.contradictions[0].misclosure, 1, 1e-6);
}

TEST(ContradictionTest, TheVerdictDoesNotDependOnCutsAxesUnitsOrOrder) {
  const ModelSpec spec = make_bennett_links(1e-6);
  const ContradictionReport one = judged(spec);
  const auto expect_same = [&](const ContradictionReport& other, double scale, const std::string& what) {
    EXPECT_EQ(other.verdict, one.verdict) << what;
    EXPECT_EQ(other.confident, one.confident) << what;
    ASSERT_EQ(other.contradictions.size(), 1u) << what;
    EXPECT_NEAR(other.residual_m / scale / one.residual_m, 1, 1e-5) << what;
    EXPECT_NEAR(other.contradictions[0].misclosure / scale / one.contradictions[0].misclosure, 1, 1e-4) << what;
    std::vector<std::string> names = joints_of(other.contradictions[0]);
    std::sort(names.begin(), names.end());
    EXPECT_EQ(names, kBennettJoints) << what;
    EXPECT_EQ(other.if_closed.rank, one.if_closed.rank) << what;
  };
  for (int cut = 0; cut < 4; ++cut) expect_same(judged(spec, cut), 1, "cut " + std::to_string(cut));
  for (const double scale : {1e-3, 1e3}) expect_same(judged(witness::scaled(spec, scale)), scale, "scaled");
  const Eigen::Matrix3d R = Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
  expect_same(judged(witness::rotated(spec, R)), 1, "rotated");
  expect_same(judged(witness::shifted(spec, {3, -2, 5})), 1, "shifted");
  for (int seed = 1; seed <= 3; ++seed) expect_same(judged(witness::permuted(spec, seed)), 1, "permuted");
}

TEST(ContradictionTest, TwoRodsOfDifferentLengthBetweenTheSamePlacesQuarrelAlone) {
  const double exact = std::hypot(1.0, 2.0);
  const ContradictionReport report = judged(make_arm_on_rods({{0, 2, 0}, {0, 2, 0}}, {exact, exact + 3e-4}));
  EXPECT_EQ(report.verdict, ClosureVerdict::kContradictory);
  EXPECT_TRUE(report.confident);
  ASSERT_EQ(report.contradictions.size(), 1u);
  EXPECT_EQ(joints_of(report.contradictions[0]), (std::vector<std::string>{"rod0", "rod1"}));  // the pin is clean
  EXPECT_NEAR(report.contradictions[0].misclosure, 3e-4, 1e-10);
  for (const JointGap& gap : report.contradictions[0].joints) EXPECT_NEAR(gap.gap_m, 1.5e-4, 1e-10) << gap.joint;
  EXPECT_NEAR(report.residual_m, 3e-4 / std::sqrt(2), 1e-10);
}

TEST(ContradictionTest, HingesOffOneAnotherMissByTheOffset) {
  for (const double offset : {1e-6, 1e-3, 0.02}) {
    const ContradictionReport report = judged(make_door_with_odd_hinge(offset, 0));
    EXPECT_EQ(report.verdict, ClosureVerdict::kContradictory) << offset;
    ASSERT_EQ(report.contradictions.size(), 1u) << offset;
    EXPECT_EQ(joints_of(report.contradictions[0]), (std::vector<std::string>{"lower", "upper"}));
    EXPECT_NEAR(report.contradictions[0].misclosure / offset, 1, 0.02) << offset;
    // 2 cm off blur everything: what would be if it closed is not claimed then.
    EXPECT_EQ(report.if_closed.confident, offset < 1e-4) << offset;
    EXPECT_EQ(report.text.find("if it closed") != std::string::npos, report.if_closed.confident) << report.text;
    if (!report.if_closed.confident) continue;
    EXPECT_EQ(report.mobility_if_closed, 1);
    EXPECT_EQ(report.redundant_if_closed, 5);
  }
  const ContradictionReport tilted = judged(make_door_with_odd_hinge(0, 1e-4));
  EXPECT_EQ(tilted.verdict, ClosureVerdict::kContradictory);
  EXPECT_EQ(judged(make_door_with_odd_hinge(0, 0)).verdict, ClosureVerdict::kCloses);
}

TEST(ContradictionTest, APureMisalignmentIsAnAngle) {
  for (const double turn : {1e-6, 1e-3}) {
    const ContradictionReport report = judged(make_plate_on_skew_guides(turn));
    EXPECT_EQ(report.verdict, ClosureVerdict::kContradictory);
    ASSERT_EQ(report.contradictions.size(), 1u);
    EXPECT_TRUE(report.contradictions[0].angular);
    EXPECT_NEAR(report.contradictions[0].misclosure / turn, 1, 1e-5);
    EXPECT_NE(report.text.find(angle_text(turn)), std::string::npos) << report.text;
  }
}

TEST(ContradictionTest, WhatIsOutOfReachIsNoContradiction) {
  for (const double length : {1.0, 0.2}) {  // the tip comes no nearer to the foot than 2 m
    const ContradictionReport report = judged(make_arm_on_rods({{3, 0, 0}}, {length}));
    EXPECT_EQ(report.verdict, ClosureVerdict::kNotFound);
    EXPECT_TRUE(report.contradictions.empty());
    EXPECT_NE(report.text.find("rod0"), std::string::npos) << report.text;
  }
}

TEST(ContradictionTest, EveryDrawnMechanismClosesForSure) {
  for (const witness::ZooEntry& entry : witness::zoo()) {
    const auto system = built(entry.spec);
    const ContradictionReport report = judged(*system);
    EXPECT_EQ(report.verdict, ClosureVerdict::kCloses) << entry.name;
    EXPECT_TRUE(report.confident) << entry.name << " " << report.blur;
    EXPECT_TRUE(report.text.empty()) << entry.name;
    EXPECT_LT(report.moved.distance_m, 1e-9) << entry.name;  // drawn loops close as drawn
    EXPECT_LT(report.moved.angle_rad, 1e-7) << entry.name;
  }
}

TEST(ContradictionTest, RandomMechanismsThatAreDrawnCloseForSure) {
  for (int seed = 1; seed <= 120; ++seed) {
    const witness::RandomMechanism mechanism = witness::make_random_mechanism(static_cast<std::uint64_t>(seed));
    const ContradictionReport report = judged(mechanism.spec);
    EXPECT_EQ(report.verdict, ClosureVerdict::kCloses) << seed << " " << mechanism.description;
    EXPECT_TRUE(report.confident) << seed << " " << mechanism.description << " " << report.blur;
  }
}

// Two quarrels that have nothing to do with one another are told apart.
TEST(ContradictionTest, EveryClusterHasItsOwnMisclosure) {
  ModelSpec spec = make_bennett_links(1e-6);
  ModelSpec arm = make_arm_on_rods({{0, 2, 0}, {0, 2, 0}}, {std::hypot(1.0, 2.0), std::hypot(1.0, 2.0) + 3e-4});
  spec.bodies.insert(spec.bodies.end(), arm.bodies.begin(), arm.bodies.end());
  spec.joints.insert(spec.joints.end(), arm.joints.begin(), arm.joints.end());
  const ContradictionReport report = judged(spec);
  EXPECT_EQ(report.verdict, ClosureVerdict::kContradictory);
  ASSERT_EQ(report.contradictions.size(), 2u);
  EXPECT_EQ(joints_of(report.contradictions[0]), (std::vector<std::string>{"rod0", "rod1"}));
  EXPECT_EQ(joints_of(report.contradictions[1]), kBennettJoints);
  EXPECT_NEAR(report.contradictions[0].misclosure, 3e-4, 1e-9);
  EXPECT_NE(report.text.find("1 more"), std::string::npos) << report.text;
}

TEST(ContradictionTest, TheMoveFromTheDrawingIsTold) {
  const ContradictionReport report = judged(make_arm_on_rods({{2, 0.5, 0}}, {1.6}));
  EXPECT_EQ(report.verdict, ClosureVerdict::kCloses);
  EXPECT_EQ(report.moved.body, "arm");
  EXPECT_GT(report.moved.distance_m, 0.1);
  EXPECT_NEAR(report.moved.distance_m, 2 * std::sin(report.moved.angle_rad / 2), 1e-12);  // 1 m from the pin
}

double force_of(const PreloadReport& preload, const std::string& joint) {
  for (const JointPreload& one : preload.joints) {
    if (one.joint == joint) return Eigen::Vector3d(one.value[0], one.value[1], one.value[2]).norm();
  }
  ADD_FAILURE() << joint;
  return 0;
}

PreloadReport preloaded(const System& system, const ContradictionReport& report) {
  const RedundancyReport redundancy = analyze_redundancy(system, report.state, {.blur = report.blur});
  return analyze_preload(system, report.state, redundancy, report.misfit);
}

// Both rods 5 mm short: the tip stays in the middle and each rod is stretched by them, F = k · 5 mm.
TEST(ElasticAssemblyTest, RodsWithStiffnessTakeUpWhatTheyAreShort) {
  const double exact = std::hypot(1.0, 2.0), k = 1e6;
  ModelSpec spec = make_arm_on_rods({{0, 2, 0}, {0, -2, 0}}, {exact - 0.005, exact - 0.005});
  EXPECT_EQ(judged(spec).verdict, ClosureVerdict::kContradictory);
  for (JointSpec& joint : spec.joints) {
    if (joint.type != JointType::kDistance) continue;
    joint.stiffness = StiffnessSpec{number3(k, k, k), std::nullopt, {}};
  }
  const auto system = built(spec);
  const ContradictionReport report = judged(*system);
  ASSERT_EQ(report.verdict, ClosureVerdict::kElastic) << report.text;
  ASSERT_EQ(report.contradictions.size(), 1u);
  for (const JointGap& gap : report.contradictions[0].joints) {
    EXPECT_NEAR(gap.gap_m, gap.joint == "pin" ? 0 : 0.005, 1e-9) << gap.joint;  // the pin is rigid
  }
  const PreloadReport preload = preloaded(*system, report);
  ASSERT_EQ(preload.status, PreloadStatus::kSolved);
  EXPECT_NEAR(force_of(preload, "rod0"), k * 0.005, 1e-3);
  EXPECT_NEAR(force_of(preload, "rod1"), k * 0.005, 1e-3);
  EXPECT_NEAR(force_of(preload, "pin"), 2 * k * 0.005 / exact, 1e-3);  // both pull the tip towards x = 0
}

TEST(ElasticAssemblyTest, StiffnessOutsideTheQuarrelIsInVain) {
  const double exact = std::hypot(1.0, 2.0);
  ModelSpec spec = make_arm_on_rods({{0, 2, 0}, {0, 2, 0}}, {exact, exact + 1e-3});
  spec.joints[0].stiffness = StiffnessSpec{number3(1e6, 1e6, 1e6), number3(1e4, 1e4, 1e4), {}};
  const ContradictionReport report = judged(spec);
  EXPECT_EQ(report.verdict, ClosureVerdict::kContradictory);
  EXPECT_TRUE(report.stiffness_in_vain);
  EXPECT_NE(report.hint.find("stiffness"), std::string::npos);
}

// Bending stiffness alone does not let a hinge shift along its axis.
TEST(ElasticAssemblyTest, StiffnessInOtherComponentsIsInVain) {
  ModelSpec spec = make_plate_on_skew_guides(1e-3);
  const double rigid = std::numeric_limits<double>::infinity();
  for (JointSpec& joint : spec.joints) joint.stiffness = StiffnessSpec{number3(1e6, 1e6, 1e6), std::nullopt, {}};
  const ContradictionReport vain = judged(spec);
  EXPECT_EQ(vain.verdict, ClosureVerdict::kContradictory);
  EXPECT_TRUE(vain.stiffness_in_vain);
  for (JointSpec& joint : spec.joints) {
    joint.stiffness = StiffnessSpec{number3(rigid, rigid, rigid), number3(5e4, 5e4, 5e4), {}};
  }
  const auto system = built(spec);
  const ContradictionReport report = judged(*system);
  ASSERT_EQ(report.verdict, ClosureVerdict::kElastic);
  const PreloadReport preload = preloaded(*system, report);
  ASSERT_EQ(preload.status, PreloadStatus::kSolved);
  for (const JointPreload& joint : preload.joints) {  // two torsion springs in series: k turn / 2
    EXPECT_NEAR(Eigen::Vector3d(joint.value[3], joint.value[4], joint.value[5]).norm(), 25.0, 1e-3) << joint.joint;
  }
}

TEST(ElasticAssemblyTest, StressesDoNotDependOnTheCut) {
  ModelSpec spec = make_bennett_links(1e-6);
  for (std::size_t j = 0; j < spec.joints.size(); ++j) {
    const double k = 1e6 * (1 + 0.7 * static_cast<double>(j));
    spec.joints[j].stiffness = StiffnessSpec{number3(k, 2 * k, 0.5 * k), number3(0.1 * k, 0.3 * k, 0.2 * k), {}};
  }
  std::vector<double> first;
  for (int cut = 0; cut < 4; ++cut) {
    const auto system = built(spec, cut);
    const ContradictionReport report = judged(*system);
    ASSERT_EQ(report.verdict, ClosureVerdict::kElastic) << cut;
    EXPECT_TRUE(report.confident);
    const PreloadReport preload = preloaded(*system, report);
    ASSERT_EQ(preload.status, PreloadStatus::kSolved) << cut;
    std::vector<double> forces;
    for (const std::string& joint : kBennettJoints) forces.push_back(force_of(preload, joint));
    if (first.empty()) first = forces;
    for (std::size_t j = 0; j < 4; ++j) {
      EXPECT_GT(forces[j], 1e-3);
      EXPECT_NEAR(forces[j] / first[j], 1, 1e-4) << "cut " << cut << " joint " << j;
    }
  }
}

TEST(ElasticAssemblyTest, OneCompliantHingeIsEnoughForBennett) {
  ModelSpec spec = make_bennett_links(1e-5);
  spec.joints[2].stiffness = StiffnessSpec{number3(1e6, 1e6, 1e6), number3(1e4, 1e4, 1e4), {}};
  const ContradictionReport report = judged(spec);
  EXPECT_EQ(report.verdict, ClosureVerdict::kElastic) << report.text;
  ASSERT_EQ(report.contradictions.size(), 1u);
  for (const JointGap& gap : report.contradictions[0].joints) {
    EXPECT_EQ(gap.gap_m > 1e-10, gap.joint == "J3") << gap.joint;
  }
}

TEST(ContradictionTextTest, LengthsAndAnglesComeInSensibleUnits) {
  EXPECT_EQ(length_text(5.2e-7), "520 nm");
  EXPECT_EQ(length_text(5e-6), "5 µm");
  EXPECT_EQ(length_text(0.003), "3 mm");
  EXPECT_EQ(length_text(1.25), "1.25 m");
  EXPECT_EQ(length_text(0), "0 µm");
  EXPECT_EQ(angle_text(4e-6), "4 µrad");
  EXPECT_EQ(angle_text(0.002), "2 mrad");
}

}  // namespace
}  // namespace ferrers
