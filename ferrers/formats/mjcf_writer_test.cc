#include "ferrers/formats/mjcf_writer.h"

#include <fstream>
#include <map>
#include <sstream>

#include "ferrers/dynamics/equations.h"
#include "ferrers/formats/mjcf_test_model.h"
#include "ferrers/formats/writers.h"
#include "ferrers/io/model_reader.h"
#include "ferrers/kinematics/assembly.h"
#include "ferrers/redundancy/analysis.h"

namespace ferrers {
namespace {

using mjcf_testing::build;
using mjcf_testing::loader_of;
using mjcf_testing::messages;
using testing::HasSubstr;

std::string file_text(const std::string& name) {
  std::ifstream in(std::string(FERRERS_SOURCE_DIR) + "/" + name, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

struct Verdict {
  int rows, rank, mobility, coordinates;
  bool operator==(const Verdict&) const = default;
};

std::ostream& operator<<(std::ostream& out, const Verdict& v) {
  return out << v.rows << " rows, rank " << v.rank << ", mobility " << v.mobility << ", " << v.coordinates;
}

Verdict verdict_of(const Model& model) {
  const auto system = make_system(model);
  const RedundancyReport report = analyze_redundancy(*system, make_drawn_state(*system));
  return {report.closure_rows, report.closure_rank, report.mobility, report.closure_coordinates};
}

/// M as drawn, in the order of the coordinates' names.
MatrixXd mass_matrix(const Model& model) {
  const auto system = make_system(model);
  const auto dynamics = make_dynamics_model(system);
  Equations eq = make_equations(*dynamics);
  compute_equations(*dynamics, make_drawn_state(*system), eq);
  std::vector<int> order(static_cast<std::size_t>(system->nv));
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
  const MatrixXd M = eq.M.dense_rows(order);
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    return system->coordinate_names[static_cast<std::size_t>(a)] <
           system->coordinate_names[static_cast<std::size_t>(b)];
  });
  MatrixXd sorted(system->nv, system->nv);
  for (int i = 0; i < system->nv; ++i) {
    for (int j = 0; j < system->nv; ++j)
      sorted(i, j) = M(order[static_cast<std::size_t>(i)], order[static_cast<std::size_t>(j)]);
  }
  return sorted;
}

TEST(MjcfWriterTest, WhatWasReadIsReadAgainTheSame) {
  const std::string folder = "tests/models/formats/mjcf/";
  for (const char* name : {"four-bar.xml", "every-joint.xml", "tendons.xml"}) {
    SCOPED_TRACE(name);
    const ModelFile file =
        read_any_model_text(file_text(folder + name), name, ModelFormat::kMjcf,
                            [&](const std::string& path) { return std::optional(file_text(folder + path)); });
    ASSERT_TRUE(file.read.model) << messages(file.read.diagnostics);
    Diagnostics told;
    const std::string text = write_mjcf(file.read.spec, told);
    const Model again = build(text);
    EXPECT_EQ(verdict_of(again), verdict_of(*file.read.model)) << text;
    const MatrixXd M = mass_matrix(*file.read.model), M_again = mass_matrix(again);
    ASSERT_EQ(M.rows(), M_again.rows());
    EXPECT_LT((M - M_again).cwiseAbs().maxCoeff(), 1e-12 * M.cwiseAbs().maxCoeff());
  }
}

TEST(MjcfWriterTest, JointsThatMujocoDoesNotHaveAreSeveralOfIts) {
  const ModelReadResult read = read_model_text(R"(ferrers: 1
bodies:
  a: {mass: 1 kg, com: [0.1, 0, 0], inertia: {moments: [1, 1, 1]}}
  b: {mass: 1 kg, com: [0.4, 0.2, 0], inertia: {moments: [1, 1, 1]}}
  c: {mass: 1 kg, com: [0.5, 0.2, 0.1], inertia: {moments: [1, 1, 1]}}
  d: {mass: 1 kg, com: [0.5, 0.3, 0.1], inertia: {moments: [1, 1, 1]}}
joints:
  u: {type: universal, bodies: [ground, a], at: [0, 0, 0], axes: [x, y]}
  p: {type: planar, bodies: [b, a], at: [0.2, 0, 0], normal: [1, 1, 0]}
  k: {type: cylindrical, bodies: [b, c], at: [0.4, 0.1, 0], axis: z}
  s: {type: screw, bodies: [c, d], at: [0.4, 0.2, 0], axis: y, lead: 10 mm}
)",
                                               "joints.yaml");
  ASSERT_TRUE(read.model) << messages(read.diagnostics);
  Diagnostics told;
  const std::string text = write_mjcf(read.spec, told);
  const Model again = build(text);
  EXPECT_EQ(verdict_of(again).mobility, verdict_of(*read.model).mobility);
  EXPECT_THAT(text, HasSubstr("polycoef=\"0 0.00159154943091"));
  EXPECT_TRUE(told.empty()) << messages(told);
}

TEST(MjcfWriterTest, NamesThatAreMadeUpAreNoneOfTheModel) {
  const ModelReadResult read = read_model_text(R"(ferrers: 1
bodies:
  world: {mass: 1 kg, com: [0.1, 0, 0], inertia: {moments: [1, 1, 1]}}
  world_: {mass: 1 kg, com: [0.4, 0.2, 0], inertia: {moments: [1, 1, 1]}}
joints:
  k: {type: cylindrical, bodies: [ground, world], at: [0, 0, 0], axis: z}
  k_angle: {type: revolute, bodies: [world, world_], at: [0.4, 0, 0], axis: x}
forces:
  d: {type: joint_damping, joint: k.angle, damping: 3}
  e: {type: joint_damping, joint: k_angle, damping: 5}
)",
                                               "names.yaml");
  ASSERT_TRUE(read.model) << messages(read.diagnostics);
  Diagnostics told;
  const std::string text = write_mjcf(read.spec, told);
  const Model again = build(text);
  EXPECT_EQ(again.bodies().size(), 4U) << text;  // one between the cylinder's two joints
  EXPECT_THAT(text, HasSubstr("name=\"world__2\""));
  const auto damping = [&](const std::string& joint) {
    for (const ForceElement& force : again.forces()) {
      const auto* one = std::get_if<JointDamping>(&force.element);
      if (one != nullptr && again.joint(one->coordinate.joint).name == joint) return one->damping;
    }
    return 0.0;
  };
  EXPECT_EQ(damping("k_angle_2"), 3) << text;
  EXPECT_EQ(damping("k_angle"), 5) << text;
}

/// Poses of the bodies of both as they start, by name.
void expect_same_start(const Model& one, const Model& other) {
  const auto poses = [](const Model& model) {
    const auto system = make_system(model);
    const AssemblyResult start = assemble(*system);
    EXPECT_EQ(start.status, AssemblyStatus::kAssembled) << start.message;
    PositionKinematics pos = make_position_kinematics(*system);
    compute_positions(*system, start.state.q, pos);
    std::map<std::string, Pose> all;
    for (std::size_t i = 1; i < model.bodies().size(); ++i) {
      all[model.bodies()[i].name] = body_pose(*system, pos, BodyId(i));
    }
    return all;
  };
  const auto a = poses(one), b = poses(other);
  for (const auto& [name, pose] : a) {
    if (b.count(name) == 0) continue;
    EXPECT_LT((pose.p - b.at(name).p).norm(), 1e-9) << name;
    EXPECT_LT((pose.R - b.at(name).R).norm(), 1e-9) << name;
  }
}

TEST(MjcfWriterTest, AStartThatIsNotAsDrawnIsAKey) {
  const ModelReadResult read = read_model_text(R"(ferrers: 1
bodies:
  a: {mass: 1 kg, com: [0.5, 0, 0], inertia: {moments: [1, 1, 1]}}
  b: {mass: 1 kg, com: [1, 0.5, 0], inertia: {moments: [1, 1, 1]}}
  c: {mass: 1 kg, com: [1.5, 1, 0], inertia: {moments: [1, 1, 1]}}
  ball: {mass: 1 kg, com: [0, 1, 0], inertia: {moments: [1, 1, 1]}, pose: {position: [1, 1, 0], rotation: {axis: y, angle: 0.5}}}
  bird: {mass: 1 kg, com: [1, 2, 3], inertia: {moments: [1, 1, 1]}}
  nut: {mass: 1 kg, com: [0, 2, 3], inertia: {moments: [1, 1, 1]}}
joints:
  O: {type: revolute, bodies: [ground, a], at: [0, 0, 0], axis: z}
  A: {type: revolute, bodies: [b, a], at: [1, 0, 0], axis: z}
  B: {type: revolute, bodies: [b, c], at: [1, 1, 0], axis: z}
  C: {type: revolute, bodies: [ground, c], at: [2, 1, 0], axis: z}
  s: {type: spherical, bodies: [ground, ball], at: [1, 2, 0]}
  f: {type: free, bodies: [ground, bird]}
  screw: {type: screw, bodies: [ground, nut], at: [0, 2, 3], axis: [1, 1, 0], lead: 10 mm}
initial:
  O: {position: 0.3}
  s: {position: [0.8, 0.6, 0, 0]}
  f: {position: [0.1, 0.2, 0.3, 0.6, 0, 0.8, 0]}
  screw: {position: 2}
)",
                                               "start.yaml");
  ASSERT_TRUE(read.model) << messages(read.diagnostics);
  Diagnostics told;
  const std::string text = write_mjcf(read.spec, told);
  EXPECT_THAT(text, HasSubstr("<key name=\"start\""));
  expect_same_start(*read.model, build(text));
  const ModelReadResult drawn = read_model_text(file_text("examples/four-bar/model.yaml"), "model.yaml");
  EXPECT_THAT(write_mjcf(drawn.spec, told), testing::Not(HasSubstr("<key")));
}

TEST(MjcfWriterTest, AnInertiaThatMujocoRefusesIsToldAsAWarning) {
  const ModelReadResult read = read_model_text(R"(ferrers: 1
bodies:
  a: {mass: 1 kg, com: [0.1, 0, 0], inertia: {moments: [1, 1, 3], unphysical: true}}
joints:
  r: {type: revolute, bodies: [ground, a], at: [0, 0, 0], axis: z}
)",
                                               "plate.yaml");
  ASSERT_TRUE(read.model) << messages(read.diagnostics);
  Diagnostics told;
  write_mjcf(read.spec, told);
  ASSERT_EQ(told.items().size(), 1U);
  EXPECT_EQ(told.items()[0].severity, Severity::kWarning);
  EXPECT_THAT(told.items()[0].message, HasSubstr("the inertia of 'a'"));
}

TEST(MjcfWriterTest, ARevoluteClosureIsTwoPoints) {
  const ModelReadResult read = read_model_text(file_text("examples/four-bar/model.yaml"), "model.yaml");
  ASSERT_TRUE(read.model) << messages(read.diagnostics);
  Diagnostics told;
  const Model again = build(write_mjcf(read.spec, told));
  EXPECT_EQ(verdict_of(again).mobility, 1);
  EXPECT_EQ(verdict_of(again).rows, 6);
}

TEST(MjcfWriterTest, WhatMjcfCannotSayIsTold) {
  const ModelReadResult read = read_model_text(R"(ferrers: 1
bodies:
  a: {mass: 1 kg, com: [0, 0, 0]}
joints:
  r: {type: revolute, bodies: [ground, a], at: [0, 0, 0], axis: z}
  line: {type: point_on_line, bodies: [ground, a], at: [1, 0, 0], axis: x}
forces:
  wind: {type: force, body: a, at: [0, 0, 0], force: [1, 0, 0]}
initial: {r: {position: 0.1}}
)",
                                               "told.yaml");
  ASSERT_TRUE(read.model) << messages(read.diagnostics);
  Diagnostics told;
  write_mjcf(read.spec, told);
  const std::string all = messages(told);
  for (const char* word : {"F607", "'line', a point_on_line joint", "the force 'wind'"}) {
    EXPECT_THAT(all, HasSubstr(word));
  }
  EXPECT_FALSE(told.has_errors());
}

}  // namespace
}  // namespace ferrers
