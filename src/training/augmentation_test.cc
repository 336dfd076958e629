#include "training/augmentation.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

namespace msf {
namespace {

// A black image with one bright rectangle, which is its only object.
LabeledImage BrightRectangle(cv::Size size, cv::Rect object) {
  LabeledImage image{cv::Mat(size, CV_8UC3, cv::Scalar(0, 0, 0)), {}};
  cv::rectangle(image.pixels, object, cv::Scalar(255, 255, 255), cv::FILLED);
  image.objects.push_back({3, static_cast<float>(object.x), static_cast<float>(object.y),
                           static_cast<float>(object.br().x), static_cast<float>(object.br().y),
                           false});
  return image;
}

cv::Rect BrightPixels(const cv::Mat& pixels) {
  cv::Mat grey, points;
  cv::cvtColor(pixels, grey, cv::COLOR_BGR2GRAY);
  cv::findNonZero(grey > 180, points);
  return points.empty() ? cv::Rect() : cv::boundingRect(points);
}

AugmentationOptions GeometryOnly() {
  AugmentationOptions options;
  options.hue = options.saturation = options.value = options.blur = 0.0;
  options.min_visible = 0.0;
  options.turned_outline = kTurnedCorners;  // rectangles fill their boxes
  return options;
}

TEST(AugmentationTest, QuarterTurnMovesBoxesExactly) {
  // x' = 100 - y, y' = x: a quarter turn of a 100 pixel square.
  const cv::Matx23d turn(0, -1, 100, 1, 0, 0);
  const std::vector<VocObject> moved =
      TransformObjects({{0, 10, 20, 30, 60, false}}, turn, {100, 100}, 0.5);
  ASSERT_EQ(moved.size(), 1U);
  EXPECT_FLOAT_EQ(moved[0].x0, 40);
  EXPECT_FLOAT_EQ(moved[0].y0, 10);
  EXPECT_FLOAT_EQ(moved[0].x1, 80);
  EXPECT_FLOAT_EQ(moved[0].y1, 30);
}

TEST(AugmentationTest, HiddenObjectsLoseTheirLabel) {
  const cv::Matx23d shift(1, 0, -80, 0, 1, 0);
  const std::vector<VocObject> objects = {{0, 0, 0, 100, 50, false}};
  EXPECT_EQ(TransformObjects(objects, shift, {200, 200}, 0.1).size(), 1U);  // a fifth is left
  EXPECT_TRUE(TransformObjects(objects, shift, {200, 200}, 0.3).empty());
}

TEST(AugmentationTest, LabelsStayOnTheirPixels) {
  const std::vector<LabeledImage> images = {BrightRectangle({320, 240}, {100, 60, 90, 120})};
  for (double mosaic : {0.0, 1.0}) {
    AugmentationOptions options = GeometryOnly();
    options.mosaic = mosaic;
    for (int seed = 0; seed < 40; ++seed) {
      Random random(seed);
      const LabeledImage picture = MakeTrainingPicture(images, 0, 320, options, random);
      const cv::Rect bright = BrightPixels(picture.pixels);
      if (picture.objects.empty() || bright.empty()) continue;
      cv::Rect2f labels(picture.objects[0].x0, picture.objects[0].y0, 0, 0);
      for (const VocObject& o : picture.objects)
        labels |= cv::Rect2f(o.x0, o.y0, o.x1 - o.x0, o.y1 - o.y0);
      // Labels are hulls of rotated rectangles and may be larger where the border cuts; never
      // smaller than what is seen.
      EXPECT_LE(labels.x, bright.x + 2) << seed;
      EXPECT_LE(labels.y, bright.y + 2) << seed;
      EXPECT_GE(labels.br().x, bright.br().x - 2) << seed;
      EXPECT_GE(labels.br().y, bright.br().y - 2) << seed;
    }
  }
}

TEST(AugmentationTest, BorderCropCutsObjects) {
  const std::vector<LabeledImage> images = {BrightRectangle({320, 320}, {110, 110, 100, 100})};
  AugmentationOptions options = GeometryOnly();
  options.mosaic = 0.0;
  options.rotate_upright = 1.0;
  options.border_crop = 1.0;
  int at_border = 0;
  for (int seed = 0; seed < 20; ++seed) {
    Random random(seed);
    const LabeledImage picture = MakeTrainingPicture(images, 0, 320, options, random);
    ASSERT_EQ(picture.objects.size(), 1U);
    const VocObject& o = picture.objects[0];
    at_border += o.x0 == 0 || o.y0 == 0 || o.x1 == 320 || o.y1 == 320 ? 1 : 0;
  }
  EXPECT_EQ(at_border, 20);
}

TEST(AugmentationTest, SameSeedGivesTheSamePicture) {
  const std::vector<LabeledImage> images = {BrightRectangle({320, 240}, {100, 60, 90, 120}),
                                            BrightRectangle({200, 320}, {50, 50, 100, 200})};
  Random a(7), b(7), c(8);
  const LabeledImage first = MakeTrainingPicture(images, 0, 320, {}, a);
  const LabeledImage again = MakeTrainingPicture(images, 0, 320, {}, b);
  const LabeledImage other = MakeTrainingPicture(images, 0, 320, {}, c);
  EXPECT_EQ(cv::norm(first.pixels, again.pixels, cv::NORM_INF), 0.0);
  EXPECT_NE(cv::norm(first.pixels, other.pixels, cv::NORM_INF), 0.0);
}

TEST(AugmentationTest, SharesOutsideTheirRangeAreRefused) {
  AugmentationOptions options;
  EXPECT_TRUE(options.Check().ok());
  options.mosaic = 1.5;
  EXPECT_FALSE(options.Check().ok());
}

}  // namespace
}  // namespace msf
