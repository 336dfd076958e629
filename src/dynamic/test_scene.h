// A textured wall with something before it, and features on both, for the tests of this room.
#pragma once

#include <memory>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "dynamic/coarse_depth.h"
#include "feature/frame_features.h"
#include "feature/scale_levels.h"
#include "sensor/rgbd_frame.h"

namespace msf {

inline constexpr float kWall_m = 3.04f;   // in the middle of a bin of the depth histogram
inline constexpr float kThing_m = 2.04f;  // the same

inline const std::shared_ptr<const Camera>& TestCamera() {
  static const auto kCamera = std::make_shared<const Camera>(*Camera::Preset("simulated"));
  return kCamera;
}

inline ScaleLevels TestLevels() { return {8, 1.2}; }

// A part of the image in which depth is different.
struct DepthPatch {
  cv::Rect px;
  float depth_m = 0;  // 0 = none
};

inline cv::Mat MakeDepth(float wall_m, const std::vector<DepthPatch>& patches) {
  const Camera& camera = *TestCamera();
  const auto value = [&](float depth_m) { return cv::Scalar(depth_m * camera.depth_factor); };
  cv::Mat depth(camera.height, camera.width, CV_16U, value(wall_m));
  for (const DepthPatch& patch : patches) depth(patch.px) = value(patch.depth_m);
  return depth;
}

// A frame that has no colour.
inline RgbdFrame DepthFrame(float wall_m, const std::vector<DepthPatch>& patches = {}) {
  RgbdFrame frame;
  frame.camera = TestCamera();
  frame.depth = MakeDepth(wall_m, patches);
  return frame;
}

// Smooth random texture of the image's size.
inline cv::Mat MakeTexture(uint64_t seed) {
  cv::Mat noise(TestCamera()->height, TestCamera()->width, CV_8U);
  cv::RNG random(seed);
  random.fill(noise, cv::RNG::UNIFORM, 0, 255);
  cv::GaussianBlur(noise, noise, {}, 3);
  cv::normalize(noise, noise, 0, 255, cv::NORM_MINMAX);
  return noise;
}

// A wall, whose texture the camera's motion moves to the right by `wall_shift_px`, and before it a
// thing that carries its texture with it (none when `thing_px` is empty).
inline RgbdFrame TexturedFrame(int number, double time_s, float wall_shift_px,
                               const cv::Rect& thing_px = {}) {
  static const cv::Mat kWall = MakeTexture(7), kThing = MakeTexture(11);
  RgbdFrame frame;
  frame.id = FrameId(number);
  frame.time_s = time_s;
  frame.camera = TestCamera();
  const cv::Matx23f shift(1, 0, wall_shift_px, 0, 1, 0);
  cv::warpAffine(kWall, frame.color, shift, kWall.size(), cv::INTER_LINEAR, cv::BORDER_REFLECT);
  if (thing_px.empty()) {
    frame.depth = MakeDepth(kWall_m, {});
    return frame;
  }
  kThing(cv::Rect({0, 0}, thing_px.size())).copyTo(frame.color(thing_px));
  frame.depth = MakeDepth(kWall_m, {{thing_px, kThing_m}});
  return frame;
}

inline void AddFeature(const Eigen::Vector2f& px, float depth_m, FrameFeatures& features) {
  const auto bf = static_cast<float>(TestCamera()->bf);
  features.image_px.push_back(px);
  features.uv_px.push_back(px);
  features.depth_m.push_back(depth_m);
  features.u_right_px.push_back(depth_m > 0 ? px.x() - bf / depth_m : -1);
  features.angle_rad.push_back(0);
  features.level.push_back(0);
  features.static_weight.push_back(1);
  features.descriptors.push_back({static_cast<uint64_t>(features.size()), 0, 0, 0});
}

// A feature every 16 px, with the frame's depth.
inline FrameFeatures GridFeatures(const RgbdFrame& frame) {
  const CoarseDepth depth(frame);
  FrameFeatures features;
  for (int y = 40; y <= 440; y += 16) {
    for (int x = 40; x <= 600; x += 16) {
      const Eigen::Vector2f px(static_cast<float>(x), static_cast<float>(y));
      AddFeature(px, depth.At(px), features);
    }
  }
  features.BuildGrid(*TestCamera());
  return features;
}

}  // namespace msf
