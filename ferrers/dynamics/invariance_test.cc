#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "ferrers/dynamics/reactions.h"
#include "ferrers/redundancy/analysis.h"
#include "ferrers/redundancy/permanence.h"
#include "ferrers/testing/elastic_joints.h"
#include "ferrers/testing/engine_probe.h"
#include "ferrers/testing/random_mechanism.h"
#include "ferrers/testing/transforms.h"
#include "ferrers/testing/zoo_parts.h"

/// Nothing depends on how a mechanism is written down: random mechanisms, each described once more (turned, moved, in
/// other units, in another order, cut elsewhere, or several of these at once), give the same verdict, the same unique
/// reactions and the same distributed ones.
namespace ferrers::witness {
namespace {

constexpr int kMechanisms = 520;
constexpr double kAgreement = 1e-9;  // of the largest reaction of the mechanism

// --- Another description of the same mechanism ---

/// What is done to a description: places go to scale · turn · x + shift.
struct Change {
  Matrix3d turn = Matrix3d::Identity();
  Vector3d shift = Vector3d::Zero();
  double scale = 1;
  bool turned = false, shifted = false, reordered = false, recut = false;
  std::uint64_t seed = 0;

  std::string name() const {
    return std::string(turned ? " turned" : "") + (shifted ? " shifted" : "") +
           (scale != 1 ? " scaled by " + std::to_string(scale) : "") + (reordered ? " reordered" : "") +
           (recut ? " cut elsewhere" : "");
  }
};

/// One of the 24 rotations that take axes to axes, or any.
Matrix3d random_turn(RandomSource& random) {
  if (random.chance(0.5)) return random.rotation();
  const int first = random.below(3), second = (first + 1 + random.below(2)) % 3;
  Matrix3d R = Matrix3d::Zero();
  R(first, 0) = random.chance(0.5) ? 1 : -1;
  R(second, 1) = random.chance(0.5) ? 1 : -1;
  R.col(2) = Vector3d(R.col(0)).cross(Vector3d(R.col(1)));
  return R;
}

Change random_change(std::uint64_t seed) {
  RandomSource random(seed + 4711);
  Change c;
  c.seed = seed;
  while (c.name().empty()) {
    c.turned = random.chance(0.4);
    if (c.turned) c.turn = random_turn(random);
    c.shifted = random.chance(0.4);
    if (c.shifted) c.shift = 10 * random.direction();
    if (random.chance(0.5)) c.scale = random.chance(0.5) ? 1e-3 : 1e3;
    c.shift *= c.scale;
    c.reordered = random.chance(0.4);
    c.recut = random.chance(0.4);
  }
  return c;
}

ModelSpec changed(const ModelSpec& spec, const Change& c) {
  ModelSpec out = spec;
  if (c.scale != 1) out = scaled(out, c.scale);
  if (c.turned) out = rotated(out, c.turn);
  if (c.shifted) out = shifted(out, c.shift);
  if (c.reordered) out = permuted(out, c.seed + 1);
  return out;
}

TopologyOptions other_cuts(const ModelSpec& spec, const Change& c) {
  TopologyOptions options;
  RandomSource random(c.seed + 99);
  for (std::size_t j = 0; c.recut && j < spec.joints.size(); ++j) options.cut.push_back(random.chance(0.5));
  return options;
}

/// The same state in the other description. Body frames are those of the world as drawn, in both.
AbsoluteState changed(const AbsoluteState& state, const Model& before, const Model& after, const Change& c) {
  AbsoluteState out = drawn_state(after);
  for (std::size_t b = 1; b < out.poses.size(); ++b) {
    const std::size_t i = before.find_body(after.bodies()[b].name)->index();
    const Matrix3d R = c.turn * state.poses[i].R * c.turn.transpose();
    out.poses[b] = {R, c.scale * (c.turn * state.poses[i].p) + c.shift - R * c.shift};
    out.twists[b] << c.turn * state.twists[i].head<3>(), c.scale * (c.turn * state.twists[i].tail<3>());
  }
  return out;
}

// --- Stiffness ---

enum class Springs { kAll, kSome };

/// Joints whose frames turn with the mechanism; the others' stay the world's as drawn.
bool has_own_axes(JointType type) {
  return type != JointType::kWeld && type != JointType::kSpherical && type != JointType::kFree &&
         type != JointType::kDistance;
}

/// Stiffness that differs from joint to joint and, where the joint has axes of its own, along them; of all joints, or
/// of some in some directions. Every third mechanism also has a misaligned joint.
ModelSpec with_springs(ModelSpec spec, Springs springs, std::uint64_t seed) {
  RandomSource random(seed + 31);
  for (JointSpec& joint : spec.joints) {
    const bool some = springs == Springs::kSome;
    if (some && random.chance(0.4)) continue;
    const auto draw = [&] { return some && random.chance(0.3) ? kRigid : std::pow(10.0, random.between(3, 7)); };
    if (has_own_axes(joint.type)) {
      const Number3 force = number3(draw(), draw(), draw());
      set_stiffness(joint, force, number3(draw(), draw(), draw()));
    } else {
      const double force = draw();
      set_stiffness(joint, force, draw());
    }
    if (seed % 3 == 0 && has_own_axes(joint.type) && random.chance(0.5)) {
      const Vector3d offset = random.vector(1e-4);
      set_misalignment(joint, number3(offset.x(), offset.y(), offset.z()), number3(0, 0, 0));
    }
  }
  return spec;
}

// --- Reactions of one description ---

struct Loads {
  std::vector<JointReaction> world, own;  // per joint, axes of the world and of the joint
  DistributionOutcome outcome;
};

Loads loads_of(EngineProbe& engine, const State& state, const ForwardResult& motion, DistributionBy by) {
  DistributionOptions options;
  options.by = by;
  const ReactionSolver solver(engine.dynamics, options);
  Loads out;
  const auto solve = [&](ReactionAxes axes) {
    return solver.solve(state, engine.eq, engine.selection, motion.vdot, motion.lambda, engine.eq.u, axes,
                        &out.outcome);
  };
  out.world = solve(ReactionAxes::kWorld);
  out.own = solve(ReactionAxes::kJoint);
  std::sort(out.outcome.contradictory.begin(), out.outcome.contradictory.end());
  return out;
}

/// In newtons, moments divided by the mechanism's size; a mechanism that nothing loads is measured by its weight.
double largest_of(const Loads& loads, const Model& model, double length_m) {
  double largest = 0;
  for (const Body& body : model.bodies()) largest = std::max(largest, body.mass_kg * model.gravity().norm());
  for (const JointReaction& r : loads.world) {
    for (int k = 0; k < 6; ++k) {
      if (r.status[k] == ReactionStatus::kUndetermined) continue;
      largest = std::max(largest, std::abs(r.value[k]) / component_unit(k, length_m));
    }
  }
  return largest;
}

/// The worst status that any direction of a force (or moment) has.
ReactionStatus status_of_vector(const JointReaction& r, int first) {
  return std::max({r.status[first], r.status[first + 1], r.status[first + 2]});
}

Vector3d vector_of(const JointReaction& r, int first) {
  return {r.value[first], r.value[first + 1], r.value[first + 2]};
}

/// The reactions of two descriptions beside each other.
class Comparison {
 public:
  Comparison(const EngineProbe& before, const EngineProbe& after, const Change& change)
      : before_(before), after_(after), change_(change) {}

  void expect_same(const Loads& wanted, const Loads& got) {
    size_ = largest_of(wanted, before_.model(), before_.scaling.length_m);
    EXPECT_EQ(got.outcome.used, wanted.outcome.used);
    EXPECT_EQ(got.outcome.contradictory, wanted.outcome.contradictory);
    for (std::size_t j = 0; j < before_.model().coordinates_begin(); ++j) {
      const Joint& joint = before_.model().joints()[j];
      const std::size_t there = after_.model().find_joint(joint.name)->index();
      SCOPED_TRACE(joint.name);
      if (has_own_axes(joint.type)) {
        for (int k = 0; k < 6; ++k) expect_component(wanted.own[j], k, 1, got.own[there], k);
      }
      expect_world_components(wanted.world[j], got.world[there]);
      for (const int first : {0, 3}) expect_vector(wanted.world[j], got.world[there], first);
    }
  }

 private:
  double unit(int k) const { return component_unit(k, before_.scaling.length_m) * size_; }
  double back(int k) const { return k < 3 ? 1 / change_.scale : 1 / (change_.scale * change_.scale); }

  void expect_component(const JointReaction& wanted, int k, double sign, const JointReaction& got, int at) {
    EXPECT_EQ(to_string(got.status[at]), to_string(wanted.status[k])) << kComponentNames[k];
    if (wanted.status[k] == ReactionStatus::kUndetermined || got.status[at] == ReactionStatus::kUndetermined) return;
    EXPECT_NEAR(sign * got.value[at] * back(k), wanted.value[k], kAgreement * unit(k)) << kComponentNames[k];
  }

  /// Components that the turn takes to components.
  void expect_world_components(const JointReaction& wanted, const JointReaction& got) {
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) {
        const double sign = change_.turn(row, column);
        if (std::abs(sign) != 1) continue;
        expect_component(wanted, column, sign, got, row);
        expect_component(wanted, column + 3, sign, got, row + 3);
      }
    }
  }

  void expect_vector(const JointReaction& wanted, const JointReaction& got, int first) {
    const ReactionStatus status = status_of_vector(wanted, first);
    EXPECT_EQ(to_string(status_of_vector(got, first)), to_string(status)) << kComponentNames[first];
    if (status == ReactionStatus::kUndetermined || status_of_vector(got, first) == ReactionStatus::kUndetermined)
      return;
    const Vector3d turned_back = change_.turn.transpose() * vector_of(got, first) * back(first);
    EXPECT_LE((turned_back - vector_of(wanted, first)).norm(), kAgreement * unit(first)) << kComponentNames[first];
  }

  const EngineProbe& before_;
  const EngineProbe& after_;
  const Change& change_;
  double size_ = 1;
};

// --- The properties ---

// Ten mechanisms a test, so that a failure names a short list.
class InvarianceTest : public ::testing::TestWithParam<int> {
 protected:
  template <class Check>
  void for_each_mechanism(const Check& check) const {
    for (int seed = 10 * GetParam(); seed < 10 * GetParam() + 10; ++seed) {
      const RandomMechanism m = make_random_mechanism(static_cast<std::uint64_t>(seed));
      const Change change = random_change(m.seed);
      SCOPED_TRACE("seed " + std::to_string(seed) + ": " + m.description + ", " + change.name());
      check(m, change);
    }
  }
};

TEST_P(InvarianceTest, VerdictsAreTheSame) {
  for_each_mechanism([](const RandomMechanism& m, const Change& change) {
    const ModelSpec other_spec = changed(m.spec, change);
    const EngineProbe one(m.spec), other(other_spec, other_cuts(other_spec, change));
    const State drawn = make_drawn_state(*one.system), other_drawn = make_drawn_state(*other.system);
    const RedundancyReport a = analyze_redundancy(*one.system, drawn),
                           b = analyze_redundancy(*other.system, other_drawn);
    EXPECT_EQ(b.constraint_rows, a.constraint_rows);
    EXPECT_EQ(b.rank, a.rank);
    EXPECT_EQ(b.mobility, a.mobility);
    EXPECT_EQ(b.redundant, a.redundant);
    EXPECT_EQ(b.decision.confident, a.decision.confident);
    EXPECT_NEAR(b.characteristic_length_m / change.scale, a.characteristic_length_m, 1e-12 * a.characteristic_length_m);
    ASSERT_EQ(b.reactions.size(), a.reactions.size());
    std::map<std::string, std::pair<int, bool>> of_a, of_b;
    for (const ReactionUniqueness& r : a.reactions) of_a[r.joint] = {r.unique_dimension, r.participates};
    for (const ReactionUniqueness& r : b.reactions) of_b[r.joint] = {r.unique_dimension, r.participates};
    EXPECT_EQ(of_b, of_a);
    if (a.redundant == 0) return;
    const PermanenceReport p = analyze_permanence(*one.system, drawn, a),
                           q = analyze_permanence(*other.system, other_drawn, b);
    EXPECT_EQ(to_string(q.kind), to_string(p.kind));
    EXPECT_EQ(q.generic_mobility, p.generic_mobility);
    EXPECT_EQ(q.generic_redundant, p.generic_redundant);
    EXPECT_EQ(q.finite_mobility, p.finite_mobility);
  });
}

/// Compares reactions without and with each way of distribution, at one state.
void expect_same_reactions(const RandomMechanism& m, const Change& change, const AbsoluteState* at) {
  for (const Springs springs : {Springs::kAll, Springs::kSome}) {
    SCOPED_TRACE(springs == Springs::kAll ? "stiffness everywhere" : "stiffness in places");
    const ModelSpec spec = with_springs(m.spec, springs, m.seed), other_spec = changed(spec, change);
    EngineProbe one(spec), other(other_spec, other_cuts(other_spec, change));
    const AbsoluteState absolute = at ? *at : drawn_state(one.model());
    const State state = tree_state(*one.system, absolute);
    const State other_state = tree_state(*other.system, changed(absolute, one.model(), other.model(), change));
    const ForwardResult motion = one.forward(state), other_motion = other.forward(other_state);
    ASSERT_EQ(motion.status, ForwardStatus::kSolved);
    ASSERT_EQ(other_motion.status, ForwardStatus::kSolved);
    Comparison comparison(one, other, change);
    for (const DistributionBy by :
         {DistributionBy::kNothing, DistributionBy::kJointStiffness, DistributionBy::kEqualStiffness}) {
      if (springs == Springs::kSome && by != DistributionBy::kJointStiffness) continue;
      SCOPED_TRACE("distributed by " + std::string(to_string(by)));
      comparison.expect_same(loads_of(one, state, motion, by), loads_of(other, other_state, other_motion, by));
    }
  }
}

TEST_P(InvarianceTest, ReactionsAtRestAreTheSame) {
  for_each_mechanism([](const RandomMechanism& m, const Change& change) { expect_same_reactions(m, change, nullptr); });
}

TEST_P(InvarianceTest, ReactionsInMotionAreTheSame) {
  for_each_mechanism([](const RandomMechanism& m, const Change& change) {
    EngineProbe engine(m.spec);
    const AbsoluteState moving = absolute_state(*engine.system, engine.wandered(m.seed));
    expect_same_reactions(m, change, &moving);
  });
}

INSTANTIATE_TEST_SUITE_P(Tens, InvarianceTest, ::testing::Range(0, kMechanisms / 10));

TEST(InvarianceSeriesTest, EveryChangeIsMadeOften) {
  std::map<std::string, int> made;
  for (int seed = 0; seed < kMechanisms; ++seed) {
    const Change c = random_change(static_cast<std::uint64_t>(seed));
    made["turned"] += c.turned;
    made["shifted"] += c.shifted;
    made["small"] += c.scale < 1;
    made["large"] += c.scale > 1;
    made["reordered"] += c.reordered;
    made["recut"] += c.recut;
  }
  ASSERT_EQ(made.size(), 6u);
  for (const auto& [name, count] : made) EXPECT_GE(count, 100) << name;
}

TEST(InvarianceSeriesTest, AllJointTypesAndKindsOfLoopsOccur) {
  std::map<std::string, int> pieces;
  std::set<JointType> types;
  int redundant = 0, several = 0;
  for (int seed = 0; seed < kMechanisms; ++seed) {
    const RandomMechanism m = make_random_mechanism(static_cast<std::uint64_t>(seed));
    redundant += m.verdict.redundant > 0;
    several += m.loops > 1;
    for (const JointSpec& joint : m.spec.joints) types.insert(joint.type);
    for (const char* piece : {"planar loop", "spherical loop", "bennett", "bricard", "generic loop"}) {
      pieces[piece] += m.description.find(piece) != std::string::npos;
    }
  }
  EXPECT_EQ(types.size(), all_joint_types().size());
  EXPECT_GE(redundant, kMechanisms / 2);
  EXPECT_GE(several, kMechanisms / 2);
  for (const auto& [piece, count] : pieces) EXPECT_GE(count, 30) << piece;
}

}  // namespace
}  // namespace ferrers::witness
