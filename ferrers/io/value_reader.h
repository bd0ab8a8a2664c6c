#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ferrers/core/diagnostics.h"
#include "ferrers/io/document.h"
#include "ferrers/io/fields.h"
#include "ferrers/io/law_file.h"
#include "ferrers/model/spec.h"

/// Single values of a document: what is a number, a vector, a name is decided here, by the rules of the model file and
/// not by those of a YAML library.
///
/// Every function reports what is wrong and goes on: a number that cannot be had becomes NaN (model building stays
/// silent about what follows from it), anything else empty. Nodes that were reported already are passed in silence.
namespace ferrers {

/// What a value is called in messages, and what its neighbours tell about a mistake.
struct ValueLabel {
  std::string_view key;          ///< 'stiffness'.
  std::string_view owner_title;  ///< "a spring"; may be empty.
};

/// A number as written: '12', '12 mm'.
struct WrittenNumber {
  double value = 0;                    ///< SI.
  std::optional<Dimension> dimension;  ///< With a unit only.
};

/// At most this many bytes of the user's text are repeated in a message.
std::string quoted_in_message(std::string_view text);

class ValueReader {
 public:
  /// `laws` reads CSV files; `diagnostics` receives every error. Both outlive this object.
  ValueReader(LawFiles& laws, Diagnostics& diagnostics) : laws_(laws), diagnostics_(diagnostics) {}

  /// Called with every field that an `ObjectReader` asks for; a test proves with it that all of the table are.
  std::function<void(const ObjectFamily&, const ObjectType&, std::string_view key)> on_asked;

  std::size_t error_count() const { return diagnostics_.items().size(); }
  void error(std::string_view code, SourceRange at, std::string message, std::string hint = {});

  /// `wanted`: no value means any dimension. `written`, if asked for, gets the dimension of a number with a unit.
  Number number(const DocumentNode& node, ValueLabel label, std::optional<Dimension> wanted,
                std::optional<Dimension>* written = nullptr);
  /// `count` 0: any. `wanted` holds one dimension for all, or one per entry.
  std::vector<Number> numbers(const DocumentNode& node, ValueLabel label, std::size_t count,
                              std::span<const std::optional<Dimension>> wanted);
  Number3 vector3(const DocumentNode& node, ValueLabel label, std::optional<Dimension> wanted);
  Number3 vector3_or_scalar(const DocumentNode& node, ValueLabel label, std::optional<Dimension> wanted,
                            bool may_be_rigid);
  Number3 direction(const DocumentNode& node, ValueLabel label);
  PlaceSpec place(const DocumentNode& node, ValueLabel label, bool is_direction);
  std::optional<std::array<Number3, 2>> point_pair(const DocumentNode& node, ValueLabel label);

  std::optional<int> integer(const DocumentNode& node, ValueLabel label);
  std::optional<bool> boolean(const DocumentNode& node, ValueLabel label);
  std::optional<std::string> text(const DocumentNode& node, ValueLabel label);
  std::optional<NameRef> name(const DocumentNode& node, ValueLabel label);
  std::optional<std::string_view> choice(const DocumentNode& node, ValueLabel label,
                                         std::span<const std::string_view> choices);
  std::optional<CoordinateRef> coordinate(const DocumentNode& node, ValueLabel label);
  std::optional<Expression> expression(const DocumentNode& node, ValueLabel label);
  std::optional<Expression> formula_or_number(const DocumentNode& node, ValueLabel label);
  std::vector<std::vector<Expression>> formula_matrix(const DocumentNode& node, ValueLabel label);
  /// A map from coordinates ('joint', 'joint.coordinate') to formulas, or to laws of time.
  std::vector<std::pair<CoordinateRef, Expression>> coordinate_formulas(const DocumentNode& node, ValueLabel label);
  std::vector<std::pair<CoordinateRef, LawSpec>> coordinate_laws(const DocumentNode& node, ValueLabel label);
  std::optional<LawSpec> law(const DocumentNode& node, ValueLabel label, std::optional<Dimension> wanted);

  /// Reads "12", "12 mm"; reports at `at`.
  std::optional<WrittenNumber> written_number(std::string_view text, SourceRange at, ValueLabel label,
                                              std::optional<Dimension> wanted);

  /// A list with exactly `count` entries (0: any); false, with a message, for anything else.
  bool is_list(const DocumentNode& node, ValueLabel label, std::size_t count, std::string_view of);

 private:
  std::optional<Expression> formula(const DocumentNode& node);
  std::vector<std::pair<CoordinateRef, const DocumentNode*>> by_coordinate(const DocumentNode& node, ValueLabel label);
  void wrong_type(const DocumentNode& node, ValueLabel label, std::string_view wanted, std::string hint = {});
  void not_a_number(std::string_view text, SourceRange at, ValueLabel label, std::size_t digits);

  LawFiles& laws_;
  Diagnostics& diagnostics_;
};

}  // namespace ferrers
