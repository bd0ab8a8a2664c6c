#include "ferrers/io/fields.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>

#include "ferrers/io/document.h"
#include "ferrers/io/spec_reader.h"
#include "ferrers/model/joints/joint_type.h"

namespace ferrers {
namespace {

const std::filesystem::path kModels = std::filesystem::path(FERRERS_SOURCE_DIR) / "tests" / "models";

std::string every_field() {
  std::ifstream stream(kModels / "every_field.yaml");
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

std::string id(const ObjectFamily& family, const ObjectType& type, std::string_view key) {
  return fmt::format("{}/{}/{}", family.name, type.tag, key);
}

TEST(FieldsTest, TheReaderAsksForEveryFieldOfTheTable) {
  Diagnostics diagnostics;
  const auto root = parse_document(every_field(), diagnostics);
  ASSERT_TRUE(root.has_value());
  LawFiles laws(kModels);
  ValueReader values(laws, diagnostics);
  std::set<std::string> asked;
  values.on_asked = [&](const ObjectFamily& family, const ObjectType& type, std::string_view key) {
    asked.insert(id(family, type, key));
  };
  SpecReader(values).read(*root, "every_field");
  EXPECT_TRUE(diagnostics.empty());
  for (const ObjectFamily& family : object_families()) {
    for (const ObjectType& type : family.types) {
      for (const FieldInfo& field : type.fields) {
        EXPECT_TRUE(asked.count(id(family, type, field.key)) > 0) << id(family, type, field.key);
      }
    }
  }
}

TEST(FieldsTest, EveryJointTypeOfTheEngineHasAType) {
  const ObjectFamily& joints = object_family(Family::kJoint);
  EXPECT_EQ(joints.types.size(), all_joint_types().size());
  for (const JointTypeInfo* info : all_joint_types()) {
    const ObjectType* type = joints.find_type(info->name);
    ASSERT_NE(type, nullptr) << info->name;
    EXPECT_NE(type->find("bodies"), nullptr);
    EXPECT_EQ(type->find("axis") != nullptr,
              info->placement == PlacementRule::kPointAxis || info->placement == PlacementRule::kMesh);
  }
}

TEST(FieldsTest, KeysOfATypeAreUniqueAndDocumented) {
  for (const ObjectFamily& family : object_families()) {
    EXPECT_FALSE(family.doc.empty()) << family.name;
    for (const ObjectType& type : family.types) {
      std::set<std::string_view> keys;
      for (const FieldInfo& field : type.fields) {
        EXPECT_TRUE(keys.insert(field.key).second) << id(family, type, field.key);
        EXPECT_FALSE(field.doc.empty()) << id(family, type, field.key);
        EXPECT_FALSE(field.required && !field.default_text.empty()) << id(family, type, field.key);
      }
    }
  }
}

TEST(FieldsTest, ThePageNamesEveryFieldAndFamily) {
  const std::string page = model_reference_page();
  for (const ObjectFamily& family : object_families()) {
    EXPECT_NE(page.find(fmt::format("\n## {}\n", family.name)), std::string::npos) << family.name;
    for (const ObjectType& type : family.types) {
      for (const FieldInfo& field : type.fields) {
        EXPECT_NE(page.find(fmt::format("| `{}` |", field.key)), std::string::npos) << field.key;
      }
    }
  }
}

TEST(FieldsTest, TheCommittedPageIsTheOneOfTheTable) {
  std::ifstream stream(std::string(FERRERS_SOURCE_DIR) + "/docs/model-file.md");
  std::ostringstream committed;
  committed << stream.rdbuf();
  EXPECT_EQ(committed.str(), model_reference_page());
}

TEST(FieldsTest, NamesAreAsTheFormatSays) {
  for (const char* good : {"a", "_", "A_1", "crank"}) EXPECT_TRUE(is_model_name(good)) << good;
  for (const char* bad : {"", "1a", "a-b", "a.b", "a b", "\xC3\xA9"}) EXPECT_FALSE(is_model_name(bad)) << bad;
}

}  // namespace
}  // namespace ferrers
