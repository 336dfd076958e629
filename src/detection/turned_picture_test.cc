#include "detection/turned_picture.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

namespace msf {
namespace {

// A grey picture with one white box.
cv::Mat PictureOf(const ImageBox& box, cv::Size size) {
  cv::Mat picture(size, CV_8UC3, cv::Scalar::all(60));
  cv::rectangle(picture,
                cv::Rect(cv::Point(static_cast<int>(box.x0), static_cast<int>(box.y0)),
                         cv::Point(static_cast<int>(box.x1), static_cast<int>(box.y1))),
                cv::Scalar::all(255), cv::FILLED);
  return picture;
}

// Around all that is bright.
ImageBox BrightBox(const cv::Mat& picture) {
  cv::Mat grey;
  cv::cvtColor(picture, grey, cv::COLOR_BGR2GRAY);
  const cv::Rect box = cv::boundingRect(grey > 180);
  return {static_cast<float>(box.x), static_cast<float>(box.y), static_cast<float>(box.br().x),
          static_cast<float>(box.br().y)};
}

void ExpectNear(const ImageBox& a, const ImageBox& b, float tolerance) {
  EXPECT_NEAR(a.x0, b.x0, tolerance);
  EXPECT_NEAR(a.y0, b.y0, tolerance);
  EXPECT_NEAR(a.x1, b.x1, tolerance);
  EXPECT_NEAR(a.y1, b.y1, tolerance);
}

TEST(TurnedPicture, QuarterTurnsAreClockwiseAndBoxesComeBackExactly) {
  const ImageBox box{40, 60, 100, 400};  // near the left border
  const cv::Mat picture = PictureOf(box, {640, 480});
  const TurnedPicture clockwise(picture, CV_PI / 2, {416, 320});
  ASSERT_EQ(clockwise.pixels().size(), cv::Size(416, 320));
  // What was left is above: 640 pixels become 320.
  ExpectNear(BrightBox(clockwise.pixels()), {208 - 80, 20, 208 + 90, 50}, 1.5f);
  ExpectNear(clockwise.ToImage(BrightBox(clockwise.pixels())), box, 3);
  const TurnedPicture back(picture, -CV_PI / 2, {416, 320});
  EXPECT_GT(BrightBox(back.pixels()).y0, 200);
  ExpectNear(back.ToImage(BrightBox(back.pixels())), box, 3);
}

TEST(TurnedPicture, OtherTurnsGiveABoxAroundTheObject) {
  // A disc: what it fills of its box turned back is between the ellipse and all.
  cv::Mat picture(480, 640, CV_8UC3, cv::Scalar::all(60));
  cv::circle(picture, {300, 200}, 80, cv::Scalar::all(255), cv::FILLED);
  for (const double degrees : {-60, -30, 30, 60, 135}) {
    const TurnedPicture turned(picture, degrees * CV_PI / 180, {416, 320});
    const ImageBox box = turned.ToImage(BrightBox(turned.pixels()));
    EXPECT_NEAR((box.x0 + box.x1) / 2, 300, 3) << degrees;
    EXPECT_NEAR((box.y0 + box.y1) / 2, 200, 3) << degrees;
    EXPECT_GT(box.width(), 158) << degrees;
    EXPECT_LT(box.width(), 2 * 80 * 1.2) << degrees;
  }
}

TEST(TurnedPicture, BoxesEndAtTheBorderOfTheImage) {
  const TurnedPicture turned(PictureOf({0, 0, 9, 9}, {640, 480}), CV_PI / 4, {416, 320});
  ExpectNear(turned.ToImage({-500, -500, 900, 900}), {0, 0, 640, 480}, 1e-3f);
}

TEST(TurnedPicture, GreyPicturesAndSinglePixelsToo) {
  EXPECT_EQ(TurnedPicture(cv::Mat(48, 64, CV_8UC1, cv::Scalar(7)), 1, {32, 32}).pixels().type(),
            CV_8UC1);
  EXPECT_EQ(TurnedPicture(cv::Mat(1, 1, CV_8UC3, cv::Scalar()), 1, {1, 1}).pixels().size(),
            cv::Size(1, 1));
}

}  // namespace
}  // namespace msf
