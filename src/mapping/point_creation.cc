#include "mapping/point_creation.h"

#include <algorithm>
#include <optional>

#include "estimation/triangulation.h"
#include "matching/epipolar_matcher.h"

namespace msf {
namespace {

// Features without a map point, and likely static.
std::vector<uint8_t> FreeFeatures(const KeyFrame& keyframe, double min_static_probability) {
  std::vector<uint8_t> free(keyframe.points.size());
  for (size_t i = 0; i < free.size(); ++i) {
    free[i] = !keyframe.points[i].valid() &&
              keyframe.features->static_weight[i] >= min_static_probability;
  }
  return free;
}

// One end of a match.
struct Sight {
  const KeyFrame& keyframe;
  int feature;

  const FrameFeatures& features() const { return *keyframe.features; }
  Eigen::Vector2d Position() const { return features().uv_px[feature].cast<double>(); }
  Eigen::Vector3d RayInWorld(const Camera& camera) const {
    return (keyframe.T_cw.rotation().conjugate() * camera.Unproject(Position(), 1)).normalized();
  }
  // Cosine of the angle under which the virtual stereo pair sees the point; 1 without depth.
  double StereoCosine(const Camera& camera) const {
    if (!features().HasDepth(feature)) return 1;
    return std::cos(2 * std::atan2(camera.baseline_m() / 2, features().depth_m[feature]));
  }
  Eigen::Vector3d PointInWorld(const Camera& camera) const {
    return keyframe.T_cw.Inverse() * features().PointInCamera(feature, camera);
  }
};

std::optional<Eigen::Vector3d> Locate(const MappingOptions& options, const Camera& camera,
                                      const Sight& a, const Sight& b) {
  const double parallax_cosine = a.RayInWorld(camera).dot(b.RayInWorld(camera));
  const double stereo_a = a.StereoCosine(camera), stereo_b = b.StereoCosine(camera);
  const bool any_depth = stereo_a < 1 || stereo_b < 1;
  const bool wide = parallax_cosine > 0 && parallax_cosine < std::min(stereo_a, stereo_b);
  if (wide && (any_depth || parallax_cosine < options.max_parallax_cosine)) {
    return Triangulate(camera, a.keyframe.T_cw, a.Position(), b.keyframe.T_cw, b.Position());
  }
  if (!any_depth) return std::nullopt;
  return stereo_a < stereo_b ? a.PointInWorld(camera) : b.PointInWorld(camera);
}

bool AgreesWith(const Sight& sight, const Eigen::Vector3d& p_w, const Map& map,
                const NoiseOptions& noise) {
  const ImageObservation observation =
      ObserveFeature(sight.features(), sight.feature, map.camera(), map.levels(), noise, 1);
  return ReprojectionChi2(map.camera(), sight.keyframe.T_cw * p_w, observation) <
         Chi2Gates().For(observation);
}

// The ratio of distances must fit the ratio of the levels at which the point was found.
bool ScalesAgree(const Sight& a, const Sight& b, const Eigen::Vector3d& p_w,
                 const ScaleLevels& levels) {
  const double distance_a = (p_w - a.keyframe.CentreInWorld()).norm();
  const double distance_b = (p_w - b.keyframe.CentreInWorld()).norm();
  if (distance_a <= 0 || distance_b <= 0) return false;
  const double by_distance = distance_b / distance_a;
  const double by_level =
      levels.scale(b.features().level[b.feature]) / levels.scale(a.features().level[a.feature]);
  const double slack = 1.5 * levels.factor();
  return by_distance < by_level * slack && by_distance * slack > by_level;
}

}  // namespace

std::vector<NewPoint> TriangulateWithNeighbour(const MappingOptions& options,
                                               const NoiseOptions& noise, const Map& map,
                                               KeyFrameId id, KeyFrameId neighbour_id) {
  const KeyFrame* keyframe = map.FindKeyFrame(id);
  const KeyFrame* neighbour = map.FindKeyFrame(neighbour_id);
  if (!keyframe || !neighbour || !keyframe->words || !neighbour->words) return {};
  const Camera& camera = map.camera();
  const double distance_m = (keyframe->CentreInWorld() - neighbour->CentreInWorld()).norm();
  if (distance_m < options.min_baselines * camera.baseline_m()) return {};

  const std::vector<uint8_t> free = FreeFeatures(*keyframe, options.min_static_probability),
                             neighbour_free =
                                 FreeFeatures(*neighbour, options.min_static_probability);
  const auto pairs =
      MatchByEpipolarLine({*keyframe->features, *keyframe->words, free},
                          {*neighbour->features, *neighbour->words, neighbour_free},
                          keyframe->T_cw * neighbour->T_cw.Inverse(), camera, map.levels(), {});
  std::vector<NewPoint> points;
  for (const auto& [i, j] : pairs) {
    const Sight a{*keyframe, i}, b{*neighbour, j};
    const std::optional<Eigen::Vector3d> p_w = Locate(options, camera, a, b);
    if (!p_w || !AgreesWith(a, *p_w, map, noise) || !AgreesWith(b, *p_w, map, noise)) continue;
    if (ScalesAgree(a, b, *p_w, map.levels())) points.push_back({*p_w, i, j});
  }
  return points;
}

std::vector<MapPointId> AddNewPoints(const std::vector<NewPoint>& points, KeyFrameId id,
                                     KeyFrameId neighbour_id, Map& map) {
  std::vector<MapPointId> added;
  const KeyFrame* keyframe = map.FindKeyFrame(id);
  const KeyFrame* neighbour = map.FindKeyFrame(neighbour_id);
  if (!keyframe || !neighbour) return added;
  for (const NewPoint& point : points) {
    if (keyframe->points[point.feature].valid() ||
        neighbour->points[point.neighbour_feature].valid())
      continue;
    const MapPointId new_id = map.AddPoint(point.p_w, id, point.feature);
    map.AddObservation(new_id, neighbour_id, point.neighbour_feature);
    map.UpdateAppearance(new_id);
    map.UpdateNormalAndRange(new_id);
    added.push_back(new_id);
  }
  return added;
}

}  // namespace msf
