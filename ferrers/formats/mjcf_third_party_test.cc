#include <filesystem>

#include "ferrers/formats/mjcf_test_model.h"
#include "ferrers/redundancy/analysis.h"
#include "ferrers/testing/third_party.h"

// Robots of others, where they are: FERRERS_THIRD_PARTY_MODELS names a folder that holds mujoco_menagerie, or parts of
// it.
namespace ferrers {
namespace {

using mjcf_testing::messages;

struct Counts {
  int rows, rank, mobility, redundant;
};

Counts counts_of(const std::filesystem::path& path, ImportBase base) {
  ImportOptions options;
  options.base = base;
  const ModelFile file = read_any_model_file(path, {}, options);
  EXPECT_TRUE(file.read.model) << messages(file.read.diagnostics);
  if (!file.read.model) return {};
  const auto system = make_system(*file.read.model);
  const RedundancyReport report = analyze_redundancy(*system, make_drawn_state(*system));
  return {report.closure_rows, report.closure_rank, report.mobility, report.redundant};
}

TEST(MjcfThirdPartyTest, CassieHasTwoRedundantRowsOfTwelve) {
  const auto path = witness::third_party("mujoco_menagerie/agility_cassie/cassie.xml");
  if (!path) GTEST_SKIP() << witness::kNoThirdPartyModels;
  for (const auto& [base, mobility] : {std::pair(ImportBase::kFixed, 16), std::pair(ImportBase::kAsInFile, 22)}) {
    const Counts counts = counts_of(*path, base);
    EXPECT_EQ(counts.rows, 12);
    EXPECT_EQ(counts.rank, 10);
    EXPECT_EQ(counts.mobility, mobility);
    EXPECT_EQ(counts.redundant, 2);
  }
}

TEST(MjcfThirdPartyTest, TheGripperOfXarm7HasTwoRedundantRowsOfSeven) {
  const auto path = witness::third_party("mujoco_menagerie/ufactory_xarm7/hand.xml");
  if (!path) GTEST_SKIP() << witness::kNoThirdPartyModels;
  const Counts counts = counts_of(*path, ImportBase::kAsInFile);
  EXPECT_EQ(counts.rows, 7);
  EXPECT_EQ(counts.rank, 5);
  EXPECT_EQ(counts.mobility, 1);
  EXPECT_EQ(counts.redundant, 2);
}

}  // namespace
}  // namespace ferrers
