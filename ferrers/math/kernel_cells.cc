#include "ferrers/math/kernel_cells.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <utility>

#include "ferrers/math/number_index.h"
#include "ferrers/math/straight_code.h"

namespace ferrers {
namespace {

using Value = ExpressionGraph::Value;

constexpr std::size_t kFew = 12;    // tags that a cell may have
constexpr std::size_t kWidth = 4;   // lanes
constexpr std::size_t kFewest = 3;  // cells that are worth a group
constexpr int kNone = 0, kMany = -1;

// Sets of tags, each once.
class TagSets {
 public:
  TagSets() { sets_.emplace_back(); }

  int single(int tag) { return number({tag}); }
  int united(int a, int b) {
    if (a == kMany || b == kMany) return kMany;
    if (a == b || b == kNone) return a;
    if (a == kNone) return b;
    if (a > b) std::swap(a, b);
    const std::uint64_t pair = static_cast<std::uint64_t>(a) << 32U | static_cast<unsigned>(b);
    const int next = static_cast<int>(unions_.size());
    const int known = index_.find_or_add(mixed(pair), next, [&](int one) { return unions_[one].first == pair; });
    if (known != next) return unions_[known].second;
    std::vector<int> all;
    std::set_union(sets_[a].begin(), sets_[a].end(), sets_[b].begin(), sets_[b].end(), std::back_inserter(all));
    const int united = all.size() > kFew ? kMany : number(std::move(all));
    unions_.emplace_back(pair, united);
    return united;
  }
  const std::vector<int>& operator[](int set) const { return sets_[set]; }
  std::size_t count() const { return sets_.size(); }

 private:
  int number(std::vector<int> set) {
    const auto [place, is_new] = numbers_.try_emplace(set, static_cast<int>(sets_.size()));
    if (is_new) sets_.push_back(std::move(set));
    return place->second;
  }

  std::vector<std::vector<int>> sets_;
  std::map<std::vector<int>, int> numbers_;
  std::vector<std::pair<std::uint64_t, int>> unions_;  ///< Of two sets.
  NumberIndex index_;                                  ///< Of these.
};

class Partition {
 public:
  Partition(const ExpressionGraph& graph, std::span<const int> outputs, const KernelTags& tags)
      : graph_(graph), values_(graph.values()), is_needed_(values_.size(), false), local_(values_.size(), -1) {
    for (const int output : outputs) is_needed_[output] = true;
    for (std::size_t i = values_.size(); i-- > 0;) {
      if (!is_needed_[i] || !values_[i].is_operation()) continue;
      for (const int arg : values_[i].args) {
        if (arg >= 0) is_needed_[arg] = true;
      }
    }
    find_sources(tags);
    find_users(outputs, tags);
  }

  std::vector<KernelLevel> run() {
    // A cell's place in time: what depends on few comes first, by how few; what few depend on last, by how many.
    struct Key {
      std::size_t level;
      std::vector<int> tags;
      auto operator<=>(const Key&) const = default;
    };
    std::map<Key, KernelCell> cells;
    const std::size_t middle = kFew + 1;
    std::vector<KernelLevel> levels(2 * kFew + 3);
    std::vector<KernelCell*> known_forward(forward_.count()), known_backward(backward_.count());  // by set
    for (int i = 0; i < static_cast<int>(values_.size()); ++i) {
      if (!is_needed_[i] || !values_[i].is_operation()) continue;
      const bool forward = sources_[i] != kMany;
      if (!forward && users_[i] == kMany) {
        levels[middle].rest.push_back(i);
        continue;
      }
      const int set = forward ? sources_[i] : users_[i];
      const std::vector<int>& tags = forward ? forward_[set] : backward_[set];
      const std::size_t level = forward ? tags.size() : 2 * middle - tags.size();
      KernelCell*& cell = (forward ? known_forward : known_backward)[static_cast<std::size_t>(set)];
      if (cell == nullptr) cell = &cells[{level, tags}];
      cell->values.push_back(i);
    }
    std::map<std::pair<std::size_t, std::vector<int>>, std::vector<KernelCell*>> groups;
    for (auto& [key, cell] : cells) {
      if (std::vector<int> shape = shape_of(cell); !shape.empty()) {
        groups[{key.level, std::move(shape)}].push_back(&cell);
      } else {
        leave(cell, levels[key.level]);
      }
    }
    for (auto& [key, members] : groups) {
      KernelLevel& level = levels[key.first];
      if (!is_worth_it(*members.front(), members.size())) {
        for (KernelCell* cell : members) leave(*cell, level);
        continue;
      }
      level.groups.emplace_back();
      for (KernelCell* cell : members) level.groups.back().cells.push_back(std::move(*cell));
    }
    for (KernelLevel& level : levels) std::sort(level.rest.begin(), level.rest.end());
    return levels;
  }

 private:
  void find_sources(const KernelTags& tags) {
    sources_.assign(values_.size(), kNone);
    for (std::size_t i = 0; i < values_.size(); ++i) {
      if (!is_needed_[i]) continue;
      if (values_[i].op == ExpressionOp::kVariable) sources_[i] = forward_.single(tags.inputs[values_[i].args[0]]);
      if (!values_[i].is_operation()) continue;
      for (const int arg : values_[i].args) {
        if (arg >= 0) sources_[i] = forward_.united(sources_[i], sources_[arg]);
      }
    }
  }

  void find_users(std::span<const int> outputs, const KernelTags& tags) {
    users_.assign(values_.size(), kNone);
    for (std::size_t i = 0; i < outputs.size(); ++i) {
      users_[outputs[i]] = backward_.united(users_[outputs[i]], backward_.single(tags.outputs[i]));
    }
    for (std::size_t i = values_.size(); i-- > 0;) {
      if (!is_needed_[i] || !values_[i].is_operation()) continue;
      for (const int arg : values_[i].args) {
        if (arg >= 0) users_[arg] = backward_.united(users_[arg], users_[i]);
      }
    }
  }

  // Operations and operands by their places within the cell; empty where lanes cannot do it.
  std::vector<int> shape_of(KernelCell& cell) {
    std::vector<int> shape;
    for (std::size_t k = 0; k < cell.values.size(); ++k) local_[cell.values[k]] = static_cast<int>(k);
    std::vector<int> touched;
    bool fits = true;
    for (const int index : cell.values) {
      const Value& value = values_[index];
      fits = fits && is_instruction(value.op);
      shape.push_back(static_cast<int>(value.op));
      for (const int arg : kernel_operands(graph_, index)) {
        if (arg < 0) continue;
        if (values_[arg].is_constant()) {
          shape.push_back(-1);
          cell.constants.push_back(values_[arg].constant);
          continue;
        }
        if (local_[arg] < 0) {
          local_[arg] = static_cast<int>(cell.values.size() + cell.externals.size());
          cell.externals.push_back(arg);
        }
        shape.push_back(local_[arg]);
      }
    }
    for (const int index : cell.values) local_[index] = -1;
    for (const int index : cell.externals) local_[index] = -1;
    return fits ? shape : std::vector<int>();
  }

  // Lanes pay for what they read and write.
  static bool is_worth_it(const KernelCell& cell, std::size_t count) {
    const std::size_t packs = (count + kWidth - 1) / kWidth, operations = cell.values.size();
    return count >= kFewest && 5 * packs * (operations + cell.externals.size() + 2) < 4 * count * operations;
  }

  static void leave(KernelCell& cell, KernelLevel& level) {
    level.rest.insert(level.rest.end(), cell.values.begin(), cell.values.end());
  }

  const ExpressionGraph& graph_;
  const std::vector<Value>& values_;
  std::vector<bool> is_needed_;
  TagSets forward_, backward_;
  std::vector<int> sources_, users_;  ///< Per value, a set.
  std::vector<int> local_;            ///< Per value, while a cell is looked at: its place there.
};

}  // namespace

std::array<int, 3> kernel_operands(const ExpressionGraph& graph, int value) {
  const Value& operation = graph.values()[value];
  std::array<int, 3> args = operation.args;
  const bool commutes = operation.op == ExpressionOp::kAdd || operation.op == ExpressionOp::kMultiply;
  if (commutes && graph.values()[args[0]].is_constant()) std::swap(args[0], args[1]);
  return args;
}

std::vector<KernelLevel> find_kernel_levels(const ExpressionGraph& graph, std::span<const int> outputs,
                                            const KernelTags& tags) {
  return Partition(graph, outputs, tags).run();
}

}  // namespace ferrers
