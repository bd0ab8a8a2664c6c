#include "ferrers/redundancy/rate_conflict.h"

#include <fmt/format.h>

#include <cmath>

#include "ferrers/math/rank.h"
#include "ferrers/redundancy/selection.h"

namespace ferrers {
namespace {

constexpr double kAgreement = 1e-8;  // of rates, relative to what makes them up; not a rank decision

}  // namespace

std::string rate_conflict_message(const RateConflict& conflict) {
  return fmt::format(
      "the constraints contradict each other in their rates: no velocity keeps '{}' too, which is off by "
      "{:.3g} per second",
      conflict.row, conflict.residual);
}

std::optional<RateConflict> find_rate_conflict(const System& system, const Scaling& scaling,
                                               const ConstraintKinematics& constraints) {
  const VectorXd nu = scaling.rows.cwiseProduct(constraints.nu.head(system.m));
  if (nu.isZero(0)) return std::nullopt;
  const MatrixXd G = scaling.rows.asDiagonal() * constraints.G * scaling.columns.asDiagonal();
  const std::vector<int> rows = select_independent(system, scaling, constraints).rows;
  const VectorXd rates = solve_least_norm(G(rows, Eigen::all), nu(rows)).x;
  const VectorXd off = G * rates - nu;
  const VectorXd size = G.cwiseAbs() * rates.cwiseAbs() + nu.cwiseAbs();
  long worst = 0;
  off.cwiseAbs().maxCoeff(&worst);
  if (std::abs(off[worst]) <= kAgreement * size[worst]) return std::nullopt;
  return RateConflict{system.row_names[static_cast<std::size_t>(worst)], std::abs(off[worst]) / scaling.rows[worst]};
}

}  // namespace ferrers
