#include "ferrers/math/kernel.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "ferrers/core/checks.h"
#include "ferrers/math/kernel_layout.h"
#include "ferrers/math/kernel_section.h"

namespace ferrers {
namespace {

using Base = X86Assembler::Base;
using Operand = X86Assembler::Operand;
using GraphValue = ExpressionGraph::Value;

constexpr int kLanes = 4;

// What is written down one after another: a group, or what is in none.
struct Section {
  const KernelGroup* group = nullptr;
  KernelLayout::Positions positions;  // of the group's cells in its rows
  std::vector<int> rest;
};

std::vector<Section> make_sections(const std::vector<KernelLevel>& levels) {
  std::vector<Section> sections;
  for (const KernelLevel& level : levels) {
    for (const KernelGroup& group : level.groups) sections.push_back({&group, {}, {}});
    if (level.rest.empty()) continue;
    if (sections.empty() || sections.back().group != nullptr) sections.emplace_back();
    std::vector<int>& rest = sections.back().rest;
    rest.insert(rest.end(), level.rest.begin(), level.rest.end());
  }
  return sections;
}

// The board in rbx, which loops move, and in rbp; from its place `scratch` on r12.
void begin_function(X86Assembler& assembler, int scratch) {
  assembler.push(Base::kRbx);
  assembler.push(Base::kRbp);
  assembler.push(Base::kR12);  // and with the return address the stack is aligned for calls
  assembler.move(Base::kRbx, Base::kRdi);
  assembler.move(Base::kRbp, Base::kRdi);
  assembler.address(Base::kR12, Base::kRdi, scratch);
}

void end_function(X86Assembler& assembler, bool lanes) {
  if (lanes) assembler.forget_lanes();
  assembler.pop(Base::kR12);
  assembler.pop(Base::kRbp);
  assembler.pop(Base::kRbx);
  assembler.finish();
}

class Builder {
 public:
  Builder(const ExpressionGraph& graph, std::span<const int> outputs, const std::vector<KernelLevel>& levels)
      : graph_(graph),
        values_(graph.values()),
        outputs_(outputs),
        sections_(make_sections(levels)),
        layout_(static_cast<int>(values_.size())),
        section_of_(values_.size(), -1),
        leaves_elsewhere_(values_.size(), false) {
    lay_out();
  }

  /// Writes all sections; what the board is at first, and the places.
  void write(X86Assembler& assembler, std::vector<double>& board, std::vector<int>& inputs, std::vector<int>& places,
             double& shared_part) {
    std::vector<StraightCode> codes;
    std::size_t shared = 0, all = 0;
    for (const Section& section : sections_) {
      if (section.group != nullptr) {
        write_group(*section.group, section.positions, codes);
        shared += section.group->cells.size() * section.group->cells.front().values.size();
        all += section.group->cells.size() * section.group->cells.front().values.size();
      } else {
        codes.push_back(write_rest(section.rest));
        all += section.rest.size();
      }
    }
    shared_part = all == 0 ? 0 : static_cast<double>(shared) / static_cast<double>(all);
    for (const int output : outputs_) places.push_back(place_of_output(output));
    for (std::size_t i = 0; i < values_.size(); ++i) {
      if (values_[i].op != ExpressionOp::kVariable || !leaves_elsewhere_[i]) continue;
      const auto input = static_cast<std::size_t>(values_[i].args[0]);
      if (inputs.size() <= input) inputs.resize(input + 1, -1);
      inputs[input] = layout_.place_of(static_cast<int>(i));
    }

    begin_function(assembler, layout_.size());
    int scratch = 0;
    bool lanes = false;
    for (const StraightCode& code : codes) {
      scratch = std::max(scratch, write_straight_code(code, assembler));
      lanes = lanes || code.lanes > 1;
    }
    end_function(assembler, lanes);
    board.assign(static_cast<std::size_t>(layout_.size() + scratch), 0.0);
    for (const auto& [place, value] : constants_) board[static_cast<std::size_t>(place)] = value;
  }

 private:
  // ---- places --------------------------------------------------------------------------------------------------

  void lay_out() {
    for (std::size_t s = 0; s < sections_.size(); ++s) {
      const auto own = [&](const std::vector<int>& operations) {
        for (const int index : operations) section_of_[index] = static_cast<int>(s);
      };
      own(sections_[s].rest);
      if (sections_[s].group == nullptr) continue;
      for (const KernelCell& cell : sections_[s].group->cells) own(cell.values);
    }
    for (std::size_t i = 0; i < values_.size(); ++i) {
      if (section_of_[i] < 0) continue;
      for (const int arg : values_[i].args) {
        if (arg >= 0 && section_of_[arg] != section_of_[i]) leaves_elsewhere_[arg] = true;
      }
    }
    for (const int output : outputs_) leaves_elsewhere_[output] = true;
    for (std::size_t i = 0; i < values_.size(); ++i) {
      if (leaves_elsewhere_[i] && !values_[i].is_constant()) layout_.add(static_cast<int>(i), section_of_[i]);
    }
    for (std::size_t s = 0; s < sections_.size(); ++s) {
      if (sections_[s].group == nullptr) continue;
      const std::vector<KernelCell>& cells = sections_[s].group->cells;
      std::vector<KernelLayout::Row> read;
      for (std::size_t k = 0; k < cells.front().externals.size(); ++k) {
        read.push_back(row_of(cells, &KernelCell::externals, k));
      }
      KernelLayout::Positions& positions = sections_[s].positions;
      positions = layout_.find_positions(read, cells.size());
      for (const KernelLayout::Row& row : read) layout_.read_together(row, positions);
      for (std::size_t k = 0; k < cells.front().values.size(); ++k) {
        if (!is_exported(cells, k)) continue;
        const KernelLayout::Row row = row_of(cells, &KernelCell::values, k);
        for (const int number : row) layout_.add(number, static_cast<int>(s));
        layout_.write_together(row, positions);
      }
    }
    layout_.place();
  }

  bool is_exported(const std::vector<KernelCell>& cells, std::size_t k) const {
    return std::any_of(cells.begin(), cells.end(),
                       [&](const KernelCell& cell) { return leaves_elsewhere_[cell.values[k]]; });
  }

  static KernelLayout::Row row_of(const std::vector<KernelCell>& cells, std::vector<int> KernelCell::*what,
                                  std::size_t k) {
    KernelLayout::Row row;
    row.reserve(cells.size());
    for (const KernelCell& cell : cells) row.push_back((cell.*what)[k]);
    return row;
  }

  int place_of_output(int output) {
    if (!values_[output].is_constant()) return layout_.place_of(output);
    const int place = layout_.extend(1);
    constants_.push_back({place, values_[output].constant});
    return place;
  }

  // ---- sections ------------------------------------------------------------------------------------------------

  StraightCode write_rest(const std::vector<int>& rest) {
    KernelSection section;
    section.reserve(rest.size());
    std::vector<int>& number = number_;
    number.resize(values_.size(), -1);
    std::vector<int> touched;
    for (const int index : rest) {
      std::array<int, 3> args = kernel_operands(graph_, index);
      for (int& arg : args) {
        if (arg < 0) continue;
        if (number[arg] < 0) {
          touched.push_back(arg);
          number[arg] = values_[arg].is_constant() ? section.constant(values_[arg].constant)
                                                   : section.memory(Operand::at(Base::kRbx, layout_.place_of(arg)));
        }
        arg = number[arg];
      }
      touched.push_back(index);
      number[index] = section.operation(values_[index].op, args);
      if (leaves_elsewhere_[index]) section.store(number[index], Operand::at(Base::kRbx, layout_.place_of(index)));
    }
    for (const int index : touched) number[index] = -1;
    // What groups leave over are chains along the mechanism, which would wait for themselves.
    const bool has_groups = sections_.size() > 1;
    return section.take(1, 1, has_groups ? KernelSection::Order::kJustInTime : KernelSection::Order::kDepthFirst);
  }

  void write_group(const KernelGroup& group, const KernelLayout::Positions& positions,
                   std::vector<StraightCode>& codes) {
    const int length = positions.back() + 1;
    const std::vector<KernelCell>& cells = group.cells;
    const KernelCell& first = cells.front();
    KernelSection section, copies;
    std::vector<int> externals;
    for (std::size_t k = 0; k < first.externals.size(); ++k) {
      const KernelLayout::Row row = row_of(cells, &KernelCell::externals, k);
      if (std::all_of(row.begin(), row.end(), [&](int one) { return one == row.front(); })) {
        externals.push_back(section.same_memory(Operand::at(Base::kRbp, layout_.place_of(row.front()))));
      } else if (layout_.is_row(row, positions)) {
        externals.push_back(section.memory(Operand::at(Base::kRbx, layout_.place_of(row.front()))));
      } else {
        const int place = layout_.extend(length);
        for (std::size_t i = 0; i < row.size(); ++i) {
          copies.store(copies.memory(Operand::at(Base::kRbx, layout_.place_of(row[i]))),
                       Operand::at(Base::kRbx, place + positions[i]));
        }
        externals.push_back(section.memory(Operand::at(Base::kRbx, place)));
      }
    }
    std::size_t constants = 0;
    const auto next_constant = [&] {
      const std::size_t k = constants++;
      const double value = first.constants[k];
      if (std::all_of(cells.begin(), cells.end(), [&](const KernelCell& cell) { return cell.constants[k] == value; })) {
        return section.constant(value);
      }
      const int place = layout_.extend(length);
      for (std::size_t i = 0; i < cells.size(); ++i) {
        constants_.push_back({place + positions[i], cells[i].constants[k]});
      }
      return section.memory(Operand::at(Base::kRbx, place));
    };
    std::size_t met = 0;  // externals, in the order of their first use
    number_.resize(values_.size(), -1);
    for (std::size_t k = 0; k < first.values.size(); ++k) {
      const int index = first.values[k];
      std::array<int, 3> args = kernel_operands(graph_, index);
      for (int& arg : args) {
        if (arg < 0) continue;
        if (values_[arg].is_constant()) {
          arg = next_constant();
          continue;
        }
        if (number_[arg] < 0) number_[arg] = externals[met++];
        arg = number_[arg];
      }
      number_[index] = section.operation(values_[index].op, args);
      if (is_exported(cells, k)) section.store(number_[index], Operand::at(Base::kRbx, layout_.place_of(index)));
    }
    for (const int index : first.values) number_[index] = -1;
    for (const int index : first.externals) number_[index] = -1;
    if (!copies.is_empty()) codes.push_back(copies.take(1, 1));
    codes.push_back(section.take(kLanes, (length + kLanes - 1) / kLanes));
  }

  const ExpressionGraph& graph_;
  const std::vector<GraphValue>& values_;
  std::span<const int> outputs_;
  std::vector<Section> sections_;
  KernelLayout layout_;
  std::vector<int> section_of_;  ///< Of operations that are computed, else −1.
  std::vector<bool> leaves_elsewhere_;
  std::vector<int> number_;  ///< Within the section that is being written, or −1.
  std::vector<std::pair<int, double>> constants_;
};

}  // namespace

namespace {

// Inputs, outputs and scratch follow each other; nothing is shared between lanes.
StraightCode code_in_lanes(const ExpressionGraph& graph, std::span<const int> outputs, int count,
                           std::vector<int>& inputs, std::vector<int>& places) {
  const std::vector<GraphValue>& values = graph.values();
  KernelSection section;
  std::vector<int> number(values.size(), -1);
  std::vector<bool> is_needed(values.size(), false);
  for (const int output : outputs) is_needed[output] = true;
  for (std::size_t i = values.size(); i-- > 0;) {
    if (!is_needed[i] || !values[i].is_operation()) continue;
    for (const int arg : values[i].args) {
      if (arg >= 0) is_needed[arg] = true;
    }
  }
  int next = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!is_needed[i]) continue;
    if (values[i].is_constant()) {
      number[i] = section.constant(values[i].constant);
    } else if (values[i].op == ExpressionOp::kVariable) {
      const auto input = static_cast<std::size_t>(values[i].args[0]);
      if (inputs.size() <= input) inputs.resize(input + 1, -1);
      inputs[input] = next++;
      number[i] = section.memory(Operand::at(Base::kRbx, count * inputs[input]));
    } else {
      std::array<int, 3> args = values[i].args;
      for (int& arg : args) arg = arg < 0 ? -1 : number[arg];
      number[i] = section.operation(values[i].op, args);
    }
  }
  for (const int output : outputs) {
    places.push_back(next);
    section.store(number[output], Operand::at(Base::kRbx, count * next++));
  }
  return section.take(kLanes, count / kLanes);
}

bool all_are_instructions(const StraightCode& code) {
  return std::all_of(code.values.begin(), code.values.end(), [](const StraightCode::Value& value) {
    return !value.is_operation() || value.op > static_cast<StraightCode::Op>(ExpressionOp::kIf) ||
           is_instruction(static_cast<ExpressionOp>(value.op));
  });
}

}  // namespace

Kernel Kernel::in_lanes(const ExpressionGraph& graph, std::span<const int> outputs, int count) {
  require(count > 0 && count % kLanes == 0, "Kernel: a multiple of four evaluations");
  Kernel kernel;
  if (!has_machine_code()) return kernel;
  const StraightCode code = code_in_lanes(graph, outputs, count, kernel.inputs_, kernel.outputs_);
  if (!all_are_instructions(code)) return kernel;
  const std::size_t places = kernel.inputs_.size() + kernel.outputs_.size(),
                    numbers = places * static_cast<std::size_t>(count);
  X86Assembler assembler;
  begin_function(assembler, static_cast<int>(numbers));
  const int scratch = write_straight_code(code, assembler);
  end_function(assembler, true);
  kernel.board_.assign(numbers + static_cast<std::size_t>(scratch), 0.0);
  kernel.shared_part_ = 1;
  kernel.assemble(assembler);
  return kernel;
}

Kernel::Kernel(const ExpressionGraph& graph, std::span<const int> outputs, const KernelTags& tags) {
  if (!has_machine_code()) return;
  const std::vector<KernelLevel> levels = find_kernel_levels(graph, outputs, tags);
  X86Assembler assembler;
  Builder(graph, outputs, levels).write(assembler, board_, inputs_, outputs_, shared_part_);
  inputs_.resize(tags.inputs.size(), -1);
  assemble(assembler);
}

void Kernel::assemble(X86Assembler& assembler) {
  const std::vector<std::uint8_t> code = assembler.take();
  memory_ = MachineMemory::make(code);
  if (memory_ == nullptr) return;
  run_ = reinterpret_cast<Function>(const_cast<void*>(memory_->begin()));
  code_bytes_ = code.size();
}

Kernel::Board Kernel::make_board() const {
  Board board;
  constexpr std::size_t size = std::size(Board::Block().numbers);
  board.blocks_.assign((board_.size() + size - 1) / size, Board::Block());
  if (!board_.empty()) std::memcpy(board.data(), board_.data(), board_.size() * sizeof(double));
  return board;
}

}  // namespace ferrers
