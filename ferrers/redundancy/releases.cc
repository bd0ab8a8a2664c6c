#include "ferrers/redundancy/releases.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "ferrers/model/joints/joint_type.h"
#include "ferrers/redundancy/release_search.h"

namespace ferrers {
namespace {

constexpr int kMostWithSpins = 50;  // groups up to which sets with idle spins, and one change more, are looked at
constexpr int kMostWalked = 600;    // coordinates up to which a generic configuration is looked for

double analysis_work(const System& system) {
  double work = 0;
  for (const Cluster& cluster : system.topology->clusters) {
    double rows = 0, columns = 0;
    for (const int c : cluster.closures) rows += system.topology->closures[c].row_count;
    for (const int n : cluster.nodes) columns += system.nodes[n].nv;
    work += rows * columns * std::min(rows, columns);
  }
  return work;
}

bool holds_as_drawn_only(const Model& model) {
  return std::any_of(model.joints().begin(), model.joints().end(), [](const Joint& joint) {
    return joint.type == JointType::kGearMesh && joint.constants.mesh_holds_as_drawn_only;
  });
}

int most_redundant_branch(const PermanenceReport& permanence) {
  int most = 0;
  for (const BranchReport& branch : permanence.branches) most = std::max(most, branch.redundant);
  return most;
}

// One set per group.
struct Combination {
  std::vector<int> sets;
  int counted = 0, spins = 0, alternatives = 0;
  double conditioning = 1, preference = 0;
  bool complete = true;
};

bool is_better_combination(const Combination& a, const Combination& b) {
  if (a.complete != b.complete) return a.complete;
  if ((a.spins > 0) != (b.spins > 0)) return b.spins > 0;
  if (a.counted != b.counted) return a.counted < b.counted;
  return is_preferred(a.conditioning, a.preference, b.conditioning, b.preference);
}

// A state where the redundancy is the generic one.
std::optional<State> find_generic_state(const System& system, const State& from, int generic_redundant) {
  if (system.nv > kMostWalked) return std::nullopt;
  const Scaling& scaling = system.scaling;
  PositionKinematics pos = make_position_kinematics(system);
  const VelocityKinematics rest = make_velocity_kinematics(system);
  ConstraintKinematics constraints = make_constraint_kinematics(system);
  compute_positions(system, from.q, pos);
  compute_constraints(system, from, pos, rest, constraints);
  const MatrixXd free =
      analyze_rank(scaling.rows.asDiagonal() * constraints.G * scaling.columns.asDiagonal(), 1.0).right_null;
  if (free.cols() == 0) return std::nullopt;
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  constexpr int kAttempts = 16;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    VectorXd weights(free.cols());
    for (double& w : weights) w = normal(random);
    VectorXd step = free * weights;
    step *= 0.35 / (1 + attempt % 4) * scaling.length_m / step.cwiseAbs().maxCoeff();
    State there = from;
    displace(system, step.cwiseProduct(scaling.columns), there.q);
    int iterations = 0;
    if (close_loops(system, scaling, {}, 60, there, iterations) > closed_tolerance(scaling)) continue;
    if (analyze_redundancy(system, there).redundant == generic_redundant) return there;
  }
  return std::nullopt;
}

class ReleaseAnalysis {
 public:
  ReleaseAnalysis(const System& system, const State& state, const RedundancyReport& report,
                  const ReleaseOptions& options)
      : system_(system), model_(*system.model), state_(state), report_(report), options_(options) {
    for (const Parameter& parameter : model_.parameters()) parameters_[parameter.name] = parameter.value;
  }

  ReleaseReport run() {
    out_.idle_freedoms = idle_freedoms(system_, state_, report_);
    if (report_.redundant == 0) {
      out_.note = "nothing is redundant";
      return std::move(out_);
    }
    find_generic();
    if (out_.note.empty() || generic_redundant_ > 0) search();
    return std::move(out_);
  }

 private:
  PermanenceOptions permanence_options() const {
    PermanenceOptions options;
    options.branches.configurations = options_.configurations;
    return options;
  }

  // What the mechanism is like in general: the base that changes are judged against.
  void find_generic() {
    generic_mobility_ = report_.mobility;
    generic_redundant_ = report_.redundant;
    base_ = state_;
    base_report_ = report_;
    PermanenceReport own;
    const PermanenceReport* permanence = options_.permanence;
    if (permanence == nullptr) {
      own = analyze_permanence(system_, state_, report_, permanence_options());
      permanence = &own;
    }
    if (!permanence->generic_redundant) return;
    special_branches_ = std::max(0, most_redundant_branch(*permanence) - *permanence->generic_redundant);
    if (*permanence->generic_redundant >= report_.redundant) return;
    if (*permanence->generic_redundant == 0) {
      generic_redundant_ = 0;
      out_.note = "redundant at this pose only: away from it no joint needs to change";
      return;
    }
    const std::optional<State> there = find_generic_state(system_, state_, *permanence->generic_redundant);
    if (!there) return;
    base_ = *there;
    base_report_ = analyze_redundancy(system_, *there);
    generic_redundant_ = base_report_.redundant;
    generic_mobility_ = base_report_.mobility;
    out_.note = fmt::format("for the {} that are redundant at generic configurations; this pose adds {}",
                            generic_redundant_, report_.redundant - generic_redundant_);
  }

  void search() {
    groups_ = find_release_groups(system_, base_, base_report_, out_.obstacles);
    out_.groups = static_cast<int>(groups_.size());
    if (groups_.empty()) return;
    const SpinAnalyzer spins(system_, base_, base_report_);
    ReleaseSearchOptions search;
    search.max_changes = options_.max_changes;
    search.evaluations = std::max(200, options_.evaluations / out_.groups);
    search.most = options_.most + 2;
    search.idle_spins = out_.groups <= kMostWithSpins;
    bool any = false;
    for (const ReleaseGroup& group : groups_) {
      ReleaseSearch found = search_group(group, spins, search);
      out_.search_was_cut = out_.search_was_cut || found.cut;
      any = any || !found.sets.empty();
      found_.push_back(std::move(found.sets));
    }
    if (any) recheck(combine());
    if (out_.releases.empty()) {
      out_.note = "no change of joint types was found that removes the redundancy";
      if (out_.search_was_cut) out_.note += "; too many self-stresses hang together for a full search";
    }
  }

  // For every pattern that some group offers: the groups that offer it use it, the others their best.
  std::vector<Combination> combine() const {
    std::vector<const std::vector<int>*> patterns;
    std::set<std::vector<int>> seen_patterns;
    for (const auto& sets : found_) {
      for (const ReleaseSet& set : sets) {
        if (seen_patterns.insert(set.pattern).second) patterns.push_back(&set.pattern);
      }
    }
    constexpr std::size_t kMostPatterns = 40;
    if (patterns.size() > kMostPatterns) patterns.resize(kMostPatterns);
    std::vector<Combination> all;
    std::set<std::vector<int>> seen;
    for (const std::vector<int>* pattern : patterns) {
      Combination one;
      for (const auto& sets : found_) {
        const auto same =
            std::find_if(sets.begin(), sets.end(), [&](const ReleaseSet& set) { return set.pattern == *pattern; });
        one.sets.push_back(sets.empty() ? -1 : same == sets.end() ? 0 : static_cast<int>(same - sets.begin()));
      }
      if (!seen.insert(one.sets).second) continue;
      measure(one);
      all.push_back(std::move(one));
    }
    std::stable_sort(all.begin(), all.end(), is_better_combination);
    return all;
  }

  void measure(Combination& one) const {
    double changes = 0;
    for (std::size_t g = 0; g < found_.size(); ++g) {
      if (one.sets[g] < 0) {
        one.complete = false;
        continue;
      }
      const ReleaseSet& set = found_[g][one.sets[g]];
      const double n = static_cast<double>(set.candidates.size());
      one.counted += set.counted;
      one.spins += set.spins;
      one.alternatives = std::min(one.alternatives + set.alternatives, 1000000);
      one.conditioning = std::min(one.conditioning, set.conditioning);
      one.preference += n * set.preference;
      changes += n;
      one.complete = one.complete && set.complete;
    }
    if (changes > 0) one.preference /= changes;
  }

  Release make_release(const Combination& combination) const {
    Release release;
    release.conditioning = combination.conditioning;
    release.alternatives = combination.alternatives;
    release.complete = combination.complete;
    release.idle_freedoms = combination.spins;
    std::vector<const ReleaseCandidate*> chosen;
    for (std::size_t g = 0; g < found_.size(); ++g) {
      if (combination.sets[g] < 0) continue;
      for (const int c : found_[g][combination.sets[g]].candidates) chosen.push_back(&groups_[g].candidates[c]);
    }
    std::sort(chosen.begin(), chosen.end(), [](const auto* a, const auto* b) { return a->joint < b->joint; });
    for (const ReleaseCandidate* one : chosen) {
      const ReleaseKind& kind = release_kinds()[one->kind];
      release.changes.push_back({.change = {model_.joints()[one->joint].name, kind.to, one->direction},
                                 .from = kind.from,
                                 .says = kind.says});
      release.redundant_after -= one->k();
    }
    release.redundant_after = std::max(0, generic_redundant_ + release.redundant_after + combination.spins);
    release.mobility_after = generic_mobility_ + combination.spins;
    release.says = summary(release);
    return release;
  }

  static std::string summary(const Release& release) {
    constexpr std::size_t kMostNamed = 4;
    std::string text;
    if (release.changes.size() <= kMostNamed) {
      for (const ReleaseChange& one : release.changes) {
        text += fmt::format("{}{} {} {}", text.empty() ? "" : ", ", one.change.joint,
                            one.change.to == JointType::kFree ? "is" : "becomes", type_text(one));
      }
      return text;
    }
    std::map<std::string, int> counts;
    for (const ReleaseChange& one : release.changes) {
      ++counts[fmt::format("{} to {}", joint_type_info(one.from).name, type_text(one))];
    }
    for (const auto& [pair, count] : counts) text += fmt::format("{}{} × {}", text.empty() ? "" : ", ", count, pair);
    return text;
  }

  static std::string type_text(const ReleaseChange& one) {
    if (one.change.to == JointType::kFree) return "left out";
    const bool slot = one.from == JointType::kRevolute && one.change.to == JointType::kPointOnLine &&
                      one.change.direction.norm() > 0.5;
    return std::string(joint_type_info(one.change.to).name) + (slot ? " across its axis" : "");
  }

  void recheck(const std::vector<Combination>& combinations) {
    double work = 0;
    for (const Combination& combination : combinations) {
      if (static_cast<int>(out_.releases.size()) >= options_.most) break;
      if (combination.complete != combinations.front().complete) break;  // parts only where nothing whole is found
      if (work > options_.recheck_work && !out_.releases.empty()) {
        ++out_.not_rechecked;
        continue;
      }
      Release release = make_release(combination);
      if (holds(release, work)) {
        out_.releases.push_back(std::move(release));
      } else {
        ++out_.dropped;
      }
    }
    std::stable_partition(out_.releases.begin(), out_.releases.end(),
                          [](const Release& one) { return one.holds_generically.value_or(true); });
  }

  // Applies, rebuilds, analyses; fills in what was found.
  bool holds(Release& release, double& work) const {
    JointChangeResult changed = apply_release(model_.spec(), release, parameters_);
    if (!changed.spec) return false;
    release.notes = std::move(changed.notes);
    ModelBuildResult built = build_model(std::move(*changed.spec), parameters_);
    if (!built.model) return false;
    const auto system = make_system(std::move(*built.model));
    const AssemblyResult assembly = assemble(*system);
    if (assembly.status != AssemblyStatus::kAssembled) return false;
    const RedundancyReport after = analyze_redundancy(*system, assembly.state);
    work += analysis_work(*system);
    const int spins =
        static_cast<int>(idle_freedoms(*system, assembly.state, after).size() - out_.idle_freedoms.size());
    if (spins != release.idle_freedoms) return false;
    const int redundant = release.redundant_after, mobility = release.mobility_after;
    const bool here = after.redundant == redundant && after.mobility == mobility;
    PermanenceReport generic;
    if (after.redundant > 0) {
      generic = analyze_permanence(*system, assembly.state, after, permanence_options());
      work += options_.configurations * analysis_work(*system);
    } else if (!holds_as_drawn_only(*system->model)) {
      generic.generic_redundant = 0;  // rank can only be lower at special poses: full here is full in general
      generic.generic_mobility = after.mobility;
    }
    release.redundant_after = generic.generic_redundant.value_or(after.redundant);
    release.mobility_after = generic.generic_mobility.value_or(after.mobility);
    if (!generic.generic_redundant) {
      release.condition = here ? "checked at this pose only" : "";
      return here;
    }
    release.holds_generically = release.redundant_after == redundant && release.mobility_after == mobility;
    const int on_worst_branch = most_redundant_branch(generic);
    if (*release.holds_generically && on_worst_branch > redundant + special_branches_) {
      release.holds_generically = false;
      release.condition =
          fmt::format("on some branch of the motion through this pose {} stay redundant", on_worst_branch);
      return true;
    }
    if (*release.holds_generically) {
      if (!here) release.condition = fmt::format("at the drawn pose {} stay redundant", after.redundant);
      return true;
    }
    if (!here) return false;
    release.condition =
        fmt::format("holds at this pose only: at other configurations {} are redundant and the mobility is {}",
                    release.redundant_after, release.mobility_after);
    release.redundant_after = after.redundant;
    release.mobility_after = after.mobility;
    return true;
  }

  const System& system_;
  const Model& model_;
  const State& state_;
  const RedundancyReport& report_;
  ReleaseOptions options_;
  std::map<std::string, double> parameters_;
  State base_;
  RedundancyReport base_report_;
  int generic_mobility_ = 0, generic_redundant_ = 0;
  int special_branches_ = 0;  // how much more is redundant on some branch of motion through the pose
  std::vector<ReleaseGroup> groups_;
  std::vector<std::vector<ReleaseSet>> found_;
  ReleaseReport out_;
};

}  // namespace

ReleaseReport analyze_releases(const System& system, const State& state, const RedundancyReport& report,
                               const ReleaseOptions& options) {
  return ReleaseAnalysis(system, state, report, options).run();
}

JointChangeResult apply_release(const ModelSpec& spec, const Release& release,
                                const std::map<std::string, double>& parameter_values) {
  std::vector<JointChange> changes;
  for (const ReleaseChange& one : release.changes) changes.push_back(one.change);
  return change_joints(spec, changes, parameter_values);
}

}  // namespace ferrers
