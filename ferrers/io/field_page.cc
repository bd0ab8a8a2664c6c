#include <fmt/format.h>

#include "ferrers/io/fields.h"

namespace ferrers {
namespace {

std::string kind_text(const FieldInfo& field) {
  const std::string family = std::string(object_family(field.family).name);
  switch (field.kind) {
    case ValueKind::kVersion:
      return "1";
    case ValueKind::kNumber:
      return "number";
    case ValueKind::kNumberOrList:
      return "number, or list of numbers";
    case ValueKind::kNumberList:
      return "list of numbers";
    case ValueKind::kNumberPair:
      return "[low, high]";
    case ValueKind::kVector3:
      return "[x, y, z]";
    case ValueKind::kVector3OrScalar:
      return "[x, y, z], or one number";
    case ValueKind::kStiffness3:
      return "[x, y, z], or one number; `rigid`";
    case ValueKind::kVector4:
      return "[w, x, y, z]";
    case ValueKind::kDirection:
      return "direction";
    case ValueKind::kPlace:
      return "point, or map of body to point";
    case ValueKind::kAxis:
      return "direction, or map of body to direction";
    case ValueKind::kAxisPair:
      return "two directions";
    case ValueKind::kPoints:
      return "two points, or map of body to point";
    case ValueKind::kPointPair:
      return "two points";
    case ValueKind::kInteger:
      return "whole number";
    case ValueKind::kBoolean:
      return "true or false";
    case ValueKind::kText:
      return "text";
    case ValueKind::kChoice:
      return fmt::format("`{}`", fmt::join(field.choices, "`, `"));
    case ValueKind::kName:
      return "name";
    case ValueKind::kNamePair:
      return "two names";
    case ValueKind::kCoordinate:
      return "joint, or joint.coordinate";
    case ValueKind::kCoordinateList:
      return "list of these";
    case ValueKind::kExpression:
      return "formula";
    case ValueKind::kFormulaMatrix:
      return "rows of formulas or numbers";
    case ValueKind::kCoordinateFormulas:
      return "map of coordinate to formula or number";
    case ValueKind::kCoordinateLaws:
      return "map of coordinate to law";
    case ValueKind::kLaw:
      return "law";
    case ValueKind::kLaw3:
      return "three laws";
    case ValueKind::kObject:
      return fmt::format("[{0}](#{0})", family);
    case ValueKind::kNamedObjects:
      return fmt::format("map of name to [{0}](#{0})", family);
    case ValueKind::kNamedLists:
      return fmt::format("map of name to [{0}](#{0}) or list of them", family);
  }
  return {};
}

std::string cell(std::string_view text) { return text.empty() ? std::string("–") : std::string(text); }

void add_table(std::string& page, const std::vector<FieldInfo>& fields) {
  if (fields.empty()) return;
  page += "| key | value | unit | default | |\n|---|---|---|---|---|\n";
  for (const FieldInfo& field : fields) {
    page += fmt::format("| `{}` | {} | {} | {} | {} |\n", field.key, kind_text(field), cell(field.quantity.unit),
                        field.required ? "**required**" : cell(field.default_text), field.doc);
  }
  page += "\n";
}

constexpr std::string_view kIntroduction = R"(# The model file

One file in YAML 1.2 (or JSON, which is the same) describes one mechanism. This page is made from the table by which the
program reads; `ferrers schema` prints the same as a JSON Schema for editors.

- A **number** is a decimal number in SI units, a number with a unit in one text (`120 mm`, `200 N/m`, `30 deg`), or a
  formula over the parameters that starts with `=` (`= 3*r`). In a list in brackets a formula with a comma needs quotes.
  Octal, hexadecimal and infinite numbers, and numbers in quotes, are errors.
- A **direction** is `x`, `y`, `z`, `-x`, `-y`, `-z`, or a vector of any length but zero.
- A **law** is a number, a formula of the time `t` (efforts and forces also of joint coordinates: `main.position`,
  `main.velocity`), or `{file: law.csv, column: 2}`. [Formulas](formulas.md) tells operators, functions, units and names.
- A **name** has letters, digits and `_`, and does not start with a digit.
- Points and directions are given in the world as drawn, or in the body's own frame where the body has a `pose`.
- Unknown, missing and repeated keys, anchors, aliases, merge keys and tags are errors. Yes and no are `true` and `false`.

)";

}  // namespace

std::string model_reference_page() {
  std::string page(kIntroduction);
  for (const ObjectFamily& family : object_families()) {
    page += fmt::format("## {}\n\n{}\n\n", family.name, family.doc);
    if (!family.shorthand.empty()) page += fmt::format("`{}` alone may stand for the map.\n\n", family.shorthand);
    for (const ObjectType& type : family.types) {
      if (family.types.size() > 1) {
        const std::string choice = family.choice_key.empty() ? fmt::format("with `{}`", type.tag)
                                   : type.tag.empty()        ? fmt::format("without `{}`", family.choice_key)
                                                             : fmt::format("`{}: {}`", family.choice_key, type.tag);
        page += fmt::format("### {}\n\n{}. {}\n\n", choice, type.title, type.doc);
      }
      add_table(page, type.fields);
    }
  }
  while (page.size() > 1 && page[page.size() - 2] == '\n') page.pop_back();
  return page;
}

}  // namespace ferrers
