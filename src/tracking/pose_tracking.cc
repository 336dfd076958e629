#include "tracking/pose_tracking.h"

#include <algorithm>

#include "matching/projection_matcher.h"
#include "matching/word_matcher.h"

namespace msf {
namespace {

double MatchWeight(const FrameFeatures& features, int feature, double point_weight) {
  return std::min<double>(features.static_weight[feature], point_weight);
}

// The levels at which a point of the last frame can reappear: moving forward makes it larger,
// backward smaller.
std::pair<int, int> LevelRange(int level, double forward_m, const TrackingContext& context) {
  const int top = context.levels.size() - 1;
  if (forward_m > context.camera.baseline_m()) return {level, top};
  if (-forward_m > context.camera.baseline_m()) return {0, level};
  return {std::max(0, level - 1), std::min(top, level + 1)};
}

struct LastFrameQueries {
  std::vector<ProjectionQuery> queries;
  std::vector<const MapPoint*> points;
  std::vector<int> last_features;
};

LastFrameQueries ProjectLastFrame(const TrackingContext& context, const Map& map, const Frame& last,
                                  const Rigid3d& T_cw_predicted) {
  LastFrameQueries result;
  const double forward_m = (last.T_cw * T_cw_predicted.Inverse()).translation().z();
  for (int i = 0; i < last.features->size(); ++i) {
    const MapPoint* point = map.FindPoint(map.Resolve(last.points[i]));
    if (!point) continue;
    const Eigen::Vector3d p_c = T_cw_predicted * point->p_w;
    if (p_c.z() <= 0) continue;
    ProjectionQuery query;
    query.uv_px = context.camera.Project(p_c);
    query.u_right_px = query.uv_px.x() - context.camera.bf / p_c.z();
    query.radius_px =
        context.options.motion_radius_px * context.levels.scale(last.features->level[i]);
    std::tie(query.min_level, query.max_level) =
        LevelRange(last.features->level[i], forward_m, context);
    query.descriptor = point->descriptor;
    result.queries.push_back(query);
    result.points.push_back(point);
    result.last_features.push_back(i);
  }
  return result;
}

// Ascending.
std::vector<MapPointId> PointsOf(const std::vector<PointMatch>& matches) {
  std::vector<MapPointId> ids;
  ids.reserve(matches.size());
  for (const PointMatch& match : matches) ids.push_back(match.point);
  std::sort(ids.begin(), ids.end());
  return ids;
}

struct LocalQueries {
  std::vector<ProjectionQuery> queries;
  std::vector<const PointSnapshot*> points;
};

// The points that should be visible from `T_cw`, without those of `matched` (ascending).
LocalQueries ProjectLocalPoints(const TrackingContext& context,
                                const std::vector<PointSnapshot>& points, const Rigid3d& T_cw,
                                const std::vector<MapPointId>& matched, double radius_factor) {
  LocalQueries result;
  const ViewProjector project(T_cw, context.camera, context.levels);
  for (const PointSnapshot& point : points) {
    if (std::binary_search(matched.begin(), matched.end(), point.id)) continue;
    const std::optional<ProjectedPoint> projected = project(point);
    if (!projected) continue;
    const double base_px = projected->view_cosine > 0.998 ? 2.5 : 4.0;
    result.queries.push_back(
        {.uv_px = projected->uv_px,
         .u_right_px = projected->u_right_px,
         .radius_px = base_px * radius_factor * context.levels.scale(projected->level),
         .min_level = std::max(0, projected->level - 1),
         .max_level = projected->level,
         .descriptor = point.descriptor});
    result.points.push_back(&point);
  }
  return result;
}

}  // namespace

PointMatch MakePointMatch(const MapPoint& point, const FrameFeatures& features, int feature) {
  return {feature, point.id, point.p_w, MatchWeight(features, feature, point.static_weight)};
}

std::vector<PointMatch> MatchLastFrame(const TrackingContext& context, const Map& map,
                                       const Frame& last, const FrameFeatures& features,
                                       const Rigid3d& T_cw_predicted) {
  LastFrameQueries search = ProjectLastFrame(context, map, last, T_cw_predicted);
  std::vector<std::pair<int, int>> pairs;  // (feature of last, feature now)
  std::vector<int> query_of(last.features->size(), -1);
  for (size_t q = 0; q < search.queries.size(); ++q)
    query_of[search.last_features[q]] = static_cast<int>(q);
  for (int attempt = 0; attempt < 2; ++attempt) {
    const std::vector<int> found = MatchByProjection(features, search.queries, {});
    pairs.clear();
    for (size_t q = 0; q < found.size(); ++q) {
      if (found[q] >= 0) pairs.emplace_back(search.last_features[q], found[q]);
    }
    pairs = KeepConsistentRotations(pairs, *last.features, features);
    if (static_cast<int>(pairs.size()) >= context.options.min_motion_matches) break;
    for (ProjectionQuery& query : search.queries) query.radius_px *= 2;
  }
  std::vector<PointMatch> matches;
  matches.reserve(pairs.size());
  for (const auto& [last_feature, feature] : pairs) {
    matches.push_back(MakePointMatch(*search.points[query_of[last_feature]], features, feature));
  }
  return matches;
}

std::vector<PointMatch> MatchKeyFrame(const Map& map, const KeyFrame& keyframe,
                                      const BagOfWords& keyframe_words,
                                      const FrameFeatures& features, const BagOfWords& words,
                                      double ratio) {
  std::vector<uint8_t> has_point(keyframe.points.size());
  std::transform(keyframe.points.begin(), keyframe.points.end(), has_point.begin(),
                 [](MapPointId id) { return id.valid(); });
  const WordMatchOptions options{.ratio = ratio};
  std::vector<PointMatch> matches;
  for (const auto& [i, j] : MatchByWords({*keyframe.features, keyframe_words, has_point},
                                         {features, words, {}}, options)) {
    matches.push_back(MakePointMatch(*map.FindPoint(keyframe.points[i]), features, j));
  }
  return matches;
}

LocalMatches MatchLocalPoints(const TrackingContext& context,
                              const std::vector<PointSnapshot>& points,
                              const FrameFeatures& features, const Rigid3d& T_cw,
                              const std::vector<PointMatch>& matched, double radius_factor) {
  std::vector<uint8_t> taken(features.size(), 0);
  for (const PointMatch& match : matched) taken[match.feature] = 1;
  LocalMatches result;
  result.expected = PointsOf(matched);
  const LocalQueries search =
      ProjectLocalPoints(context, points, T_cw, result.expected, radius_factor);
  for (const PointSnapshot* point : search.points) result.expected.push_back(point->id);
  const std::vector<int> found = MatchByProjection(
      features, search.queries, {.ratio = context.options.local_match_ratio}, taken);
  for (size_t q = 0; q < found.size(); ++q) {
    if (found[q] < 0) continue;
    const PointSnapshot& point = *search.points[q];
    result.matches.push_back(
        {found[q], point.id, point.p_w, MatchWeight(features, found[q], point.static_weight)});
  }
  return result;
}

std::vector<Suspect> FindSuspects(const TrackingContext& context,
                                  const std::vector<PointSnapshot>& points,
                                  const FrameFeatures& removed, const Rigid3d& T_cw,
                                  const std::vector<PointMatch>& matched) {
  std::vector<Suspect> suspects;
  if (removed.size() == 0) return suspects;
  const LocalQueries search = ProjectLocalPoints(context, points, T_cw, PointsOf(matched), 1);
  const std::vector<int> found = MatchByProjection(
      removed, search.queries,
      {.max_distance = kStrictDescriptorDistance, .ratio = context.options.local_match_ratio});
  for (size_t q = 0; q < found.size(); ++q) {
    if (found[q] >= 0) suspects.push_back({found[q], search.points[q]});
  }
  return suspects;
}

bool OptimizeFramePose(const TrackingContext& context, const FrameFeatures& features,
                       int min_inliers, std::vector<PointMatch>& matches, Rigid3d& T_cw) {
  std::vector<PoseObservation> observations;
  observations.reserve(matches.size());
  for (const PointMatch& match : matches) {
    PoseObservation observation{ObserveFeature(features, match.feature, context.camera,
                                               context.levels, context.noise, match.weight)};
    observation.p_w = match.p_w;
    observations.push_back(observation);
  }
  const PoseEstimate estimate =
      OptimizePose(context.camera, T_cw, observations, context.options.pose);
  size_t kept = 0;
  for (size_t i = 0; i < matches.size(); ++i) {
    if (estimate.inlier[i]) matches[kept++] = matches[i];
  }
  matches.resize(kept);
  if (estimate.num_inliers < std::max(1, min_inliers)) return false;
  T_cw = estimate.T_cw;
  return true;
}

}  // namespace msf
