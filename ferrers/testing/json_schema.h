#pragma once

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

/// Checks JSON against the schemas of this project: draft 2020-12, as far as they use it. A keyword that is not known
/// here is itself a fault, so that nothing goes unchecked.
namespace ferrers::witness {

class JsonSchema {
 public:
  explicit JsonSchema(nlohmann::json schema) : root_(std::move(schema)) {}

  /// What is wrong, each with its place; empty: nothing.
  std::vector<std::string> faults(const nlohmann::json& value) const {
    std::vector<std::string> out;
    check(root_, value, "", out);
    return out;
  }

 private:
  using Json = nlohmann::json;

  static bool has_type(const Json& value, const std::string& type) {
    if (type == "object") return value.is_object();
    if (type == "array") return value.is_array();
    if (type == "string") return value.is_string();
    if (type == "boolean") return value.is_boolean();
    if (type == "null") return value.is_null();
    if (type == "integer") return value.is_number_integer();
    return type == "number" && value.is_number();
  }

  void check(const Json& schema, const Json& value, const std::string& at, std::vector<std::string>& out) const {
    static const std::set<std::string> known = {
        "$schema", "$id",  "$defs", "title", "description", "$ref",       "type",
        "const",   "enum", "oneOf", "items", "required",    "properties", "additionalProperties"};
    for (const auto& [key, unused] : schema.items()) {
      if (known.count(key) == 0) out.push_back(at + ": the schema's keyword '" + key + "' is not checked");
    }
    if (schema.contains("$ref")) check(resolve(schema.at("$ref")), value, at, out);
    check_value(schema, value, at, out);
    if (schema.contains("oneOf")) check_one_of(schema.at("oneOf"), value, at, out);
    if (value.is_array() && schema.contains("items")) {
      for (std::size_t i = 0; i < value.size(); ++i) {
        check(schema.at("items"), value[i], at + "/" + std::to_string(i), out);
      }
    }
    if (value.is_object()) check_object(schema, value, at, out);
  }

  static void check_value(const Json& schema, const Json& value, const std::string& at, std::vector<std::string>& out) {
    if (schema.contains("type")) {
      const Json types = schema.at("type").is_array() ? schema.at("type") : Json::array({schema.at("type")});
      const bool any = std::any_of(types.begin(), types.end(),
                                   [&](const Json& type) { return has_type(value, type.get<std::string>()); });
      if (!any) out.push_back(at + ": " + value.dump() + " is not of type " + types.dump());
    }
    if (schema.contains("const") && value != schema.at("const")) out.push_back(at + ": " + value.dump());
    if (schema.contains("enum")) {
      const Json& all = schema.at("enum");
      if (std::find(all.begin(), all.end(), value) == all.end()) {
        out.push_back(at + ": " + value.dump() + " is none of " + all.dump());
      }
    }
  }

  void check_one_of(const Json& choices, const Json& value, const std::string& at,
                    std::vector<std::string>& out) const {
    int fitting = 0;
    std::vector<std::string> last;
    for (const Json& choice : choices) {
      std::vector<std::string> wrong;
      check(choice, value, at, wrong);
      fitting += wrong.empty() ? 1 : 0;
      if (!wrong.empty()) last = wrong;
    }
    if (fitting == 1) return;
    out.push_back(at + ": fits " + std::to_string(fitting) + " of the choices");
    out.insert(out.end(), last.begin(), last.end());
  }

  void check_object(const Json& schema, const Json& value, const std::string& at, std::vector<std::string>& out) const {
    for (const Json& key : schema.value("required", Json::array())) {
      if (!value.contains(key.get<std::string>())) out.push_back(at + ": '" + key.get<std::string>() + "' is missing");
    }
    const Json properties = schema.value("properties", Json::object());
    for (const auto& [key, inner] : value.items()) {
      if (properties.contains(key)) {
        check(properties.at(key), inner, at + "/" + key, out);
      } else if (schema.value("additionalProperties", Json(true)) == Json(false)) {
        out.push_back(at + ": '" + key + "' is not in the schema");
      }
    }
  }

  const Json& resolve(const std::string& reference) const {
    return root_.at("$defs").at(reference.substr(std::string("#/$defs/").size()));
  }

  Json root_;
};

}  // namespace ferrers::witness
