#include "simulation/color_sensor.h"

#include <algorithm>
#include <cmath>

namespace msf {
namespace {

constexpr int kNoiseSize = 1 << 17;

}  // namespace

Status ColorSensorOptions::Check() const {
  if (!(noise >= 0)) return Status::Error("color.noise must not be negative");
  if (!(vignetting >= 0 && vignetting < 1))
    return Status::Error("color.vignetting must be in [0, 1)");
  if (!(exposure_drift >= 0 && exposure_drift < 1))
    return Status::Error("color.exposure_drift must be in [0, 1)");
  if (!(exposure_jump >= 0 && exposure_jump < 1))
    return Status::Error("color.exposure_jump must be in [0, 1)");
  if (!(exposure_jump_period_s > 0))
    return Status::Error("color.exposure_jump_period_s must be positive");
  if (!(shutter_s >= 0)) return Status::Error("color.shutter_s must not be negative");
  if (blur_samples < 1 || blur_samples > 64)
    return Status::Error("color.blur_samples must be in 1..64");
  return Status::Ok();
}

ColorSensor::ColorSensor(const ColorSensorOptions& options, const Camera& camera, Random random)
    : options_(options),
      random_(random),
      light_fall_off_(camera.height, camera.width, CV_32FC1),
      noise_(kNoiseSize) {
  const double corner = std::hypot(camera.width, camera.height) / 2;
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const double r = std::hypot(x - 0.5 * camera.width, y - 0.5 * camera.height) / corner;
      light_fall_off_.at<float>(y, x) = static_cast<float>(1 - options.vignetting * r * r);
    }
  }
  Color4f before = {};
  for (Color4f& sample : noise_) {
    Color4f fresh;
    const double luma = random.Normal();
    for (int c = 0; c < 4; ++c) fresh[c] = static_cast<float>(0.8 * luma + 0.6 * random.Normal());
    sample = 0.89f * fresh + 0.45f * before;  // squares sum to 1
    before = fresh;
  }
}

double ColorSensor::ExposureAt(double time_s) const {
  Random phase = random_.Fork(1);
  const double slow = std::sin(time_s * 0.57 + phase.Uniform(0, 6)),
               quick = std::sin(time_s * 1.46 + phase.Uniform(0, 6));
  const double interval = std::floor(time_s / options_.exposure_jump_period_s);
  Random jump = random_.Fork(1000 + static_cast<uint64_t>(static_cast<int64_t>(interval)));
  return (1 + options_.exposure_drift * (0.6 * slow + 0.4 * quick)) *
         (1 + options_.exposure_jump * jump.Uniform(-1, 1));
}

cv::Mat ColorSensor::Expose(const cv::Mat& color, double time_s, double light,
                            Random random) const {
  cv::Mat picture(color.size(), CV_8UC3);
  const float gain = static_cast<float>(light * ExposureAt(time_s));
  const float noise_level = static_cast<float>(options_.noise);
  for (int y = 0; y < color.rows; ++y) {
    const auto* in = reinterpret_cast<const Color4f*>(color.ptr(y));
    const float* fall_off = light_fall_off_.ptr<float>(y);
    const Color4f* noise = &noise_[random.Int(0, kNoiseSize - color.cols - 1)];
    uint8_t* out = picture.ptr<uint8_t>(y);
    for (int x = 0; x < color.cols; ++x) {
      const Color4f exposed = in[x] * (gain * fall_off[x]);
      // Read-out noise plus a part that grows with light (photon noise, linearised).
      const float deviation = noise_level * (0.7f + 0.0022f * exposed[1]);
      const Color4f level = exposed + noise[x] * deviation + 0.5f;
      for (int c = 0; c < 3; ++c)
        out[3 * x + c] = static_cast<uint8_t>(std::clamp(level[c], 0.f, 255.f));
    }
  }
  return picture;
}

}  // namespace msf
