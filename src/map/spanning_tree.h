// The skeleton of the map: every keyframe hangs on the one it shares most with when it joins; loops
// add extra edges.
#pragma once

#include <functional>
#include <map>
#include <set>

#include "util/strong_id.h"

namespace msf {

class SpanningTree {
 public:
  // Adds a keyframe below `parent` (invalid: a root).
  void Add(KeyFrameId id, KeyFrameId parent);
  void SetParent(KeyFrameId id, KeyFrameId parent);
  // Makes `id` the root of its tree by turning the edges on the way up around.
  void MakeRoot(KeyFrameId id);
  // Removes a keyframe; its children go to the neighbour with the highest `affinity` that keeps the
  // tree a tree.
  void Remove(KeyFrameId id, const std::function<int(KeyFrameId, KeyFrameId)>& affinity);

  bool Contains(KeyFrameId id) const { return nodes_.contains(id); }
  KeyFrameId Parent(KeyFrameId id) const { return nodes_.at(id).parent; }
  const std::set<KeyFrameId>& Children(KeyFrameId id) const { return nodes_.at(id).children; }

  void AddLoopEdge(KeyFrameId a, KeyFrameId b);
  const std::set<KeyFrameId>& LoopEdges(KeyFrameId id) const { return nodes_.at(id).loop_edges; }

 private:
  struct Node {
    KeyFrameId parent;
    std::set<KeyFrameId> children;
    std::set<KeyFrameId> loop_edges;
  };
  std::map<KeyFrameId, Node> nodes_;
};

}  // namespace msf
