// From a feature to an observation: how far each of its numbers can be trusted.
#pragma once

#include <algorithm>

#include "feature/frame_features.h"
#include "feature/scale_levels.h"
#include "optimization/reprojection.h"
#include "sensor/camera.h"
#include "util/status.h"

namespace msf {

// Measurement noise. A point found at pyramid level l is located to `position_sigma_px` * scale(l).
// Disparity (bf / depth) carries the noise of the depth sensor, Camera::disparity_noise_px, plus
// the error of sampling the depth next to the true point, which grows with the patch.
struct NoiseOptions {
  double position_sigma_px = 1.0;
  double disparity_sigma_px = 0;
  double disparity_level_share = 1.0;
  double disparity_knee = 2.5;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("position_sigma_px", position_sigma_px, "noise of a point's position at level 0, px");
    visit("disparity_sigma_px", disparity_sigma_px,
          "noise of the virtual disparity bf / depth, px; 0: the camera's own");
    visit("disparity_level_share", disparity_level_share,
          "0: disparity noise equal at all levels; 1: grows like the position's");
    visit("disparity_knee", disparity_knee,
          "disparity errors beyond so many sigmas lose their pull; 0: never");
  }
  Status Check() const {
    const bool ok = position_sigma_px > 0 && disparity_sigma_px >= 0 &&
                    disparity_level_share >= 0 && disparity_knee >= 0;
    return ok ? Status::Ok()
              : Status::Error(
                    "noise: position_sigma_px must be positive, the other options not negative");
  }
};

// What of a feature an observation is made of.
struct FeaturePlace {
  Eigen::Vector2f uv_px;  // undistorted
  float depth_m = 0;      // 0 = none
  uint8_t level = 0;
};

// The observation of a feature, weighted by `static_weight`.
inline ImageObservation ObserveFeature(const FeaturePlace& feature, const Camera& camera,
                                       const ScaleLevels& levels, const NoiseOptions& noise,
                                       double static_weight) {
  ImageObservation observation;
  const double scale = levels.scale(feature.level);
  const double position_sigma_px = noise.position_sigma_px * scale;
  observation.uv_px = feature.uv_px.cast<double>();
  observation.inv_sigma2 = 1 / (position_sigma_px * position_sigma_px);
  if (feature.depth_m > 0) {
    const double own_sigma_px =
        noise.disparity_sigma_px > 0 ? noise.disparity_sigma_px : camera.disparity_noise_px;
    const double sigma_px = own_sigma_px * (1 + noise.disparity_level_share * (scale - 1));
    observation.disparity_px = camera.bf / feature.depth_m;
    observation.inv_sigma2_disparity = 1 / (sigma_px * sigma_px);
    if (noise.disparity_knee > 0)
      observation.inv_knee_disparity = 1 / (noise.disparity_knee * noise.disparity_knee);
  }
  observation.weight = static_weight;
  return observation;
}

// The same for feature `i` of a frame.
inline ImageObservation ObserveFeature(const FrameFeatures& features, int i, const Camera& camera,
                                       const ScaleLevels& levels, const NoiseOptions& noise,
                                       double static_weight) {
  return ObserveFeature({features.uv_px[i], features.depth_m[i], features.level[i]}, camera, levels,
                        noise, static_weight);
}

}  // namespace msf
