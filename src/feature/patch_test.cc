// Smoothing, refinement, orientation and depth of single points.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "feature/brief_pattern.h"
#include "feature/fast_corners.h"
#include "feature/image_pyramid.h"
#include "feature/point_depth.h"
#include "feature/score_peak.h"
#include "feature/smoothing.h"
#include "feature/steered_brief.h"
#include "feature/test_images.h"

namespace msf {
namespace {

TEST(Smoothing, AgreesWithFloatingPoint) {
  const cv::Mat image = TexturedImage(101, 60, 4);
  cv::Mat smoothed, expected;
  SmoothForDescriptors(image, smoothed);
  cv::GaussianBlur(image, expected, {7, 7}, 2, 2);
  const cv::Rect inside(3, 3, 95, 54);
  EXPECT_LE(cv::norm(smoothed(inside), expected(inside), cv::NORM_INF), 2);
  SmoothForCorners(image, smoothed);
  const cv::Mat kernel = (cv::Mat_<float>(1, 5) << 1, 4, 6, 4, 1) / 16;
  cv::sepFilter2D(image, expected, CV_8U, kernel, kernel);
  EXPECT_LE(cv::norm(smoothed(inside), expected(inside), cv::NORM_INF), 1);
}

TEST(Smoothing, KeepsWhiteWhite) {
  const cv::Mat white(30, 40, CV_8UC1, cv::Scalar(255));
  cv::Mat smoothed;
  SmoothForDescriptors(white, smoothed);
  EXPECT_EQ(cv::norm(smoothed(cv::Rect(3, 3, 34, 24)), white(cv::Rect(3, 3, 34, 24)), cv::NORM_INF),
            0);
}

TEST(ImagePyramid, SizesShrinkAndTinyImagesHaveFewLevels) {
  std::vector<cv::Mat> levels;
  BuildPyramid(TexturedImage(640, 480, 1), ScaleLevels(8, 1.2), levels);
  ASSERT_EQ(levels.size(), 8u);
  for (int level = 0; level < 8; ++level) {
    EXPECT_NEAR(levels[level].cols, 640 / std::pow(1.2, level), 0.5);
    EXPECT_NEAR(levels[level].rows, 480 / std::pow(1.2, level), 0.5);
  }
  BuildPyramid(cv::Mat(2, 1, CV_8UC1, cv::Scalar(0)), ScaleLevels(8, 1.2), levels);
  EXPECT_LT(levels.size(), 8u);
}

TEST(ScorePeak, FindsTheTopOfAHill) {
  for (const Eigen::Vector2f& top :
       {Eigen::Vector2f(0, 0), Eigen::Vector2f(0.3f, -0.2f), Eigen::Vector2f(-0.45f, 0.4f)}) {
    cv::Mat scores(9, 9, CV_8UC1);
    for (int y = 0; y < 9; ++y) {
      for (int x = 0; x < 9; ++x) {
        const double r2 = std::pow(x - 4 - top.x(), 2) + std::pow(y - 4 - top.y(), 2);
        scores.at<uint8_t>(y, x) = cv::saturate_cast<uint8_t>(220 - 12 * r2);
      }
    }
    EXPECT_LT((RefineScorePeak(scores, 4, 4) - top).norm(), 0.03);
  }
}

TEST(ScorePeak, WithoutAHillItStays) {
  EXPECT_EQ(RefineScorePeak(cv::Mat(5, 5, CV_8UC1, cv::Scalar(50)), 2, 2), Eigen::Vector2f::Zero());
  cv::Mat valley(5, 5, CV_8UC1, cv::Scalar(50));
  valley.at<uint8_t>(2, 2) = 10;
  EXPECT_EQ(RefineScorePeak(valley, 2, 2), Eigen::Vector2f::Zero());
}

TEST(PatchOrientation, PointsToTheBrightSide) {
  for (int degrees = -170; degrees <= 180; degrees += 25) {
    const double angle_rad = degrees * std::numbers::pi / 180;
    cv::Mat image(61, 61, CV_8UC1);
    for (int y = 0; y < 61; ++y) {
      for (int x = 0; x < 61; ++x) {
        const double along = (x - 30) * std::cos(angle_rad) + (y - 30) * std::sin(angle_rad);
        image.at<uint8_t>(y, x) = cv::saturate_cast<uint8_t>(128 + 3 * along);
      }
    }
    EXPECT_NEAR(std::remainder(PatchOrientation(image, 30, 30) - angle_rad, 2 * std::numbers::pi),
                0, 0.02);
  }
}

TEST(BriefPattern, TestsAreDistinctAndInsideTheDisc) {
  for (size_t i = 0; i < kBriefPattern.size(); ++i) {
    const BriefTest& a = kBriefPattern[i];
    EXPECT_LE(a.x0 * a.x0 + a.y0 * a.y0, kPatchRadiusPx * kPatchRadiusPx);
    EXPECT_LE(a.x1 * a.x1 + a.y1 * a.y1, kPatchRadiusPx * kPatchRadiusPx);
    for (size_t k = 0; k < i; ++k) {
      const BriefTest& b = kBriefPattern[k];
      EXPECT_FALSE(a.x0 == b.x0 && a.y0 == b.y0 && a.x1 == b.x1 && a.y1 == b.y1);
      EXPECT_FALSE(a.x0 == b.x1 && a.y0 == b.y1 && a.x1 == b.x0 && a.y1 == b.y0);
    }
  }
}

TEST(BriefPattern, BitsAreBalancedAndMostlyIndependent) {
  const cv::Mat image = TexturedImage(640, 480, 11);
  cv::Mat smoothed;
  SmoothForDescriptors(image, smoothed);
  std::vector<Descriptor> descriptors;
  for (int y = 20; y < 460; y += 12) {
    for (int x = 20; x < 620; x += 12) {
      descriptors.push_back(DescribePatch(smoothed, x, y, {0, 0}, PatchOrientation(image, x, y)));
    }
  }
  double sum = 0;
  int count = 0;
  for (size_t i = 0; i < descriptors.size(); i += 3) {
    for (size_t k = i + 300; k < descriptors.size(); k += 97)
      sum += DescriptorDistance(descriptors[i], descriptors[k]), ++count;
  }
  EXPECT_NEAR(sum / count, 128, 8);  // unrelated patches differ in half of the bits
}

TEST(DescribePatch, TurnsWithTheImageAndShiftsWithTheOffset) {
  const cv::Mat image = TexturedImage(101, 101, 9);
  cv::Mat turned, smoothed, smoothed_turned;
  cv::rotate(image, turned, cv::ROTATE_90_CLOCKWISE);
  SmoothForDescriptors(image, smoothed);
  SmoothForDescriptors(turned, smoothed_turned);
  const Descriptor upright = DescribePatch(smoothed, 50, 50, {0, 0}, 0.3f);
  // Clockwise in an image with y down is positive: x turns into y.
  const Descriptor clockwise = DescribePatch(smoothed_turned, 50, 50, {0, 0},
                                             0.3f + static_cast<float>(std::numbers::pi / 2));
  EXPECT_LE(DescriptorDistance(upright, clockwise), 12);
  EXPECT_EQ(DescribePatch(smoothed, 49, 50, {1, 0}, 0.3f), upright);
}

TEST(PointDepth, ReadsTheNearestPixel) {
  cv::Mat depth(4, 5, CV_16UC1, cv::Scalar(0));
  depth.at<uint16_t>(2, 3) = 7500;
  EXPECT_FLOAT_EQ(PointDepth(depth, {3.4f, 1.6f}, 5000), 1.5f);
  EXPECT_EQ(PointDepth(depth, {3.6f, 1.6f}, 5000), 0);
  for (const Eigen::Vector2f& outside :
       {Eigen::Vector2f(-1, 0), Eigen::Vector2f(5, 0), Eigen::Vector2f(0, 9)}) {
    EXPECT_EQ(PointDepth(depth, outside, 5000), 0);
  }
}

TEST(PointDepth, IsLookedUpWhereTheCameraWasWhenItTookTheDepth) {
  // A wall 2 m before the camera that took the depth image, far left 3 m; the colour camera is 0.4
  // m behind and turned.
  const Camera camera{.fx = 500, .fy = 500, .cx = 319.5, .cy = 239.5};
  cv::Mat depth(480, 640, CV_16UC1, cv::Scalar(10000));
  const Rigid3d straight(Eigen::Quaterniond::Identity(), {0, 0, -0.4});
  EXPECT_NEAR(PointDepthFromElsewhere(depth, {319.5f, 239.5f}, camera, straight), 2.4, 1e-4);
  depth.colRange(0, 300).setTo(cv::Scalar(15000));
  // Turned by 0.1 rad to the left the middle of the colour image shows what is 50 px left of the
  // middle.
  const Rigid3d turned(Eigen::Quaterniond(Eigen::AngleAxisd(-0.1, Eigen::Vector3d::UnitY())),
                       {0, 0, 0});
  EXPECT_NEAR(PointDepthFromElsewhere(depth, {319.5f, 239.5f}, camera, turned), 3 / std::cos(0.1),
              1e-3);
  EXPECT_NEAR(PointDepthFromElsewhere(depth, {319.5f, 239.5f}, camera, Rigid3d()), 2, 1e-4);
  depth.setTo(cv::Scalar(0));
  EXPECT_EQ(PointDepthFromElsewhere(depth, {319.5f, 239.5f}, camera, straight), 0);
}

}  // namespace
}  // namespace msf
