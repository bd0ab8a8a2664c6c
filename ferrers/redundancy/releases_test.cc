#include "ferrers/redundancy/releases.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <span>

#include "ferrers/redundancy/release_search.h"
#include "ferrers/testing/absolute_solver.h"
#include "ferrers/testing/build_checks.h"
#include "ferrers/testing/random_mechanism.h"
#include "ferrers/testing/transforms.h"
#include "ferrers/testing/zoo.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers {
namespace {

using testing::HasSubstr;
using witness::built;
using Changes = std::vector<std::pair<std::string, JointType>>;

struct Analysed {
  std::shared_ptr<const System> system;
  State state;
  RedundancyReport report;
  ReleaseReport releases;
};

Analysed analysed(const ModelSpec& spec) {
  Analysed out;
  out.system = make_system(built(spec));
  const AssemblyResult assembly = assemble(*out.system);
  EXPECT_EQ(assembly.status, AssemblyStatus::kAssembled) << spec.name;
  out.state = assembly.state;
  out.report = analyze_redundancy(*out.system, out.state);
  out.releases = analyze_releases(*out.system, out.state, out.report);
  return out;
}

Changes changes_of(const Release& release) {
  Changes out;
  for (const ReleaseChange& one : release.changes) out.emplace_back(one.change.joint, one.change.to);
  return out;
}

// Place in the list, from 0; −1 where it is not in it.
int place_of(const ReleaseReport& report, const Changes& changes) {
  for (std::size_t i = 0; i < report.releases.size(); ++i) {
    if (changes_of(report.releases[i]) == changes) return static_cast<int>(i);
  }
  return -1;
}

// The verdict on the changed model in absolute coordinates, which share nothing with the analysis.
witness::AbsoluteVerdict verdict_after(const ModelSpec& spec, const Release& release, int wander = 0) {
  const JointChangeResult changed = apply_release(spec, release);
  EXPECT_TRUE(changed.spec) << changed.reason;
  if (!changed.spec) return {};
  const Model model = built(*changed.spec);
  const witness::AbsoluteState state = witness::wandered(model, 7, wander);
  return witness::analyze_absolute(model, state.poses);
}

TEST(ReleasesTest, TheThreePairsOfTheLiteratureComeAmongTheFirstThree) {
  using T = JointType;
  const auto among_first = [](const ModelSpec& spec, const Changes& changes) {
    const int place = place_of(analysed(spec).releases, changes);
    EXPECT_GE(place, 0) << spec.name;
    EXPECT_LT(place, 3) << spec.name;
  };
  among_first(witness::make_four_bar(witness::FourBarJoints::kRevolute),
              {{"A", T::kSpherical}, {"B", T::kCylindrical}});
  among_first(witness::make_slider_crank(witness::SliderCrankJoints::kRevolutePrismatic),
              {{"A", T::kSpherical}, {"guide", T::kCylindrical}});
  among_first(witness::make_planetary(3), {{"sun_bearing", T::kPlanar}});
}

TEST(ReleasesTest, EverySuggestionForTheZooIsIsostaticWithTheSameMobility) {
  int checked = 0;
  for (const witness::ZooEntry& entry : witness::zoo()) {
    const Analysed one = analysed(entry.spec);
    if (entry.redundant == 0) {
      EXPECT_TRUE(one.releases.releases.empty()) << entry.name;
      continue;
    }
    for (const Release& release : one.releases.releases) {
      if (!release.complete) continue;
      if (!release.holds_generically.value_or(false)) {
        EXPECT_FALSE(release.condition.empty()) << entry.name << ": " << release.says;
        continue;
      }
      EXPECT_EQ(release.redundant_after, 0);
      EXPECT_GT(release.conditioning, 0);
      EXPECT_LE(release.conditioning, 1 + 1e-12);
      const bool singular_pose = one.report.redundant != entry.redundant || !one.releases.note.empty();
      if (singular_pose) continue;  // more is redundant there; see below
      const witness::AbsoluteVerdict verdict = verdict_after(entry.spec, release);
      EXPECT_EQ(verdict.redundant, 0) << entry.name << ": " << release.says;
      EXPECT_EQ(verdict.mobility, entry.mobility + release.idle_freedoms) << entry.name << ": " << release.says;
      const witness::AbsoluteVerdict elsewhere = verdict_after(entry.spec, release, 5);
      EXPECT_EQ(elsewhere.redundant, 0) << entry.name << " moved: " << release.says;
      EXPECT_EQ(elsewhere.mobility, entry.mobility + release.idle_freedoms) << entry.name << " moved: " << release.says;
      ++checked;
    }
  }
  EXPECT_GT(checked, 60);
}

TEST(ReleasesTest, AtASingularPoseWhatIsGenericallyRedundantIsReleased) {
  const ModelSpec spec = witness::make_n_four_bar(2, std::acos(-1.0) / 2);
  const Analysed one = analysed(spec);
  EXPECT_EQ(one.report.redundant, 8);
  EXPECT_THAT(one.releases.note, HasSubstr("adds 2"));
  int general = 0;
  for (const Release& release : one.releases.releases) {
    EXPECT_EQ(release.redundant_after, 0) << release.says;
    EXPECT_EQ(release.mobility_after, 1 + release.idle_freedoms) << release.says;
    ASSERT_TRUE(release.holds_generically);
    if (!*release.holds_generically) {
      EXPECT_THAT(release.condition, HasSubstr("branch"));
      continue;
    }
    ++general;
    const witness::AbsoluteVerdict away = verdict_after(witness::make_n_four_bar(2, 0.3), release);
    EXPECT_EQ(away.redundant, 0) << release.says;
    EXPECT_EQ(away.mobility, 1 + release.idle_freedoms) << release.says;
  }
  EXPECT_GT(general, 0);
}

TEST(ReleasesTest, RowsThatNoSelfStressLoadsAreNeverReleased) {
  for (const witness::ZooEntry& entry : witness::zoo()) {
    const auto system = make_system(built(entry.spec));
    const State state = assemble(*system).state;
    const RedundancyReport report = analyze_redundancy(*system, state);
    std::vector<ReleaseObstacle> obstacles;
    for (const ReleaseGroup& group : find_release_groups(*system, state, report, obstacles)) {
      for (const ReleaseCandidate& one : group.candidates) {
        for (int i = 0; i < one.rows.rows(); ++i) {
          if (!report.reactions[one.joint].unique[i]) continue;
          EXPECT_LT(one.rows.row(i).norm(), 1e-6)
              << entry.name << " " << report.rows.names[report.rows.first[one.joint] + i];
        }
      }
    }
  }
}

TEST(ReleasesTest, AnIdleSpinComesLastAndIsCounted) {
  const Analysed one = analysed(witness::make_four_bar(witness::FourBarJoints::kRevolute));
  const int place = place_of(one.releases, {{"A", JointType::kSpherical}, {"B", JointType::kSpherical}});
  ASSERT_GE(place, 3);
  const Release& rssr = one.releases.releases[place];
  for (const Release& after : std::span(one.releases.releases).subspan(place)) EXPECT_EQ(after.idle_freedoms, 1);
  EXPECT_EQ(rssr.mobility_after, 2);
  EXPECT_EQ(rssr.redundant_after, 0);
  for (int i = 0; i < place; ++i) EXPECT_EQ(one.releases.releases[i].idle_freedoms, 0);
}

TEST(ReleasesTest, AModelWithParametersKeepsThem) {
  ModelSpec spec = witness::make_four_bar(witness::FourBarJoints::kRevolute);
  spec.parameters = {witness::parameter("reach", Number(0.9)),
                     witness::parameter("double_reach", witness::formula("2*reach"))};
  (*spec.joints[1].place.drawn)[1] = witness::formula("reach");
  const Analysed one = analysed(spec);
  ASSERT_GE(one.releases.releases.size(), 3u);
  const JointChangeResult changed = apply_release(spec, one.releases.releases[1]);
  ASSERT_TRUE(changed.spec) << changed.reason;
  EXPECT_EQ(changed.spec->parameters.size(), 2u);
  EXPECT_TRUE((*changed.spec->joints[1].place.drawn)[1].expression.has_value());
  const auto other = make_system(built(*changed.spec, {{"reach", 1.1}}));
  EXPECT_EQ(analyze_redundancy(*other, assemble(*other).state).redundant, 0);
}

TEST(ReleasesTest, ADrivenCoordinateIsNotTakenAway) {
  const Analysed one = analysed(witness::make_slider_crank(witness::SliderCrankJoints::kRevolutePrismatic));
  for (const Release& release : one.releases.releases) {
    for (const auto& [joint, to] : changes_of(release)) {
      EXPECT_FALSE(joint == "O" && (to == JointType::kSpherical || to == JointType::kPointOnLine)) << release.says;
    }
  }
  ASSERT_FALSE(one.releases.obstacles.empty());
  EXPECT_THAT(one.releases.obstacles[0].reason, HasSubstr("'motor'"));
}

TEST(ReleasesTest, OrientationAndSizeDoNotChangeTheSuggestions) {
  const Eigen::Matrix3d R = Eigen::AngleAxisd(1.1, Vector3d(0.3, -0.7, 0.65).normalized()).toRotationMatrix();
  for (ModelSpec spec : {witness::make_four_bar(witness::FourBarJoints::kRevolute), witness::make_scissor_lift(1),
                         witness::make_planetary(3), witness::make_bennett(), witness::make_andrews()}) {
    const Analysed one = analysed(spec);
    for (const ModelSpec& other : {witness::rotated(spec, R), witness::scaled(spec, 0.013)}) {
      const Analysed same = analysed(other);
      ASSERT_EQ(same.releases.releases.size(), one.releases.releases.size()) << spec.name;
      for (std::size_t i = 0; i < one.releases.releases.size(); ++i) {
        EXPECT_EQ(changes_of(same.releases.releases[i]), changes_of(one.releases.releases[i])) << spec.name << " " << i;
        EXPECT_NEAR(same.releases.releases[i].conditioning, one.releases.releases[i].conditioning, 1e-7) << spec.name;
      }
    }
  }
}

TEST(ReleasesTest, TheOrderOfBodiesAndJointsDoesNotChangeThePatterns) {
  const auto patterns = [](const Analysed& one) {
    std::vector<std::pair<std::vector<std::pair<JointType, JointType>>, long>> out;
    for (const Release& release : one.releases.releases) {
      std::vector<std::pair<JointType, JointType>> types;
      for (const ReleaseChange& change : release.changes) types.emplace_back(change.from, change.change.to);
      std::sort(types.begin(), types.end());
      out.emplace_back(std::move(types), std::lround(1e6 * release.conditioning));
    }
    std::sort(out.begin(), out.end());
    return out;
  };
  for (const ModelSpec& spec : {witness::make_four_bar(witness::FourBarJoints::kRevolute), witness::make_planetary(3),
                                witness::make_scissor_lift(1), witness::make_andrews()}) {
    for (const std::uint64_t seed : {1, 2}) {
      EXPECT_EQ(patterns(analysed(witness::permuted(spec, seed))), patterns(analysed(spec))) << spec.name;
    }
  }
}

TEST(ReleasesTest, SuggestionsForRandomMechanismsHoldInAbsoluteCoordinates) {
  int checked = 0, none = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const witness::RandomMechanism random = witness::make_random_mechanism(seed);
    if (random.verdict.redundant == 0) continue;
    const Analysed one = analysed(random.spec);
    if (!one.releases.note.empty() && !one.releases.releases.empty()) continue;  // singular as drawn
    none += one.releases.releases.empty() ? 1 : 0;
    for (const Release& release : one.releases.releases) {
      if (!release.complete) continue;
      const witness::AbsoluteVerdict verdict = verdict_after(random.spec, release);
      EXPECT_EQ(verdict.redundant, 0) << seed << " " << random.description << ": " << release.says;
      EXPECT_EQ(verdict.mobility, random.verdict.mobility + release.idle_freedoms)
          << seed << " " << random.description << ": " << release.says;
      ++checked;
    }
  }
  EXPECT_GT(checked, 150);
  EXPECT_LT(none, 30);
}

TEST(ReleasesTest, ManyIndependentLoopsAreSolvedEachForItself) {
  ModelSpec spec;
  const ModelSpec loop = witness::make_four_bar(witness::FourBarJoints::kRevolute);
  constexpr int kLoops = 300;
  for (int i = 0; i < kLoops; ++i) {
    const auto named = [&](const NameRef& name) {
      return name.name == "ground" ? name : NameRef(witness::numbered(name.name + "_", i));
    };
    for (BodySpec body : loop.bodies) {
      body.name = named(body.name);
      spec.bodies.push_back(body);
    }
    for (JointSpec joint : loop.joints) {
      joint.name = named(joint.name);
      joint.bodies = {named(joint.bodies[0]), named(joint.bodies[1])};
      spec.joints.push_back(joint);
    }
  }
  const auto system = make_system(built(spec));
  const State state = assemble(*system).state;
  const RedundancyReport report = analyze_redundancy(*system, state);
  const auto start = std::chrono::steady_clock::now();
  std::vector<ReleaseObstacle> obstacles;
  const std::vector<ReleaseGroup> groups = find_release_groups(*system, state, report, obstacles);
  const SpinAnalyzer spins(*system, state, report);
  ASSERT_EQ(groups.size(), static_cast<std::size_t>(kLoops));
  for (const ReleaseGroup& group : groups) {
    const ReleaseSearch found = search_group(group, spins, {.evaluations = 200, .idle_spins = false});
    ASSERT_FALSE(found.sets.empty());
    EXPECT_TRUE(found.sets[0].complete);
    EXPECT_EQ(found.sets[0].counted, 1);
  }
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), 5);
}

TEST(ReleasesTest, LargeGroupsAreSolvedGreedilyInBoundedTime) {
  const ModelSpec spec = witness::make_n_four_bar(40, 0.3);
  const auto start = std::chrono::steady_clock::now();
  const Analysed one = analysed(spec);
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), 20);
  EXPECT_EQ(one.report.redundant, 120);
  EXPECT_TRUE(one.releases.search_was_cut);
  ASSERT_FALSE(one.releases.releases.empty());
  for (const Release& release : one.releases.releases) {
    EXPECT_TRUE(release.complete);
    EXPECT_EQ(release.redundant_after, 0) << release.says;
    EXPECT_EQ(release.mobility_after, 1) << release.says;
  }
  EXPECT_EQ(one.releases.releases[0].changes.size(), 40u);
}

TEST(ReleasesTest, WhatCannotBeReleasedIsSaidToRemain) {
  const Analysed one = analysed(witness::make_planetary(5));  // 4 redundant; a floating sun takes two
  ASSERT_FALSE(one.releases.releases.empty());
  EXPECT_FALSE(one.releases.releases[0].complete);
  EXPECT_EQ(one.releases.releases[0].redundant_after, 2);
  EXPECT_EQ(one.releases.releases[0].mobility_after, 1);
}

}  // namespace
}  // namespace ferrers
