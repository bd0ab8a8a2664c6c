#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "ferrers/kinematics/state.h"
#include "ferrers/kinematics/system.h"

namespace ferrers {

/// The state in which a run ended, from the last complete row of its folder's `result.csv`: a killed run goes on from
/// the last row that reached the file. Every joint coordinate and velocity stands there with seventeen digits, and
/// those of bodies that float without a joint, so that the state is the same; coordinates of cut joints tell how often
/// they have turned. Which drives events have switched off stands in `summary.json`: where the model has such events
/// and a killed run left none, there is no going on.
/// `error`: what is wrong with the folder, or how its columns do not fit the model. Cost: one pass over the file.
struct RestartResult {
  std::optional<State> state;
  std::vector<std::string> drives_off;    ///< Names.
  std::vector<std::string> events_acted;  ///< At the very time of the state.
  std::string error;
};
RestartResult read_restart(const System& system, const std::filesystem::path& folder);

/// The state in the row of `result.csv` whose time is nearest to `t`, s: any row tells one, not only the last. Drives
/// that events have switched off are not looked for.
RestartResult read_stored_state(const System& system, const std::filesystem::path& folder, double t);

}  // namespace ferrers
