#include "mapping/point_fusion.h"

#include <algorithm>

#include "matching/point_projection.h"
#include "matching/projection_matcher.h"
#include "optimization/feature_observation.h"

namespace msf {
namespace {

struct Projections {
  std::vector<MapPointId> ids;
  std::vector<ProjectionQuery> queries;
  std::vector<double> disparity_px;
};

Projections ProjectUnseen(std::span<const MapPointId> points, const KeyFrame& keyframe,
                          double radius_px, const Map& map) {
  Projections result;
  const ViewProjector project(keyframe.T_cw, map.camera(), map.levels());
  for (const MapPointId id : points) {
    const MapPoint* point = map.FindPoint(id);
    if (!point || point->FeatureIn(keyframe.id) >= 0) continue;
    const std::optional<ProjectedPoint> projected = project(PointSnapshot(*point));
    if (!projected) continue;
    result.ids.push_back(id);
    result.disparity_px.push_back(projected->uv_px.x() - projected->u_right_px);
    result.queries.push_back({.uv_px = projected->uv_px,
                              .radius_px = radius_px * map.levels().scale(projected->level),
                              .min_level = std::max(0, projected->level - 1),
                              .max_level = projected->level,
                              .descriptor = point->descriptor});
  }
  return result;
}

// Whether the feature lies where the point projects, within the noise of its level.
bool Agrees(const FrameFeatures& features, int feature, const ProjectionQuery& query,
            double disparity_px, const Map& map, const NoiseOptions& noise) {
  const Chi2Gates gates;
  const ImageObservation observation =
      ObserveFeature(features, feature, map.camera(), map.levels(), noise, 1);
  const double depth_error_px =
      observation.HasDepth() ? disparity_px - observation.disparity_px : 0;
  const double chi2 = observation.inv_sigma2 * (query.uv_px - observation.uv_px).squaredNorm() +
                      observation.inv_sigma2_disparity * depth_error_px * depth_error_px;
  return chi2 < gates.For(observation);
}

}  // namespace

std::vector<PointSighting> FindPointsAgain(const NoiseOptions& noise,
                                           std::span<const MapPointId> points,
                                           KeyFrameId keyframe_id, double radius_px,
                                           const Map& map) {
  const KeyFrame& keyframe = *map.FindKeyFrame(keyframe_id);
  const Projections projections = ProjectUnseen(points, keyframe, radius_px, map);
  const std::vector<int> found = MatchByProjection(*keyframe.features, projections.queries,
                                                   {.max_distance = kStrictDescriptorDistance});
  std::vector<PointSighting> sightings;
  for (size_t q = 0; q < found.size(); ++q) {
    if (found[q] >= 0 && Agrees(*keyframe.features, found[q], projections.queries[q],
                                projections.disparity_px[q], map, noise))
      sightings.push_back({projections.ids[q], found[q]});
  }
  return sightings;
}

int FusePoints(std::span<const PointSighting> sightings, KeyFrameId keyframe_id, Map& map) {
  const KeyFrame& keyframe = *map.FindKeyFrame(keyframe_id);
  int fused = 0;
  for (const auto& [id, feature] : sightings) {
    const MapPoint* point = map.FindPoint(id);
    if (!point) continue;
    const MapPointId present = keyframe.points[feature];
    if (!present.valid()) {
      fused += map.AddObservation(id, keyframe_id, feature);
    } else if (present != id) {
      const bool keep_present =
          map.FindPoint(present)->observations.size() > point->observations.size();
      map.ReplacePoint(keep_present ? id : present, keep_present ? present : id);
      ++fused;
    }
  }
  return fused;
}

}  // namespace msf
