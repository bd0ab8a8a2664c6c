#include <algorithm>
#include <iterator>

#include "ferrers/dynamics/forward_kkt.h"

namespace ferrers {
KktStructure make_kkt_structure(const System& system, const std::vector<int>& rows) {
  KktStructure structure;
  structure.mass = mass_couplings(system);
  const std::vector<std::vector<int>> columns = columns_of_rows(system);
  for (const int row : rows) {
    structure.rows.push_back(row < system.m ? columns[static_cast<std::size_t>(row)] : std::vector<int>());
  }
  return structure;
}

void take_values(const std::vector<int>& rows, const PatternMatrix& G, KktStructure& structure) {
  structure.values.clear();
  for (std::size_t k = 0; k < rows.size(); ++k) {
    structure.values.emplace_back();
    for (const int column : structure.rows[k]) structure.values.back().push_back(G(rows[k], column));
  }
}

void take_values(const std::vector<int>& rows, const ConstraintBlocks& blocks, KktStructure& structure) {
  structure.values.clear();
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const auto after = std::upper_bound(blocks.blocks.begin(), blocks.blocks.end(), rows[k],
                                        [](int row, const ConstraintBlock& block) { return row < block.row; });
    const ConstraintBlock& block = *std::prev(after);
    structure.values.emplace_back();
    for (const int column : structure.rows[k]) {
      const auto at = std::lower_bound(block.columns.begin(), block.columns.end(), column);
      const bool holds = at != block.columns.end() && *at == column;
      structure.values.back().push_back(holds ? block.G(rows[k] - block.row, at - block.columns.begin()) : 0);
    }
  }
}

}  // namespace ferrers
