#pragma once

#include <string>

#include "ferrers/core/diagnostics.h"
#include "ferrers/model/spec.h"

namespace ferrers {

/// The MJCF of a specification that builds: the spanning tree as nested bodies, closures as equality constraints
/// between sites (a revolute one as two <connect>), couplings as equality constraints on joints or fixed tendons.
///
/// Drawn as the model is drawn; joints that MuJoCo does not have are several of its joints in one body, and massless
/// bodies between joints become such joints again. Numbers in SI and rad with all their digits. What MJCF cannot say is
/// told with F607: as a warning where the written mechanism is another one without it, as a notice else. Cost: linear.
std::string write_mjcf(const ModelSpec& spec, Diagnostics& diagnostics);

}  // namespace ferrers
