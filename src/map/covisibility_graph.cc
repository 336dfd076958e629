#include "map/covisibility_graph.h"

#include <algorithm>

namespace msf {

void CovisibilityGraph::Reorder(Node& node) {
  node.ordered.assign(node.weights.begin(), node.weights.end());
  std::stable_sort(node.ordered.begin(), node.ordered.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
}

void CovisibilityGraph::SetEdges(KeyFrameId id, const std::map<KeyFrameId, int>& weights) {
  for (const auto& [neighbour, weight] : nodes_[id].weights) {
    if (weights.contains(neighbour)) continue;
    nodes_[neighbour].weights.erase(id);
    Reorder(nodes_[neighbour]);
  }
  for (const auto& [neighbour, weight] : weights) {
    nodes_[neighbour].weights[id] = weight;
    Reorder(nodes_[neighbour]);
  }
  nodes_[id].weights = weights;
  Reorder(nodes_[id]);
}

void CovisibilityGraph::Remove(KeyFrameId id) {
  SetEdges(id, {});
  nodes_.erase(id);
}

const CovisibilityGraph::Neighbours& CovisibilityGraph::All(KeyFrameId id) const {
  static const Neighbours kNone;
  const auto found = nodes_.find(id);
  return found == nodes_.end() ? kNone : found->second.ordered;
}

std::vector<KeyFrameId> CovisibilityGraph::Best(KeyFrameId id, int count) const {
  std::vector<KeyFrameId> best;
  for (const auto& [neighbour, weight] : All(id)) {
    if (static_cast<int>(best.size()) == count) break;
    best.push_back(neighbour);
  }
  return best;
}

std::vector<KeyFrameId> CovisibilityGraph::WithWeight(KeyFrameId id, int min_weight) const {
  std::vector<KeyFrameId> strong;
  for (const auto& [neighbour, weight] : All(id)) {
    if (weight < min_weight) break;
    strong.push_back(neighbour);
  }
  return strong;
}

int CovisibilityGraph::Weight(KeyFrameId a, KeyFrameId b) const {
  const auto node = nodes_.find(a);
  if (node == nodes_.end()) return 0;
  const auto edge = node->second.weights.find(b);
  return edge == node->second.weights.end() ? 0 : edge->second;
}

}  // namespace msf
