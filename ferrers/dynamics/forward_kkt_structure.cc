#include <algorithm>
#include <iterator>

#include "ferrers/dynamics/forward_kkt.h"
#include "ferrers/dynamics/lagrangian_terms.h"

namespace ferrers {
namespace {

std::vector<int> columns_of_nodes(const System& system, const std::vector<int>& nodes) {
  std::vector<int> columns;
  for (const int n : nodes) {
    for (int k = 0; k < system.nodes[n].nv; ++k) columns.push_back(system.nodes[n].v + k);
  }
  return columns;
}

// Coordinates of one node, of those that carry it and of those that it carries.
std::vector<std::vector<int>> mass_structure(const System& system) {
  std::vector<std::vector<int>> mass(system.nv);
  for (std::size_t i = 1; i < system.nodes.size(); ++i) {
    const Node& node = system.nodes[i];
    std::vector<int> above;
    for (int a = node.parent; a > 0; a = system.nodes[a].parent) {
      for (int k = 0; k < system.nodes[a].nv; ++k) above.push_back(system.nodes[a].v + k);
    }
    for (int k = node.v; k < node.v + node.nv; ++k) {
      for (int own = node.v; own < node.v + node.nv; ++own) {
        if (own != k) mass[k].push_back(own);
      }
      for (const int a : above) {
        mass[k].push_back(a);
        mass[a].push_back(k);
      }
    }
  }
  for (const auto& [a, b] : lagrangian_mass_pattern(system)) {
    if (a != b) mass[a].push_back(b);
  }
  for (std::vector<int>& coupled : mass) {
    std::sort(coupled.begin(), coupled.end());
    coupled.erase(std::unique(coupled.begin(), coupled.end()), coupled.end());
  }
  return mass;
}

}  // namespace

KktStructure make_kkt_structure(const System& system, const std::vector<int>& rows) {
  KktStructure structure;
  structure.mass = mass_structure(system);
  std::vector<int> closure_of_row;
  for (std::size_t c = 0; c < system.topology->closures.size(); ++c) {
    closure_of_row.insert(closure_of_row.end(), system.topology->closures[c].row_count, static_cast<int>(c));
  }
  for (const int row : rows) {
    structure.rows.emplace_back();
    if (row >= system.m) continue;
    structure.rows.back() = columns_of_nodes(system, system.topology->closures[closure_of_row[row]].nodes);
  }
  return structure;
}

void take_values(const std::vector<int>& rows, const RowMatrixXd& G, KktStructure& structure) {
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
