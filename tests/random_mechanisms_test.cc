#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "ferrers/dynamics/inverse.h"
#include "ferrers/kinematics/coordinates.h"
#include "ferrers/model/pose_spec.h"
#include "ferrers/testing/compare.h"
#include "ferrers/testing/engine_probe.h"
#include "ferrers/testing/random_mechanism.h"
#include "ferrers/testing/transforms.h"
#include "ferrers/testing/zoo_parts.h"

/// What must hold for any mechanism, on 200 random ones in motion: the two problems of dynamics undo each other, the
/// engine agrees with dense absolute coordinates, and nothing depends on how the mechanism is written down.
namespace ferrers::witness {
namespace {

constexpr int kMechanisms = 200;
constexpr double kAgreement = 1e-9;

/// One mechanism of the series, moved away from its drawing and moving.
struct Subject {
  RandomMechanism mechanism;
  Model model;
  AbsoluteState state;
  explicit Subject(std::uint64_t seed)
      : mechanism(make_random_mechanism(seed)),
        model(build_model(mechanism.spec).model.value()),
        state(wandered(model, seed)) {}
  std::string name() const { return "seed " + std::to_string(mechanism.seed) + ": " + mechanism.description; }
};

const Subject& subject(int seed) {
  static std::map<int, Subject> made;
  return made.try_emplace(seed, seed).first->second;
}

VectorXd joined(const std::vector<Vector6d>& list) {
  VectorXd out(6 * static_cast<long>(list.size()));
  for (std::size_t i = 0; i < list.size(); ++i) out.segment<6>(6 * static_cast<long>(i)) = list[i];
  return out;
}

double largest_load(const std::vector<JointReaction>& reactions) {
  double largest = 1;
  for (const JointReaction& r : reactions) {
    for (int k = 0; k < 6; ++k) {
      if (r.status[k] == ReactionStatus::kUnique) largest = std::max(largest, std::abs(r.value[k]));
    }
  }
  return largest;
}

std::string component(const Model& model, std::size_t j, int k) {
  return model.joints()[j].name + "/" + std::string(kComponentNames[k]);
}

/// Equal flags, and equal values where both are unique.
void expect_same_reactions(const Model& model, const std::vector<JointReaction>& got,
                           const std::vector<JointReaction>& wanted, const std::vector<JointReaction>& scale_of) {
  const double scale = largest_load(scale_of);
  ASSERT_EQ(got.size(), wanted.size());
  for (std::size_t j = 0; j < got.size(); ++j) {
    for (int k = 0; k < 6; ++k) {
      EXPECT_EQ(got[j].status[k], wanted[j].status[k]) << component(model, j, k);
      if (got[j].status[k] != ReactionStatus::kUnique || wanted[j].status[k] != ReactionStatus::kUnique) continue;
      EXPECT_NEAR(got[j].value[k], wanted[j].value[k], kAgreement * scale) << component(model, j, k);
    }
  }
}

TEST(RandomMechanismsTest, TheSeriesCoversLoopsRedundancyAndJointTypes) {
  std::map<JointType, int> types;
  int redundant = 0, loops = 0, several = 0, coupled = 0;
  for (int seed = 0; seed < kMechanisms; ++seed) {
    const RandomMechanism& m = subject(seed).mechanism;
    redundant += m.verdict.redundant > 0;
    loops += m.loops;
    several += m.loops > 1;
    coupled += !m.spec.couplings.empty();
    std::set<JointType> of_this;
    for (const JointSpec& j : m.spec.joints) of_this.insert(j.type);
    for (const JointType type : of_this) ++types[type];
  }
  std::string counts;
  for (const auto& [type, count] : types) {
    counts += " " + std::string(joint_type_info(type).name) + " " + std::to_string(count);
  }
  std::printf("%d mechanisms: %d redundant, %d with several loops (%d loops in all), %d with couplings; with%s\n",
              kMechanisms, redundant, several, loops, coupled, counts.c_str());
  EXPECT_GE(types.size(), 6u);
  EXPECT_GE(3 * redundant, kMechanisms);
  EXPECT_GE(several, kMechanisms / 4);
}

/// Runs a check on every mechanism of the series; failures carry its seed.
template <class Check>
void for_all(const Check& check) {
  for (int seed = 0; seed < kMechanisms; ++seed) {
    SCOPED_TRACE(subject(seed).name());
    check(subject(seed));
  }
}

TEST(RandomMechanismsTest, AnEngineStateIsTheAbsoluteState) {
  for_all([](const Subject& here) {
    EngineProbe engine(here.mechanism.spec);
    const State state = tree_state(*engine.system, here.state);
    engine.evaluate(state);
    EXPECT_LT(engine.eq.constraints.phi.norm(), 1e-10);
    EXPECT_LT(engine.eq.constraints.rate.norm(), 1e-9);
    const AbsoluteState back = absolute_state(*engine.system, state);
    EXPECT_TRUE(matrices_near(joined(back.twists), joined(here.state.twists), 1e-10));
    for (std::size_t b = 1; b < back.poses.size(); ++b) {
      EXPECT_LT((back.poses[b].p - here.state.poses[b].p).norm(), 1e-10);
      EXPECT_LT((back.poses[b].R - here.state.poses[b].R).norm(), 1e-10);
    }
  });
}

TEST(RandomMechanismsTest, AccelerationsAndUniqueReactionsAgreeWithAbsoluteCoordinates) {
  for_all([](const Subject& here) {
    EngineProbe engine(here.mechanism.spec);
    const State state = tree_state(*engine.system, here.state);
    const ForwardResult result = engine.forward(state);
    ASSERT_EQ(result.status, ForwardStatus::kSolved);
    const Model& model = here.model;
    const AbsoluteState& absolute = here.state;
    const AbsoluteMotion wanted = solve_absolute(model, absolute, applied_wrenches(model, absolute, 0));
    EXPECT_TRUE(matrices_near(joined(engine.body_accelerations(result.vdot)), joined(wanted.accelerations), kAgreement,
                              "accelerations"));

    const AbsoluteVerdict verdict = analyze_absolute(model, absolute.poses);
    const std::vector<JointReaction> got = engine.reactions(state, result);
    std::vector<JointReaction> other(got.size());
    for (std::size_t j = 0; j < got.size(); ++j) {
      const JointId id(j);
      RelativeMotion motion;
      Jet rows[6];
      compute_joint_rows(*engine.system, id, state, engine.eq.pos, engine.eq.vel, motion, rows);
      const NodePoint M = engine.system->point(model.joints()[j].second, model.joints()[j].X_2M.p);
      const Vector3d at = point_position(engine.eq.pos, M) + reaction_point_from_M(model.joints()[j], motion);
      const std::vector<int>& first = wanted.constraints.first_row;
      const Vector6d w =
          joint_reaction(model, absolute.poses, id, wanted.lambda.segment(first[j], first[j + 1] - first[j]), at);
      const std::array<bool, 6> unique = unique_world_components(model, absolute.poses, id, verdict, at);
      for (int k = 0; k < 6; ++k) {
        other[j].value[k] = w[(k + 3) % 6];
        other[j].status[k] = unique[(k + 3) % 6] ? ReactionStatus::kUnique : ReactionStatus::kUndetermined;
      }
    }
    expect_same_reactions(model, got, other, other);
  });
}

TEST(RandomMechanismsTest, BothFormulationsAgree) {
  for_all([](const Subject& here) {
    EngineProbe engine(here.mechanism.spec);
    const State state = tree_state(*engine.system, here.state);
    const ForwardResult a = engine.forward(state, Formulation::kNullSpace);
    const ForwardResult b = engine.forward(state, Formulation::kElimination);
    ASSERT_EQ(a.status, ForwardStatus::kSolved);
    ASSERT_EQ(b.status, ForwardStatus::kSolved);
    EXPECT_TRUE(matrices_near(b.vdot, a.vdot, kAgreement, "vdot"));
    EXPECT_TRUE(matrices_near(b.lambda, a.lambda, kAgreement, "lambda"));
  });
}

// --- Invariance ---

TEST(RandomMechanismsTest, OtherCutsGiveTheSameMotionAndReactions) {
  for_all([](const Subject& here) {
    EngineProbe engine(here.mechanism.spec);
    const State state = tree_state(*engine.system, here.state);
    const ForwardResult result = engine.forward(state);
    const std::vector<JointReaction> reactions = engine.reactions(state, result);
    RandomSource random(here.mechanism.seed);
    TopologyOptions options;
    for (std::size_t j = 0; j < here.model.joints().size(); ++j) options.cut.push_back(random.chance(0.5));
    EngineProbe other(here.mechanism.spec, options);
    const State other_state = tree_state(*other.system, here.state);
    const ForwardResult other_result = other.forward(other_state);
    ASSERT_EQ(other_result.status, ForwardStatus::kSolved);
    EXPECT_TRUE(matrices_near(joined(other.body_accelerations(other_result.vdot)),
                              joined(engine.body_accelerations(result.vdot)), kAgreement));
    expect_same_reactions(here.model, other.reactions(other_state, other_result), reactions, reactions);
  });
}

TEST(RandomMechanismsTest, TheOrderOfTheFileChangesNothing) {
  for_all([](const Subject& here) {
    EngineProbe engine(here.mechanism.spec);
    EngineProbe other(permuted(here.mechanism.spec, here.mechanism.seed + 1));
    const Model &model = engine.model(), &shuffled = other.model();
    AbsoluteState moved = drawn_state(shuffled);
    for (std::size_t b = 1; b < moved.poses.size(); ++b) {
      const std::size_t before = model.find_body(shuffled.bodies()[b].name)->index();
      moved.poses[b] = here.state.poses[before];
      moved.twists[b] = here.state.twists[before];
    }
    const State state = tree_state(*engine.system, here.state), other_state = tree_state(*other.system, moved);
    const ForwardResult result = engine.forward(state), other_result = other.forward(other_state);
    const auto accelerations = engine.body_accelerations(result.vdot);
    const auto other_accelerations = other.body_accelerations(other_result.vdot);
    std::vector<Vector6d> sorted(accelerations.size(), Vector6d::Zero());
    for (std::size_t b = 1; b < sorted.size(); ++b) {
      sorted[b] = other_accelerations[shuffled.find_body(model.bodies()[b].name)->index()];
    }
    EXPECT_TRUE(matrices_near(joined(sorted), joined(accelerations), kAgreement));
    const auto reactions = engine.reactions(state, result),
               shuffled_reactions = other.reactions(other_state, other_result);
    std::vector<JointReaction> in_order(reactions.size());
    for (std::size_t j = 0; j < reactions.size(); ++j) {
      in_order[j] = shuffled_reactions[shuffled.find_joint(model.joints()[j].name)->index()];
    }
    expect_same_reactions(model, in_order, reactions, reactions);
  });
}

TEST(RandomMechanismsTest, BodiesInPartsThatWeldsMergeAreTheBodiesAgain) {
  for_all([](const Subject& here) {
    EngineProbe engine(here.mechanism.spec), other(in_parts(here.mechanism.spec, here.mechanism.seed));
    ASSERT_EQ(other.model().bodies().size(), engine.model().bodies().size());
    ASSERT_EQ(other.model().joints().size(), engine.model().joints().size());
    const State state = tree_state(*engine.system, here.state), other_state = tree_state(*other.system, here.state);
    const ForwardResult result = engine.forward(state), other_result = other.forward(other_state);
    EXPECT_TRUE(matrices_near(joined(other.body_accelerations(other_result.vdot)),
                              joined(engine.body_accelerations(result.vdot)), kAgreement));
    const std::vector<JointReaction> reactions = engine.reactions(state, result);
    expect_same_reactions(here.model, other.reactions(other_state, other_result), reactions, reactions);
  });
}

TEST(RigidGroupsTest, ALoadInTheAxesOfATurnedPartActsAsOnAPartThatIsKept) {
  ModelSpec spec;
  spec.bodies = {box_body("arm", {1, 0, 0}, {2, 0.1, 0.2}, 2), box_body("nozzle", {0, 0, 0.2}, {0.1, 0.2, 0.4}, 1)};
  const Matrix3d R = Eigen::AngleAxisd(0.8, Vector3d(1, 2, 2) / 3).toRotationMatrix();
  spec.bodies[1].pose = pose_spec({R, Vector3d(2, 0, 0)});
  JointSpec bolt = joint(JointType::kWeld, "bolt", "arm", "nozzle", {2, 0, 0});
  bolt.axis = {};
  bolt.merge = true;
  JointSpec ball = joint(JointType::kSpherical, "ball", "ground", "arm", {0, 0, 0});
  ball.axis = {};
  spec.joints = {ball, bolt};
  LoadSpec thrust;
  thrust.body = "nozzle";
  thrust.place = number3(0, 0, 0.4);
  thrust.components = {law("3"), law("-2"), law("10")};
  thrust.in_body_axes = true;
  spec.forces = {{"thrust", thrust, {}}};
  ModelSpec kept_spec = spec;
  keep_welds(kept_spec);
  EngineProbe merged(spec), kept(kept_spec);
  ASSERT_EQ(merged.model().bodies().size(), 2u);
  const VectorXd a = merged.forward(make_drawn_state(*merged.system)).vdot,
                 b = kept.forward(make_drawn_state(*kept.system)).vdot;
  ASSERT_EQ(a.size(), 3);
  EXPECT_TRUE(matrices_near(a, b, 1e-12, "vdot"));
}

/// Joints whose frames turn with the mechanism (the others keep world axes as drawn).
bool has_own_axes(JointType type) {
  switch (type) {
    case JointType::kWeld:
    case JointType::kSpherical:
    case JointType::kFree:
    case JointType::kDistance:
      return false;
    default:
      return true;
  }
}

TEST(RandomMechanismsTest, AResultTurnsWithTheMechanism) {
  for_all([](const Subject& here) {
    const Matrix3d R = RandomSource(here.mechanism.seed).rotation();
    EngineProbe engine(here.mechanism.spec), other(rotated(here.mechanism.spec, R));
    AbsoluteState turned = here.state;
    for (std::size_t b = 1; b < turned.poses.size(); ++b) {
      turned.poses[b] = {R * turned.poses[b].R * R.transpose(), R * turned.poses[b].p};
      const Vector3d angular = R * turned.twists[b].head<3>(), linear = R * turned.twists[b].tail<3>();
      turned.twists[b] << angular, linear;
    }
    const State state = tree_state(*engine.system, here.state), other_state = tree_state(*other.system, turned);
    const ForwardResult result = engine.forward(state), other_result = other.forward(other_state);
    std::vector<Vector6d> wanted = engine.body_accelerations(result.vdot);
    for (Vector6d& a : wanted) {
      const Vector3d angular = R * a.head<3>(), linear = R * a.tail<3>();
      a << angular, linear;
    }
    EXPECT_TRUE(matrices_near(joined(other.body_accelerations(other_result.vdot)), joined(wanted), kAgreement));
    std::vector<JointReaction> before = engine.reactions(state, result, ReactionAxes::kJoint);
    std::vector<JointReaction> after = other.reactions(other_state, other_result, ReactionAxes::kJoint);
    for (std::size_t j = 0; j < before.size(); ++j) {
      if (!has_own_axes(here.model.joints()[j].type)) before[j] = after[j] = {};
    }
    expect_same_reactions(here.model, after, before, before);
  });
}

// --- The two problems of dynamics ---

std::string exact(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "(%.17g)", value);
  return text;
}

/// A drive that could be put on the mechanism, and its rate's row.
struct Candidate {
  DriveSpec drive;
  Eigen::RowVectorXd row;
  bool is_coordinate = false;
};

std::vector<Candidate> drive_candidates(const EngineProbe& engine, const State& state, RandomSource& random) {
  std::vector<Candidate> out;
  const Model& model = engine.model();
  const System& system = *engine.system;
  const auto blank = [&] {
    Candidate c;
    c.row = Eigen::RowVectorXd::Zero(system.nv);
    c.drive.name = numbered("drive", static_cast<int>(out.size()) + 1);
    return c;
  };
  for (std::size_t j = 0; j < model.joints().size(); ++j) {
    const JointTypeInfo& type = joint_type_info(model.joints()[j].type);
    for (int k = 0; k < type.nv && type.coordinate_jets; ++k) {
      Candidate c = blank();
      c.is_coordinate = true;
      c.drive.coordinate = CoordinateRef{NameRef(model.joints()[j].name),
                                         type.nv > 1 ? std::string(type.coordinates[k].name) : std::string()};
      const CoordinateAccess access = system.access({JointId(j), k});
      const Jet jet = measure_coordinate(system, access, state, engine.eq.pos, engine.eq.vel);
      add_coordinate_row(system, access, engine.eq.pos, jet, 1, c.row);
      out.push_back(c);
    }
  }
  for (std::size_t b = 1; b < model.bodies().size(); ++b) {
    for (int k = 0; k < 15; ++k) {  // the distance of a point on the body from a place on ground
      Candidate c = blank();
      const Vector3d on_body = model.bodies()[b].com_m + random.vector(0.5), on_ground = random.vector(6);
      c.drive.bodies = std::array<NameRef, 2>{NameRef("ground"), NameRef(model.bodies()[b].name)};
      c.drive.points = std::array<Number3, 2>{numbers(on_ground), numbers(on_body)};
      const FramePair pair =
          system.frame_pair(kGround, {Matrix3d::Identity(), on_ground}, BodyId(b), {Matrix3d::Identity(), on_body});
      const RelativeMotion m = compute_relative_motion(pair, engine.eq.pos, engine.eq.vel);
      Wrench W = Wrench::Zero();
      W.tail<3>() = m.d.normalized();
      add_jet_row(system, pair, engine.eq.pos, W, 1, c.row);
      out.push_back(c);
    }
  }
  return out;
}

/// As many drives as the mobility, independent of each other; joint coordinates before distances.
std::vector<DriveSpec> full_drives(const EngineProbe& engine, const State& state, std::uint64_t seed) {
  RandomSource random(seed);
  std::vector<Candidate> candidates = drive_candidates(engine, state, random);
  const Selection& s = engine.selection;
  MatrixXd N = MatrixXd::Zero(engine.system->nv, static_cast<long>(s.independent.size()));
  for (std::size_t k = 0; k < s.independent.size(); ++k) N(s.independent[k], static_cast<long>(k)) = 1;
  if (!s.rows.empty()) {
    const MatrixXd G_d = engine.eq.constraints.G(s.rows, s.dependent),
                   G_i = engine.eq.constraints.G(s.rows, s.independent);
    N(s.dependent, Eigen::all) = -G_d.partialPivLu().solve(G_i);
  }
  std::vector<Eigen::RowVectorXd> rests;
  for (const Candidate& c : candidates) {
    Eigen::RowVectorXd rest = c.row * N;
    if (rest.norm() > 1e-12) rest /= std::max(1.0, rest.norm());
    rests.push_back(rest);
  }
  std::vector<DriveSpec> drives;
  while (drives.size() < s.independent.size()) {
    std::size_t best = 0;
    double best_size = -1;
    for (std::size_t i = 0; i < rests.size(); ++i) {
      const double size = rests[i].norm() * (candidates[i].is_coordinate ? 5 : 1);
      if (size > best_size) {
        best_size = size;
        best = i;
      }
    }
    drives.push_back(candidates[best].drive);
    const Eigen::RowVectorXd along = rests[best].normalized();
    for (Eigen::RowVectorXd& rest : rests) rest -= rest.dot(along) * along;
  }
  return drives;
}

/// Motion laws that pass through the state at t = 0, with any rate and acceleration.
ModelSpec with_motion(ModelSpec spec, const std::vector<DriveSpec>& drives, const AbsoluteState& absolute,
                      std::uint64_t seed) {
  RandomSource random(seed + 77);
  spec.drives = drives;
  EngineProbe engine(spec);
  const State state = tree_state(*engine.system, absolute);
  engine.evaluate(state);
  for (std::size_t i = 0; i < drives.size(); ++i) {
    const Jet jet = measure_drive(*engine.dynamics, engine.dynamics->drives[i], state, engine.eq.pos, engine.eq.vel,
                                  engine.eq.drive_work);
    const std::string sine = exact(random.between(-0.3, 0.3)) + "*sin(" + exact(random.between(1, 4)) + "*t)";
    spec.drives[i].motion = {law(exact(jet.value) + " + " + exact(random.between(-0.5, 0.5)) + "*t + " +
                                 exact(random.between(-0.5, 0.5)) + "*t^2 + " + sine)};
  }
  return spec;
}

TEST(RandomMechanismsTest, ForwardDynamicsUndoesInverseDynamics) {
  for_all([](const Subject& here) {
    EngineProbe plain(here.mechanism.spec);
    const State at_rest = tree_state(*plain.system, here.state);
    plain.evaluate(at_rest);
    const std::vector<DriveSpec> drives = full_drives(plain, at_rest, here.mechanism.seed);
    const ModelSpec driven_spec = with_motion(here.mechanism.spec, drives, here.state, here.mechanism.seed);
    EngineProbe driven(driven_spec);
    PrescribedMotion motion(driven.dynamics, tree_state(*driven.system, here.state));
    ASSERT_EQ(motion.check().status, PrescribedStatus::kSolved) << motion.check().message;
    for (const double t : {0.0, 0.01, 0.03}) {
      const PrescribedResult inverse = motion.solve(t);
      ASSERT_EQ(inverse.status, PrescribedStatus::kSolved) << inverse.message;
      ModelSpec forced_spec = driven_spec;
      for (std::size_t i = 0; i < forced_spec.drives.size(); ++i) {
        forced_spec.drives[i].motion.clear();
        forced_spec.drives[i].effort = {law(exact(inverse.u[static_cast<long>(i)]))};
      }
      EngineProbe forced(forced_spec);
      const State state = tree_state(*forced.system, absolute_state(*driven.system, inverse.state));
      const ForwardResult forward = forced.forward(state);
      ASSERT_EQ(forward.status, ForwardStatus::kSolved);
      EXPECT_TRUE(matrices_near(joined(forced.body_accelerations(forward.vdot)), joined([&] {
                                  driven.evaluate(inverse.state);
                                  return driven.body_accelerations(inverse.vdot);
                                }()),
                                kAgreement, "accelerations"))
          << "t = " << t;
      // The reactions are the same too.
      std::vector<JointReaction> wanted =
          ReactionSolver(driven.dynamics)
              .solve(inverse.state, driven.eq, motion.selection(), inverse.vdot, inverse.lambda, inverse.u);
      wanted.resize(here.model.coordinates_begin());
      expect_same_reactions(here.model, forced.reactions(state, forward), wanted, wanted);
    }
  });
}

/// Motion laws with the position, rate and acceleration that a forward evaluation gave, at t = 0.
ModelSpec with_found_motion(ModelSpec spec, const EngineProbe& forced, const State& state,
                            const ForwardResult& forward) {
  VelocityKinematics acc = make_velocity_kinematics(*forced.system);
  compute_accelerations(*forced.system, forced.eq.pos, forced.eq.vel, forward.vdot, acc);
  for (std::size_t i = 0; i < spec.drives.size(); ++i) {
    const DriveComponent& drive = forced.dynamics->drives[i];
    FormulaEvaluation work = make_drive_evaluation(*forced.dynamics);
    const Jet jet = measure_drive(*forced.dynamics, drive, state, forced.eq.pos, forced.eq.vel, work);
    Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(forced.system->nv);
    add_drive_row(*forced.dynamics, drive, forced.eq.pos, jet, work, row);
    const double acceleration = jet.bias + row.dot(forward.vdot);
    spec.drives[i].effort.clear();
    spec.drives[i].motion = {
        law(exact(jet.value) + " + " + exact(jet.rate) + "*t + " + exact(acceleration / 2) + "*t^2")};
  }
  return spec;
}

TEST(RandomMechanismsTest, InverseDynamicsFindsTheEffortsThatDroveTheMotion) {
  std::map<std::pair<JointType, bool>, int> driven_coordinates;  // by type, and whether the joint is cut
  int distances = 0;
  for_all([&](const Subject& here) {
    EngineProbe plain(here.mechanism.spec);
    const State found = tree_state(*plain.system, here.state);
    plain.evaluate(found);
    ModelSpec spec = here.mechanism.spec;
    spec.drives = full_drives(plain, found, here.mechanism.seed);
    RandomSource random(here.mechanism.seed + 5);
    const double size = largest_load(plain.reactions(found, plain.forward(found)));
    for (DriveSpec& drive : spec.drives) drive.effort = {law(exact(size * random.between(-1, 1)))};
    EngineProbe forced(spec);
    const State state = tree_state(*forced.system, here.state);  // drives bear on the choice of the tree
    const ForwardResult forward = forced.forward(state);
    ASSERT_EQ(forward.status, ForwardStatus::kSolved);
    for (const DriveComponent& drive : forced.dynamics->drives) {
      if (drive.kind != Drive::Kind::kCoordinate) {
        ++distances;
        continue;
      }
      const JointType type = forced.model().joint(drive.coordinate.joint).type;
      ++driven_coordinates[{type, !drive.access.in_tree}];
    }
    EngineProbe driven(with_found_motion(spec, forced, state, forward));
    PrescribedMotion motion(driven.dynamics, tree_state(*driven.system, here.state));
    const PrescribedResult inverse = motion.solve(0);
    ASSERT_EQ(inverse.status, PrescribedStatus::kSolved) << inverse.message;
    EXPECT_LT((inverse.u - forced.eq.u).cwiseAbs().maxCoeff(), kAgreement * size);
    for (const bool shared : inverse.effort_is_shared) EXPECT_FALSE(shared);
  });
  for (const auto& [place, count] : driven_coordinates) {
    std::printf("  %s %s: %d drives\n", std::string(joint_type_info(place.first).name).c_str(),
                place.second ? "(cut)" : "(tree)", count);
  }
  std::printf("  distances: %d drives\n", distances);
  for (const JointType type : {JointType::kRevolute, JointType::kPrismatic, JointType::kScrew, JointType::kCylindrical,
                               JointType::kUniversal, JointType::kPlanar}) {
    EXPECT_GT((driven_coordinates[{type, false}]), 0) << joint_type_info(type).name;
  }
  EXPECT_GT(distances, 0);
}

}  // namespace
}  // namespace ferrers::witness
