#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "ferrers/dynamics/reactions.h"
#include "ferrers/math/rank.h"
#include "ferrers/testing/elastic_joints.h"
#include "ferrers/testing/engine_probe.h"
#include "ferrers/testing/random_mechanism.h"

/// A reaction belongs to a state: neither the way on which a mechanism came there nor the rows and coordinates that
/// were chosen to solve for it show in unique or distributed values.
namespace ferrers::witness {
namespace {

constexpr int kMechanisms = 200;
constexpr double kAgreement = 1e-9;  // of the largest reaction of the mechanism

/// A redundant mechanism whose joints give way, at a state in motion, with its reactions by a fresh choice.
struct Subject {
  EngineProbe engine;
  DistributionOptions options;
  State state;
  std::vector<JointReaction> wanted;
  double best_pivot = 0;  // of the choice made at this state

  Subject(const ModelSpec& spec, std::uint64_t seed) : engine(spec) {
    options.by = seed % 2 == 0 ? DistributionBy::kJointStiffness : DistributionBy::kEqualStiffness;
    state = engine.wandered(seed);
    wanted = reactions_at(state, engine.selection).value();
  }

  /// Empty where the choice does not fit this pose (any more).
  std::optional<std::vector<JointReaction>> reactions_at(const State& at, const Selection& selection) {
    compute_equations(*engine.dynamics, at, engine.eq);
    ForwardResult result = make_forward_result(*engine.system);
    const auto solver = make_forward_solver(Formulation::kNullSpace, *engine.system, selection);
    solver->solve(engine.eq, result);
    if (result.status != ForwardStatus::kSolved) return std::nullopt;
    if (best_pivot == 0) best_pivot = solver->smallest_pivot();
    if (is_worn_pivot(solver->smallest_pivot(), best_pivot)) return std::nullopt;
    return ReactionSolver(engine.dynamics, options)
        .solve(at, engine.eq, selection, result.vdot, result.lambda, engine.eq.u);
  }

  double size() const {
    double largest = 0;
    for (const JointReaction& r : wanted) {
      for (int k = 0; k < 6; ++k) {
        if (r.status[k] == ReactionStatus::kUndetermined) continue;
        largest = std::max(largest, std::abs(r.value[k]) / component_unit(k, engine.scaling.length_m));
      }
    }
    return largest;
  }

  void expect_same(const std::vector<JointReaction>& got) const {
    const double largest = size();
    ASSERT_EQ(got.size(), wanted.size());
    for (std::size_t j = 0; j < engine.model().coordinates_begin(); ++j) {
      SCOPED_TRACE(engine.model().joints()[j].name);
      for (int k = 0; k < 6; ++k) {
        EXPECT_EQ(to_string(got[j].status[k]), to_string(wanted[j].status[k])) << kComponentNames[k];
        if (wanted[j].status[k] == ReactionStatus::kUndetermined) continue;
        EXPECT_NEAR(got[j].value[k], wanted[j].value[k],
                    kAgreement * largest * component_unit(k, engine.scaling.length_m))
            << kComponentNames[k];
      }
    }
  }
};

/// Runs a check on every redundant mechanism of the series, with stiffness in all joints; returns how many there were.
template <class Check>
int for_redundant_mechanisms(const Check& check) {
  int redundant = 0;
  for (std::uint64_t seed = 1; seed <= kMechanisms; ++seed) {
    RandomMechanism m = make_random_mechanism(seed);
    if (m.verdict.redundant == 0) continue;
    SCOPED_TRACE("seed " + std::to_string(seed) + ": " + m.description);
    set_random_stiffness(m.spec, seed, 3, 7);
    Subject subject(m.spec, seed);
    check(subject, seed);
    ++redundant;
  }
  return redundant;
}

bool same_choice(const Selection& a, const Selection& b) { return a.rows == b.rows && a.dependent == b.dependent; }

/// Independent rows and coordinates by any other preference.
Selection random_selection(const Subject& subject, std::uint64_t seed) {
  const EngineProbe& engine = subject.engine;
  const System& system = *engine.system;
  RandomSource random(seed);
  const auto weights = [&](long n) {
    VectorXd w(n);
    for (long i = 0; i < n; ++i) w[i] = random.between(0.2, 1);
    return w;
  };
  const MatrixXd G = engine.scaling.rows.asDiagonal() * engine.eq.constraints.G * engine.scaling.columns.asDiagonal();
  const int rank = static_cast<int>(engine.selection.rows.size());
  Selection out;
  out.rows = choose_independent_rows(MatrixXd(weights(system.m).asDiagonal() * G), rank);
  const MatrixXd kept = G(out.rows, Eigen::all);
  out.dependent = choose_independent_columns(MatrixXd(kept * weights(system.nv).asDiagonal()), rank);
  for (int v = 0; v < system.nv; ++v) {
    if (!std::binary_search(out.dependent.begin(), out.dependent.end(), v)) out.independent.push_back(v);
  }
  return out;
}

TEST(ReactionHistoryTest, TheChoiceOfRowsAndCoordinatesDoesNotShow) {
  int others = 0;
  const int redundant = for_redundant_mechanisms([&](Subject& subject, std::uint64_t seed) {
    const Selection usual = subject.engine.selection;
    for (std::uint64_t i = 1; i <= 4; ++i) {
      const Selection other = random_selection(subject, 10 * seed + i);
      others += !same_choice(other, usual);
      const auto got = subject.reactions_at(subject.state, other);
      ASSERT_TRUE(got.has_value());
      subject.expect_same(*got);
    }
  });
  EXPECT_GE(redundant, 60);
  EXPECT_GE(others, 3 * redundant) << "the choices must differ";
}

// The choice made at the drawn pose, or at any other, serves as long as its pivots are healthy.
TEST(ReactionHistoryTest, AChoiceMadeElsewhereDoesNotShow) {
  int others = 0, kept = 0;
  const int redundant = for_redundant_mechanisms([&](Subject& subject, std::uint64_t seed) {
    EngineProbe& engine = subject.engine;
    const Selection usual = engine.selection;
    for (const std::uint64_t elsewhere : {seed + 1000, seed + 2000, seed + 3000}) {
      engine.wandered(elsewhere, 0.6);
      const auto got = subject.reactions_at(subject.state, engine.selection);
      if (!got) continue;
      ++kept;
      others += !same_choice(engine.selection, usual);
      subject.expect_same(*got);
    }
  });
  EXPECT_GE(kept, 2 * redundant);
  EXPECT_GE(others, redundant / 2) << "the choices must differ";
}

// --- Two ways to one state ---

/// dv with from ⊕ dv = to.
VectorXd difference(const System& system, const VectorXd& from, const VectorXd& to) {
  VectorXd dv = VectorXd::Zero(system.nv);
  for (std::size_t i = 1; i < system.nodes.size(); ++i) {
    const Node& node = system.nodes[i];
    const int at = node.type->quaternion_at;
    const int scalars = at < 0 ? node.nq : at;
    for (int k = 0; k < scalars; ++k) dv[node.v + (at < 0 ? 0 : 3) + k] = to[node.q + k] - from[node.q + k];
    if (at < 0) continue;
    const auto quaternion = [&](const VectorXd& q) {
      const double* u = q.data() + node.q + at;
      return Eigen::Quaterniond(u[0], u[1], u[2], u[3]);
    };
    const Eigen::AngleAxisd turn(quaternion(to) * quaternion(from).conjugate());
    dv.segment<3>(node.v) = turn.angle() * turn.axis();
  }
  return dv;
}

/// Velocities that the independent ones of `v` give by the chosen rows.
VectorXd completed(const EngineProbe& engine, const Selection& s, const VectorXd& v) {
  VectorXd out = VectorXd::Zero(engine.system->nv);
  out(s.independent) = v(s.independent);
  if (!s.rows.empty()) {
    const MatrixXd G_d = engine.eq.constraints.G(s.rows, s.dependent);
    out(s.dependent) = -G_d.partialPivLu().solve(engine.eq.constraints.G.dense_rows(s.rows) * out);
  }
  return out;
}

/// Moves the independent coordinates from another pose to those of the state, the loops following, with a choice of
/// rows and coordinates made anew on the way and kept from there. False where the way leads to another pose.
bool arrive(EngineProbe& engine, const State& target, State& state, Selection& carried) {
  constexpr int kSteps = 8, kLast = 8;
  const Selection at_target = carried;
  engine.evaluate(state);
  carried = engine.selection;
  int iterations = 0;
  for (int i = 0; i < kSteps + kLast; ++i) {
    const VectorXd left = difference(*engine.system, state.q, target.q);
    VectorXd step = VectorXd::Zero(engine.system->nv);
    step(at_target.independent) = left(at_target.independent) / std::max(1, kSteps - i);
    displace(*engine.system, completed(engine, at_target, step), state.q);
    close_loops(*engine.system, engine.scaling, at_target.independent, 50, state, iterations);
    accept_winding(*engine.system, engine.eq.pos, state);
    compute_equations(*engine.dynamics, state, engine.eq);
    if (i == 3) carried = reselect(*engine.system, engine.scaling, engine.eq.constraints, carried);
  }
  state.v = completed(engine, carried, target.v);
  compute_equations(*engine.dynamics, state, engine.eq);
  return difference(*engine.system, state.q, target.q).norm() < 1e-9 && (state.v - target.v).norm() < 1e-8;
}

TEST(ReactionHistoryTest, TheWayToAStateDoesNotShow) {
  int far = 0, arrived = 0, others = 0;
  const int redundant = for_redundant_mechanisms([&](Subject& subject, std::uint64_t seed) {
    EngineProbe& engine = subject.engine;
    const Selection usual = engine.selection;
    State state = engine.wandered(seed + 1000, 0.6);
    far += difference(*engine.system, state.q, subject.state.q).norm() > 0.05;
    engine.selection = usual;
    Selection carried = usual;
    if (!arrive(engine, subject.state, state, carried)) return;
    ++arrived;
    auto got = subject.reactions_at(state, carried);
    if (!got) {  // worn on the way
      carried = reselect(*engine.system, engine.scaling, engine.eq.constraints, carried);
      got = subject.reactions_at(state, carried);
    }
    others += !same_choice(carried, usual);
    ASSERT_TRUE(got.has_value());
    subject.expect_same(*got);
  });
  EXPECT_GE(far, 3 * redundant / 4);
  EXPECT_GE(arrived, 3 * redundant / 4);
  EXPECT_GE(others, redundant / 5) << "the choices must differ";
}

}  // namespace
}  // namespace ferrers::witness
