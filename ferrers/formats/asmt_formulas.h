#pragma once

#include <array>
#include <string>
#include <string_view>

#include "ferrers/formats/asmt_assembly.h"

namespace ferrers {

/// A point or direction in the world, as three formulas.
using AsmtVector = std::array<std::string, 3>;

AsmtVector operator-(const AsmtVector& a, const AsmtVector& b);
std::string dot(const AsmtVector& a, const AsmtVector& b);

/// The frame of one marker of a joint, for formulas: its origin and, one metre along its axes, further points are
/// recorded on its body under `name` with an ending; frames that stand still become numbers.
class AsmtFrameFormulas {
 public:
  AsmtFrameFormulas(AsmtImport& import, const AsmtMarker& marker, std::string name, SourceRange at)
      : import_(import), marker_(marker), name_(std::move(name)), at_(at) {}

  AsmtVector origin();
  AsmtVector axis(int which);  ///< 0: x, 1: y, 2: z. A unit vector.

 private:
  AsmtVector point(int which);  ///< 0: origin, 1 to 3: one metre along x, y, z.

  AsmtImport& import_;
  const AsmtMarker& marker_;
  std::string name_;
  SourceRange at_;
  std::array<std::string, 4> recorded_;  ///< Names of the points, empty where they were not asked for.
};

/// Adds the constraint `formula` = 0. Its text is ours, so it can be parsed.
void add_asmt_constraint(AsmtImport& import, std::string_view name, const std::string& formula, SourceRange at);

}  // namespace ferrers
