#pragma once

#include <string_view>

#include "ferrers/redundancy/distribution.h"

/// Problem: stiffnesses are known roughly; how far do the reactions that they divide depend on that?
///
/// Given: a solved distribution and an interval by which each entry of each joint's stiffness may be multiplied, all
/// independently. Wanted: the least and the largest value of each reaction component.
/// Every compliance enters Zᵀ C Z with rank one, so that each component is a quotient of two linear functions of any
/// one compliance alone, hence monotone in it: the extremes lie at corners of the box. With at most
/// `kMostEnumerated` springs all corners are visited (in the order of a Gray code, one update of rank one each). With a
/// single self-stress the quotient is one of linear functions of all compliances, and going uphill along the edges ends
/// at the best corner. Both are exact. Else edges are climbed from several seeded starts: the values found are
/// attained, the true range may be wider, and the method says so. Cost: corners · (k² + k · components), or starts ·
/// components · springs · k².
namespace ferrers {

inline constexpr int kMostEnumerated = 12;

struct StiffnessRange {
  double low = 1, high = 1;  ///< Factors of every stiffness entry; 0 < low ≤ high.
};

enum class BoundsMethod {
  kExact,
  kSearch,    ///< Attained values; the true range may be wider.
  kTooLarge,  ///< Not computed: too many springs for the time that it would take.
};
std::string_view to_string(BoundsMethod method);

struct ReactionBounds {
  BoundsMethod method = BoundsMethod::kExact;
  VectorXd low, high;  ///< Per target.
};

/// `lambda`: solves the distribution with the stiffness as given. `targets`: components × rows, so that their values
/// are targets · lambda; none of them may be worked on by a remaining self-stress.
ReactionBounds bound_reactions(const ForceMethod& method, const AllRows& rows, const std::vector<ComponentMap>& maps,
                               const VectorXd& lambda, const MatrixXd& targets, const StiffnessRange& range);

}  // namespace ferrers
