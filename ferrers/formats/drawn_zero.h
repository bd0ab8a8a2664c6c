#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ferrers/model/model.h"

/// Problem: some formats start with all joint coordinates at zero and know no other pose.
namespace ferrers {

struct DrawnZero {
  ModelSpec spec;                  ///< Frames on the first bodies and limits moved; else the model's own.
  std::vector<std::string> moved;  ///< Joints whose coordinates have another zero now.
};

/// The same mechanism with coordinates that are zero where it is drawn. Nothing where nothing has to move, or where
/// couplings and constraints speak of coordinates, whose meaning would change. Universal joints and screws keep theirs.
/// Cost: linear.
std::optional<DrawnZero> move_zeros_to_drawing(const Model& model);

}  // namespace ferrers
