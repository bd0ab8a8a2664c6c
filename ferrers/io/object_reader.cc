#include "ferrers/io/object_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "ferrers/core/closest_name.h"

namespace ferrers {
namespace {

using Kind = DocumentNode::Kind;

std::vector<std::string_view> tags_of(const ObjectFamily& family) {
  std::vector<std::string_view> tags;
  for (const ObjectType& type : family.types) {
    if (!type.tag.empty()) tags.push_back(type.tag);
  }
  return tags;
}

/// What people call the same thing elsewhere.
std::string_view other_name(std::string_view written) {
  static constexpr std::array<std::array<std::string_view, 2>, 22> kNames = {{
      {"hinge", "revolute"},
      {"pin", "revolute"},
      {"rotational", "revolute"},
      {"continuous", "revolute"},
      {"slider", "prismatic"},
      {"slide", "prismatic"},
      {"translational", "prismatic"},
      {"fixed", "weld"},
      {"rigid", "weld"},
      {"ball", "spherical"},
      {"floating", "free"},
      {"cardan", "universal"},
      {"hooke", "universal"},
      {"helical", "screw"},
      {"rack_and_pinion", "gear"},
      {"gears", "gear"},
      {"damper", "joint_damping"},
      {"rotational_spring", "torsion_spring"},
      {"cuboid", "box"},
      {"ball_shape", "sphere"},
      {"bar", "rod"},
      {"moment", "torque"},
  }};
  for (const auto& [theirs, ours] : kNames) {
    if (written == theirs) return ours;
  }
  return {};
}

}  // namespace

ObjectReader::ObjectReader(ValueReader& values, const DocumentNode& node, Family family, NameRef name)
    : values_(values), node_(node), family_(object_family(family)), name_(std::move(name)) {
  if (node.kind == Kind::kBroken) return;
  if (node.is_scalar() && !family_.shorthand.empty()) {
    type_ = &family_.types.front();
    return;
  }
  if (node.kind == Kind::kNull) {
    values_.error(
        "F212", node.at, fmt::format("{} is empty", who()),
        family_.choice_key.empty() ? "" : fmt::format("it is {} and needs '{}'", family_.title, family_.choice_key));
    return;
  }
  if (node.kind != Kind::kMap) {
    values_.error("F203", node.at, fmt::format("{} wants a map of keys and values", who()),
                  fmt::format("{} is written {{key: value, key: value}}", family_.title));
    return;
  }
  type_ = choose_type();
  if (type_ != nullptr) check_keys();
}

/// The object in messages: 'crank', or its title where it has no name.
std::string ObjectReader::who() const {
  return name_.name.empty() ? std::string(family_.title) : quoted_in_message(name_.name);
}

const ObjectType* ObjectReader::choose_type() {
  if (family_.chosen_by_presence()) return choose_by_presence();
  if (family_.choice_key.empty()) return &family_.types.front();
  return choose_by_key(family_.choice_key);
}

const ObjectType* ObjectReader::choose_by_key(std::string_view key) {
  const DocumentNode* chosen = node_.find(key);
  const std::vector<std::string_view> tags = tags_of(family_);
  const std::string all = fmt::format("one of {}", fmt::join(tags, ", "));
  if (chosen == nullptr) {
    if (family_.choice_optional) return family_.find_type({});
    values_.error("F202", name_.at.known() ? name_.at : node_.at, fmt::format("{} needs '{}'", who(), key), all);
    return nullptr;
  }
  if (chosen->is_scalar() && !chosen->text.empty()) {
    if (const ObjectType* type = family_.find_type(chosen->text)) return type;
    const std::string_view ours = other_name(chosen->text);
    std::string hint = family_.find_type(ours) != nullptr && !ours.empty() ? fmt::format("it is called '{}' here", ours)
                                                                           : did_you_mean(chosen->text, tags);
    values_.error("F209", chosen->at,
                  fmt::format("there is no {} {} {}", family_.name, key, quoted_in_message(chosen->text)),
                  hint.empty() ? all : hint);
    return nullptr;
  }
  ValueLabel choice_label{key, family_.title};
  values_.choice(*chosen, choice_label, tags);
  return nullptr;
}

const ObjectType* ObjectReader::choose_by_presence() {
  const ObjectType* chosen = nullptr;
  for (const ObjectType& type : family_.types) {
    const auto found = std::find_if(node_.entries.begin(), node_.entries.end(),
                                    [&](const DocumentEntry& entry) { return entry.key == type.tag; });
    if (found == node_.entries.end()) continue;
    if (chosen == nullptr) {
      chosen = &type;
      continue;
    }
    values_.error("F211", found->key_at, fmt::format("{} has both '{}' and '{}'", who(), chosen->tag, type.tag),
                  "leave one of them out");
    return nullptr;
  }
  if (chosen == nullptr) {
    values_.error("F202", name_.at.known() ? name_.at : node_.at,
                  fmt::format("{} needs one of the keys {}", who(), fmt::join(tags_of(family_), ", ")));
  }
  return chosen;
}

void ObjectReader::check_keys() {
  for (const DocumentEntry& entry : node_.entries) {
    if (entry.key != family_.choice_key && type_->find(entry.key) == nullptr) report_unknown_key(entry);
  }
  for (const FieldInfo& field : type_->fields) {
    const DocumentNode* other = field.unless.empty() ? nullptr : node_.find(field.unless);
    if (other != nullptr && node_.find(field.key) != nullptr) {
      values_.error("F211", other->at, fmt::format("{} has both '{}' and '{}'", who(), field.key, field.unless),
                    "leave one of them out");
    }
    if (!field.required || other != nullptr || node_.find(field.key) != nullptr) continue;
    values_.error("F202", name_.at.known() ? name_.at : node_.at, fmt::format("{} needs '{}'", who(), field.key),
                  fmt::format("{}: {}", field.key, field.doc));
  }
}

void ObjectReader::report_unknown_key(const DocumentEntry& entry) {
  std::vector<std::string_view> known;
  if (!family_.choice_key.empty()) known.push_back(family_.choice_key);
  for (const FieldInfo& field : type_->fields) known.push_back(field.key);
  std::string hint = did_you_mean(entry.key, known);
  for (const ObjectType& type : family_.types) {
    if (hint.empty() && type.find(entry.key) != nullptr) {
      hint = fmt::format("'{}' belongs to {}, and this is {}", entry.key, type.title, type_->title);
    }
  }
  if (entry.key.find(':') != std::string::npos && entry.value.kind == Kind::kNull) {
    hint = "a key is followed by ': ' with a space";
  }
  if (hint.empty()) hint = fmt::format("known keys: {}", fmt::join(known, ", "));
  values_.error("F201", entry.key_at, fmt::format("unknown key {} in {}", quoted_in_message(entry.key), type_->title),
                std::move(hint));
}

const DocumentNode* ObjectReader::find(std::string_view key) const {
  if (node_.is_scalar()) return key == family_.shorthand ? &node_ : nullptr;
  return node_.find(key);
}

bool ObjectReader::has(std::string_view key) const { return find(key) != nullptr; }

SourceRange ObjectReader::place(std::string_view key) const {
  const DocumentNode* node = find(key);
  return node != nullptr ? node->at : node_.at;
}

const DocumentNode* ObjectReader::ask(std::string_view key, std::initializer_list<ValueKind> kinds) {
  const FieldInfo* field = type_ != nullptr ? type_->find(key) : nullptr;
  if (field == nullptr || std::find(kinds.begin(), kinds.end(), field->kind) == kinds.end()) {
    throw std::invalid_argument(fmt::format("ObjectReader: '{}' of '{}' is not in the table so", key, family_.name));
  }
  if (values_.on_asked) values_.on_asked(family_, *type_, field->key);
  return find(key);
}

std::vector<std::optional<Dimension>> ObjectReader::wanted(std::string_view key) const {
  const Quantity& quantity = type_->find(key)->quantity;
  std::vector<std::optional<Dimension>> list;
  switch (quantity.measure) {
    case Measure::kNone:
    case Measure::kAny:
      break;
    case Measure::kFixed:
      list.push_back(quantity.dimension);
      break;
    case Measure::kCoordinate:
      list.assign(coordinates_.position.begin(), coordinates_.position.end());
      break;
    case Measure::kCoordinateRate:
      list.assign(coordinates_.rate.begin(), coordinates_.rate.end());
      break;
    case Measure::kCoordinateEffort:
    case Measure::kCoordinateDamping:
      for (const Dimension& rate : coordinates_.rate) {
        const Dimension effort = rate == kAngularVelocity ? kTorque : kForce;
        list.emplace_back(quantity.measure == Measure::kCoordinateEffort ? effort : effort / rate);
      }
      break;
  }
  return list;
}

void ObjectReader::version(std::string_view key) {
  const DocumentNode* node = ask(key, {ValueKind::kVersion});
  if (node == nullptr) return;
  const std::optional<int> version = values_.integer(*node, label(key));
  if (version && *version != 1) {
    values_.error("F210", node->at, fmt::format("version {} of the model file is not known", *version),
                  "this program reads version 1");
  }
}

std::optional<Number> ObjectReader::number(std::string_view key, std::optional<Dimension>* written) {
  const DocumentNode* node = ask(key, {ValueKind::kNumber});
  if (node == nullptr) return std::nullopt;
  const auto dimensions = wanted(key);
  return values_.number(*node, label(key), dimensions.size() == 1 ? dimensions[0] : std::nullopt, written);
}

std::optional<Number> ObjectReader::number_of(std::string_view key, std::optional<Dimension> wanted_dimension) {
  const DocumentNode* node = ask(key, {ValueKind::kNumber});
  return node == nullptr ? std::nullopt : std::optional(values_.number(*node, label(key), wanted_dimension));
}

std::vector<Number> ObjectReader::numbers(std::string_view key) {
  const DocumentNode* node = ask(key, {ValueKind::kNumberList, ValueKind::kNumberOrList});
  if (node == nullptr) return {};
  auto dimensions = wanted(key);
  if (dimensions.size() > 1 && node->items.size() != dimensions.size()) dimensions.clear();
  if (type_->find(key)->kind == ValueKind::kNumberOrList && node->kind != Kind::kSequence) {
    return {values_.number(*node, label(key), dimensions.size() == 1 ? dimensions[0] : std::nullopt)};
  }
  return values_.numbers(*node, label(key), 0, dimensions);
}

std::optional<std::array<Number, 2>> ObjectReader::number_pair(std::string_view key) {
  const DocumentNode* node = ask(key, {ValueKind::kNumberPair});
  if (node == nullptr) return std::nullopt;
  const auto list = values_.numbers(*node, label(key), 2, wanted(key));
  return std::array{list[0], list[1]};
}

std::optional<Number3> ObjectReader::vector3(std::string_view key) {
  const DocumentNode* node = ask(key, {ValueKind::kVector3, ValueKind::kVector3OrScalar, ValueKind::kStiffness3});
  if (node == nullptr) return std::nullopt;
  const auto dimensions = wanted(key);
  const std::optional<Dimension> dimension = dimensions.empty() ? std::nullopt : dimensions[0];
  const ValueKind kind = type_->find(key)->kind;
  if (kind == ValueKind::kVector3) return values_.vector3(*node, label(key), dimension);
  return values_.vector3_or_scalar(*node, label(key), dimension, kind == ValueKind::kStiffness3);
}

std::optional<std::array<Number, 4>> ObjectReader::vector4(std::string_view key) {
  const DocumentNode* node = ask(key, {ValueKind::kVector4});
  if (node == nullptr) return std::nullopt;
  const auto list = values_.numbers(*node, label(key), 4, wanted(key));
  return std::array{list[0], list[1], list[2], list[3]};
}

std::optional<Number3> ObjectReader::direction(std::string_view key) {
  const DocumentNode* node = ask(key, {ValueKind::kDirection});
  return node == nullptr ? std::nullopt : std::optional(values_.direction(*node, label(key)));
}

PlaceSpec ObjectReader::place_spec(std::string_view key) {
  const DocumentNode* node = ask(key, {ValueKind::kPlace, ValueKind::kAxis});
  return node == nullptr ? PlaceSpec() : values_.place(*node, label(key), type_->find(key)->kind == ValueKind::kAxis);
}

std::optional<std::array<PlaceSpec, 2>> ObjectReader::axis_pair(std::string_view key,
                                                                const std::array<NameRef, 2>& bodies) {
  const DocumentNode* node = ask(key, {ValueKind::kAxisPair});
  if (node == nullptr) return std::nullopt;
  if (node->kind == Kind::kMap) {
    // One axis per body, each in its frame.
    const PlaceSpec both = values_.place(*node, label(key), true);
    std::array<PlaceSpec, 2> pair = {both, both};
    for (std::size_t i = 0; i < 2; ++i) {
      std::erase_if(pair[i].on_body, [&](const auto& entry) { return entry.first.name == bodies[1 - i].name; });
    }
    return pair;
  }
  if (!values_.is_list(*node, label(key), 2, "directions")) return std::nullopt;
  return std::array{values_.place(node->items[0], label(key), true), values_.place(node->items[1], label(key), true)};
}

std::optional<std::array<Number3, 2>> ObjectReader::points(std::string_view key, const std::array<NameRef, 2>& bodies,
                                                           bool& on_bodies) {
  const DocumentNode* node = ask(key, {ValueKind::kPoints});
  on_bodies = false;
  if (node == nullptr) return std::nullopt;
  if (node->kind != Kind::kMap) return values_.point_pair(*node, label(key));
  on_bodies = true;
  std::array<std::optional<Number3>, 2> found;
  const bool bodies_known = !bodies[0].name.empty() && !bodies[1].name.empty();
  for (const DocumentEntry& entry : node->entries) {
    const Number3 point = values_.vector3(entry.value, label(key), kLength);
    const std::size_t which = entry.key == bodies[0].name ? 0 : entry.key == bodies[1].name ? 1 : 2;
    if (which < 2) found[which] = point;
    if (which == 2 && bodies_known) {
      values_.error("F320", entry.key_at,
                    fmt::format("{} names {}, which is not one of its bodies", quoted_in_message(key),
                                quoted_in_message(entry.key)),
                    fmt::format("its bodies are '{}' and '{}'", bodies[0].name, bodies[1].name));
    }
  }
  for (std::size_t i = 0; i < 2 && bodies_known; ++i) {
    if (found[i]) continue;
    values_.error("F320", node->at, fmt::format("{} gives no point on '{}'", quoted_in_message(key), bodies[i].name),
                  "given body by body, both bodies are named");
  }
  if (!found[0] || !found[1]) return std::nullopt;
  return std::array{*found[0], *found[1]};
}

std::optional<std::array<Number3, 2>> ObjectReader::point_pair(std::string_view key) {
  const DocumentNode* node = ask(key, {ValueKind::kPointPair});
  return node == nullptr ? std::nullopt : values_.point_pair(*node, label(key));
}

std::optional<int> ObjectReader::integer(std::string_view key) {
  const DocumentNode* node = ask(key, {ValueKind::kInteger});
  return node == nullptr ? std::nullopt : values_.integer(*node, label(key));
}

std::optional<bool> ObjectReader::boolean(std::string_view key) {
  const DocumentNode* node = ask(key, {ValueKind::kBoolean});
  return node == nullptr ? std::nullopt : values_.boolean(*node, label(key));
}

std::optional<std::string> ObjectReader::text(std::string_view key) {
  const DocumentNode* node = ask(key, {ValueKind::kText});
  return node == nullptr ? std::nullopt : values_.text(*node, label(key));
}

std::optional<NameRef> ObjectReader::name(std::string_view key) {
  const DocumentNode* node = ask(key, {ValueKind::kName});
  return node == nullptr ? std::nullopt : values_.name(*node, label(key));
}

std::optional<std::array<NameRef, 2>> ObjectReader::name_pair(std::string_view key) {
  const DocumentNode* node = ask(key, {ValueKind::kNamePair});
  if (node == nullptr || !values_.is_list(*node, label(key), 2, "names")) return std::nullopt;
  const auto first = values_.name(node->items[0], label(key));
  const auto second = values_.name(node->items[1], label(key));
  if (!first || !second) return std::nullopt;
  return std::array{*first, *second};
}

std::optional<std::string_view> ObjectReader::choice(std::string_view key) {
  const DocumentNode* node = ask(key, {ValueKind::kChoice});
  return node == nullptr ? std::nullopt : values_.choice(*node, label(key), type_->find(key)->choices);
}

std::optional<CoordinateRef> ObjectReader::coordinate(std::string_view key) {
  const DocumentNode* node = ask(key, {ValueKind::kCoordinate});
  return node == nullptr ? std::nullopt : values_.coordinate(*node, label(key));
}

std::vector<CoordinateRef> ObjectReader::coordinates(std::string_view key) {
  const DocumentNode* node = ask(key, {ValueKind::kCoordinateList});
  if (node == nullptr || !values_.is_list(*node, label(key), 0, "joints")) return {};
  std::vector<CoordinateRef> list;
  for (const DocumentNode& item : node->items) {
    if (const auto ref = values_.coordinate(item, label(key))) list.push_back(*ref);
  }
  return list.size() == node->items.size() ? list : std::vector<CoordinateRef>();
}

std::optional<Expression> ObjectReader::expression(std::string_view key) {
  const DocumentNode* node = ask(key, {ValueKind::kExpression});
  return node == nullptr ? std::nullopt : values_.expression(*node, label(key));
}

std::vector<std::vector<Expression>> ObjectReader::formula_matrix(std::string_view key) {
  const DocumentNode* node = ask(key, {ValueKind::kFormulaMatrix});
  if (node == nullptr) return {};
  return values_.formula_matrix(*node, label(key));
}

std::vector<std::pair<CoordinateRef, Expression>> ObjectReader::coordinate_formulas(std::string_view key) {
  const DocumentNode* node = ask(key, {ValueKind::kCoordinateFormulas});
  if (node == nullptr) return {};
  return values_.coordinate_formulas(*node, label(key));
}

std::vector<std::pair<CoordinateRef, LawSpec>> ObjectReader::coordinate_laws(std::string_view key) {
  const DocumentNode* node = ask(key, {ValueKind::kCoordinateLaws});
  if (node == nullptr) return {};
  return values_.coordinate_laws(*node, label(key));
}

std::vector<LawSpec> ObjectReader::laws(std::string_view key) {
  const DocumentNode* node = ask(key, {ValueKind::kLaw, ValueKind::kLaw3});
  if (node == nullptr) return {};
  const auto dimensions = wanted(key);
  const std::optional<Dimension> dimension = dimensions.size() == 1 ? dimensions[0] : std::nullopt;
  const bool three = type_->find(key)->kind == ValueKind::kLaw3;
  if (three && !values_.is_list(*node, label(key), 3, "laws")) return {};
  std::vector<LawSpec> list;
  for (std::size_t i = 0; i < (three ? 3U : 1U); ++i) {
    const auto law = values_.law(three ? node->items[i] : *node, label(key), dimension);
    if (law) list.push_back(*law);
  }
  return list.size() == (three ? 3U : 1U) ? list : std::vector<LawSpec>();
}

const DocumentNode* ObjectReader::object(std::string_view key) {
  return ask(key, {ValueKind::kObject, ValueKind::kNamedObjects, ValueKind::kNamedLists});
}

}  // namespace ferrers
