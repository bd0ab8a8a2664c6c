#pragma once

#include <vector>

#include "ferrers/redundancy/idle_freedoms.h"
#include "ferrers/redundancy/release_candidates.h"

/// Problem: of all joint changes choose sets that release as many rows as there are self-stresses, on which Z is
/// regular: then nothing is redundant and the mobility is what it was.
///
/// Given: one group of self-stresses with its candidates. Wanted: for every pattern of changes (which types become
/// which, how often) the best set, with its conditioning: the least singular value of Z_R for orthonormal Z in scaled
/// units, 0…1. Sets with one row more than self-stresses and full rank add one motion; they count where that is the
/// idle spin of one body.
/// Method: small groups by enumeration in the order of the number of changes, under a bound on evaluations; a level
/// that would exceed it is left out whole, so that no order of joints matters. Larger groups greedily: the change with
/// most rows, then the best conditioned part that is new to those chosen (pivoted, with a lazy queue), for several
/// preferences. Cost of the latter: about linear in the candidates where Z is local.
namespace ferrers {

struct ReleaseSet {
  std::vector<int> candidates;  ///< Indices into the group's, by joint.
  std::vector<int> pattern;     ///< Their kinds, sorted.
  int counted = 0;              ///< Number of changes; leaving a joint out counts more.
  int released = 0;             ///< Rows; the group's size if complete, one more for each idle spin.
  int spins = 0;
  double conditioning = 0;
  double preference = 0;  ///< Mean of the logarithms of the candidates' preferences.
  int alternatives = 0;   ///< Other choices of joints with this pattern.
  bool complete = false;
  double work = 0;  ///< Multiplications that a greedy choice took.
};

struct ReleaseSearchOptions {
  int max_changes = 4;
  int evaluations = 20000;  ///< Of this group.
  int most = 8;             ///< Patterns kept.
  bool idle_spins = true;   ///< Look for sets that add an idle spin too.
};

struct ReleaseSearch {
  std::vector<ReleaseSet> sets;  ///< Best first, those with idle spins last.
  bool cut = false;              ///< The bound on evaluations left larger numbers of changes out.
};

ReleaseSearch search_group(const ReleaseGroup& group, const SpinAnalyzer& spins, const ReleaseSearchOptions& options);

/// Least singular value of the released rows of Z for orthonormal Z.
double release_conditioning(const ReleaseGroup& group, const std::vector<int>& candidates);

/// Released constraints answer errors of the others 1/conditioning-fold. Down to a twentieth that matters less than
/// what a change costs, so conditioning counts by grades before preference, and by its value after it.
int conditioning_grade(double conditioning);

/// True where `a` comes before `b`: grade, preference, conditioning.
bool is_preferred(double conditioning_a, double preference_a, double conditioning_b, double preference_b);

/// Best first: complete, idle spins, number of changes, then as above.
bool is_better(const ReleaseSet& a, const ReleaseSet& b);

/// Greedy choice (release_greedy.cc). `joint_allowed` and `kind_allowed` restrict it; incomplete where that leaves
/// something.
struct GreedyRules {
  bool slide_and_align_only = false;  ///< Neither spheres in cylinders nor crosses made of hinges.
  bool moving_only = false;           ///< No bearings on ground.
  bool removal = false;               ///< Joints may be left out.
};
ReleaseSet choose_greedily(const ReleaseGroup& group, const SpinAnalyzer& spins, const GreedyRules& rules);

/// Fills in pattern, counts, preference and conditioning.
ReleaseSet make_release_set(const ReleaseGroup& group, std::vector<int> candidates);

}  // namespace ferrers
