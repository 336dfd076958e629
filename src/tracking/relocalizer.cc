#include "tracking/relocalizer.h"

#include <algorithm>

#include "estimation/pnp.h"
#include "matching/projection_matcher.h"

namespace msf {
namespace {

// The matches that agree with one pose, and that pose.
std::optional<Rigid3d> FindConsensus(const TrackingContext& context,
                                     const RelocalizationOptions& options,
                                     const FrameFeatures& features, uint64_t seed,
                                     std::vector<PointMatch>& matches) {
  std::vector<PnpMatch> pnp_matches;
  pnp_matches.reserve(matches.size());
  for (const PointMatch& match : matches) {
    pnp_matches.push_back({match.p_w, features.uv_px[match.feature].cast<double>(),
                           context.levels.sigma2(features.level[match.feature])});
  }
  const RansacOptions ransac{.confidence = options.ransac_confidence,
                             .max_iterations = options.ransac_iterations,
                             .min_inliers = options.ransac_min_inliers,
                             .seed = seed};
  const std::optional<PnpEstimate> estimate =
      EstimatePose(context.camera, pnp_matches, {.ransac = ransac});
  if (!estimate) return std::nullopt;
  size_t kept = 0;
  for (size_t i = 0; i < matches.size(); ++i) {
    if (estimate->inlier[i]) matches[kept++] = matches[i];
  }
  matches.resize(kept);
  return estimate->T_cw;
}

// Looks for the candidate's other points where the pose puts them, and optimises with all; false
// when too few agree.
bool GrowMatches(const TrackingContext& context, const Map& map, const KeyFrame& candidate,
                 double radius_px, int max_distance, const FrameFeatures& features,
                 std::vector<PointMatch>& matches, Rigid3d& T_cw) {
  std::vector<uint8_t> taken(features.size(), 0);
  std::vector<MapPointId> matched;
  for (const PointMatch& match : matches) {
    taken[match.feature] = 1;
    matched.push_back(match.point);
  }
  std::sort(matched.begin(), matched.end());
  std::vector<ProjectionQuery> queries;
  std::vector<const MapPoint*> points;
  const ViewProjector project(T_cw, context.camera, context.levels);
  for (const MapPointId id : candidate.points) {
    if (!id.valid() || std::binary_search(matched.begin(), matched.end(), id)) continue;
    const MapPoint& point = *map.FindPoint(id);
    const std::optional<ProjectedPoint> projected = project(PointSnapshot(point));
    if (!projected) continue;
    queries.push_back({.uv_px = projected->uv_px,
                       .radius_px = radius_px * context.levels.scale(projected->level),
                       .min_level = std::max(0, projected->level - 1),
                       .max_level = std::min(context.levels.size() - 1, projected->level + 1),
                       .descriptor = point.descriptor});
    points.push_back(&point);
  }
  const std::vector<int> found =
      MatchByProjection(features, queries, {.max_distance = max_distance}, taken);
  for (size_t q = 0; q < found.size(); ++q) {
    if (found[q] >= 0) matches.push_back(MakePointMatch(*points[q], features, found[q]));
  }
  return OptimizeFramePose(context, features, context.options.min_pose_inliers, matches, T_cw);
}

std::optional<Relocalization> TryCandidate(const TrackingContext& context,
                                           const RelocalizationOptions& options, const Map& map,
                                           const KeyFrame& candidate, const FrameFeatures& features,
                                           const BagOfWords& words, uint64_t seed) {
  Relocalization result;
  result.keyframe = candidate.id;
  result.matches =
      MatchKeyFrame(map, candidate, *candidate.words, features, words, options.match_ratio);
  if (static_cast<int>(result.matches.size()) < options.min_matches) return std::nullopt;
  const std::optional<Rigid3d> consensus =
      FindConsensus(context, options, features, seed, result.matches);
  if (!consensus) return std::nullopt;
  result.T_cw = *consensus;
  if (!OptimizeFramePose(context, features, context.options.min_pose_inliers, result.matches,
                         result.T_cw)) {
    return std::nullopt;
  }
  const auto enough = [&] {
    return static_cast<int>(result.matches.size()) >= options.min_inliers;
  };
  const auto grow = [&](double radius_px, int max_distance) {
    return GrowMatches(context, map, candidate, radius_px, max_distance, features, result.matches,
                       result.T_cw);
  };
  if (!enough() && !grow(options.wide_radius_px, options.wide_max_distance)) return std::nullopt;
  const bool promising = static_cast<int>(result.matches.size()) > options.narrow_from_inliers;
  if (!enough() && promising && !grow(options.narrow_radius_px, options.narrow_max_distance))
    return std::nullopt;
  return enough() ? std::optional(result) : std::nullopt;
}

}  // namespace

Status RelocalizationOptions::Check() const {
  const bool ok = match_ratio > 0 && match_ratio <= 1 && min_matches > 0 && ransac_iterations > 0 &&
                  ransac_confidence > 0 && ransac_confidence < 1 && ransac_min_inliers >= 4 &&
                  min_inliers > 0 && wide_radius_px > 0 && wide_max_distance >= 0 &&
                  narrow_radius_px > 0 && narrow_max_distance >= 0 && narrow_from_inliers >= 0;
  return ok ? Status::Ok()
            : Status::Error(
                  "relocalization: match_ratio must be in (0, 1], ransac_confidence in (0, 1), "
                  "ransac_min_inliers at least 4, the other numbers positive");
}

std::optional<Relocalization> Relocalize(const TrackingContext& context,
                                         const RelocalizationOptions& options, const Map& map,
                                         const std::vector<KeyFrameId>& candidates,
                                         const FrameFeatures& features, const BagOfWords& words,
                                         uint64_t seed) {
  for (const KeyFrameId id : candidates) {
    const KeyFrame* candidate = map.FindKeyFrame(id);
    if (!candidate || !candidate->words) continue;
    std::optional<Relocalization> found =
        TryCandidate(context, options, map, *candidate, features, words,
                     seed + static_cast<uint64_t>(id.value()));
    if (found) return found;
  }
  return std::nullopt;
}

}  // namespace msf
