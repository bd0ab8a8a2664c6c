#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ferrers/core/units.h"

/// The one table of what a model file may hold. The reader (model_reader.h), the JSON Schema (schema.h) and the
/// reference page (`model_reference_page`) come from it; a test proves that the reader reads every field of it.
///
/// Vocabulary: a *family* is a sort of object (a joint, a force); its *types* have their own fields. What tells the
/// types of a family apart is a choice key (`type: spring`, `shape: box`), or which key is present (a drive's `joint`,
/// `bodies` or `point`).
namespace ferrers {

enum class ValueKind {
  kVersion,          ///< The integer 1.
  kNumber,           ///< Number, 'number unit', or '= expression' over the parameters.
  kNumberOrList,     ///< One number, or one per coordinate.
  kNumberList,       ///< Any count.
  kNumberPair,       ///< [low, high].
  kVector3,          ///< [x, y, z].
  kVector3OrScalar,  ///< [x, y, z], or one number for all three.
  kStiffness3,       ///< The same; an entry may be the word 'rigid'.
  kVector4,          ///< [w, x, y, z].
  kDirection,        ///< x, y, z, -x, -y, -z, or [x, y, z].
  kPlace,            ///< A point [x, y, z] as drawn, or a map from each of the two bodies to a point in its frame.
  kAxis,             ///< A direction as drawn, or a map from each of the two bodies to a direction in its frame.
  kAxisPair,         ///< Two of these.
  kPoints,           ///< Two points, on the first and second body; or a map from body to point.
  kPointPair,        ///< Two points as drawn.
  kInteger,
  kBoolean,  ///< true or false.
  kText,
  kChoice,      ///< One of `choices`.
  kName,        ///< The name of something in this file.
  kNamePair,    ///< [first, second].
  kCoordinate,  ///< 'joint' or 'joint.coordinate'.
  kCoordinateList,
  kExpression,          ///< '= expression' of time and coordinates.
  kFormulaMatrix,       ///< Rows of expressions or numbers.
  kCoordinateFormulas,  ///< A map from coordinates to expressions or numbers.
  kCoordinateLaws,      ///< A map from coordinates to laws of time.
  kLaw,                 ///< A number, '= expression' of time, or {file: law.csv, column: 2}.
  kLaw3,                ///< Three of these.
  kObject,              ///< One object of `family`.
  kNamedObjects,        ///< A map from names to objects of `family`.
  kNamedLists,          ///< A map from names to an object of `family` or a list of such.
};

/// What a number measures. Some depend on the joint coordinate that the object speaks of.
enum class Measure {
  kNone,   ///< Not a number.
  kAny,    ///< Any dimension.
  kFixed,  ///< `dimension`.
  kCoordinate,
  kCoordinateRate,
  kCoordinateEffort,
  kCoordinateDamping,
};

struct Quantity {
  Measure measure = Measure::kNone;
  Dimension dimension;    ///< For kFixed.
  std::string_view unit;  ///< For people: "N·m/rad".
};

enum class Family {
  kModel,
  kParameter,
  kBody,
  kBodyInertia,
  kPose,
  kRotation,
  kJoint,
  kJointStiffness,
  kMisalignment,
  kJointFrames,
  kFriction,
  kCoupling,
  kConstraint,
  kLagrangian,
  kGeneralCoordinate,
  kForceElement,
  kBushingStiffness,
  kBushingDamping,
  kDrive,
  kInitial,
  kRecord,
  kEvent,
  kLawFile,
};

struct FieldInfo {
  std::string_view key;
  ValueKind kind = ValueKind::kNumber;
  bool required = false;
  std::string_view unless;  ///< The field that stands for this one; they exclude each other.
  Quantity quantity;
  std::string_view default_text;  ///< What its absence means; empty: nothing to say.
  std::string doc;
  Family family = Family::kModel;  ///< For kObject, kNamedObjects, kNamedLists, kLaw.
  std::vector<std::string_view> choices;
};

struct ObjectType {
  std::string_view tag;  ///< The value of the family's choice key; or the key whose presence chooses; else empty.
  std::string title;     ///< With its article: "a revolute joint".
  std::string doc;
  std::vector<FieldInfo> fields;

  const FieldInfo* find(std::string_view key) const;
};

struct ObjectFamily {
  Family id;
  std::string_view name;         ///< "joint"; names the definition in the schema.
  std::string_view title;        ///< "a joint".
  std::string_view choice_key;   ///< "type", "shape"; empty: one type, or chosen by presence.
  bool choice_optional = false;  ///< Then the type with an empty tag is meant.
  std::string_view shorthand;    ///< The field that may stand for the whole object.
  std::string doc;
  std::vector<ObjectType> types;

  bool chosen_by_presence() const { return choice_key.empty() && types.size() > 1; }
  const ObjectType* find_type(std::string_view tag) const;
};

const ObjectFamily& object_family(Family family);
/// All families, the model first, in the order of the reference page.
const std::vector<ObjectFamily>& object_families();

/// Names are `[A-Za-z_][A-Za-z0-9_]*`.
bool is_model_name(std::string_view text);

/// The reference page of the model file in Markdown, from the table.
std::string model_reference_page();

}  // namespace ferrers
