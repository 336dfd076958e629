// Which keyframes see the same points, and how many of them.
#pragma once

#include <map>
#include <utility>
#include <vector>

#include "util/strong_id.h"

namespace msf {

class CovisibilityGraph {
 public:
  // (keyframe, shared points), most shared first, ties by id.
  using Neighbours = std::vector<std::pair<KeyFrameId, int>>;

  // Replaces the edges of `id` by those of `weights`, on both sides.
  void SetEdges(KeyFrameId id, const std::map<KeyFrameId, int>& weights);
  void Remove(KeyFrameId id);

  const Neighbours& All(KeyFrameId id) const;
  std::vector<KeyFrameId> Best(KeyFrameId id, int count) const;
  std::vector<KeyFrameId> WithWeight(KeyFrameId id, int min_weight) const;
  int Weight(KeyFrameId a, KeyFrameId b) const;

 private:
  struct Node {
    std::map<KeyFrameId, int> weights;
    Neighbours ordered;
  };
  static void Reorder(Node& node);
  std::map<KeyFrameId, Node> nodes_;
};

}  // namespace msf
