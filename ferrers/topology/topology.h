#pragma once

#include <string>
#include <vector>

#include "ferrers/core/ids.h"
#include "ferrers/model/model.h"
#include "ferrers/topology/spanning_forest.h"

/// The combinatorial side of a mechanism: forest, closures, loops, clusters and the Grübler count. No number of it
/// depends on geometry.
namespace ferrers {

/// A condition on the tree coordinates: a cut joint, or a coupling.
struct Closure {
  JointId joint;        ///< Valid for a cut joint.
  CouplingId coupling;  ///< Valid for a coupling.
  int row = 0;          ///< First of its rows.
  int row_count = 0;
  std::vector<int> nodes;  ///< Tree nodes whose coordinates it can touch, ascending: the loop it closes.
};

/// Closures that share tree coordinates, directly or through others: analysed together, independent of other clusters.
struct Cluster {
  std::vector<int> closures;
  std::vector<int> nodes;  ///< Union of their nodes, ascending.
};

struct Topology {
  SpanningForest forest;
  std::vector<Closure> closures;  ///< Cut joints in the order of the file, then couplings.
  std::vector<Cluster> clusters;
  int nq = 0, nv = 0;  ///< Tree coordinates.
  int closure_rows = 0;
  std::vector<int> q_of_node, v_of_node;  ///< First coordinate of each node.
  std::vector<int> node_of_joint;         ///< The node whose inboard joint it is, or −1 (cut).
  std::vector<int> closure_of_joint;      ///< Or −1 (tree).

  int moving_bodies = 0;
  int joint_rows = 0;           ///< Σ (6 − f) over all joints, and couplings.
  int general_coordinates = 0;  ///< Coordinates that carry no body.
  /// Velocities of the full system: six per moving body, and the generalized coordinates.
  int full_velocities() const { return 6 * moving_bodies + general_coordinates; }
  int grubler() const { return full_velocities() - joint_rows; }
};

struct TopologyOptions {
  std::vector<bool> cut;  ///< Joints to cut although they could carry a body (empty: none).
};

Topology make_topology(const Model& model, const TopologyOptions& options = {});

}  // namespace ferrers
