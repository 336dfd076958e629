#include "matching/projection_matcher.h"

#include <climits>
#include <cmath>

namespace msf {
namespace {

struct Candidate {
  int feature = -1;
  int distance = INT_MAX;
};

Candidate FindBest(const FrameFeatures& features, const ProjectionQuery& query,
                   const ProjectionMatchOptions& options, std::span<const uint8_t> taken,
                   std::vector<int>& area) {
  area.clear();
  features.FindInArea(query.uv_px, query.radius_px, query.min_level, query.max_level, area);
  Candidate best, second;
  for (const int feature : area) {
    if (!taken.empty() && taken[feature]) continue;
    const float u_right_px = features.u_right_px[feature];
    if (query.u_right_px >= 0 && u_right_px >= 0 &&
        std::abs(query.u_right_px - u_right_px) > query.radius_px)
      continue;
    const int distance = DescriptorDistance(query.descriptor, features.descriptors[feature]);
    if (distance < best.distance) {
      second = best;
      best = {feature, distance};
    } else if (distance < second.distance) {
      second = {feature, distance};
    }
  }
  if (best.distance > options.max_distance) return {};
  const bool same_level =
      second.feature >= 0 && features.level[best.feature] == features.level[second.feature];
  if (same_level && best.distance > options.ratio * second.distance) return {};
  return best;
}

}  // namespace

std::vector<int> MatchByProjection(const FrameFeatures& features,
                                   std::span<const ProjectionQuery> queries,
                                   const ProjectionMatchOptions& options,
                                   std::span<const uint8_t> taken) {
  std::vector<int> matches(queries.size(), -1);
  struct Owner {
    int query = -1;
    int distance = INT_MAX;
  };
  std::vector<Owner> owners(features.size());
  std::vector<int> area;
  for (size_t q = 0; q < queries.size(); ++q) {
    const Candidate best = FindBest(features, queries[q], options, taken, area);
    if (best.feature < 0) continue;
    Owner& owner = owners[best.feature];
    if (best.distance >= owner.distance) continue;
    if (owner.query >= 0) matches[owner.query] = -1;
    owner = {static_cast<int>(q), best.distance};
    matches[q] = best.feature;
  }
  return matches;
}

}  // namespace msf
