#include "ferrers/topology/topology.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "ferrers/model/joints/joint_type.h"
#include "ferrers/testing/random_mechanism.h"
#include "ferrers/testing/random_source.h"
#include "ferrers/testing/zoo.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers {
namespace {

using witness::joint;
using witness::numbered;
using witness::RandomSource;

Model built(const ModelSpec& spec) {
  ModelBuildResult result = build_model(spec);
  for (const Diagnostic& d : result.diagnostics.items()) {
    if (d.severity == Severity::kError) ADD_FAILURE() << spec.name << ": " << d.code << " " << d.message;
  }
  return std::move(result.model).value();
}

int freedoms(const Model& model, JointId id) { return joint_type_info(model.joint(id).type).freedoms(); }

/// A graph of up to five bodies and seven joints of all types; not always connected.
ModelSpec random_graph(std::uint64_t seed) {
  RandomSource random(seed);
  ModelSpec spec;
  spec.name = "graph";
  const int bodies = 1 + random.below(5), joints = 1 + random.below(7);
  const auto name = [](int i) { return i == 0 ? std::string("ground") : numbered("b", i); };
  for (int i = 1; i <= bodies; ++i) spec.bodies.push_back(witness::box_body(name(i), {1.0 * i, 0, 0}, {1, 1, 1}, 1));
  const JointType types[] = {JointType::kWeld,         JointType::kRevolute,  JointType::kCylindrical,
                             JointType::kSpherical,    JointType::kPrismatic, JointType::kPointOnLine,
                             JointType::kPointOnPlane, JointType::kPlanar,    JointType::kFree};
  for (int j = 0; j < joints; ++j) {
    const int a = random.below(bodies + 1);
    const int b = (a + 1 + random.below(bodies)) % (bodies + 1);
    spec.joints.push_back(joint(types[random.below(9)], numbered("J", j), name(a), name(b), random.vector(1)));
  }
  for (int i = 1; i <= bodies; ++i) {  // bodies without a joint are errors: one on a plane floats
    bool found = false;
    for (const JointSpec& j : spec.joints) found = found || j.bodies[0].name == name(i) || j.bodies[1].name == name(i);
    if (!found) spec.joints.push_back(joint(JointType::kPointOnPlane, numbered("P", i), "ground", name(i), {0, 0, 0}));
  }
  return spec;
}

/// Least Σ freedoms over all choices of joints that span with the fewest floating bodies (6 each): by trying all.
int least_freedoms(const Model& model) {
  const int joints = static_cast<int>(model.joints().size()), bodies = static_cast<int>(model.bodies().size());
  int best = 1000;
  for (int choice = 0; choice < 1 << joints; ++choice) {
    std::vector<int> root(bodies);
    std::iota(root.begin(), root.end(), 0);
    const auto find = [&](int i) {
      while (root[i] != i) i = root[i];
      return i;
    };
    int sum = 0, parts = bodies;
    bool is_forest = true;
    for (int j = 0; j < joints && is_forest; ++j) {
      if (!(choice >> j & 1)) continue;
      const int a = find(model.joints()[j].first.index()), b = find(model.joints()[j].second.index());
      is_forest = a != b && joint_type_info(model.joints()[j].type).can_be_tree;
      root[a] = b;
      --parts;
      sum += freedoms(model, JointId(j));
    }
    if (is_forest) best = std::min(best, sum + 6 * (parts - 1));
  }
  return best;
}

int tree_freedoms(const Model& model, const SpanningForest& forest) {
  int sum = 0;
  for (std::size_t i = 1; i < forest.nodes.size(); ++i) {
    sum += forest.nodes[i].joint.valid() ? freedoms(model, forest.nodes[i].joint) : 6;
  }
  return sum;
}

void expect_forest(const Model& model, const SpanningForest& forest) {
  ASSERT_EQ(forest.nodes.size(), model.bodies().size());
  EXPECT_EQ(forest.nodes[0].body, kGround);
  EXPECT_EQ(forest.nodes[0].parent, -1);
  std::set<int> bodies, joints;
  for (std::size_t i = 0; i < forest.nodes.size(); ++i) {
    const TreeNode& node = forest.nodes[i];
    bodies.insert(node.body.index());
    EXPECT_EQ(forest.node_of_body[node.body.index()], static_cast<int>(i));
    if (i == 0) continue;
    ASSERT_GE(node.parent, 0);
    ASSERT_LT(node.parent, static_cast<int>(i));  // parent first
    EXPECT_EQ(node.depth, forest.nodes[node.parent].depth + 1);
    if (!node.joint.valid()) {
      EXPECT_EQ(node.parent, 0);  // floats
      continue;
    }
    EXPECT_TRUE(joints.insert(node.joint.index()).second);
    const Joint& j = model.joint(node.joint);
    EXPECT_TRUE(joint_type_info(j.type).can_be_tree);
    EXPECT_EQ(node.forward ? j.second : j.first, node.body);
    EXPECT_EQ(node.forward ? j.first : j.second, forest.nodes[node.parent].body);
  }
  EXPECT_EQ(bodies.size(), model.bodies().size());
  for (const JointId id : forest.cut_joints) EXPECT_TRUE(joints.insert(id.index()).second);
  EXPECT_EQ(joints.size(), model.joints().size());  // every joint is in the tree or cut
  EXPECT_TRUE(std::is_sorted(forest.cut_joints.begin(), forest.cut_joints.end()));
}

TEST(SpanningForestTest, EveryBodyIsReachedOnceAfterItsParent) {
  for (int seed = 0; seed < 300; ++seed) {
    const Model model = built(random_graph(seed));
    expect_forest(model, make_spanning_forest(model, {}));
  }
  for (const witness::ZooEntry& entry : witness::zoo()) {
    const Model model = built(entry.spec);
    expect_forest(model, make_spanning_forest(model, {}));
  }
}

TEST(SpanningForestTest, NoOtherTreeHasFewerFreedoms) {
  for (int seed = 0; seed < 300; ++seed) {
    const Model model = built(random_graph(seed));
    EXPECT_EQ(tree_freedoms(model, make_spanning_forest(model, {})), least_freedoms(model)) << "seed " << seed;
  }
}

TEST(SpanningForestTest, PreferencesCostNothing) {
  for (int seed = 0; seed < 100; ++seed) {
    const Model model = built(random_graph(seed));
    const int least = tree_freedoms(model, make_spanning_forest(model, {}));
    for (std::size_t j = 0; j < model.joints().size(); ++j) {
      std::vector<bool> preferred(model.joints().size(), false);
      preferred[j] = true;
      EXPECT_EQ(tree_freedoms(model, make_spanning_forest(model, preferred)), least);
    }
  }
}

TEST(SpanningForestTest, APreferredJointStaysInTheTreeWhereItCostsNothing) {
  const Model model = built(witness::make_four_bar(witness::FourBarJoints::kRevolute));
  for (std::size_t j = 0; j < 4; ++j) {
    std::vector<bool> preferred(4, false);
    preferred[j] = true;
    const SpanningForest forest = make_spanning_forest(model, preferred);
    EXPECT_EQ(std::count(forest.cut_joints.begin(), forest.cut_joints.end(), JointId(j)), 0) << j;
  }
}

TEST(SpanningForestTest, ForbiddenJointsAreCutAndTheirBodyFloats) {
  const Model model = built(witness::make_pendulum());
  const SpanningForest forest = make_spanning_forest(model, {}, {true});
  expect_forest(model, forest);
  EXPECT_FALSE(forest.nodes[1].joint.valid());
  EXPECT_EQ(forest.cut_joints.size(), 1u);
  EXPECT_THROW(make_spanning_forest(model, {true, false}), std::invalid_argument);
  EXPECT_THROW(make_spanning_forest(model, {}, {true, false}), std::invalid_argument);
}

TEST(TopologyTest, CoordinatesAndRowsAreNumberedWithoutGaps) {
  for (int seed = 0; seed < 60; ++seed) {
    const Model model = built(witness::make_random_mechanism(seed).spec);
    const Topology t = make_topology(model);
    int q = 0, v = 0, rows = 0;
    for (std::size_t i = 1; i < t.forest.nodes.size(); ++i) {
      const JointId id = t.forest.nodes[i].joint;
      const JointTypeInfo& type = id.valid() ? joint_type_info(model.joint(id).type) : kFreeJoint;
      EXPECT_EQ(t.q_of_node[i], q);
      EXPECT_EQ(t.v_of_node[i], v);
      q += type.nq;
      v += type.nv;
    }
    EXPECT_EQ(t.nq, q);
    EXPECT_EQ(t.nv, v);
    for (const Closure& closure : t.closures) {
      EXPECT_EQ(closure.row, rows);
      rows += closure.row_count;
      EXPECT_NE(closure.joint.valid(), closure.coupling.valid());
      EXPECT_TRUE(std::is_sorted(closure.nodes.begin(), closure.nodes.end()));
    }
    EXPECT_EQ(t.closure_rows, rows);
    // n − m counts the same whatever the tree.
    EXPECT_EQ(t.nv - t.closure_rows, t.grubler());
    for (std::size_t j = 0; j < model.joints().size(); ++j) {
      EXPECT_NE(t.node_of_joint[j] >= 0, t.closure_of_joint[j] >= 0);
    }
  }
}

TEST(TopologyTest, ClustersPartClosuresThatShareNoCoordinate) {
  for (int seed = 0; seed < 60; ++seed) {
    const Topology t = make_topology(built(witness::make_random_mechanism(seed).spec));
    std::set<int> closures, nodes;
    for (const Cluster& cluster : t.clusters) {
      std::set<int> reached;
      for (const int c : cluster.closures) {
        EXPECT_TRUE(closures.insert(c).second);
        reached.insert(t.closures[c].nodes.begin(), t.closures[c].nodes.end());
      }
      EXPECT_EQ(std::vector<int>(reached.begin(), reached.end()), cluster.nodes);
      for (const int n : cluster.nodes) EXPECT_TRUE(nodes.insert(n).second) << "clusters share a node";
      // Connected: growing from the first closure over shared nodes reaches all.
      std::set<int> grown(t.closures[cluster.closures[0]].nodes.begin(), t.closures[cluster.closures[0]].nodes.end());
      for (std::size_t again = 0; again < cluster.closures.size(); ++again) {
        for (const int c : cluster.closures) {
          const std::vector<int>& of = t.closures[c].nodes;
          if (std::any_of(of.begin(), of.end(), [&](int n) { return grown.count(n) > 0; })) {
            grown.insert(of.begin(), of.end());
          }
        }
      }
      EXPECT_EQ(grown, reached);
    }
    EXPECT_EQ(closures.size(), t.closures.size());
  }
}

TEST(TopologyTest, ALoopIsTheTreePathBetweenTheCutJointsBodies) {
  const Model model = built(witness::make_four_bar(witness::FourBarJoints::kRevolute));
  const Topology t = make_topology(model);
  ASSERT_EQ(t.closures.size(), 1u);
  EXPECT_EQ(t.closures[0].nodes, (std::vector<int>{1, 2, 3}));
  EXPECT_EQ(t.closures[0].row_count, 5);
  EXPECT_EQ(t.grubler(), -2);
  const Topology doors = make_topology(built(witness::make_door(3)));
  EXPECT_EQ(doors.closures.size(), 2u);
  EXPECT_EQ(doors.clusters.size(), 1u);
  EXPECT_EQ(doors.nv, 1);
}

TEST(TopologyTest, TwoMechanismsAreTwoClusters) {
  ModelSpec spec = witness::make_door(2);
  spec.bodies.push_back(witness::box_body("other", {5, 0, 0}, {1, 1, 1}, 1));
  for (const char* name : {"H1", "H2"}) {
    spec.joints.push_back(joint(JointType::kRevolute, name, "ground", "other", {5, 0, 0}));
  }
  const Topology t = make_topology(built(spec));
  EXPECT_EQ(t.clusters.size(), 2u);
}

TEST(TopologyTest, ACouplingJoinsTheNodesOfItsCoordinates) {
  ModelSpec spec;
  spec.name = "coupled";
  spec.bodies = {witness::box_body("a", {0, 0, 0}, {1, 1, 1}, 1), witness::box_body("b", {2, 0, 0}, {1, 1, 1}, 1)};
  spec.joints = {joint(JointType::kRevolute, "A", "ground", "a", {0, 0, 0}),
                 joint(JointType::kRevolute, "B", "ground", "b", {2, 0, 0})};
  CouplingSpec coupling;
  coupling.name = "belt";
  coupling.coordinates = {{NameRef("A"), ""}, {NameRef("B"), ""}};
  coupling.coefficients = {Number(1), Number(-2)};
  spec.couplings = {coupling};
  const Topology t = make_topology(built(spec));
  ASSERT_EQ(t.closures.size(), 1u);
  EXPECT_TRUE(t.closures[0].coupling.valid());
  EXPECT_EQ(t.closures[0].nodes, (std::vector<int>{1, 2}));
  EXPECT_EQ(t.grubler(), 1);
}

}  // namespace
}  // namespace ferrers
