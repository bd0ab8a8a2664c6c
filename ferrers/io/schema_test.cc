#include "ferrers/io/schema.h"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "ferrers/io/fields.h"

namespace ferrers {
namespace {

using Json = nlohmann::json;

TEST(SchemaTest, TheCommittedSchemaIsTheOneOfTheTable) {
  std::ifstream stream(std::string(FERRERS_SOURCE_DIR) + "/schemas/model.schema.json");
  std::ostringstream committed;
  committed << stream.rdbuf();
  EXPECT_EQ(committed.str(), model_schema_json()) << "write it anew: ferrers schema > schemas/model.schema.json";
}

/// Every reference points to a definition.
void expect_references_exist(const Json& node, const Json& definitions) {
  if (node.is_object() && node.contains("$ref")) {
    const std::string target = node.at("$ref").get<std::string>();
    EXPECT_TRUE(definitions.contains(target.substr(std::string("#/$defs/").size()))) << target;
  }
  if (node.is_structured()) {
    for (const Json& inner : node) expect_references_exist(inner, definitions);
  }
}

TEST(SchemaTest, EveryReferenceHasItsDefinition) {
  const Json schema = Json::parse(model_schema_json());
  EXPECT_EQ(schema.at("$schema"), "https://json-schema.org/draft/2020-12/schema");
  expect_references_exist(schema, schema.at("$defs"));
}

TEST(SchemaTest, ObjectsAreClosedAndNameTheirRequiredKeys) {
  const Json schema = Json::parse(model_schema_json());
  const Json& joints = schema.at("$defs").at("joint").at("oneOf");
  ASSERT_EQ(joints.size(), object_family(Family::kJoint).types.size());
  for (const Json& joint : joints) {
    EXPECT_EQ(joint.at("additionalProperties"), false);
    EXPECT_EQ(joint.at("required").at(0), "type");
    EXPECT_EQ(joint.at("required").at(1), "bodies");
  }
  EXPECT_EQ(schema.at("required"), Json::parse(R"(["ferrers"])"));
}

}  // namespace
}  // namespace ferrers
