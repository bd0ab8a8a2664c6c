#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "ferrers/kinematics/state.h"
#include "ferrers/kinematics/system.h"

namespace ferrers {

/// The state in which a run ended, from the last complete row of its folder's `result.csv`: a killed run goes on from
/// the last row that reached the file. Every joint coordinate and velocity stands there with seventeen digits, so that
/// the state is the same; coordinates of cut joints tell how often they have turned.
/// `error`: what is wrong with the folder, or how its columns do not fit the model. Cost: one pass over the file.
struct RestartResult {
  std::optional<State> state;
  std::string error;
};
RestartResult read_restart(const System& system, const std::filesystem::path& folder);

}  // namespace ferrers
