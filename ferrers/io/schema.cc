#include "ferrers/io/schema.h"

#include <nlohmann/json.hpp>

#include "ferrers/io/fields.h"

namespace ferrers {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kName = "^[A-Za-z_][A-Za-z0-9_]*$";

Json reference(std::string_view definition) { return {{"$ref", "#/$defs/" + std::string(definition)}}; }

Json list_of(const Json& item, int count) {
  Json list = {{"type", "array"}, {"items", item}};
  if (count > 0) list["minItems"] = list["maxItems"] = count;
  return list;
}

Json any_of(std::initializer_list<Json> choices) { return {{"anyOf", Json::array_t(choices)}}; }

Json by_body(const Json& value) {
  return {{"type", "object"}, {"additionalProperties", value}, {"minProperties", 1}, {"maxProperties", 2}};
}

/// Values that many fields share.
Json shared_definitions() {
  Json defs;
  defs["number"] = any_of({{{"type", "number"}},
                           {{"type", "string"},
                            {"description", "'= expression' over the parameters, or a number with a unit: '120 mm'"},
                            {"pattern", "^ *(=|[-+]?([0-9]+\\.?[0-9]*|\\.[0-9]+)([eE][-+]?[0-9]+)? *[^ 0-9])"}}});
  defs["formula"] = {{"type", "string"}, {"pattern", "^ *="}, {"description", "'= expression'"}};
  defs["name"] = {{"type", "string"}, {"pattern", kName}};
  defs["coordinate"] = {{"type", "string"},
                        {"pattern", "^[A-Za-z_][A-Za-z0-9_]*(\\.[A-Za-z_][A-Za-z0-9_]*)?$"},
                        {"description", "'joint' or 'joint.coordinate'"}};
  const Json number = reference("number");
  defs["vector3"] = list_of(number, 3);
  defs["vector4"] = list_of(number, 4);
  defs["direction"] = any_of({{{"enum", {"x", "y", "z", "-x", "-y", "-z"}}}, reference("vector3")});
  defs["place"] = any_of({reference("vector3"), by_body(reference("vector3"))});
  defs["axis"] = any_of({reference("direction"), by_body(reference("direction"))});
  const Json stiffness = any_of({number, {{"const", "rigid"}}});
  defs["stiffness3"] = any_of({stiffness, list_of(stiffness, 3)});
  defs["point_pair"] = list_of(reference("vector3"), 2);
  defs["law"] = any_of({number, reference(object_family(Family::kLawFile).name)});
  return defs;
}

Json value_schema(const FieldInfo& field);

Json named(const Json& value) {
  return {{"type", {"object", "null"}}, {"propertyNames", {{"pattern", kName}}}, {"additionalProperties", value}};
}

Json by_coordinate(const Json& value) {
  return {{"type", {"object", "null"}},
          {"propertyNames", {{"pattern", "^[A-Za-z_][A-Za-z0-9_]*(\\.[A-Za-z_][A-Za-z0-9_]*)?$"}}},
          {"additionalProperties", value}};
}

Json family_reference(Family family) { return reference(object_family(family).name); }

Json value_schema(const FieldInfo& field) {
  const Json number = reference("number");
  switch (field.kind) {
    case ValueKind::kVersion:
      return {{"const", 1}};
    case ValueKind::kNumber:
      return number;
    case ValueKind::kNumberOrList:
      return any_of({number, list_of(number, 0)});
    case ValueKind::kNumberList:
      return list_of(number, 0);
    case ValueKind::kNumberPair:
      return list_of(number, 2);
    case ValueKind::kVector3:
      return reference("vector3");
    case ValueKind::kVector3OrScalar:
      return any_of({number, reference("vector3")});
    case ValueKind::kStiffness3:
      return reference("stiffness3");
    case ValueKind::kVector4:
      return reference("vector4");
    case ValueKind::kDirection:
      return reference("direction");
    case ValueKind::kPlace:
      return reference("place");
    case ValueKind::kAxis:
      return reference("axis");
    case ValueKind::kAxisPair:
      return any_of({list_of(reference("axis"), 2), by_body(reference("direction"))});
    case ValueKind::kPoints:
      return any_of({reference("point_pair"), by_body(reference("vector3"))});
    case ValueKind::kPointPair:
      return reference("point_pair");
    case ValueKind::kInteger:
      return {{"type", "integer"}, {"minimum", 2}};
    case ValueKind::kBoolean:
      return {{"type", "boolean"}};
    case ValueKind::kText:
      return {{"type", "string"}};
    case ValueKind::kChoice:
      return {{"enum", Json(field.choices)}};
    case ValueKind::kName:
      return reference("name");
    case ValueKind::kNamePair:
      return list_of(reference("name"), 2);
    case ValueKind::kCoordinate:
      return reference("coordinate");
    case ValueKind::kCoordinateList:
      return list_of(reference("coordinate"), 0);
    case ValueKind::kExpression:
      return reference("formula");
    case ValueKind::kFormulaMatrix:
      return list_of(list_of(reference("number"), 0), 0);
    case ValueKind::kCoordinateFormulas:
      return by_coordinate(reference("number"));
    case ValueKind::kCoordinateLaws:
      return by_coordinate(reference("law"));
    case ValueKind::kLaw:
      return reference("law");
    case ValueKind::kLaw3:
      return list_of(reference("law"), 3);
    case ValueKind::kObject:
      return family_reference(field.family);
    case ValueKind::kNamedObjects:
      return named(family_reference(field.family));
    case ValueKind::kNamedLists:
      return named(any_of({family_reference(field.family), list_of(family_reference(field.family), 0)}));
  }
  return Json::object();
}

std::string description(const FieldInfo& field) {
  std::string text = field.doc;
  if (!field.quantity.unit.empty()) text += " [" + std::string(field.quantity.unit) + "]";
  if (!field.default_text.empty()) text += " (default: " + std::string(field.default_text) + ")";
  return text;
}

Json type_schema(const ObjectFamily& family, const ObjectType& type) {
  Json properties = Json::object();
  Json required = Json::array();
  Json alternatives = Json::array();  // required, unless another field stands for them
  std::string_view other;
  if (!family.choice_key.empty() && !type.tag.empty()) {
    properties[std::string(family.choice_key)] = {{"const", type.tag}};
    required.push_back(family.choice_key);
  }
  for (const FieldInfo& field : type.fields) {
    Json value = value_schema(field);
    value["description"] = description(field);
    properties[std::string(field.key)] = std::move(value);
    if (!field.unless.empty()) other = field.unless;
    if (field.required) (field.unless.empty() ? required : alternatives).push_back(field.key);
  }
  Json schema = {{"title", type.title}, {"type", "object"}};
  if (!type.doc.empty()) schema["description"] = type.doc;
  schema["properties"] = std::move(properties);
  if (!required.empty()) schema["required"] = std::move(required);
  if (!other.empty()) {
    Json own = Json::array();  // neither needed nor allowed beside the other
    for (const FieldInfo& field : type.fields) {
      if (!field.unless.empty()) own.push_back({{"required", {field.key}}});
    }
    Json without_other = {{"not", {{"required", {other}}}}};
    if (!alternatives.empty()) without_other["required"] = std::move(alternatives);
    schema["oneOf"] = {std::move(without_other), {{"required", {other}}, {"not", {{"anyOf", std::move(own)}}}}};
  }
  schema["additionalProperties"] = false;
  return schema;
}

Json family_schema(const ObjectFamily& family) {
  Json schema;
  if (family.types.size() == 1) {
    schema = type_schema(family, family.types.front());
  } else {
    Json types = Json::array();
    for (const ObjectType& type : family.types) types.push_back(type_schema(family, type));
    schema["oneOf"] = std::move(types);
  }
  if (!family.shorthand.empty()) {
    schema = any_of({value_schema(*family.types.front().find(family.shorthand)), schema});
  }
  schema["description"] = family.doc;
  return schema;
}

}  // namespace

std::string model_schema_json() {
  Json schema = {{"$schema", "https://json-schema.org/draft/2020-12/schema"},
                 {"title", "Ferrers model file, version 1"}};
  schema.update(family_schema(object_family(Family::kModel)));
  schema["title"] = "Ferrers model file, version 1";
  Json defs = shared_definitions();
  for (const ObjectFamily& family : object_families()) {
    if (family.id != Family::kModel) defs[std::string(family.name)] = family_schema(family);
  }
  schema["$defs"] = std::move(defs);
  return schema.dump(2) + "\n";
}

}  // namespace ferrers
