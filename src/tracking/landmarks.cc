#include "tracking/landmarks.h"

namespace msf {
namespace {

bool IsOld(const Map& map, const MapPoint& point, double time_s, double age_s) {
  const KeyFrame* first = map.FindKeyFrame(point.first_keyframe);
  // A keyframe that is gone was found redundant, and so lies back.
  return !first || time_s - first->time_s >= age_s;
}

std::vector<Landmark> EvenlyChosen(const std::vector<Landmark>& landmarks, size_t count) {
  if (landmarks.size() <= count) return landmarks;
  std::vector<Landmark> chosen;
  chosen.reserve(count);
  for (size_t k = 0; k < count; ++k) chosen.push_back(landmarks[k * landmarks.size() / count]);
  return chosen;
}

}  // namespace

std::vector<Landmark> FindLandmarks(const TrackingContext& context, const Map& map,
                                    const Frame& frame, const FrameFeatures& extracted,
                                    std::span<const PointMatch> matches) {
  const TrackingOptions& options = context.options;
  std::vector<Landmark> landmarks;
  for (const PointMatch& match : matches) {
    if (match.feature >= extracted.size()) continue;  // a removed one that has come back
    const MapPoint* point = map.FindPoint(match.point);
    if (!point || point->static_weight < options.landmark_probability ||
        !IsOld(map, *point, frame.image->time_s, options.landmark_age_s))
      continue;
    const double depth_m = (frame.T_cw * point->p_w).z();
    landmarks.push_back(
        {extracted.image_px[match.feature],
         context.camera.Unproject(extracted.uv_px[match.feature].cast<double>(), depth_m)});
  }
  return EvenlyChosen(landmarks, static_cast<size_t>(options.max_landmarks));
}

}  // namespace msf
