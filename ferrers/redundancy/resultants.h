#pragma once

#include <string>
#include <vector>

#include "ferrers/redundancy/analysis.h"

/// Problem: how two hinges share a door's weight is not determined, what they carry together is.
///
/// Given: a report with its self-stresses. Wanted: joints that stand side by side between the same two bodies (welded
/// ones count as one), or that carry one body together, of whose summed wrench more is unique than of theirs one by
/// one. What every self-stress puts into the sum, G_allᵀ Z = 0 per body, decides; the sum is taken at one point. Cost:
/// linear in the joints, times the square of what a body has.
namespace ferrers {

struct UniqueResultant {
  std::vector<std::string> joints;  ///< Whose wrenches are added, in the order of the file.
  std::string on_body;              ///< The body that they act on.
  std::string from_body;            ///< The other side; empty: several.
  int unique_dimension = 0;         ///< Of the six components of the sum.
  int separate_dimension = 0;       ///< Of the joint of whose wrench most is known: unique ones and its freedoms.
};

std::vector<UniqueResultant> find_unique_resultants(const System& system, const State& state,
                                                    const RedundancyReport& report);

}  // namespace ferrers
