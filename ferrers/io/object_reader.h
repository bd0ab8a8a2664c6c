#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

#include "ferrers/io/document.h"
#include "ferrers/io/fields.h"
#include "ferrers/io/value_reader.h"
#include "ferrers/model/spec.h"

namespace ferrers {

/// Dimensions of a joint's coordinates, for fields that speak of them. Empty: not known, then nothing is checked.
struct CoordinateDimensions {
  std::vector<Dimension> position;  ///< Per position coordinate (a quaternion has four).
  std::vector<Dimension> rate;      ///< Per velocity coordinate.
};

/// Reads one object of a family by its row in the table of fields.
///
/// Made: the type is chosen; unknown and missing keys are reported. Then each field is asked for by its key: the table
/// says how it is read, its dimension, and what its absence means. Asking for a key that the type has not, or as
/// something else than it is, is a bug: `std::invalid_argument`. Absent and unreadable fields come back empty.
class ObjectReader {
 public:
  ObjectReader(ValueReader& values, const DocumentNode& node, Family family, NameRef name);

  bool usable() const { return type_ != nullptr; }  ///< Its type is known; else nothing may be asked for.
  const ObjectType& type() const { return *type_; }
  std::string_view tag() const { return type_ == nullptr ? std::string_view() : type_->tag; }
  const DocumentNode& node() const { return node_; }
  bool has(std::string_view key) const;
  SourceRange place(std::string_view key) const;  ///< Of the value, else of the object.
  void set_coordinates(CoordinateDimensions dimensions) { coordinates_ = std::move(dimensions); }

  void version(std::string_view key);  ///< Checks the format version.
  std::optional<Number> number(std::string_view key, std::optional<Dimension>* written = nullptr);
  std::optional<Number> number_of(std::string_view key, std::optional<Dimension> wanted);
  std::vector<Number> numbers(std::string_view key);
  std::optional<std::array<Number, 2>> number_pair(std::string_view key);
  std::optional<Number3> vector3(std::string_view key);
  std::optional<std::array<Number, 4>> vector4(std::string_view key);
  std::optional<Number3> direction(std::string_view key);
  PlaceSpec place_spec(std::string_view key);
  std::optional<std::array<PlaceSpec, 2>> axis_pair(std::string_view key, const std::array<NameRef, 2>& bodies);
  std::optional<std::array<Number3, 2>> points(std::string_view key, const std::array<NameRef, 2>& bodies,
                                               bool& on_bodies);
  std::optional<std::array<Number3, 2>> point_pair(std::string_view key);
  std::optional<int> integer(std::string_view key);
  std::optional<bool> boolean(std::string_view key);
  std::optional<std::string> text(std::string_view key);
  std::optional<NameRef> name(std::string_view key);
  std::optional<std::array<NameRef, 2>> name_pair(std::string_view key);
  std::optional<std::string_view> choice(std::string_view key);
  std::optional<CoordinateRef> coordinate(std::string_view key);
  std::vector<CoordinateRef> coordinates(std::string_view key);
  std::optional<Expression> expression(std::string_view key);
  std::vector<std::vector<Expression>> formula_matrix(std::string_view key);
  std::vector<std::pair<CoordinateRef, Expression>> coordinate_formulas(std::string_view key);
  std::vector<std::pair<CoordinateRef, LawSpec>> coordinate_laws(std::string_view key);
  std::vector<LawSpec> laws(std::string_view key);  ///< kLaw: one; kLaw3: three; empty when one is not readable.
  const DocumentNode* object(std::string_view key);

 private:
  const ObjectType* choose_type();
  const ObjectType* choose_by_key(std::string_view key);
  const ObjectType* choose_by_presence();
  void check_keys();
  void report_unknown_key(const DocumentEntry& entry);
  const DocumentNode* find(std::string_view key) const;
  /// The node of a field of one of these kinds; null when it is absent.
  const DocumentNode* ask(std::string_view key, std::initializer_list<ValueKind> kinds);
  std::vector<std::optional<Dimension>> wanted(std::string_view key) const;
  ValueLabel label(std::string_view key) const { return {key, type_->title}; }
  std::string who() const;

  ValueReader& values_;
  const DocumentNode& node_;
  const ObjectFamily& family_;
  NameRef name_;
  const ObjectType* type_ = nullptr;
  CoordinateDimensions coordinates_;
};

}  // namespace ferrers
