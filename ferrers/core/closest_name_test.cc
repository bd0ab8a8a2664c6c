#include "ferrers/core/closest_name.h"

#include <gtest/gtest.h>

#include <vector>

namespace ferrers {
namespace {

const std::vector<std::string> kKeys = {"stiffness", "damping", "free_length", "at", "axis", "axes"};

TEST(ClosestNameTest, OneSlipOfTheHandIsForgiven) {
  EXPECT_EQ(closest_name("stifness", kKeys), "stiffness");
  EXPECT_EQ(closest_name("dampign", kKeys), "damping");
  EXPECT_EQ(closest_name("Damping", kKeys), "damping");
  EXPECT_EQ(closest_name("freelength", kKeys), "free_length");
  EXPECT_EQ(closest_name("axs", kKeys), "axis");
}

TEST(ClosestNameTest, AnUnlikeNameGetsNoSuggestion) {
  EXPECT_EQ(closest_name("colour", kKeys), "");
  EXPECT_EQ(closest_name("", kKeys), "");
  EXPECT_EQ(closest_name("z", kKeys), "");
  EXPECT_EQ(closest_name(std::string(100000, 'a'), kKeys), "");
}

TEST(ClosestNameTest, TheHintIsEmptyWhenThereIsNothingToSay) {
  EXPECT_EQ(did_you_mean("dampin", kKeys), "did you mean 'damping'?");
  EXPECT_EQ(did_you_mean("colour", kKeys), "");
}

}  // namespace
}  // namespace ferrers
