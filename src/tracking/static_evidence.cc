#include "tracking/static_evidence.h"

#include <algorithm>

#include "matching/projection_matcher.h"

namespace msf {

std::vector<StaticEvidence> GatherStaticEvidence(const TrackingContext& context,
                                                 std::span<const PointSnapshot> local_points,
                                                 const FrameFeatures& features,
                                                 std::span<const PointMatch> matches,
                                                 const FrameFeatures& removed,
                                                 const Rigid3d& T_cw) {
  constexpr double kRadius_px = 4;
  std::vector<StaticEvidence> evidence;
  std::vector<MapPointId> matched;
  for (const PointMatch& match : matches) {
    matched.push_back(match.point);
    // The weight of a match is the lesser probability of its point and its feature.
    if (match.weight < 1) evidence.push_back({match.point, features.static_weight[match.feature]});
  }
  if (removed.size() == 0) return evidence;
  std::sort(matched.begin(), matched.end());
  std::vector<ProjectionQuery> queries;
  std::vector<MapPointId> searched;
  const ViewProjector project(T_cw, context.camera, context.levels);
  for (const PointSnapshot& point : local_points) {
    if (std::binary_search(matched.begin(), matched.end(), point.id)) continue;
    const std::optional<ProjectedPoint> projected = project(point);
    if (!projected) continue;
    queries.push_back({.uv_px = projected->uv_px,
                       .u_right_px = projected->u_right_px,
                       .radius_px = kRadius_px * context.levels.scale(projected->level),
                       .min_level = std::max(0, projected->level - 1),
                       .max_level = projected->level,
                       .descriptor = point.descriptor});
    searched.push_back(point.id);
  }
  const std::vector<int> found =
      MatchByProjection(removed, queries, {.ratio = context.options.local_match_ratio});
  for (size_t q = 0; q < found.size(); ++q) {
    if (found[q] >= 0) evidence.push_back({searched[q], removed.static_weight[found[q]]});
  }
  return evidence;
}

}  // namespace msf
