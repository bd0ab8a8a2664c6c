#pragma once

#include <vector>

#include "ferrers/dynamics/dynamics_model.h"

namespace ferrers {

/// The equations of the bodies, of springs, and of the joints that close loops, written down: entries that are not
/// always zero. Inputs of the trace are q, v and winding, in this order.
struct TracedEquations {
  struct Entry {
    int row, column;
    Traced value;
  };
  struct Number {
    int index;
    Traced value;
  };
  std::vector<Entry> M;  ///< row ≤ column.
  std::vector<Number> h;
  std::vector<Entry> G;
  std::vector<Number> phi, rate, gamma;
  std::vector<Traced> places, speeds, turns;  ///< |p|², |v|² and |ω|² of the bodies' nodes: m², m²/s², 1/s².
  Traced power;                 ///< Of springs and their dampers, which h holds with the sign of a load, W.
  std::vector<int> input_tags;  ///< Per input, what it belongs to: see below.
};

/// Numbers that tell parts of the mechanism apart: one per node, one per joint that closes a loop.
std::vector<int> tags_of_coordinates(const System& system);
std::vector<int> tags_of_rows(const System& system);

/// Cost: some 100 ns per operation.
TracedEquations trace_equations(const DynamicsModel& model, Trace& trace);

/// Whether there are force elements that `trace_equations` does not know.
bool has_untraced_forces(const DynamicsModel& model);
/// Whether these, or efforts of drives, read poses and twists, and not coordinates alone.
bool other_forces_read_poses(const DynamicsModel& model);

}  // namespace ferrers
