#include "ferrers/simulate/prescribed_laws.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "ferrers/dynamics/inverse.h"
#include "ferrers/redundancy/selection.h"

namespace ferrers {
namespace {

constexpr std::array<std::string_view, 3> kWhat = {"position", "rate", "acceleration"};
constexpr std::array<std::string_view, 3> kPer = {"", "/s", "/s²"};

// What rounding makes of rates and accelerations at rest, relative to what acts.
constexpr double kRounding = 1e-10;

// Largest acceleration that happens or that forces would give by themselves, m/s², angles times L.
double largest_acceleration(const Scaling& scaling, const Equations& eq, const VectorXd& vdot) {
  double largest = 0;
  for (long i = 0; i < vdot.size(); ++i) {
    const double mass = eq.M(i, i), free = mass > 0 ? std::abs(eq.force[i]) / mass : 0;
    largest = std::max(largest, std::max(std::abs(vdot[i]), free) / scaling.columns[i]);
  }
  return largest;
}

}  // namespace

std::string find_law_without_value(const DynamicsModel& model, const Equations& eq, double t) {
  for (std::size_t i = 0; i < eq.driven.size(); ++i) {
    const ConstraintKinematics& c = eq.constraints;
    const long row = model.system->m + static_cast<long>(i);
    if (std::isfinite(c.phi[row]) && std::isfinite(c.nu[row]) && std::isfinite(c.gamma[row])) continue;
    const DriveComponent& drive = model.drives[static_cast<std::size_t>(eq.driven[i])];
    const Law::Motion law = drive.motion->motion(t);
    const std::array<double, 3> values = {law.value, law.rate, law.acceleration};
    for (std::size_t k = 0; k < 3; ++k) {
      if (std::isfinite(values[k])) continue;
      return fmt::format("the motion law of drive '{}' gives no finite {} at t = {:g} s", drive.name, kWhat[k], t);
    }
  }
  return "";
}

std::string find_law_against_constraints(const DynamicsModel& model, const Scaling& scaling, const Equations& eq,
                                         const std::vector<int>& implied, const VectorXd& vdot, double t) {
  if (implied.empty()) return "";
  const ConstraintKinematics& c = eq.constraints;
  const double L = scaling.length_m;
  const auto scale_of = [&](std::size_t i) {
    return model.drives[static_cast<std::size_t>(eq.driven[i])].rotary ? L : 1.0;
  };
  const auto row_of = [&](std::size_t i) { return model.system->m + static_cast<long>(i); };
  double rate = 0, acceleration = 0;
  for (std::size_t i = 0; i < eq.driven.size(); ++i) {
    const DriveComponent& drive = model.drives[static_cast<std::size_t>(eq.driven[i])];
    rate = std::max(rate, std::abs(c.rate[row_of(i)]) * scale_of(i));
    acceleration = std::max(acceleration, std::abs(drive.motion->motion(t).acceleration) * scale_of(i));
  }
  const double acting = std::max(largest_acceleration(scaling, eq, vdot), rate * rate / L);
  const std::array<double, 3> sizes = {L, rate, std::max(acceleration, rate * rate / L)};
  const std::array<double, 3> floors = {0, kRounding * std::sqrt(acting * L), kRounding * acting};
  for (const int i : implied) {
    const auto at = static_cast<std::size_t>(i);
    const DriveComponent& drive = model.drives[static_cast<std::size_t>(eq.driven[at])];
    const long row = row_of(at);
    const Law::Motion law = drive.motion->motion(t);
    const std::array<double, 3> asked = {law.value, law.rate, law.acceleration};
    const std::array<double, 3> off = {c.phi[row], c.rate[row] - c.nu[row], c.G.row(row).dot(vdot) - c.gamma[row]};
    for (std::size_t k = 0; k < 3; ++k) {
      // not a rank decision: whether a given law agrees
      const double size = std::max(sizes[k], std::abs(asked[k]) * scale_of(at));
      if (std::abs(off[k]) * scale_of(at) <= kLawAgreement[k] * size + floors[k]) continue;
      const std::string_view unit = drive.rotary ? "rad" : "m";
      return fmt::format(
          "the prescribed motion '{}' contradicts the constraints at t = {:g} s: it asks for the {} {:.9g} {}{}, the "
          "constraints make it {:.9g} {}{}",
          drive.name, t, kWhat[k], asked[k], unit, kPer[k], asked[k] + off[k], unit, kPer[k]);
    }
  }
  return "";
}

void compute_idle_drives(const System& system, const Selection& joints, const std::vector<int>& implied,
                         Equations& eq) {
  const auto k = static_cast<long>(implied.size());
  eq.idle_efforts = MatrixXd::Zero(eq.u.size(), k);
  eq.idle_lambda = MatrixXd::Zero(system.m, k);
  if (k == 0) return;
  MatrixXd rows(k, static_cast<long>(joints.dependent.size()));
  for (long i = 0; i < k; ++i) {
    const int at = implied[static_cast<std::size_t>(i)];
    eq.idle_efforts(eq.driven[static_cast<std::size_t>(at)], i) = 1;
    rows.row(i) = eq.constraints.G({system.m + at}, joints.dependent);
  }
  if (joints.rows.empty()) return;
  // The row is C G_d, so that an effort of 1 is balanced by −Cᵀ.
  const MatrixXd C_transposed = DependentBlock(joints, eq.constraints.G).solve_transposed(rows.transpose());
  for (std::size_t i = 0; i < joints.rows.size(); ++i) {
    eq.idle_lambda.row(joints.rows[i]) = -C_transposed.row(static_cast<long>(i));
  }
}

}  // namespace ferrers
