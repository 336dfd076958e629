// A map's skeleton as a pose graph, and its solution as a correction.
#pragma once

#include <map>
#include <span>
#include <vector>

#include "loop_closing/map_correction.h"
#include "optimization/pose_graph.h"

namespace msf {

struct MapPoseGraph {
  PoseGraph graph;
  std::vector<KeyFrameId> keyframes;  // of graph.nodes
  std::map<KeyFrameId, int> node_of;
  std::vector<Rigid3d> T_cw_before;  // of the keyframes when copied
  MapId map_id;
  uint64_t epoch = 0;

  // Demands T_ab between two of the keyframes; nothing happens when one is not in the graph.
  void AddEdge(KeyFrameId a, KeyFrameId b, const Rigid3d& T_ab);
};

// The keyframes of one map, joined as they are now along the spanning tree, loop edges, and where
// they share at least `strong_covisibility` points. Roots of the tree are fixed.
MapPoseGraph CopyPoseGraph(const Map& map, std::span<const KeyFrameId> keyframes,
                           int strong_covisibility);

// What the solved graph says about how the map moves.
MapCorrection CorrectionOf(const MapPoseGraph& graph);

}  // namespace msf
