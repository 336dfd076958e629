#include "feature/orb_extractor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "feature/test_images.h"

namespace msf {
namespace {

FrameFeatures ExtractFrom(const cv::Mat& image, const OrbOptions& options = {}) {
  return OrbExtractor(options).Extract(FrameOf(image));
}

// How well the points of `a`, moved by the 2x3 affine map, are found again in `b`.
struct Repeated {
  int visible = 0;  // points of a that the map leaves well inside b
  int found =
      0;  // of these, with a mutual nearest descriptor (distance <= 60) within 3 px per level scale
  double median_error_px = 0;  // of the found, in level pixels
  double median_turn_error_rad = 0;
};

int Nearest(const Descriptor& descriptor, const std::vector<Descriptor>& others) {
  int best = -1, best_distance = 61;
  for (int i = 0; i < static_cast<int>(others.size()); ++i) {
    const int distance = DescriptorDistance(descriptor, others[i]);
    if (distance < best_distance) {
      best_distance = distance;
      best = i;
    }
  }
  return best;
}

double Median(std::vector<double> values) {
  if (values.empty()) return 1e9;
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

Repeated Compare(const FrameFeatures& a, const FrameFeatures& b, const cv::Mat& map,
                 double turn_rad, cv::Size size) {
  Repeated repeated;
  const ScaleLevels levels(8, 1.2);
  std::vector<double> errors, turns;
  for (int i = 0; i < a.size(); ++i) {
    const Eigen::Vector3d p(a.image_px[i].x(), a.image_px[i].y(), 1);
    const Eigen::Vector2d moved(
        map.at<double>(0, 0) * p.x() + map.at<double>(0, 1) * p.y() + map.at<double>(0, 2),
        map.at<double>(1, 0) * p.x() + map.at<double>(1, 1) * p.y() + map.at<double>(1, 2));
    if (moved.x() < 40 || moved.y() < 40 || moved.x() > size.width - 41 ||
        moved.y() > size.height - 41)
      continue;
    ++repeated.visible;
    const int j = Nearest(a.descriptors[i], b.descriptors);
    if (j < 0 || Nearest(b.descriptors[j], a.descriptors) != i) continue;
    const double scale = levels.scale(b.level[j]);
    const double error = (b.image_px[j].cast<double>() - moved).norm() / scale;
    if (error > 3) continue;
    ++repeated.found;
    errors.push_back(error);
    turns.push_back(
        std::abs(std::remainder(b.angle_rad[j] - a.angle_rad[i] - turn_rad, 2 * std::numbers::pi)));
  }
  repeated.median_error_px = Median(errors);
  repeated.median_turn_error_rad = Median(turns);
  return repeated;
}

// `image` turned by the angle (positive: from x towards y) and scaled about its centre.
Repeated CompareWithWarped(const cv::Mat& image, double turn_deg, double scale,
                           const OrbOptions& options = {}) {
  const cv::Point2f centre((image.cols - 1) / 2.0f, (image.rows - 1) / 2.0f);
  const cv::Mat map = cv::getRotationMatrix2D(centre, -turn_deg, scale);
  cv::Mat source = image, warped;
  if (scale < 1) cv::GaussianBlur(image, source, {0, 0}, 0.5 * std::sqrt(1 / (scale * scale) - 1));
  cv::warpAffine(source, warped, map, image.size(), cv::INTER_LINEAR, cv::BORDER_REFLECT);
  return Compare(ExtractFrom(image, options), ExtractFrom(warped, options), map,
                 turn_deg * std::numbers::pi / 180, image.size());
}

const cv::Mat& Texture() {
  static const cv::Mat image = TexturedImage(640, 480, 7);
  return image;
}

TEST(OrbExtractor, FindsPointsAgainAfterRotation) {
  for (const double turn_deg : {10.0, 45.0, 90.0, 160.0}) {
    const Repeated repeated = CompareWithWarped(Texture(), turn_deg, 1);
    EXPECT_GT(repeated.visible, 300) << turn_deg;
    EXPECT_GT(repeated.found, 0.45 * repeated.visible) << turn_deg;
    EXPECT_LT(repeated.median_error_px, 0.5) << turn_deg;
    EXPECT_LT(repeated.median_turn_error_rad, 0.06) << turn_deg;
  }
}

TEST(OrbExtractor, FindsPointsAgainAfterScaling) {
  for (const double scale : {0.6, 0.8, 1.3}) {
    const Repeated repeated = CompareWithWarped(Texture(), 0, scale);
    EXPECT_GT(repeated.visible, 150) << scale;
    EXPECT_GT(repeated.found, (scale < 0.7 ? 0.15 : 0.3) * repeated.visible) << scale;
    EXPECT_LT(repeated.median_error_px, 0.6) << scale;
  }
}

TEST(OrbExtractor, SubpixelPlacesAreMoreExact) {
  const double exact = CompareWithWarped(Texture(), 5, 1).median_error_px;
  const double rounded = CompareWithWarped(Texture(), 5, 1, {.subpixel = false}).median_error_px;
  EXPECT_LT(exact, 0.7 * rounded);
}

TEST(OrbExtractor, CoarseLevelsAreNotShifted) {
  // Left and right corners of squares are found as far inside the squares as each other, so their
  // mean distance from the edges is 0, unless a level is shifted: ignoring that pixels have their
  // centres half a pixel inside costs (scale - 1) / 2.
  cv::Mat image(480, 640, CV_8UC1, cv::Scalar(90));
  for (int y = 60; y < 420; y += 90) {
    for (int x = 60; x < 580; x += 90)
      cv::rectangle(image, cv::Rect(x, y, 45, 45), cv::Scalar(200), cv::FILLED);
  }
  const FrameFeatures features = ExtractFrom(image);
  for (int level = 0; level < 8; ++level) {
    double sum = 0;
    int count = 0;
    for (int i = 0; i < features.size(); ++i) {
      const double to_edge = std::remainder(features.image_px[i].x() + 0.5 - 60, 45);
      if (features.level[i] != level || std::abs(to_edge) > 8) continue;
      sum += to_edge;
      ++count;
    }
    ASSERT_GT(count, 40) << level;
    EXPECT_LT(std::abs(sum / count), 0.3) << level;
  }
}

TEST(OrbExtractor, GivesTheNumberAskedForWithQuotasPerLevel) {
  OrbExtractor extractor({});
  const RgbdFrame frame = FrameOf(Texture());
  const FrameFeatures features = extractor.Extract(frame);
  EXPECT_EQ(features.size(), 1000);
  EXPECT_EQ(extractor.Extract(frame, 300).size(), 300);
  const std::vector<int> quotas = LevelQuotas(extractor.levels(), 1000);
  std::vector<int> counts(8, 0);
  for (const uint8_t level : features.level) ++counts[level];
  EXPECT_EQ(counts, quotas);
}

TEST(OrbExtractor, QuotasShrinkWithTheScaleAndAddUp) {
  const ScaleLevels levels(8, 1.2);
  for (const int total : {1, 7, 100, 1000, 1500}) {
    const std::vector<int> quotas = LevelQuotas(levels, total);
    int sum = 0;
    for (const int quota : quotas) sum += quota;
    EXPECT_EQ(sum, total);
  }
  const std::vector<int> quotas = LevelQuotas(levels, 1000);
  for (int level = 1; level < 8; ++level) EXPECT_NEAR(quotas[level - 1] / 1.2, quotas[level], 1.5);
}

TEST(OrbExtractor, PointsKeepTheBorderAndFillEveryPart) {
  const FrameFeatures features = ExtractFrom(Texture());
  std::vector<int> per_part(16, 0);
  for (const Eigen::Vector2f& p : features.image_px) {
    EXPECT_GE(p.x(), 18);
    EXPECT_GE(p.y(), 18);
    EXPECT_LE(p.x(), 640 - 19);
    EXPECT_LE(p.y(), 480 - 19);
    ++per_part[static_cast<int>(p.y()) / 120 * 4 + static_cast<int>(p.x()) / 160];
  }
  for (const int count : per_part) EXPECT_GT(count, 25);
}

TEST(OrbExtractor, WeakTextureGetsPointsBesideStrong) {
  // Left: full contrast; right: a tenth of it.
  cv::Mat image = Texture().clone();
  cv::Mat right = image.colRange(320, 640);
  right.convertTo(right, CV_8U, 0.15, 110);
  const FrameFeatures features = ExtractFrom(image);
  int on_right = 0;
  for (const Eigen::Vector2f& p : features.image_px) on_right += p.x() > 330;
  EXPECT_GT(on_right, 150);
}

TEST(OrbExtractor, ImagesWithoutTextureGiveNoPoints) {
  for (const int grey : {0, 128, 255}) {
    const FrameFeatures features = ExtractFrom(cv::Mat(480, 640, CV_8UC1, cv::Scalar(grey)));
    EXPECT_EQ(features.size(), 0);
    std::vector<int> found;
    features.FindInArea({320, 240}, 100, 0, 7, found);
    EXPECT_TRUE(found.empty());
  }
}

TEST(OrbExtractor, AnySizeOfImageWorks) {
  OrbExtractor extractor({});
  for (const cv::Size size :
       {cv::Size(1, 1), cv::Size(5, 300), cv::Size(38, 38), cv::Size(39, 39), cv::Size(41, 80),
        cv::Size(127, 65), cv::Size(640, 480), cv::Size(1001, 333)}) {
    const FrameFeatures features =
        extractor.Extract(FrameOf(TexturedImage(size.width, size.height, 3)));
    EXPECT_LE(features.size(), 1000);
    if (size.area() > 100000) {
      EXPECT_GT(features.size(), 500);
    }
  }
}

TEST(OrbExtractor, ColourAndGreyAgreeAndRepeatThemselves) {
  cv::Mat colour;
  cv::cvtColor(Texture(), colour, cv::COLOR_GRAY2BGR);
  OrbExtractor extractor({});
  const FrameFeatures first = extractor.Extract(FrameOf(colour));
  extractor.Extract(FrameOf(TexturedImage(320, 240, 1)));  // leaves other content in the buffers
  const FrameFeatures second = extractor.Extract(FrameOf(Texture()));
  EXPECT_EQ(first.descriptors, second.descriptors);
  EXPECT_EQ(first.uv_px, second.uv_px);
  EXPECT_EQ(first.angle_rad, second.angle_rad);
}

TEST(OrbExtractor, LeavesTheFramesAsTheyAre) {
  OrbExtractor extractor({});
  const RgbdFrame grey = FrameOf(Texture().clone());
  extractor.Extract(grey);
  cv::Mat colour(Texture().size(), CV_8UC3, cv::Scalar(1, 2, 3));
  extractor.Extract(FrameOf(colour));  // must not land in the pixels of the frame before
  EXPECT_EQ(cv::norm(grey.color, Texture(), cv::NORM_INF), 0);
}

TEST(OrbExtractor, DescriptorsStandBrightnessAndContrast) {
  cv::Mat dimmed;
  Texture().convertTo(dimmed, CV_8U, 0.6, 30);
  const cv::Mat identity = (cv::Mat_<double>(2, 3) << 1, 0, 0, 0, 1, 0);
  const Repeated repeated =
      Compare(ExtractFrom(Texture()), ExtractFrom(dimmed), identity, 0, Texture().size());
  EXPECT_GT(repeated.found, 0.7 * repeated.visible);
  EXPECT_LT(repeated.median_error_px, 0.1);
}

TEST(OrbExtractor, DepthAndVirtualStereo) {
  RgbdFrame frame = FrameOf(Texture());
  frame.depth.colRange(0, 320).setTo(cv::Scalar(0));
  const FrameFeatures features = OrbExtractor({}).Extract(frame);
  int with_depth = 0;
  for (int i = 0; i < features.size(); ++i) {
    EXPECT_EQ(features.static_weight[i], 1.0f);
    if (features.image_px[i].x() < 319) {
      EXPECT_FALSE(features.HasDepth(i));
      EXPECT_LT(features.u_right_px[i], 0);
    } else if (features.image_px[i].x() > 320) {
      ++with_depth;
      EXPECT_FLOAT_EQ(features.depth_m[i], 2);
      EXPECT_NEAR(features.u_right_px[i], features.uv_px[i].x() - frame.camera->bf / 2, 1e-3);
    }
  }
  EXPECT_GT(with_depth, 200);
}

TEST(OrbExtractor, PointsAreUndistorted) {
  RgbdFrame frame = FrameOf(Texture());
  frame.camera = std::make_shared<const Camera>(*Camera::Preset("tum_fr1"));
  const FrameFeatures features = OrbExtractor({}).Extract(frame);
  for (int i = 0; i < features.size(); i += 50) {
    const Eigen::Vector2d distorted = frame.camera->Distort(features.uv_px[i].cast<double>());
    EXPECT_LT((distorted - features.image_px[i].cast<double>()).norm(), 1e-2);
  }
}

TEST(OrbExtractor, BadOptionsAndFramesAreRefused) {
  EXPECT_TRUE(OrbOptions{}.Check().ok());
  EXPECT_FALSE(OrbOptions{.num_features = 0}.Check().ok());
  for (const double factor : {-1.2, 1.0, 4.5, std::nan("")})
    EXPECT_FALSE(OrbOptions{.scale_factor = factor}.Check().ok()) << factor;
  EXPECT_FALSE((OrbOptions{.fast_threshold = 5, .min_fast_threshold = 7}.Check().ok()));
  EXPECT_FALSE(OrbOptions{.even_share = 1.5}.Check().ok());
  EXPECT_THROW(OrbExtractor({.num_levels = 0}), ContractViolation);
  RgbdFrame frame = FrameOf(Texture());
  frame.depth = cv::Mat(10, 10, CV_16UC1);
  EXPECT_THROW(OrbExtractor({}).Extract(frame), ContractViolation);
}

TEST(FrameFeatures, SearchInTheGridEqualsSearchByBruteForce) {
  RgbdFrame frame = FrameOf(Texture());
  frame.camera = std::make_shared<const Camera>(*Camera::Preset("tum_fr1"));
  const FrameFeatures features = OrbExtractor({}).Extract(frame);
  std::mt19937 random(2);
  for (int trial = 0; trial < 300; ++trial) {
    const Eigen::Vector2d centre(static_cast<double>(random() % 760) - 60,
                                 static_cast<double>(random() % 600) - 60);
    const double radius = 1 + random() % 80;
    const int min_level = static_cast<int>(random() % 8),
              max_level = min_level + static_cast<int>(random() % 3);
    std::vector<int> found, expected;
    features.FindInArea(centre, radius, min_level, max_level, found);
    for (int i = 0; i < features.size(); ++i) {
      const bool near = (features.uv_px[i] - centre.cast<float>()).cwiseAbs().maxCoeff() <
                        static_cast<float>(radius);
      if (near && features.level[i] >= min_level && features.level[i] <= max_level)
        expected.push_back(i);
    }
    std::sort(found.begin(), found.end());
    EXPECT_EQ(found, expected);
  }
}

}  // namespace
}  // namespace msf
