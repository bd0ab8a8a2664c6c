#pragma once

#include <array>
#include <string>
#include <vector>

#include "ferrers/formats/asmt_assembly.h"

namespace ferrers {

struct AsmtJoints;

enum class AsmtRelationKind { kRackPinion, kScrew, kGear };

/// One equation between the motions of two parts.
///
/// With z of marker I and the angle a from x of I to x of J about it, and with the offset (x, z) of J from I in I's
/// axes, the file's solver demands that these keep their stored value:
///
///     rack and pinion:  x + radius a
///     screw:            2 pi z - pitch a
///     gears:            (orbit of I seen from J) + radius I / radius J (orbit of J seen from I)
struct AsmtRelation {
  AsmtRelationKind kind = AsmtRelationKind::kGear;
  std::string name;
  SourceRange at;
  AsmtMarker first, second;
  std::array<double, 2> lengths = {0, 0};  ///< Radius, or pitch, or both radii; m.
};

AsmtRelation read_asmt_relation(AsmtRelationKind kind, const AsmtRecord& record, const std::string& name,
                                const AsmtMarker& first, const AsmtMarker& second, AsmtImport& import);

/// Adds each relation as a constraint of joint coordinates, exactly, where both parts turn about z or slide on a common
/// part; refused by name (F602) elsewhere. Cost: linear in the joints of the parts concerned.
void add_asmt_relations(const std::vector<AsmtRelation>& relations, const AsmtJoints& joints, AsmtImport& import);

}  // namespace ferrers
