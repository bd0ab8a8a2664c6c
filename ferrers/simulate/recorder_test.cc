#include "ferrers/simulate/recorder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ferrers/testing/elastic_joints.h"
#include "ferrers/testing/run_probe.h"
#include "ferrers/testing/zoo.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers::witness {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

SimulationOptions still(const DistributionOptions& distribution = {}) {
  SimulationOptions options;
  options.grid = {0.02, 0.01};
  options.distribution = distribution;
  return options;
}

ModelSpec make_elastic_door(int hinges) {
  ModelSpec spec = make_door(hinges);
  for (JointSpec& joint : spec.joints) set_stiffness(joint, 1e6, 1e4);
  return spec;
}

TEST(RecorderTest, LargestLoadsSayWhetherTheyWereDistributed) {
  const ProbedRun run = probe_run(make_elastic_door(2), still());
  ASSERT_EQ(run.summary.status, RunStatus::kFinished);
  EXPECT_TRUE(run.summary.distribution.used);
  EXPECT_EQ(run.summary.distribution.by, DistributionBy::kJointStiffness);
  EXPECT_TRUE(run.summary.distribution.notices.empty());
  for (const JointPeak& peak : run.summary.peaks) {
    EXPECT_TRUE(peak.force_distributed);
    EXPECT_TRUE(peak.force_determined);
    EXPECT_GT(peak.force.value_or(0), 98);
  }
  const ProbedRun plain = probe_run(make_door(2), still());
  EXPECT_FALSE(plain.summary.distribution.used);
  EXPECT_FALSE(plain.summary.peaks[0].force);
}

TEST(RecorderTest, MisalignmentThatCannotBeIsToldOnce) {
  ModelSpec spec = make_door(2);
  set_misalignment(spec.joints[1], number3(1e-4, 0, 0), number3(0, 0, 0));
  const ProbedRun run = probe_run(spec, still());
  ASSERT_EQ(run.samples.size(), 3u);
  EXPECT_THAT(run.summary.distribution.notices, ElementsAre(HasSubstr("'hinge1', 'hinge2'")));
  for (const JointPeak& peak : run.summary.peaks) EXPECT_FALSE(peak.force);
}

TEST(RecorderTest, EqualStiffnessTellsItsLengthAndThatMisalignmentIsNotUsed) {
  ModelSpec spec = make_elastic_door(2);
  set_misalignment(spec.joints[1], number3(1e-4, 0, 0), number3(0, 0, 0));
  DistributionOptions options;
  options.by = DistributionBy::kEqualStiffness;
  const ProbedRun run = probe_run(spec, still(options));
  EXPECT_NEAR(run.summary.distribution.length_m, 1.7, 1e-12);
  EXPECT_THAT(run.summary.distribution.notices, ElementsAre(HasSubstr("misalignment is not used")));
}

TEST(RecorderTest, RangesThatTakeTooLongAreRefusedBeforeTheFirstRow) {
  DistributionOptions options;
  options.range = StiffnessRange{0.5, 2};
  const ProbedRun large = probe_run(make_elastic_door(40), still(options));
  EXPECT_EQ(large.summary.status, RunStatus::kUnsupported);
  EXPECT_THAT(large.summary.message, HasSubstr("too long"));
  EXPECT_TRUE(large.samples.empty());
  const ProbedRun small = probe_run(make_elastic_door(2), still(options));
  EXPECT_EQ(small.summary.status, RunStatus::kFinished);
  EXPECT_EQ(small.summary.distribution.bounds, BoundsMethod::kExact);
  EXPECT_LT(small.samples[0].reactions[0].low[2], 98);
  EXPECT_GT(small.samples[0].reactions[0].high[2], 98.2);
}

}  // namespace
}  // namespace ferrers::witness
