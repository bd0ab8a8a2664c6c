#pragma once

#include <string>
#include <vector>

#include "ferrers/model/model.h"

namespace ferrers {

enum class LawUse { kMotion, kEffort };

/// What a run's reader must know of laws that come from tables: that they are natural cubic splines, twice continuously
/// differentiable, and where the run leaves a table's times, beyond which the end tangent goes on. One sentence per
/// table and end; in the order of the model file. `t_begin`, `t_end`: of the run, s.
std::vector<std::string> describe_sampled_laws(const Model& model, LawUse use, double t_begin, double t_end);

}  // namespace ferrers
