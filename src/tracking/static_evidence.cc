#include "tracking/static_evidence.h"

#include <algorithm>

namespace msf {

std::vector<StaticEvidence> GatherStaticEvidence(const FrameFeatures& features,
                                                 std::span<const PointMatch> matches,
                                                 const FrameFeatures& removed,
                                                 std::span<const Suspect> suspects) {
  std::vector<StaticEvidence> evidence;
  std::vector<MapPointId> matched;
  for (const PointMatch& match : matches) {
    matched.push_back(match.point);
    // The weight of a match is the lesser probability of its point and its feature.
    if (match.weight < 1) evidence.push_back({match.point, features.static_weight[match.feature]});
  }
  std::sort(matched.begin(), matched.end());
  for (const Suspect& suspect : suspects) {
    const MapPointId id = suspect.point->id;
    if (!std::binary_search(matched.begin(), matched.end(), id))
      evidence.push_back({id, removed.static_weight[suspect.removed_feature]});
  }
  return evidence;
}

}  // namespace msf
