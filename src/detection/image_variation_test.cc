#include "detection/image_variation.h"

#include <gtest/gtest.h>

namespace msf {
namespace {

// Black, with a white rectangle that is the only object.
LabeledPicture WhiteBox(int width, int height, const cv::Rect& box) {
  LabeledPicture picture{cv::Mat(height, width, CV_8UC3, cv::Scalar::all(0)), {}};
  picture.pixels(box).setTo(cv::Scalar::all(255));
  const auto f = [](int x) { return static_cast<float>(x); };
  picture.objects.push_back({3, {f(box.x), f(box.y), f(box.x + box.width), f(box.y + box.height)}});
  return picture;
}

// The smallest box around white pixels.
cv::Rect WhiteArea(const cv::Mat& pixels) {
  cv::Rect area;
  for (int y = 0; y < pixels.rows; ++y) {
    for (int x = 0; x < pixels.cols; ++x) {
      if (pixels.at<cv::Vec3b>(y, x)[0] > 200)
        area = area.empty() ? cv::Rect(x, y, 1, 1) : area | cv::Rect(x, y, 1, 1);
    }
  }
  return area;
}

TEST(Rotate, QuarterTurnMovesPixelsAndBoxAlike) {
  const LabeledPicture turned = Rotate(WhiteBox(60, 40, {10, 5, 20, 8}), 90);
  EXPECT_EQ(turned.pixels.size(), cv::Size(60, 60));
  ASSERT_EQ(turned.objects.size(), 1u);
  const ImageBox& box = turned.objects[0].box;
  const cv::Rect white = WhiteArea(turned.pixels);
  EXPECT_NEAR(box.x0, white.x, 0.01);
  EXPECT_NEAR(box.y0, white.y, 0.01);
  EXPECT_NEAR(box.width(), white.width, 0.01);
  EXPECT_NEAR(box.height(), white.height, 0.01);
  EXPECT_NEAR(box.width(), 8, 0.01);
  EXPECT_FALSE(turned.objects[0].ignored);
  EXPECT_EQ(turned.pixels.at<cv::Vec3b>(0, 0), cv::Vec3b(114, 114, 114));
}

TEST(Rotate, ZeroDegreesOnlyCentres) {
  const LabeledPicture same = Rotate(WhiteBox(60, 40, {10, 5, 20, 8}), 0);
  EXPECT_EQ(WhiteArea(same.pixels), cv::Rect(10, 15, 20, 8));
  EXPECT_NEAR(same.objects[0].box.y0, 15, 1e-4);
}

TEST(Rotate, ObjectsThatLeaveThePictureAreIgnored) {
  const LabeledPicture turned = Rotate(WhiteBox(60, 60, {0, 0, 6, 6}), 45);
  EXPECT_TRUE(turned.objects.empty() || turned.objects[0].ignored);
}

TEST(CutObject, EverySideCutsTheWantedPart) {
  const LabeledPicture picture = WhiteBox(60, 40, {10, 8, 20, 16});
  for (const ImageSide side :
       {ImageSide::kLeft, ImageSide::kTop, ImageSide::kRight, ImageSide::kBottom}) {
    const LabeledPicture cut = CutObject(picture, 0, 0.5, side);
    ASSERT_EQ(cut.objects.size(), 1u);
    EXPECT_NEAR(cut.objects[0].box.area(), 20 * 8, 0.01);
    const cv::Rect white = WhiteArea(cut.pixels);
    EXPECT_EQ(white.x, cut.objects[0].box.x0);
    EXPECT_EQ(white.y, cut.objects[0].box.y0);
    EXPECT_EQ(white.area(), 160);
    const bool at_border = white.x == 0 || white.y == 0 ||
                           white.x + white.width == cut.pixels.cols ||
                           white.y + white.height == cut.pixels.rows;
    EXPECT_TRUE(at_border);
  }
}

TEST(CutObject, OtherObjectsAreIgnored) {
  LabeledPicture picture = WhiteBox(60, 40, {10, 8, 20, 16});
  picture.objects.push_back({3, {40, 8, 50, 30}});
  picture.objects.push_back({3, {0, 0, 5, 5}});  // left of the cut: gone
  const LabeledPicture cut = CutObject(picture, 0, 0.5, ImageSide::kLeft);
  ASSERT_EQ(cut.objects.size(), 2u);
  EXPECT_FALSE(cut.objects[0].ignored);
  EXPECT_TRUE(cut.objects[1].ignored);
}

}  // namespace
}  // namespace msf
