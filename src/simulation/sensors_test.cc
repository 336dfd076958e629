#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <set>

#include "simulation/color_sensor.h"
#include "simulation/depth_sensor.h"

namespace msf {
namespace {

Camera TestCamera() { return *Camera::Preset("simulated"); }

// A flat wall at `z` metres that faces the camera.
RenderedView FlatView(double z) {
  const Camera camera = TestCamera();
  RenderedView view;
  view.depth_m = cv::Mat(camera.height, camera.width, CV_32FC1, cv::Scalar(z));
  view.cosine = cv::Mat(camera.height, camera.width, CV_32FC1, cv::Scalar(1));
  return view;
}

cv::Mat Measure(const DepthSensorOptions& options, const RenderedView& view) {
  return DepthSensor(options, TestCamera(), Random(1)).Measure(view, Random(2));
}

struct Spread {
  double mean_m, deviation_m;
};

Spread SpreadOf(const cv::Mat& depth) {
  cv::Scalar mean, deviation;
  cv::meanStdDev(depth.colRange(1, depth.cols - 1), mean, deviation);
  return {mean[0] / 5000, deviation[0] / 5000};
}

TEST(DepthSensor, NoiseGrowsWithTheSquareOfDistance) {
  DepthSensorOptions options;
  options.disparity_steps = 1e4;  // noise alone
  options.distortion_px = 0;
  options.farthest_m = 8;
  for (const double z : {0.8, 1.6, 3.2, 4.5}) {
    const Spread spread = SpreadOf(Measure(options, FlatView(z)));
    EXPECT_NEAR(spread.deviation_m, 0.0015 * z * z, 0.05 * 0.0015 * z * z + 1e-4) << z;
    EXPECT_NEAR(spread.mean_m, z, 1e-3 + 1e-4 * z * z) << z;
  }
}

TEST(DepthSensor, DisparityComesInEighthsOfAPixel) {
  const cv::Mat depth = Measure({}, FlatView(2.03));
  std::set<int> values;
  for (int y = 0; y < depth.rows; y += 3) {
    for (int x = 1; x < depth.cols - 1; x += 3) values.insert(depth.at<uint16_t>(y, x));
  }
  EXPECT_LT(values.size(), 9u);
  for (const int value : values) {
    if (value == 0) continue;
    const double eighths = 40 / (value / 5000.0) * 8;
    EXPECT_NEAR(eighths, std::round(eighths), 0.02);
  }
}

TEST(DepthSensor, DistortionIsSmoothFixedAndGrowsWithTheSquareOfDistance) {
  DepthSensorOptions options;
  options.disparity_steps = 1e4;
  options.noise_per_m = 0;
  options.distortion_px = 0.2;
  const cv::Mat near = Measure(options, FlatView(1)), far = Measure(options, FlatView(3));
  double largest = 0;
  for (int y = 4; y < 480; y += 59) {
    for (int x = 4; x < 640; x += 79) {
      const double near_error_m = near.at<uint16_t>(y, x) / 5000.0 - 1;
      const double far_error_m = far.at<uint16_t>(y, x) / 5000.0 - 3;
      EXPECT_NEAR(far_error_m, 9 * near_error_m, 0.004);
      EXPECT_NEAR(far.at<uint16_t>(y, x), far.at<uint16_t>(y, x + 1), 6);
      largest = std::max(largest, std::abs(far_error_m));
    }
  }
  EXPECT_NEAR(largest, 0.2 * 9 / 40, 0.012);
}

TEST(DepthSensor, NothingBeyondTheRange) {
  EXPECT_EQ(cv::countNonZero(Measure({}, FlatView(0.4))), 0);
  EXPECT_EQ(cv::countNonZero(Measure({}, FlatView(5.6))), 0);
  EXPECT_EQ(cv::countNonZero(Measure({}, FlatView(0))), 0);
}

TEST(DepthSensor, GrazingSurfacesFadeOut) {
  RenderedView view = FlatView(2);
  view.cosine.setTo(0.5);
  EXPECT_GT(cv::countNonZero(Measure({}, view)), 0.99 * 640 * 480);
  view.cosine.setTo(0.1);
  const int half_gone = cv::countNonZero(Measure({}, view));
  EXPECT_GT(half_gone, 0.2 * 640 * 480);
  EXPECT_LT(half_gone, 0.8 * 640 * 480);
  view.cosine.setTo(0.01);
  EXPECT_LT(cv::countNonZero(Measure({}, view)), 0.02 * 640 * 480);
}

TEST(DepthSensor, ShadowLiesOnOneSideOfANearThing) {
  RenderedView view = FlatView(3);
  view.depth_m.colRange(300, 360).setTo(1.0);
  const cv::Mat depth = Measure({}, view);
  const auto empty_columns = [&](int from, int to) {
    int empty = 0;
    for (int x = from; x < to; ++x) empty += cv::countNonZero(depth.col(x)) == 0;
    return empty;
  };
  // The width of the shadow is the difference of disparities: 40 - 13.3 px.
  EXPECT_NEAR(empty_columns(250, 300), 26, 2);
  EXPECT_EQ(empty_columns(362, 420), 0);
  EXPECT_GT(cv::countNonZero(depth.col(361)), 0);
}

TEST(DepthSensor, PerfectMeansRoundedOnly) {
  DepthSensorOptions options;
  options.perfect = true;
  const cv::Mat depth = Measure(options, FlatView(7.1234));
  EXPECT_EQ(depth.at<uint16_t>(7, 9), 35617);
  EXPECT_EQ(SpreadOf(depth).deviation_m, 0);
}

TEST(ColorSensor, NoiseHasTheGivenSpreadAndLightFallsOffToTheCorners) {
  const Camera camera = TestCamera();
  ColorSensorOptions options;
  options.exposure_drift = 0;
  const cv::Mat grey(camera.height, camera.width, CV_32FC4, cv::Scalar::all(128));
  const cv::Mat picture = ColorSensor(options, camera, Random(1)).Expose(grey, 0, 1, Random(2));
  cv::Scalar mean, deviation;
  cv::meanStdDev(picture(cv::Rect(300, 220, 40, 40)), mean, deviation);
  EXPECT_NEAR(mean[1], 128, 0.5);
  EXPECT_NEAR(deviation[1], 2.0 * (0.7 + 0.0022 * 128), 0.25);
  cv::meanStdDev(picture(cv::Rect(0, 0, 20, 20)), mean, deviation);
  EXPECT_NEAR(mean[1], 128 * (1 - 0.12 * 0.92), 1.5);
}

TEST(ColorSensor, ExposureDriftsSlowlyAndJumpsOnlyWhenAsked) {
  ColorSensorOptions options;
  const ColorSensor drifting(options, TestCamera(), Random(1));
  double low = 9, high = 0;
  for (int i = 0; i < 900; ++i) {
    const double t = i / 30.0;
    low = std::min(low, drifting.ExposureAt(t));
    high = std::max(high, drifting.ExposureAt(t));
    EXPECT_NEAR(drifting.ExposureAt(t + 1.0 / 30), drifting.ExposureAt(t), 0.006);
  }
  EXPECT_GT(high - low, 0.06);
  EXPECT_LE(high - low, 0.16);
  options.exposure_jump = 0.3;
  const ColorSensor jumping(options, TestCamera(), Random(1));
  double largest = 0;
  for (int i = 0; i < 900; ++i) {
    const double t = i / 30.0;
    largest = std::max(largest, std::abs(jumping.ExposureAt(t + 1.0 / 30) - jumping.ExposureAt(t)));
  }
  EXPECT_GT(largest, 0.1);
}

}  // namespace
}  // namespace msf
