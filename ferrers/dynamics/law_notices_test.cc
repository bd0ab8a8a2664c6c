#include "ferrers/dynamics/law_notices.h"

#include <gtest/gtest.h>

#include "ferrers/testing/zoo.h"

namespace ferrers::witness {
namespace {

Model four_bar_with_table() {
  ModelSpec spec = make_driven_four_bar();
  LawSpec table;
  table.samples = {{0.0, 1.0, 2.0}, {0.0, 0.5, 0.7}};
  table.file = "crank.csv";
  spec.drives[0].motion = {table};
  return *build_model(spec).model;
}

TEST(LawNoticesTest, ATableIsSaidToBecomeASpline) {
  const auto notices = describe_sampled_laws(four_bar_with_table(), LawUse::kMotion, 0, 2);
  ASSERT_EQ(notices.size(), 1U);
  EXPECT_NE(notices[0].find("cubic spline through 3 samples of crank.csv"), std::string::npos) << notices[0];
  EXPECT_NE(notices[0].find("twice continuously differentiable"), std::string::npos) << notices[0];
}

TEST(LawNoticesTest, LeavingTheTableIsSaid) {
  const Model model = four_bar_with_table();
  const auto after = describe_sampled_laws(model, LawUse::kMotion, 0, 3);
  ASSERT_EQ(after.size(), 2U);
  EXPECT_NE(after[1].find("after it the law goes on along its end tangent"), std::string::npos) << after[1];
  EXPECT_EQ(describe_sampled_laws(model, LawUse::kMotion, -1, 3).size(), 2U);
}

TEST(LawNoticesTest, FormulasAndOtherLawsAreNotMentioned) {
  EXPECT_TRUE(describe_sampled_laws(*build_model(make_driven_four_bar()).model, LawUse::kMotion, 0, 9).empty());
  EXPECT_TRUE(describe_sampled_laws(four_bar_with_table(), LawUse::kEffort, 0, 9).empty());
}

}  // namespace
}  // namespace ferrers::witness
