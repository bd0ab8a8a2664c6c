#pragma once

#include <vector>

#include "ferrers/core/ids.h"
#include "ferrers/model/model.h"

/// Problem: a mechanism is a graph (bodies, joints) with loops. Choose a tree that carries every body from ground by
/// joints with named coordinates, so that a few relative coordinates describe the motion and every other joint closes a
/// loop by its rows.
///
/// Given: the model's graph. Wanted: for every body its inboard joint (or none: it floats), and the cut joints.
/// Properties: every body appears once, after its parent; ground is the root; joints without named coordinates are
/// always cut; the sum of the tree joints' freedoms is the least possible (so the cut joints are the ones with the
/// fewest rows), ties are broken by depth, then by the order of the file. A body that no tree joint reaches floats on
/// an implicit `free` joint to ground. The same motion and the same verdicts come out of every choice (tested). Cost:
/// O(joints · log joints).
namespace ferrers {

/// A body of the tree. Node 0 is ground; node index and body index differ.
struct TreeNode {
  BodyId body;          ///< Invalid for the node of a generalized coordinate.
  int parent = -1;      ///< Node index, smaller than this node's; −1 for ground.
  JointId joint = {};   ///< Inboard joint; invalid for ground and for a floating body.
  bool forward = true;  ///< True: the parent is the joint's first body.
  int depth = 0;
};

struct SpanningForest {
  /// Bodies; after them one node per generalized coordinate, a leaf on ground that carries nothing.
  std::vector<TreeNode> nodes;
  std::vector<int> node_of_body;    ///< Indexed by body.
  std::vector<JointId> cut_joints;  ///< In the order of the file.
};

/// `preferred[joint]`: keep this joint in the tree where it costs nothing (its coordinate is coupled, driven or
/// sprung). `forbidden`: joints to cut although they could be tree joints (to test independence of the choice).
SpanningForest make_spanning_forest(const Model& model, const std::vector<bool>& preferred,
                                    const std::vector<bool>& forbidden = {});

}  // namespace ferrers
