#pragma once

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "ferrers/model/model.h"

/// What tests of model building say often.
namespace ferrers::witness {

/// A number written as a formula of the parameters.
inline Number formula(const std::string& text, SourceRange at = {}) {
  Diagnostics diagnostics;
  const std::optional<Expression> expression = Expression::parse(text, at, diagnostics);
  EXPECT_TRUE(expression.has_value()) << text;
  Number number;
  number.expression = expression.value_or(Expression());
  number.at = at;
  return number;
}

inline ParameterSpec parameter(const std::string& name, const Number& value) {
  ParameterSpec spec;
  spec.name = name;
  spec.value = value;
  return spec;
}

/// The codes of all diagnostics, in the order found.
inline std::vector<std::string> codes(const Diagnostics& diagnostics) {
  std::vector<std::string> found;
  for (const Diagnostic& one : diagnostics.items()) found.push_back(one.code);
  return found;
}

inline std::vector<std::string> build_codes(const ModelSpec& spec, const std::map<std::string, double>& values = {}) {
  return codes(build_model(spec, values).diagnostics);
}

/// All messages and hints in one text, for failures and for looking up words.
inline std::string messages(const Diagnostics& diagnostics) {
  std::string text;
  for (const Diagnostic& one : diagnostics.items()) text += one.code + ": " + one.message + " (" + one.hint + ")\n";
  return text;
}

/// The model of a specification that must have no errors.
inline Model built(const ModelSpec& spec, const std::map<std::string, double>& values = {}) {
  ModelBuildResult result = build_model(spec, values);
  EXPECT_TRUE(result.model.has_value()) << messages(result.diagnostics);
  return result.model ? *result.model : Model();
}

using Codes = std::vector<std::string>;

}  // namespace ferrers::witness
