#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ferrers/io/fields.h"

/// The parts of the table of fields (fields.h); only fields.cc puts them together.
namespace ferrers {

std::vector<ObjectFamily> make_body_families();    ///< Model, parameters, bodies.
std::vector<ObjectFamily> make_joint_families();   ///< Joints, couplings.
std::vector<ObjectFamily> make_action_families();  ///< Forces, drives, initial state, records, events.

// Quantities.
inline constexpr Quantity kOfAny{Measure::kAny, {}, "any unit"};
inline constexpr Quantity kOfLength{Measure::kFixed, kLength, "m"};
inline constexpr Quantity kOfMass{Measure::kFixed, kMass, "kg"};
inline constexpr Quantity kOfInertia{Measure::kFixed, kInertia, "kg·m²"};
inline constexpr Quantity kOfAcceleration{Measure::kFixed, kAcceleration, "m/s²"};
inline constexpr Quantity kOfAngle{Measure::kFixed, kPureNumber, "rad"};
inline constexpr Quantity kOfPureNumber{Measure::kFixed, kPureNumber, "1"};
inline constexpr Quantity kOfForce{Measure::kFixed, kForce, "N"};
inline constexpr Quantity kOfTorque{Measure::kFixed, kTorque, "N·m"};
inline constexpr Quantity kOfStiffness{Measure::kFixed, kStiffness, "N/m"};
inline constexpr Quantity kOfTorsionStiffness{Measure::kFixed, kTorque, "N·m/rad"};
inline constexpr Quantity kOfDamping{Measure::kFixed, kDamping, "N·s/m"};
inline constexpr Quantity kOfTorsionDamping{Measure::kFixed, kTorsionDamping, "N·m·s/rad"};
inline constexpr Quantity kOfCoordinate{Measure::kCoordinate, {}, "rad or m"};
inline constexpr Quantity kOfCoordinateRate{Measure::kCoordinateRate, {}, "rad/s or m/s"};
inline constexpr Quantity kOfCoordinateEffort{Measure::kCoordinateEffort, {}, "N·m or N"};
inline constexpr Quantity kOfCoordinateDamping{Measure::kCoordinateDamping, {}, "N·m·s/rad or N·s/m"};

inline FieldInfo field(std::string_view key, ValueKind kind, Quantity quantity, std::string doc,
                       std::string_view default_text = {}) {
  FieldInfo made;
  made.key = key;
  made.kind = kind;
  made.quantity = quantity;
  made.doc = std::move(doc);
  made.default_text = default_text;
  return made;
}

inline FieldInfo required(FieldInfo made) {
  made.required = true;
  return made;
}

/// A field that another one may stand for.
inline FieldInfo unless(std::string_view other, FieldInfo made) {
  made.unless = other;
  return made;
}

inline FieldInfo object_field(std::string_view key, ValueKind kind, Family family, std::string doc,
                              std::string_view default_text = {}) {
  FieldInfo made = field(key, kind, {}, std::move(doc), default_text);
  made.family = family;
  return made;
}

inline FieldInfo law_field(std::string_view key, ValueKind kind, Quantity quantity, std::string doc,
                           std::string_view default_text = {}) {
  FieldInfo made = field(key, kind, quantity, std::move(doc), default_text);
  made.family = Family::kLawFile;
  return made;
}

inline FieldInfo choice_field(std::string_view key, std::vector<std::string_view> choices, std::string doc,
                              std::string_view default_text = {}) {
  FieldInfo made = field(key, ValueKind::kChoice, {}, std::move(doc), default_text);
  made.choices = std::move(choices);
  return made;
}

}  // namespace ferrers
