#include "ferrers/redundancy/idle_freedoms.h"

#include <gtest/gtest.h>

#include "ferrers/testing/build_checks.h"
#include "ferrers/testing/zoo.h"

namespace ferrers {
namespace {

std::vector<IdleFreedom> idle_of(const ModelSpec& spec) {
  const auto system = make_system(witness::built(spec));
  const AssemblyResult assembly = assemble(*system);
  EXPECT_EQ(assembly.status, AssemblyStatus::kAssembled);
  return idle_freedoms(*system, assembly.state, analyze_redundancy(*system, assembly.state));
}

TEST(IdleFreedomsTest, ARodBetweenTwoBallJointsSpinsAboutItself) {
  const std::vector<IdleFreedom> idle = idle_of(witness::make_four_bar(witness::FourBarJoints::kTwoSpherical));
  ASSERT_EQ(idle.size(), 1u);
  EXPECT_EQ(idle[0].body, "coupler");
  EXPECT_EQ(idle[0].joints, (std::vector<std::string>{"A", "B"}));
  const Vector3d rod = Vector3d(1.7, 0.6, 0).normalized();
  EXPECT_NEAR(idle[0].axis.cross(rod).norm(), 0, 1e-12);
}

TEST(IdleFreedomsTest, ADrivenOrWantedFreedomIsNotIdle) {
  for (const ModelSpec& spec :
       {witness::make_shaft_determinate(), witness::make_pendulum(),
        witness::make_four_bar(witness::FourBarJoints::kSphericalCylindrical),
        witness::make_slider_crank(witness::SliderCrankJoints::kSphericalCylindrical), witness::make_planetary(3)}) {
    EXPECT_TRUE(idle_of(spec).empty()) << spec.name;
  }
}

TEST(IdleFreedomsTest, ARollerBetweenTwoForksIsIdleUnlessItIsDriven) {
  ModelSpec spec = witness::make_four_bar(witness::FourBarJoints::kRevolute);
  JointSpec& b = spec.joints[2];  // the coupler's two hinges on one axis: it turns alone
  b.place = spec.joints[1].place;
  ASSERT_EQ(idle_of(spec).size(), 1u);
  DriveSpec drive;
  drive.name = "motor";
  drive.coordinate = CoordinateRef{NameRef("A"), ""};
  spec.drives = {drive};
  EXPECT_TRUE(idle_of(spec).empty());
}

}  // namespace
}  // namespace ferrers
