#include "loop_closing/duplicate_fusion.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "matching/point_projection.h"
#include "matching/projection_matcher.h"

namespace msf {
namespace {

bool Fuse(MapPointId established, KeyFrameId keyframe, int feature, Map& map) {
  const MapPointId present = map.FindKeyFrame(keyframe)->points[feature];
  if (present == established) return false;
  if (!present.valid()) return map.AddObservation(established, keyframe, feature);
  map.ReplacePoint(present, established);
  return true;
}

}  // namespace

int FuseMatches(std::span<const std::pair<int, MapPointId>> matches, KeyFrameId keyframe,
                Map& map) {
  int fused = 0;
  for (const auto& [feature, id] : matches) {
    const MapPointId point = map.Resolve(id);
    if (point.valid()) fused += Fuse(point, keyframe, feature, map);
  }
  return fused;
}

int FuseIntoKeyFrame(std::span<const MapPointId> points, KeyFrameId keyframe_id, double radius_px,
                     Map& map) {
  const KeyFrame& keyframe = *map.FindKeyFrame(keyframe_id);
  const ViewProjector project(keyframe.T_cw, map.camera(), map.levels());
  std::vector<MapPointId> searched;
  std::vector<ProjectionQuery> queries;
  for (const MapPointId id : points) {
    const MapPoint* point = map.FindPoint(id);
    if (!point || point->FeatureIn(keyframe_id) >= 0) continue;
    const std::optional<ProjectedPoint> projected = project(PointSnapshot(*point));
    if (!projected) continue;
    searched.push_back(id);
    queries.push_back({.uv_px = projected->uv_px,
                       .u_right_px = projected->u_right_px,
                       .radius_px = radius_px * map.levels().scale(projected->level),
                       .min_level = std::max(0, projected->level - 1),
                       .max_level = projected->level,
                       .descriptor = point->descriptor});
  }
  const std::vector<int> found =
      MatchByProjection(*keyframe.features, queries, {.max_distance = kStrictDescriptorDistance});
  int fused = 0;
  for (size_t q = 0; q < found.size(); ++q) {
    const MapPointId id = map.Resolve(searched[q]);
    if (found[q] >= 0 && id.valid()) fused += Fuse(id, keyframe_id, found[q], map);
  }
  return fused;
}

}  // namespace msf
