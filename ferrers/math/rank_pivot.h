#pragma once

namespace ferrers {

/// True when nothing but rounding is left of a pivot of a symmetric elimination (Cholesky) that began as `diagonal`, or
/// it is not positive: zero by the rule of `is_surely_zero` (math/rank.h), in a matrix scaled to a diagonal of ones.
bool is_lost_pivot(double pivot, double diagonal);

}  // namespace ferrers
