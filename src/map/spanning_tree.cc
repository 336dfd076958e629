#include "map/spanning_tree.h"

#include <vector>

#include "util/check.h"

namespace msf {

void SpanningTree::Add(KeyFrameId id, KeyFrameId parent) {
  MSF_CHECK(!nodes_.contains(id), "a keyframe joins the tree once");
  nodes_[id] = {};
  SetParent(id, parent);
}

void SpanningTree::SetParent(KeyFrameId id, KeyFrameId parent) {
  Node& node = nodes_.at(id);
  if (node.parent.valid()) nodes_.at(node.parent).children.erase(id);
  node.parent = parent;
  if (parent.valid()) nodes_.at(parent).children.insert(id);
}

void SpanningTree::MakeRoot(KeyFrameId id) {
  KeyFrameId new_parent;
  while (id.valid()) {
    const KeyFrameId old_parent = Parent(id);
    SetParent(id, new_parent);
    new_parent = id;
    id = old_parent;
  }
}

void SpanningTree::Remove(KeyFrameId id,
                          const std::function<int(KeyFrameId, KeyFrameId)>& affinity) {
  const Node removed = nodes_.at(id);
  // Children join one at a time: each that has joined may carry the next, so that nobody becomes
  // its own ancestor.
  std::set<KeyFrameId> orphans = removed.children;
  std::vector<KeyFrameId> joined;
  if (removed.parent.valid()) joined.push_back(removed.parent);
  while (!orphans.empty()) {
    if (joined.empty()) {  // a root goes: its first child takes its place
      SetParent(*orphans.begin(), KeyFrameId());
      joined.push_back(*orphans.begin());
      orphans.erase(orphans.begin());
      continue;
    }
    int best_affinity = -1;
    KeyFrameId best_child, best_parent;
    for (const KeyFrameId child : orphans) {
      for (const KeyFrameId parent : joined) {
        const int value = affinity(child, parent);
        if (value <= best_affinity) continue;
        best_affinity = value;
        best_child = child;
        best_parent = parent;
      }
    }
    SetParent(best_child, best_parent);
    joined.push_back(best_child);
    orphans.erase(best_child);
  }
  SetParent(id, KeyFrameId());
  for (const KeyFrameId other : removed.loop_edges) nodes_.at(other).loop_edges.erase(id);
  nodes_.erase(id);
}

void SpanningTree::AddLoopEdge(KeyFrameId a, KeyFrameId b) {
  nodes_.at(a).loop_edges.insert(b);
  nodes_.at(b).loop_edges.insert(a);
}

}  // namespace msf
