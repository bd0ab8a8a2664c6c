#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "ferrers/model/joint_change.h"
#include "ferrers/redundancy/idle_freedoms.h"
#include "ferrers/redundancy/permanence.h"
#include "ferrers/redundancy/release_candidates.h"

/// Problem: which joints would have to be of another type for the mechanism to move as it does, but with every reaction
/// determined, no assembly stress and no need for tight tolerances?
///
/// Given: an assembled state and its report (self-stresses Z over all joints' rows). Wanted: joint changes that release
/// rows R with Z_R regular: then the redundancy is gone and the mobility stays (one more per idle spin, where said).
/// Method: groups of self-stresses that share joints are solved each for itself (release_search.h) and combined, best
/// with best, one suggestion for each pattern of changes. Where the mechanism is more redundant at this pose than at
/// generic ones, a generic configuration is taken: what only the pose adds is no joint's fault.
/// Order of the suggestions: no idle freedoms first; then fewer changes; then the grade of the conditioning (down to
/// 0.05 it is good), the mean preference of the changes, the conditioning. Preferences are a small table
/// (release_candidates.cc): a joint between moving bodies before a bearing on ground; guides may turn at no cost; a
/// member that floats should be centred by contacts and carry no other member along.
/// Every suggestion is re-checked: applied, built, assembled and analysed. Where nothing is redundant at its pose, the
/// rank is full there and so at all but special poses of the motion (a rank can only drop at special ones); else its
/// generic configurations are analysed too.
namespace ferrers {

struct ReleaseChange {
  JointChange change;  ///< `joint`, `to`.
  JointType from = JointType::kRevolute;
  std::string_view says;  ///< What it costs and gains.
};

struct Release {
  std::vector<ReleaseChange> changes;  ///< In the order of the file.
  int redundant_after = 0;             ///< As found by analysing the changed model, generic where that is known.
  int mobility_after = 0;
  int idle_freedoms = 0;    ///< New spins of one body that move no other.
  double conditioning = 0;  ///< Least singular value of Z_R for orthonormal Z in scaled units, 0…1.
  int alternatives = 0;     ///< Other choices of joints with the same pattern of changes, not re-checked.
  bool complete = true;     ///< False: it leaves some redundancy, nothing better was found.
  /// What the re-check found at generic configurations; empty where none was reached or the model is too large.
  std::optional<bool> holds_generically;
  std::string says;                ///< "A becomes spherical, B becomes cylindrical".
  std::string condition;           ///< Where it does not hold generally: how.
  std::vector<std::string> notes;  ///< What the changed joints cannot keep (limits, friction).
};

struct ReleaseReport {
  std::vector<Release> releases;           ///< Best first.
  std::vector<ReleaseObstacle> obstacles;  ///< Changes that the rest of the model forbids.
  std::vector<IdleFreedom> idle_freedoms;  ///< Of the mechanism as it is.
  int groups = 0;                          ///< Independent groups of self-stresses.
  bool search_was_cut = false;             ///< Larger sets were chosen greedily, not enumerated.
  int dropped = 0;                         ///< Candidates that the re-check refused.
  int not_rechecked = 0;                   ///< Suggestions beyond the bound on re-checks, left out.
  std::string note;                        ///< Why the list is empty, or what it is based on; may be empty.
};

struct ReleaseOptions {
  int most = 8;                                  ///< Suggestions.
  int max_changes = 4;                           ///< Per group, in enumeration.
  int evaluations = 40000;                       ///< In all; a bound, not a time, so that answers are always the same.
  int configurations = 3;                        ///< Generic configurations of each re-check.
  double recheck_work = 3e9;                     ///< Bound on Σ rows · coordinates² over the re-checks.
  const PermanenceReport* permanence = nullptr;  ///< Of the mechanism, if known already.
};

ReleaseReport analyze_releases(const System& system, const State& state, const RedundancyReport& report,
                               const ReleaseOptions& options = {});

/// The specification (the analysed one; parameters may have other values) with the changes made. Throws
/// `std::invalid_argument` where it has no such joints.
JointChangeResult apply_release(const ModelSpec& spec, const Release& release,
                                const std::map<std::string, double>& parameter_values = {});

}  // namespace ferrers
