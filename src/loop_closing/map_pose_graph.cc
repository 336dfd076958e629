#include "loop_closing/map_pose_graph.h"

#include <set>

namespace msf {

void MapPoseGraph::AddEdge(KeyFrameId a, KeyFrameId b, const Rigid3d& T_ab) {
  const auto node_a = node_of.find(a), node_b = node_of.find(b);
  if (a == b || node_a == node_of.end() || node_b == node_of.end()) return;
  graph.edges.push_back({.a = node_a->second, .b = node_b->second, .T_ab = T_ab});
}

MapPoseGraph CopyPoseGraph(const Map& map, std::span<const KeyFrameId> keyframes,
                           int strong_covisibility) {
  MapPoseGraph copy;
  copy.epoch = map.epoch();
  for (const KeyFrameId id : keyframes) {
    const KeyFrame& keyframe = *map.FindKeyFrame(id);
    copy.node_of[id] = static_cast<int>(copy.keyframes.size());
    copy.map_id = keyframe.map_id;
    copy.keyframes.push_back(id);
    copy.T_cw_before.push_back(keyframe.T_cw);
    copy.graph.nodes.push_back({keyframe.T_cw, !map.tree().Parent(id).valid()});
  }
  for (const KeyFrameId id : copy.keyframes) {
    // Each pair once, however many ways it is joined.
    std::set<KeyFrameId> joined = map.tree().Children(id);
    for (const KeyFrameId other : map.tree().LoopEdges(id)) {
      if (id < other) joined.insert(other);
    }
    for (const KeyFrameId other : map.covisibility().WithWeight(id, strong_covisibility)) {
      if (id < other && map.tree().Parent(id) != other) joined.insert(other);
    }
    for (const KeyFrameId other : joined) {
      if (!copy.node_of.contains(other)) continue;
      const Rigid3d T_ab = map.FindKeyFrame(id)->T_cw * map.FindKeyFrame(other)->T_cw.Inverse();
      copy.AddEdge(id, other, T_ab);
    }
  }
  return copy;
}

MapCorrection CorrectionOf(const MapPoseGraph& copy) {
  MapCorrection correction;
  correction.map_id = copy.map_id;
  correction.epoch = copy.epoch;
  for (size_t k = 0; k < copy.keyframes.size(); ++k) {
    correction.motion[copy.keyframes[k]] =
        MotionBetween(copy.T_cw_before[k], copy.graph.nodes[k].T_cw);
  }
  return correction;
}

}  // namespace msf
