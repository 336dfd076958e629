// From perfect colour to what a cheap colour camera delivers: exposure, vignetting, noise, eight
// bits.
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "sensor/camera.h"
#include "simulation/random.h"
#include "simulation/texture.h"
#include "util/status.h"

namespace msf {

struct ColorSensorOptions {
  double noise = 2.0;
  double vignetting = 0.12;
  double exposure_drift = 0.08;
  double exposure_jump = 0;
  double exposure_jump_period_s = 3;
  double shutter_s = 0.012;
  int blur_samples = 1;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("noise", noise,
          "standard deviation of medium grey, levels of 255; dark is a bit quieter");
    visit("vignetting", vignetting, "loss of light in the corners, 0..1");
    visit("exposure_drift", exposure_drift, "slow change of brightness, share of 1");
    visit("exposure_jump", exposure_jump, "sudden changes of brightness up to this share");
    visit("exposure_jump_period_s", exposure_jump_period_s, "time between sudden changes");
    visit("shutter_s", shutter_s, "exposure time, s (matters with motion blur)");
    visit("blur_samples", blur_samples, "pictures averaged over the exposure; 1 = no motion blur");
  }
  Status Check() const;
};

class ColorSensor {
 public:
  ColorSensor(const ColorSensorOptions& options, const Camera& camera, Random random);

  // 8-bit BGR image of a rendered picture (32-bit float, 4 channels) taken at `time_s` under
  // `light`, the share of the usual light.
  cv::Mat Expose(const cv::Mat& color, double time_s, double light, Random random) const;
  // Brightness factor at a time.
  double ExposureAt(double time_s) const;

 private:
  ColorSensorOptions options_;
  Random random_;
  cv::Mat light_fall_off_;      // 32-bit float
  std::vector<Color4f> noise_;  // standard normal, neighbours alike as after demosaicing
};

}  // namespace msf
