#include "loop_closing/place_verification.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "matching/projection_matcher.h"
#include "matching/word_matcher.h"

namespace msf {
namespace {

// A disparity that is off by this, at level 0, and by its noise, is another surface's.
constexpr double kSurfaceGap_px = 1.2;

std::vector<uint8_t> FlagPoints(const KeyFrameView& view) {
  std::vector<uint8_t> has_point(view.points.size());
  std::transform(view.points.begin(), view.points.end(), has_point.begin(),
                 [](MapPointId id) { return id.valid(); });
  return has_point;
}

}  // namespace

const char* ToString(PlaceVerdict verdict) {
  switch (verdict) {
    case PlaceVerdict::kAccepted:
      return "accepted";
    case PlaceVerdict::kFewWordMatches:
      return "few matches by words";
    case PlaceVerdict::kNoAlignment:
      return "no rigid alignment";
    case PlaceVerdict::kFewGuidedMatches:
      return "few matches by projection";
    case PlaceVerdict::kNotRefinable:
      return "no common pose";
    case PlaceVerdict::kDepthDisagrees:
      return "depths disagree";
    case PlaceVerdict::kFewTightMatches:
      return "few matches by tight projection";
    case PlaceVerdict::kTooLittleSeen:
      return "too little of what should be visible is seen";
    case PlaceVerdict::kTooMuchDrift:
      return "more drift than believable";
  }
  return "unknown";
}

PlaceMatch PlaceVerifier::Verify(const PlaceWindow& current, const PlaceWindow& matched,
                                 uint64_t seed) const {
  PlaceMatch match;
  match.current = current.centre().id;
  match.matched = matched.centre().id;
  const std::vector<WordMatch> words = MatchWords(current.centre(), matched);
  if (static_cast<int>(words.size()) < options_.min_word_matches) return match;
  const std::optional<Rigid3d> T_c_m = Align(words, current, matched, seed);
  if (!T_c_m) {
    match.verdict = PlaceVerdict::kNoAlignment;
    return match;
  }
  Rigid3d T_cw = *T_c_m * matched.centre().T_cw;
  match.verdict = Confirm(current.centre(), matched, options_.min_guided_matches,
                          options_.min_tight_matches, T_cw, match.matches);
  match.T_c_m = T_cw * matched.centre().T_cw.Inverse();
  return match;
}

PlaceMatch PlaceVerifier::VerifyFrom(const Rigid3d& T_c_m, const KeyFrameView& current,
                                     const PlaceWindow& matched) const {
  PlaceMatch match;
  match.current = current.id;
  match.matched = matched.centre().id;
  Rigid3d T_cw = T_c_m * matched.centre().T_cw;
  // The camera moves on: a follower sees less of the window than the one that found it.
  match.verdict = Confirm(current, matched, options_.min_neighbour_matches,
                          options_.min_guided_matches, T_cw, match.matches);
  match.T_c_m = T_cw * matched.centre().T_cw.Inverse();
  return match;
}

std::vector<PlaceMatch> PlaceVerifier::AgreeingNeighbours(const PlaceMatch& match,
                                                          const PlaceWindow& current,
                                                          const PlaceWindow& matched) const {
  std::vector<PlaceMatch> agreeing;
  const Rigid3d T_wc = current.centre().T_cw.Inverse();
  for (size_t k = 1; k < current.keyframes.size(); ++k) {
    const KeyFrameView& neighbour = current.keyframes[k];
    // No refinement: the question is whether the neighbour confirms this very motion.
    const Rigid3d T_n_m = neighbour.T_cw * T_wc * match.T_c_m;
    Found found = Project(neighbour, T_n_m * matched.centre().T_cw, matched,
                          {options_.tight_radius_px, options_.tight_max_distance});
    if (static_cast<int>(found.matches.size()) < options_.min_neighbour_matches) continue;
    agreeing.push_back({PlaceVerdict::kAccepted, neighbour.id, matched.centre().id, T_n_m,
                        std::move(found.matches)});
  }
  return agreeing;
}

std::vector<PlaceVerifier::WordMatch> PlaceVerifier::MatchWords(const KeyFrameView& current,
                                                                const PlaceWindow& matched) const {
  const std::vector<uint8_t> current_usable = FlagPoints(current);
  const WordImage current_image{*current.features, *current.words, current_usable};
  std::map<int, WordMatch> best_of_feature;
  for (const KeyFrameView& view : matched.keyframes) {
    const std::vector<uint8_t> usable = FlagPoints(view);
    const auto pairs = MatchByWords(current_image, {*view.features, *view.words, usable},
                                    {.ratio = options_.match_ratio});
    for (const auto& [i, j] : pairs) {
      const int distance =
          DescriptorDistance(current.features->descriptors[i], view.features->descriptors[j]);
      const WordMatch match{i, view.points[j], levels_.sigma2(view.features->level[j]), distance};
      const auto [place, is_new] = best_of_feature.try_emplace(i, match);
      if (!is_new && distance < place->second.distance) place->second = match;
    }
    // The candidate itself looked alike; when not even it matches, its neighbours need no look.
    const bool is_centre = &view == &matched.centre();
    if (is_centre && 2 * static_cast<int>(pairs.size()) < options_.min_word_matches) return {};
  }
  // Several features may show one point in different keyframes: the most alike keeps it.
  std::map<MapPointId, WordMatch> best_of_point;
  for (const auto& [feature, match] : best_of_feature) {
    const auto [place, is_new] = best_of_point.try_emplace(match.point, match);
    if (!is_new && match.distance < place->second.distance) place->second = match;
  }
  std::vector<WordMatch> matches;
  matches.reserve(best_of_point.size());
  for (const auto& [point, match] : best_of_point) matches.push_back(match);
  return matches;
}

std::optional<Rigid3d> PlaceVerifier::Align(const std::vector<WordMatch>& words,
                                            const PlaceWindow& current, const PlaceWindow& matched,
                                            uint64_t seed) const {
  const KeyFrameView& view = current.centre();
  std::vector<RigidMatch> matches;
  for (const WordMatch& word : words) {
    RigidMatch match;
    match.p_c1 = view.T_cw * current.FindPoint(view.points[word.feature])->p_w;
    match.p_c2 = matched.centre().T_cw * matched.FindPoint(word.point)->p_w;
    match.sigma2_1_px2 = levels_.sigma2(view.features->level[word.feature]);
    match.sigma2_2_px2 = word.sigma2_px2;
    matches.push_back(match);
  }
  RigidAlignmentOptions options = options_.alignment;
  options.ransac.seed = seed;
  const std::optional<RigidAlignment> alignment = AlignRigidly(camera_, matches, options);
  if (!alignment) return std::nullopt;
  return alignment->T_c1_c2;
}

PlaceVerifier::Found PlaceVerifier::Project(const KeyFrameView& view, const Rigid3d& T_cw,
                                            const PlaceWindow& matched,
                                            const Search& search) const {
  Found found;
  std::vector<ProjectionQuery> queries;
  std::vector<std::pair<MapPointId, double>> searched;  // and the disparity it should have
  const ViewProjector project(T_cw, camera_, levels_);
  for (const PointSnapshot& point : matched.points) {
    const std::optional<ProjectedPoint> projected = project(point);
    if (!projected) continue;
    queries.push_back({.uv_px = projected->uv_px,
                       .radius_px = search.radius_px * levels_.scale(projected->level),
                       .min_level = std::max(0, projected->level - 1),
                       .max_level = std::min(levels_.size() - 1, projected->level + 1),
                       .descriptor = point.descriptor});
    searched.emplace_back(point.id, projected->uv_px.x() - projected->u_right_px);
  }
  found.num_visible = static_cast<int>(queries.size());
  const std::vector<int> features =
      MatchByProjection(*view.features, queries, {.max_distance = search.max_distance});
  for (size_t q = 0; q < features.size(); ++q) {
    if (features[q] < 0) continue;
    if (view.features->HasDepth(features[q])) {
      ++found.num_deep;
      if (!DepthAgrees(*view.features, features[q], searched[q].second)) continue;
      ++found.num_deep_right;
    }
    found.matches.emplace_back(features[q], searched[q].first);
  }
  return found;
}

bool PlaceVerifier::DepthAgrees(const FrameFeatures& features, int feature,
                                double disparity_px) const {
  const ImageObservation seen = ObserveFeature(features, feature, camera_, levels_, noise_, 1);
  const double noise_px = 1 / std::sqrt(seen.inv_sigma2_disparity);
  return std::abs(disparity_px - seen.disparity_px) <=
         kSurfaceGap_px * levels_.scale(features.level[feature]) + noise_px;
}

void PlaceVerifier::Refine(const KeyFrameView& view, const PlaceWindow& matched, Matches& matches,
                           Rigid3d& T_cw) const {
  std::vector<PoseObservation> observations;
  for (const auto& [feature, id] : matches) {
    const PointSnapshot& point = *matched.FindPoint(id);
    const double weight = std::min(point.static_weight, view.features->static_weight[feature]);
    PoseObservation observation{
        ObserveFeature(*view.features, feature, camera_, levels_, noise_, weight)};
    observation.p_w = point.p_w;
    observations.push_back(observation);
  }
  const PoseEstimate estimate = OptimizePose(camera_, T_cw, observations, pose_);
  size_t kept = 0;
  for (size_t i = 0; i < matches.size(); ++i) {
    if (estimate.inlier[i]) matches[kept++] = matches[i];
  }
  matches.resize(kept);
  T_cw = estimate.T_cw;
}

PlaceVerdict PlaceVerifier::Confirm(const KeyFrameView& view, const PlaceWindow& matched,
                                    int min_guided, int min_tight, Rigid3d& T_cw,
                                    Matches& matches) const {
  Found found =
      Project(view, T_cw, matched, {options_.guided_radius_px, options_.guided_max_distance});
  if (static_cast<int>(found.matches.size()) < min_guided) return PlaceVerdict::kFewGuidedMatches;
  Refine(view, matched, found.matches, T_cw);
  if (static_cast<int>(found.matches.size()) < options_.min_refined_matches)
    return PlaceVerdict::kNotRefinable;

  found = Project(view, T_cw, matched, {options_.tight_radius_px, options_.tight_max_distance});
  if (found.num_deep_right < options_.min_agreeing_depth_share * found.num_deep)
    return PlaceVerdict::kDepthDisagrees;
  if (static_cast<int>(found.matches.size()) < min_tight) return PlaceVerdict::kFewTightMatches;
  if (found.matches.size() < options_.min_seen_share * found.num_visible)
    return PlaceVerdict::kTooLittleSeen;
  Refine(view, matched, found.matches, T_cw);
  matches = std::move(found.matches);
  return matches.empty() ? PlaceVerdict::kNotRefinable : PlaceVerdict::kAccepted;
}

}  // namespace msf
