#pragma once

#include "ferrers/model/spec.h"

/// Mechanisms of any size whose figures are known by counting, for scale and for benchmarks.
namespace ferrers::witness {

/// A tangle: `bodies` bodies, each hung on an earlier one by a ball joint, and `loops` more ball joints between random
/// bodies, all in one cluster. Points are generic (seeded), so that the rank is min(rows, columns).
ModelSpec make_ball_tangle(int bodies, int loops);

/// The same with hinges whose axes all meet in the world's origin: every loop repeats three rows of five, and the
/// bodies only turn.
ModelSpec make_spherical_tangle(int bodies, int loops);

/// `cells` equal scissor cells in a row, joined at their ends: one chain of loops without a ground to rest on between.
ModelSpec make_lazy_tongs(int cells);

}  // namespace ferrers::witness
