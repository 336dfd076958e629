#include "tracking/keyframe_creation.h"

#include <algorithm>

namespace msf {
namespace {

constexpr int kMinNewPoints = 100;

std::array<uint8_t, 3> ColorAt(const cv::Mat& image, const Eigen::Vector2f& image_px) {
  const int x = std::clamp(cvRound(image_px.x()), 0, image.cols - 1);
  const int y = std::clamp(cvRound(image_px.y()), 0, image.rows - 1);
  const uint8_t* pixel = image.ptr<uint8_t>(y) + x * image.channels();
  if (image.channels() == 1) return {pixel[0], pixel[0], pixel[0]};
  return {pixel[0], pixel[1], pixel[2]};
}

// Features with depth, nearest first.
std::vector<int> ByDepth(const FrameFeatures& features) {
  std::vector<int> order;
  for (int i = 0; i < features.size(); ++i) {
    if (features.HasDepth(i)) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return features.depth_m[a] < features.depth_m[b]; });
  return order;
}

}  // namespace

KeyFrameId InsertKeyFrame(const TrackingContext& context, Frame& frame, Map& map) {
  KeyFrame keyframe;
  keyframe.frame_id = frame.image->id;
  keyframe.time_s = frame.image->time_s;
  keyframe.features = frame.features;
  keyframe.words = frame.words;
  keyframe.T_cw = frame.T_cw;
  for (const Eigen::Vector2f& image_px : frame.features->image_px) {
    keyframe.colors_bgr.push_back(ColorAt(frame.image->color, image_px));
  }
  const KeyFrameId id = map.AddKeyFrame(std::move(keyframe));
  for (size_t i = 0; i < frame.points.size(); ++i) {
    MapPointId& point = frame.points[i];
    point = map.Resolve(point);
    if (point.valid() && !map.AddObservation(point, id, static_cast<int>(i))) point = MapPointId();
  }

  const FrameFeatures& features = *frame.features;
  const Rigid3d T_wc = frame.T_cw.Inverse();
  int handled = 0;
  for (const int i : ByDepth(features)) {
    if (features.depth_m[i] > context.CloseDepth() && handled >= kMinNewPoints) break;
    ++handled;
    if (frame.points[i].valid() ||
        features.static_weight[i] < context.options.min_static_probability)
      continue;
    const Eigen::Vector3d p_w = T_wc * features.PointInCamera(i, context.camera);
    frame.points[i] = map.AddPoint(p_w, id, i);
  }
  map.UpdateConnections(id);
  return id;
}

KeyFrameEvidence GatherEvidence(const TrackingContext& context, const Map& map,
                                const Frame& frame) {
  KeyFrameEvidence evidence;
  evidence.inliers = frame.NumPoints();
  // Early on no point can have been seen by two keyframes.
  const int min_strength = map.NumKeyFrames(map.active_map()) <= 2 ? 2 : 3;
  if (const KeyFrame* reference = map.FindKeyFrame(frame.reference)) {
    for (const MapPointId id : reference->points) {
      evidence.reference_points +=
          id.valid() && map.FindPoint(id)->observation_strength >= min_strength;
    }
  }
  const FrameFeatures& features = *frame.features;
  for (int i = 0; i < features.size(); ++i) {
    if (!features.HasDepth(i) || features.depth_m[i] >= context.CloseDepth()) continue;
    if (features.static_weight[i] < context.options.min_static_probability) continue;
    (frame.points[i].valid() ? evidence.tracked_close : evidence.untracked_close) += 1;
  }
  const int num_hidden = frame.removed ? frame.removed->size() : 0;
  evidence.hidden_share =
      static_cast<double>(num_hidden) / std::max(1, num_hidden + features.size());
  return evidence;
}

}  // namespace msf
