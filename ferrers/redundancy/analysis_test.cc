#include "ferrers/redundancy/analysis.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <map>

#include "ferrers/redundancy/joint_jacobian.h"
#include "ferrers/testing/absolute_solver.h"
#include "ferrers/testing/compare.h"
#include "ferrers/testing/random_mechanism.h"
#include "ferrers/testing/random_source.h"
#include "ferrers/testing/transforms.h"
#include "ferrers/testing/zoo.h"

namespace ferrers {
namespace {

using witness::AbsoluteVerdict;
using witness::matrices_near;
using witness::permuted;
using witness::rotated;
using witness::scaled;
using witness::shifted;
using witness::ZooEntry;

constexpr int kSeeds = 220;  // random mechanisms of every property

std::shared_ptr<const System> built(const ModelSpec& spec, const std::vector<bool>& cut = {}) {
  return make_system(*build_model(spec).model, {.cut = cut});
}

RedundancyReport analyze_drawn(const System& system) { return analyze_redundancy(system, make_drawn_state(system)); }

int unique_rows(const RedundancyReport& report) {
  int count = 0;
  for (const ReactionUniqueness& r : report.reactions)
    count += static_cast<int>(std::count(r.unique.begin(), r.unique.end(), true));
  return count;
}

int unique_dimension(const RedundancyReport& report) {
  int sum = 0;
  for (const ReactionUniqueness& r : report.reactions) sum += r.unique_dimension;
  return sum;
}

/// What does not depend on how a mechanism is described: counts, and unique dimensions by joint name.
struct Verdict {
  int rows, rank, mobility, redundant;
  bool confident;
  std::map<std::string, int> unique_dimensions;
  bool operator==(const Verdict&) const = default;
};

Verdict verdict_of(const RedundancyReport& r) {
  Verdict v{r.constraint_rows, r.rank, r.mobility, r.redundant, r.decision.confident, {}};
  for (const ReactionUniqueness& reaction : r.reactions)
    v.unique_dimensions[reaction.joint] = reaction.unique_dimension;
  return v;
}

std::ostream& operator<<(std::ostream& out, const Verdict& v) {
  out << v.rows << " rows, rank " << v.rank << ", mobility " << v.mobility << ", redundant " << v.redundant
      << (v.confident ? ", confident" : ", in doubt") << ", unique dimensions";
  for (const auto& [joint, dimension] : v.unique_dimensions) out << " " << joint << ":" << dimension;
  return out;
}

/// Every property that a report has by itself, at one state.
void expect_consistent(const System& system, const State& state, const RedundancyReport& r, const std::string& what) {
  SCOPED_TRACE(what);
  EXPECT_EQ(r.rank + r.mobility, 6 * r.bodies);
  EXPECT_EQ(r.constraint_rows - r.rank, r.redundant);
  EXPECT_EQ(r.grubler, r.mobility - r.redundant);
  EXPECT_EQ(static_cast<int>(r.selection.rows.size()), r.closure_rank);
  EXPECT_EQ(static_cast<int>(r.selection.dependent.size()), r.closure_rank);
  EXPECT_EQ(static_cast<int>(r.selection.independent.size()), r.mobility);
  EXPECT_EQ(static_cast<int>(r.excluded_rows.size()), r.redundant);
  EXPECT_EQ(r.rows.size(), r.constraint_rows);

  // Self-stresses balance every body, fill the null space, and are unit vectors far from dependent in scaled units.
  const MatrixXd G = compute_scaled_joint_jacobian(system, state, r.rows, r.characteristic_length_m);
  const MatrixXd Z = r.rows.scale.cwiseInverse().asDiagonal() * MatrixXd(r.self_stresses);
  ASSERT_EQ(Z.cols(), r.redundant);
  if (r.redundant > 0) {
    EXPECT_LT((G.transpose() * Z).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_TRUE(matrices_near(Z.colwise().norm(), MatrixXd::Ones(1, r.redundant), 1e-12));
    EXPECT_GT(Eigen::JacobiSVD<MatrixXd>(Z).singularValues().minCoeff(), 0.02);
    for (int k = 0; k < r.redundant; ++k) {  // and each says truly which joints it loads
      std::vector<int> loaded;
      for (int j = 0; j < static_cast<int>(r.reactions.size()); ++j) {
        if (!Z.col(k).segment(r.rows.first[j], r.rows.count[j]).isZero(3e-8)) loaded.push_back(j);
      }
      EXPECT_EQ(r.self_stress_places[k].joints, loaded);
    }
  }
  // All joints' rows on body velocities say the same without a tree.
  const RankDecision all = analyze_rank(G).decision;
  EXPECT_EQ(all.rank, r.rank) << all.singular_values.transpose();
  EXPECT_EQ(all.confident, r.decision.confident);

  // Selected rows span all rows of G; dependent columns make them square and regular.
  PositionKinematics pos = make_position_kinematics(system);
  compute_positions(system, state.q, pos);
  ConstraintKinematics c = make_constraint_kinematics(system);
  compute_constraints(system, state, pos, make_velocity_kinematics(system), c);
  const Scaling& scaling = system.scaling;
  const MatrixXd scaled_G = scaling.rows.asDiagonal() * c.G * scaling.columns.asDiagonal();
  const MatrixXd kept = scaled_G(r.selection.rows, Eigen::all);
  if (r.closure_rank > 0) {
    EXPECT_EQ(analyze_rank(kept, 1.0).decision.rank, r.closure_rank);
    EXPECT_EQ(analyze_rank(kept(Eigen::all, r.selection.dependent), 1.0).decision.rank, r.closure_rank);
    EXPECT_GT(r.selection.smallest_pivot, 1e-6);
  }
  // Closure rows' self-stresses by elimination balance G.
  const MatrixXd eliminated = self_stresses_of_selection(system, r.selection, c.G);
  EXPECT_EQ(eliminated.cols(), r.redundant);
  if (r.redundant > 0) {
    EXPECT_LT((c.G.transpose() * eliminated).norm(), 1e-8 * (1 + eliminated.norm() * c.G.norm()));
  }
}

/// A row is unique exactly when leaving it out lowers the rank; the unique part of a joint's wrench is what leaving out
/// all its rows costs.
void expect_unique_by_brute_force(const System& system, const State& state, const RedundancyReport& r,
                                  const std::string& what) {
  SCOPED_TRACE(what);
  const MatrixXd G = compute_scaled_joint_jacobian(system, state, r.rows, r.characteristic_length_m);
  const auto rank_without = [&](int first, int count) {
    std::vector<int> left;
    for (int i = 0; i < G.rows(); ++i) {
      if (i < first || i >= first + count) left.push_back(i);
    }
    return analyze_rank(G(left, Eigen::all), 1.0).decision.rank;
  };
  for (std::size_t j = 0; j < r.reactions.size(); ++j) {
    for (int i = 0; i < r.reactions[j].rows; ++i) {
      const bool needed = rank_without(r.rows.first[j] + i, 1) < r.rank;
      EXPECT_EQ(r.reactions[j].unique[i], needed) << r.rows.names[r.rows.first[j] + i];
    }
    EXPECT_EQ(r.reactions[j].unique_dimension, r.rank - rank_without(r.rows.first[j], r.reactions[j].rows))
        << r.reactions[j].joint;
  }
}

void expect_agrees(const RedundancyReport& r, const AbsoluteVerdict& witness, const std::string& what) {
  SCOPED_TRACE(what);
  EXPECT_EQ(r.constraint_rows, witness.rows);
  EXPECT_EQ(r.rank, witness.rank);
  EXPECT_EQ(r.mobility, witness.mobility);
  EXPECT_EQ(r.redundant, witness.redundant);
  ASSERT_EQ(r.reactions.size(), witness.unique_dimensions.size());
  std::vector<bool> rows;
  for (std::size_t j = 0; j < r.reactions.size(); ++j) {
    EXPECT_EQ(r.reactions[j].unique_dimension, witness.unique_dimensions[j]) << r.reactions[j].joint;
    rows.insert(rows.end(), r.reactions[j].unique.begin(), r.reactions[j].unique.end());
  }
  EXPECT_EQ(rows, witness.unique_rows);
}

class ZooRedundancyTest : public ::testing::TestWithParam<ZooEntry> {};

TEST_P(ZooRedundancyTest, CountsAreThePublishedOnesAndConfident) {
  const ZooEntry& entry = GetParam();
  const auto system = built(entry.spec);
  const RedundancyReport r = analyze_drawn(*system);
  EXPECT_EQ(r.bodies, entry.bodies);
  EXPECT_EQ(r.constraint_rows, entry.rows);
  EXPECT_EQ(r.rank, entry.rank) << r.decision.singular_values.transpose();
  EXPECT_EQ(r.mobility, entry.mobility);
  EXPECT_EQ(r.redundant, entry.redundant);
  EXPECT_TRUE(r.decision.confident);
  if (entry.unique) {
    EXPECT_EQ(unique_rows(r), *entry.unique);
  }
  if (entry.unique_dimension) {
    EXPECT_EQ(unique_dimension(r), *entry.unique_dimension);
  }
  EXPECT_LT(r.inconsistency, 1e-12);
}

TEST_P(ZooRedundancyTest, ReportsAreConsistentAndAgreeWithTwoOtherWays) {
  const auto system = built(GetParam().spec);
  const State drawn = make_drawn_state(*system);
  const RedundancyReport r = analyze_redundancy(*system, drawn);
  expect_consistent(*system, drawn, r, "");
  expect_unique_by_brute_force(*system, drawn, r, "leaving out rows");
  const std::vector<Pose> poses = witness::drawn_state(*system->model).poses;
  expect_agrees(r, witness::analyze_absolute(*system->model, poses), "absolute coordinates");
}

TEST_P(ZooRedundancyTest, EveryPlaceSizeAndOrderGivesTheSameVerdict) {
  const ModelSpec& spec = GetParam().spec;
  const Verdict wanted = verdict_of(analyze_drawn(*built(spec)));
  witness::RandomSource random(spec.joints.size());
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(verdict_of(analyze_drawn(*built(rotated(spec, random.rotation())))), wanted) << "turned";
    EXPECT_EQ(verdict_of(analyze_drawn(*built(shifted(spec, 10 * random.direction())))), wanted) << "moved";
    EXPECT_EQ(verdict_of(analyze_drawn(*built(permuted(spec, 17 + i)))), wanted) << "in another order";
  }
  for (const double s : {1e-3, 1e3}) {
    EXPECT_EQ(verdict_of(analyze_drawn(*built(scaled(spec, s)))), wanted) << "scaled by " << s;
  }
}

/// Up to `limit` different sets of joints to cut: all of them where they are few, else random ones.
std::vector<std::vector<bool>> choices_of_cuts(std::size_t joints, int limit, std::uint64_t seed) {
  std::vector<std::vector<bool>> choices;
  witness::RandomSource random(seed);
  const bool all = joints < 20 && (1 << joints) <= limit;
  for (int i = 0; i < (all ? 1 << joints : limit); ++i) {
    std::vector<bool> cut(joints);
    for (std::size_t j = 0; j < joints; ++j) cut[j] = all ? (i >> j & 1) : random.chance(0.3);
    choices.push_back(cut);
  }
  return choices;
}

TEST_P(ZooRedundancyTest, EveryChoiceOfCutJointsGivesTheSameVerdict) {
  const ModelSpec& spec = GetParam().spec;
  const Verdict wanted = verdict_of(analyze_drawn(*built(spec)));
  for (const std::vector<bool>& cut : choices_of_cuts(spec.joints.size(), 256, 1)) {
    EXPECT_EQ(verdict_of(analyze_drawn(*built(spec, cut))), wanted) << ::testing::PrintToString(cut);
  }
}

std::string test_name(const ::testing::TestParamInfo<ZooEntry>& info) { return info.param.name; }
INSTANTIATE_TEST_SUITE_P(Zoo, ZooRedundancyTest, ::testing::ValuesIn(witness::zoo()), test_name);

// Ten random mechanisms a test, so that a failure names a short list.
class RandomRedundancyTest : public ::testing::TestWithParam<int> {
 protected:
  template <class Check>
  void for_each_mechanism(const Check& check) const {
    for (int seed = 10 * GetParam(); seed < 10 * GetParam() + 10; ++seed) {
      const witness::RandomMechanism m = witness::make_random_mechanism(seed);
      check(m, "seed " + std::to_string(seed) + ": " + m.description);
    }
  }
};

TEST_P(RandomRedundancyTest, ReportsAreConsistentAndAgreeWithTheWitness) {
  for_each_mechanism([](const witness::RandomMechanism& m, const std::string& what) {
    const auto system = built(m.spec);
    const State drawn = make_drawn_state(*system);
    const RedundancyReport r = analyze_redundancy(*system, drawn);
    EXPECT_TRUE(r.decision.confident) << what << "\n" << r.decision.singular_values.transpose();
    expect_consistent(*system, drawn, r, what);
    expect_agrees(r, m.verdict, what);
    expect_unique_by_brute_force(*system, drawn, r, what);
  });
}

TEST_P(RandomRedundancyTest, DescriptionsGiveTheSameVerdict) {
  for_each_mechanism([](const witness::RandomMechanism& m, const std::string& what) {
    const Verdict wanted = verdict_of(analyze_drawn(*built(m.spec)));
    witness::RandomSource random(m.seed);
    EXPECT_EQ(verdict_of(analyze_drawn(*built(rotated(m.spec, random.rotation())))), wanted) << "turned " << what;
    EXPECT_EQ(verdict_of(analyze_drawn(*built(shifted(m.spec, 10 * random.direction())))), wanted) << "moved " << what;
    EXPECT_EQ(verdict_of(analyze_drawn(*built(permuted(m.spec, m.seed + 1)))), wanted) << "permuted " << what;
    EXPECT_EQ(verdict_of(analyze_drawn(*built(scaled(m.spec, 1e-3)))), wanted) << "small " << what;
    EXPECT_EQ(verdict_of(analyze_drawn(*built(scaled(m.spec, 1e3)))), wanted) << "large " << what;
    for (const std::vector<bool>& cut : choices_of_cuts(m.spec.joints.size(), 16, m.seed)) {
      EXPECT_EQ(verdict_of(analyze_drawn(*built(m.spec, cut))), wanted) << ::testing::PrintToString(cut) << what;
    }
  });
}

INSTANTIATE_TEST_SUITE_P(Tens, RandomRedundancyTest, ::testing::Range(0, kSeeds / 10));

/// A door whose second hinge sits `off` beside the first one's line, seen from the door.
ModelSpec crooked_door(double off) {
  ModelSpec spec = witness::make_door(2);
  spec.bodies[0].pose = PoseSpec{number3(0, 0, 0), std::nullopt, {}};
  JointSpec& hinge = spec.joints[1];
  const Number3 at = *hinge.place.drawn;
  Number3 on_door = at;
  on_door[0] = Number(at[0].value + off);
  hinge.place.drawn.reset();
  hinge.place.on_body = {{"ground", at}, {spec.bodies[0].name, on_door}};
  return spec;
}

TEST(RedundancyTest, AContradictionIsMeasured) {
  EXPECT_EQ(analyze_drawn(*built(crooked_door(0))).inconsistency, 0);
  EXPECT_NEAR(analyze_drawn(*built(crooked_door(1e-3))).inconsistency, 1e-3, 1e-15);
}

TEST(RedundancyTest, IndependentCoordinatesHaveNames) {
  const RedundancyReport r = analyze_drawn(*built(witness::make_four_bar(witness::FourBarJoints::kRevolute)));
  EXPECT_EQ(r.independent_coordinate_names.size(), 1u);
  ASSERT_EQ(r.excluded_row_names.size(), 3u);
  for (const std::string& name : r.excluded_row_names) EXPECT_NE(name.find('/'), std::string::npos);
}

TEST(RedundancyTest, ReselectionKeepsTheRank) {
  const auto system = built(witness::make_bennett());
  const State drawn = make_drawn_state(*system);
  const Scaling& scaling = system->scaling;
  PositionKinematics pos = make_position_kinematics(*system);
  compute_positions(*system, drawn.q, pos);
  ConstraintKinematics c = make_constraint_kinematics(*system);
  compute_constraints(*system, drawn, pos, make_velocity_kinematics(*system), c);
  RankDecision decision;
  const Selection first = select_independent(*system, scaling, c, &decision);
  EXPECT_EQ(decision.rank, 2);
  const Selection again = reselect(*system, scaling, c, first);
  EXPECT_EQ(again.rows, first.rows);
  EXPECT_EQ(again.dependent, first.dependent);
  EXPECT_EQ(again.independent, first.independent);
}

}  // namespace
}  // namespace ferrers
