#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <set>
#include <string>

#include "ferrers/model/joints/joint_type.h"
#include "ferrers/testing/compare.h"
#include "ferrers/testing/finite_difference.h"
#include "ferrers/testing/random_source.h"

namespace ferrers {
namespace {

using witness::differentiate;
using witness::matrices_near;
using witness::RandomSource;

constexpr double kTwoPi = 2 * std::numbers::pi;

/// Numbers for every type at once; a gear pair with base radii 0.3 and −0.45 (external).
JointConstants make_constants() {
  JointConstants c;
  c.lead_m = 0.13;
  c.length_m = 0.9;
  c.base_radius_1_m = 0.3;
  c.base_radius_2_m = -0.45;
  c.mesh_side = -1;
  c.mesh_offset_m = 0.07;
  return c;
}

struct Rates {
  Eigen::Vector3d w1, w2, u1, u2, a1, a2;  ///< ω constant; origins of F and M at u t + a t²/2.
};

/// Two frames in free motion: turning at constant rates, origins on parabolas.
struct TwoFrames {
  Eigen::Matrix3d R_F, R_M;
  Eigen::Vector3d p_F, p_M;
  Rates rates;

  static TwoFrames random(RandomSource& r) {
    return {r.rotation(),
            r.rotation(),
            r.vector(1),
            r.vector(1) + 1.5 * r.direction(),
            {r.vector(1), r.vector(1), r.vector(1), r.vector(1), r.vector(1), r.vector(1)}};
  }

  RelativeMotion at(double t) const {
    RelativeMotion m;
    m.R_F = quaternion_exp(rates.w1 * t) * R_F;
    m.R_M = quaternion_exp(rates.w2 * t) * R_M;
    m.d = p_M + rates.u2 * t + 0.5 * t * t * rates.a2 - p_F - rates.u1 * t - 0.5 * t * t * rates.a1;
    m.w1 = rates.w1;
    m.w2 = rates.w2;
    m.w = rates.w2 - rates.w1;
    m.v = rates.u2 + rates.a2 * t - rates.u1 - rates.a1 * t - rates.w1.cross(m.d);
    m.a = rates.a2 - rates.a1 - rates.w1.cross(rates.w1.cross(m.d));
    return m;
  }
};

Twist twist_of(const RelativeMotion& m) {
  Twist V;
  V << m.w, m.v;
  return V;
}

/// All functions of a type in one list: rows, coordinates and angles, the last two on the turn of `reference`.
std::vector<Jet> all_jets(const JointTypeInfo& type, const JointConstants& c, const RelativeMotion& m,
                          const std::vector<double>& reference = {}) {
  Jet jets[6];
  double winding[2] = {0, 0};
  std::vector<Jet> angles;
  if (type.angles) {
    type.angles(c, m, jets);
    for (int i = 0; i < type.winding_count; ++i) {
      if (!reference.empty()) jets[i] = continued(jets[i], reference[i]);
      winding[i] = jets[i].value;
      angles.push_back(jets[i]);
    }
  }
  std::vector<Jet> out = angles;
  type.rows(c, m, winding, jets);
  out.insert(out.end(), jets, jets + type.row_count());
  if (type.coordinate_jets) {
    type.coordinate_jets(c, m, jets);
    for (int i = 0, slot = 0; i < type.nv; ++i) {
      if (type.coordinates[i].kind == CoordinateKind::kAngle) jets[i] = continued(jets[i], winding[slot++]);
      out.push_back(jets[i]);
    }
  }
  return out;
}

std::vector<double> angle_values(const JointTypeInfo& type, const JointConstants& c, const RelativeMotion& m) {
  Jet jets[2];
  if (type.angles) type.angles(c, m, jets);
  return {jets[0].value, jets[1].value};
}

/// A gear pair needs its centres further apart than the base radii; all other types take any pose.
bool is_possible(const JointTypeInfo& type, const JointConstants& c, const RelativeMotion& m) {
  if (type.type != JointType::kGearMesh) return true;
  const Eigen::Vector3d z = m.R_F.col(2);
  return (m.d - z * z.dot(m.d)).norm() > 1.2 * std::abs(c.base_radius_1_m - c.base_radius_2_m);
}

/// Poses where an angle of the type is not near its singularity, found from `seed`.
TwoFrames random_frames(const JointTypeInfo& type, const JointConstants& c, int seed) {
  RandomSource random(1000 + seed);
  for (;;) {
    const TwoFrames frames = TwoFrames::random(random);
    const RelativeMotion m = frames.at(0);
    bool smooth = is_possible(type, c, m);
    for (const Jet& jet : all_jets(type, c, m)) smooth = smooth && jet.W.norm() < 8;
    if (smooth) return frames;
  }
}

/// Random coordinates: several turns, unit quaternions.
std::vector<double> random_q(const JointTypeInfo& type, RandomSource& random) {
  std::vector<double> q(static_cast<std::size_t>(type.nq));
  for (double& value : q) value = random.between(-9, 9);
  if (type.quaternion_at < 0) return q;
  const Eigen::Quaterniond u(random.rotation());
  const double wxyz[] = {u.w(), u.x(), u.y(), u.z()};
  std::copy(wxyz, wxyz + 4, q.begin() + type.quaternion_at);
  return q;
}

/// q after time t with constant velocities (ω in F axes).
std::vector<double> flow(const JointTypeInfo& type, std::vector<double> q, const std::vector<double>& v, double t) {
  const int at = type.quaternion_at;
  if (at < 0) {
    for (int i = 0; i < type.nq; ++i) q[i] += t * v[i];
    return q;
  }
  for (int i = 0; i < at; ++i) q[i] += t * v[3 + i];
  const Eigen::Quaterniond u = quaternion_exp(t * Eigen::Vector3d(v[0], v[1], v[2])) *
                               Eigen::Quaterniond(q[at], q[at + 1], q[at + 2], q[at + 3]);
  const double wxyz[] = {u.w(), u.x(), u.y(), u.z()};
  std::copy(wxyz, wxyz + 4, q.begin() + at);
  return q;
}

struct Subspace {
  Eigen::MatrixXd S;  // 6 × nv, F axes
  Twist S_dot_v;
};

Subspace subspace_of(const JointTypeInfo& type, const JointConstants& c, const std::vector<double>& q,
                     const std::vector<double>& v) {
  Twist S[6];
  Subspace out;
  type.subspace(c, q.data(), v.data(), S, out.S_dot_v);
  out.S.resize(6, type.nv);
  for (int k = 0; k < type.nv; ++k) out.S.col(k) = S[k];
  return out;
}

/// A relative motion on the joint's own motion, F at random.
RelativeMotion own_motion(const JointTypeInfo& type, const JointConstants& c, const std::vector<double>& q,
                          const std::vector<double>& v, const Eigen::Matrix3d& R_F, const Eigen::Vector3d& w1) {
  Pose X_FM;
  type.motion(c, q.data(), X_FM);
  RelativeMotion m;
  m.R_F = R_F;
  m.R_M = R_F * X_FM.R;
  m.d = R_F * X_FM.p;
  const Subspace s = subspace_of(type, c, q, v);
  Twist V = Twist::Zero();
  for (int k = 0; k < type.nv; ++k) V += s.S.col(k) * v[k];
  m.w1 = w1;
  m.w = R_F * V.head<3>();
  m.v = R_F * V.tail<3>();
  m.w2 = w1 + m.w;
  // Bias of the joint's own motion: what is left of the acceleration when the coordinates' accelerations are zero.
  m.alpha = R_F * s.S_dot_v.head<3>() + w1.cross(m.w);
  m.a = R_F * s.S_dot_v.tail<3>() + 2 * w1.cross(m.v);
  return m;
}

std::vector<double> random_v(const JointTypeInfo& type, RandomSource& random) {
  std::vector<double> v(6);
  for (int i = 0; i < type.nv; ++i) v[i] = random.between(-1, 1);
  return v;
}

class JointTypesTest : public ::testing::TestWithParam<const JointTypeInfo*> {
 protected:
  const JointTypeInfo& type_ = *GetParam();
  const JointConstants constants_ = make_constants();
};

TEST_P(JointTypesTest, TheTableIsConsistent) {
  EXPECT_EQ(&joint_type_info(type_.type), &type_);
  EXPECT_EQ(find_joint_type(type_.name), &type_);
  EXPECT_EQ(type_.position_names.size(), static_cast<std::size_t>(type_.nq));
  EXPECT_EQ(type_.coordinates.size(), static_cast<std::size_t>(type_.nv));
  EXPECT_TRUE(std::is_sorted(type_.row_components.begin(), type_.row_components.end()));
  const std::set<int> components(type_.row_components.begin(), type_.row_components.end());
  EXPECT_EQ(components.size(), type_.row_components.size());
  if (type_.can_be_tree) {
    EXPECT_EQ(type_.nv, type_.freedoms());
    EXPECT_EQ(type_.nq, type_.nv + (type_.quaternion_at >= 0 ? 1 : 0));
    EXPECT_NE(type_.motion.numbers, nullptr);
    EXPECT_NE(type_.subspace.numbers, nullptr);
  }
}

TEST_P(JointTypesTest, FunctionsOfThePoseHaveExactFirstAndSecondDerivativesAnywhere) {
  for (int seed = 0; seed < 25; ++seed) {
    const TwoFrames frames = random_frames(type_, constants_, seed);
    const RelativeMotion now = frames.at(0);
    const std::vector<double> reference = angle_values(type_, constants_, now);
    const std::vector<Jet> jets = all_jets(type_, constants_, now, reference);
    for (std::size_t i = 0; i < jets.size(); ++i) {
      const auto value = [&](double t) { return all_jets(type_, constants_, frames.at(t), reference)[i].value; };
      const auto rate = [&](double t) { return all_jets(type_, constants_, frames.at(t), reference)[i].rate; };
      EXPECT_NEAR(jets[i].rate, differentiate(value, 0.0, 2e-3), 1e-8) << "seed " << seed << " function " << i;
      EXPECT_NEAR(jets[i].bias, differentiate(rate, 0.0, 2e-3), 1e-7) << "seed " << seed << " function " << i;
      EXPECT_NEAR(jets[i].rate, jets[i].W.dot(twist_of(now)), 1e-12) << "seed " << seed << " function " << i;
    }
  }
}

TEST_P(JointTypesTest, AccelerationsEnterByTheWrench) {
  for (int seed = 0; seed < 10; ++seed) {
    const RelativeMotion without = random_frames(type_, constants_, seed).at(0);
    RandomSource random(seed);
    RelativeMotion with = without;
    const Eigen::Vector3d alpha = random.vector(2), a = random.vector(2);
    with.alpha += alpha;
    with.a += a;
    const std::vector<Jet> f = all_jets(type_, constants_, with), g = all_jets(type_, constants_, without);
    for (std::size_t i = 0; i < f.size(); ++i) {
      const double added = f[i].W.head<3>().dot(alpha) + f[i].W.tail<3>().dot(a);
      EXPECT_NEAR(f[i].bias - g[i].bias, added, 1e-11) << i;
    }
  }
}

TEST_P(JointTypesTest, FunctionsDoNotDependOnTheFrameOfReference) {
  for (int seed = 0; seed < 10; ++seed) {
    const TwoFrames frames = random_frames(type_, constants_, seed);
    const RelativeMotion here = frames.at(0);
    RandomSource random(77 + seed);
    const Eigen::Matrix3d R = random.rotation();
    RelativeMotion there = here;  // the same, turned as a whole
    there.R_F = R * here.R_F;
    there.R_M = R * here.R_M;
    for (auto field : {&RelativeMotion::d, &RelativeMotion::w1, &RelativeMotion::w2, &RelativeMotion::w,
                       &RelativeMotion::v, &RelativeMotion::alpha, &RelativeMotion::a}) {
      there.*field = R * (here.*field);
    }
    const std::vector<double> reference = angle_values(type_, constants_, here);
    const std::vector<Jet> f = all_jets(type_, constants_, here, reference),
                           g = all_jets(type_, constants_, there, reference);
    for (std::size_t i = 0; i < f.size(); ++i) {
      EXPECT_NEAR(f[i].value, g[i].value, 1e-12);
      EXPECT_NEAR(f[i].rate, g[i].rate, 1e-11);
      EXPECT_NEAR(f[i].bias, g[i].bias, 1e-10);
      EXPECT_LT((R * f[i].W.head<3>() - g[i].W.head<3>()).norm(), 1e-11);
      EXPECT_LT((R * f[i].W.tail<3>() - g[i].W.tail<3>()).norm(), 1e-11);
    }
  }
}

TEST_P(JointTypesTest, TheSubspaceIsTheDerivativeOfTheMotion) {
  if (!type_.can_be_tree) GTEST_SKIP() << "never in the tree";
  for (int seed = 0; seed < 20; ++seed) {
    RandomSource random(seed);
    const std::vector<double> q = random_q(type_, random), v = random_v(type_, random);
    const auto pose = [&](double t) {
      Pose X;
      type_.motion(constants_, flow(type_, q, v, t).data(), X);
      Eigen::Matrix<double, 3, 4> both;
      both << X.R, X.p;
      return both;
    };
    const Eigen::Matrix<double, 3, 4> rate = differentiate(pose, 0.0);
    const Eigen::Matrix3d spin = rate.leftCols<3>() * pose(0).leftCols<3>().transpose();
    Twist wanted;
    wanted << spin(2, 1), spin(0, 2), spin(1, 0), rate.col(3);
    const Subspace s = subspace_of(type_, constants_, q, v);
    const Eigen::VectorXd velocity = Eigen::Map<const Eigen::VectorXd>(v.data(), type_.nv);
    EXPECT_TRUE(matrices_near(Eigen::VectorXd(s.S * velocity), wanted, 1e-11));
    const auto twist = [&](double t) {
      return Eigen::VectorXd(subspace_of(type_, constants_, flow(type_, q, v, t), v).S * velocity);
    };
    EXPECT_TRUE(matrices_near(s.S_dot_v, differentiate(twist, 0.0), 1e-11));
    if (type_.constant_subspace) {
      EXPECT_TRUE(matrices_near(s.S_dot_v, Twist::Zero(), 0));
    }
  }
}

TEST_P(JointTypesTest, RowsVanishOnTheOwnMotionAndAreOrthogonalToIt) {
  if (!type_.can_be_tree) GTEST_SKIP() << "never in the tree";
  for (int seed = 0; seed < 20; ++seed) {
    RandomSource random(300 + seed);
    const std::vector<double> q = random_q(type_, random), v = random_v(type_, random);
    const RelativeMotion m = own_motion(type_, constants_, q, v, random.rotation(), random.vector(1));
    const Subspace s = subspace_of(type_, constants_, q, v);
    Jet rows[6];
    const double winding[2] = {type_.type == JointType::kScrew ? q[0] + 0.4 : 0, 0};  // a reference half a turn near
    type_.rows(constants_, m, winding, rows);
    Eigen::MatrixXd T(6, type_.row_count());
    for (int i = 0; i < type_.row_count(); ++i) {
      EXPECT_NEAR(rows[i].value, 0, 1e-12) << i;
      EXPECT_NEAR(rows[i].rate, 0, 1e-12) << i;
      EXPECT_NEAR(rows[i].bias, 0, 1e-11) << i;
      T.col(i) << m.R_F.transpose() * rows[i].W.head<3>(), m.R_F.transpose() * rows[i].W.tail<3>();
    }
    if (type_.nv > 0 && type_.row_count() > 0) {
      EXPECT_LT((T.transpose() * s.S).cwiseAbs().maxCoeff(), 1e-12);
    }
    Eigen::MatrixXd both(6, 6);  // and together they are everything
    both << T, s.S;
    EXPECT_GT(Eigen::JacobiSVD<Eigen::MatrixXd>(both).singularValues()[5], 1e-3);
    // A row's wrench is mainly what its name says: unit force along, or unit moment about, that axis of F (universal:
    // the moment goes along the common perpendicular).
    for (int i = 0; i < type_.row_count(); ++i) {
      const int component = type_.row_components[i];
      if (component < 3) {
        EXPECT_NEAR(T(3 + component, i), 1, 1e-12);
        EXPECT_NEAR(T.col(i).tail<3>().norm(), 1, 1e-12);
      } else {
        EXPECT_LT(T.col(i).tail<3>().norm(), 1e-12);
        EXPECT_GT(T.col(i).head<3>().norm(), 1e-3);
      }
    }
  }
}

TEST_P(JointTypesTest, RowsAreTheUnitWrenchesOfTheirNamesAsDrawn) {
  if (type_.type == JointType::kGearMesh || type_.type == JointType::kDistance) GTEST_SKIP() << "their own tests";
  RelativeMotion m;
  RandomSource random(5);
  m.R_F = m.R_M = random.rotation();
  Jet rows[6];
  const double winding[2] = {0, 0};
  type_.rows(constants_, m, winding, rows);
  for (int i = 0; i < type_.row_count(); ++i) {
    const int component = type_.row_components[i];
    Wrench in_F;
    in_F << m.R_F.transpose() * rows[i].W.head<3>(), m.R_F.transpose() * rows[i].W.tail<3>();
    Wrench wanted = Wrench::Unit(component < 3 ? 3 + component : component - 3);
    if (type_.type == JointType::kScrew && component == 2) wanted[2] = -constants_.lead_m / kTwoPi;
    EXPECT_TRUE(matrices_near(in_F, wanted, 1e-14)) << i;
  }
}

TEST_P(JointTypesTest, CoordinatesAreReadBackFromThePose) {
  if (!type_.coordinate_jets) GTEST_SKIP() << "no scalar coordinates";
  for (int seed = 0; seed < 20; ++seed) {
    RandomSource random(500 + seed);
    const std::vector<double> q = random_q(type_, random), v = random_v(type_, random);
    const RelativeMotion m = own_motion(type_, constants_, q, v, random.rotation(), random.vector(1));
    Jet jets[6];
    type_.coordinate_jets(constants_, m, jets);
    for (int i = 0; i < type_.nv; ++i) {
      const bool angle = type_.coordinates[i].kind == CoordinateKind::kAngle;
      if (angle) {
        EXPECT_LE(std::abs(jets[i].value), std::numbers::pi);
        jets[i] = continued(jets[i], q[i] + 3);  // any reference less than half a turn away
      }
      EXPECT_NEAR(jets[i].value, q[i], 1e-12) << i;
      EXPECT_NEAR(jets[i].rate, v[i], 1e-12) << i;
      EXPECT_NEAR(jets[i].bias, 0, 1e-11) << i;
      // Power of the coordinate's wrench: its own velocity only.
      const Subspace s = subspace_of(type_, constants_, q, v);
      Eigen::Matrix<double, 6, 1> in_F;
      in_F << m.R_F.transpose() * jets[i].W.head<3>(), m.R_F.transpose() * jets[i].W.tail<3>();
      const Eigen::VectorXd power = s.S.transpose() * in_F;
      EXPECT_TRUE(matrices_near(power, Eigen::VectorXd::Unit(type_.nv, i), 1e-12));
    }
  }
}

std::string test_name(const ::testing::TestParamInfo<const JointTypeInfo*>& info) {
  return std::string(info.param->name);
}
INSTANTIATE_TEST_SUITE_P(Types, JointTypesTest, ::testing::ValuesIn(all_joint_types()), test_name);

TEST(JointTypeTableTest, UnknownNamesAreNotFound) {
  EXPECT_EQ(all_joint_types().size(), 13u);
  EXPECT_EQ(find_joint_type("hinge"), nullptr);
}

TEST(PointJointsTest, PointsStayOnLineAndPlaneWhateverTheRotation) {
  RandomSource random(1);
  for (int i = 0; i < 20; ++i) {
    RelativeMotion m;
    m.R_F = random.rotation();
    m.R_M = random.rotation();
    Jet rows[6];
    m.d = m.R_F * Eigen::Vector3d(0, 0, random.between(-2, 2));
    kPointOnLineJoint.rows({}, m, nullptr, rows);
    EXPECT_NEAR(std::hypot(rows[0].value, rows[1].value), 0, 1e-14);
    m.d = m.R_F * Eigen::Vector3d(random.between(-2, 2), random.between(-2, 2), 0.25);
    kPointOnPlaneJoint.rows({}, m, nullptr, rows);
    EXPECT_NEAR(rows[0].value, 0.25, 1e-14);
    EXPECT_LT(rows[0].W.head<3>().norm(), 1e-14);  // no moment on the sphere
  }
}

TEST(DistanceJointTest, TheRowIsTheStretchOfTheRodAndItsWrenchAUnitPush) {
  RandomSource random(2);
  const JointConstants constants = make_constants();
  for (int i = 0; i < 20; ++i) {
    RelativeMotion m;
    m.R_F = random.rotation();
    m.d = random.between(0.2, 3) * random.direction();
    Jet row;
    kDistanceJoint.rows(constants, m, nullptr, &row);
    EXPECT_NEAR(row.value, m.d.norm() - constants.length_m, 1e-14);
    EXPECT_LT((row.W.tail<3>() - m.d.normalized()).norm(), 1e-14);
    EXPECT_LT(row.W.head<3>().norm(), 1e-14);
  }
}

// Closed form: the tangent of two base circles. External gears turn against each other in the ratio of their radii.
TEST(GearMeshJointTest, TheForceIsAUnitForceTangentToBothBaseCircles) {
  const JointConstants c = make_constants();
  for (int seed = 0; seed < 20; ++seed) {
    RandomSource random(seed);
    RelativeMotion m;
    m.R_F = random.rotation();
    m.R_M = m.R_F * Eigen::AngleAxisd(random.between(-3, 3), Eigen::Vector3d::UnitZ());
    const double heading = random.between(-3, 3);
    m.d = m.R_F * (random.between(0.8, 2) * Eigen::Vector3d(std::cos(heading), std::sin(heading), 0));
    const std::vector<double> winding = angle_values(kGearMeshJoint, c, m);
    Jet row;
    kGearMeshJoint.rows(c, m, winding.data(), &row);
    const Eigen::Vector3d force = row.W.tail<3>(), z = m.R_F.col(2);
    EXPECT_NEAR(force.norm(), 1, 1e-13);
    EXPECT_NEAR(force.dot(z), 0, 1e-13);
    EXPECT_NEAR(std::abs(row.W.head<3>().dot(z)), std::abs(c.base_radius_2_m), 1e-13);
    const Eigen::Vector3d about_first = row.W.head<3>() + m.d.cross(force);
    EXPECT_NEAR(std::abs(about_first.dot(z)), std::abs(c.base_radius_1_m), 1e-13);
  }
}

TEST(GearMeshJointTest, GearsRollInTheRatioOfTheirRadiiOverManyTurns) {
  const JointConstants c = make_constants();
  RelativeMotion m;
  m.d = Eigen::Vector3d(0.9, 0, 0);
  double winding[2] = {0, std::numbers::pi};
  Jet row;
  kGearMeshJoint.rows(c, m, winding, &row);
  const double drawn = row.value;
  for (double turn = 0; turn < 40; turn += 0.5) {  // seen from the first gear: it turns by `turn` in the world
    const double second = turn * c.base_radius_1_m / c.base_radius_2_m;
    m.R_F = Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    m.R_M = Eigen::AngleAxisd(second, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    const std::vector<double> angles = angle_values(kGearMeshJoint, c, m);
    for (int i = 0; i < 2; ++i) {
      Jet jet;
      jet.value = angles[i];
      winding[i] = continued(jet, winding[i]).value;
    }
    kGearMeshJoint.rows(c, m, winding, &row);
    EXPECT_NEAR(row.value, drawn, 1e-12) << turn;
  }
}

TEST(GearMeshJointTest, TheReactionPointIsThePitchPoint) {
  Joint joint;
  joint.type = JointType::kGearMesh;
  joint.constants = make_constants();
  RelativeMotion m;
  m.d = Eigen::Vector3d(1.5, 0, 0.2);  // centres 1.5 apart, second gear 0.2 higher
  const Eigen::Vector3d from_second = reaction_point_from_M(joint, m);
  // 0.3 : 0.45 divides 1.5 into 0.6 and 0.9.
  EXPECT_LT((from_second - Eigen::Vector3d(-0.9, 0, 0)).norm(), 1e-14);
  joint.type = JointType::kRevolute;
  EXPECT_EQ(reaction_point_from_M(joint, m).norm(), 0);
}

TEST(FlippedTest, ReversedAxesAreSeenWhereRowsCannotTell) {
  RelativeMotion straight, z_reversed, x_reversed;
  z_reversed.R_M = Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()).toRotationMatrix();
  x_reversed.R_M = Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  for (const JointTypeInfo* type : all_joint_types()) {
    EXPECT_FALSE(is_flipped(*type, straight)) << type->name;
    int moments = 0;
    for (const int component : type->row_components) moments += component >= 3;
    EXPECT_EQ(is_flipped(*type, z_reversed), moments >= 2) << type->name;
    EXPECT_EQ(is_flipped(*type, x_reversed), moments == 3) << type->name;
    if (type->type == JointType::kGearMesh || type->type == JointType::kDistance) continue;
    const double winding[2] = {0, 0};
    Jet rows[6];
    type->rows(make_constants(), z_reversed, winding, rows);
    for (int i = 0; i < type->row_count(); ++i) EXPECT_NEAR(rows[i].value, 0, 1e-15) << type->name;
  }
}

TEST(ContinuedTest, TheTurnNearestToTheReferenceIsMeant) {
  Jet jet;
  jet.value = 3;
  EXPECT_NEAR(continued(jet, 3 + 5 * kTwoPi + 3.1).value, 3 + 5 * kTwoPi, 1e-13);
  EXPECT_NEAR(continued(jet, -4).value, 3 - kTwoPi, 1e-13);
  EXPECT_EQ(continued(jet, 1).value, 3);
}

}  // namespace
}  // namespace ferrers
