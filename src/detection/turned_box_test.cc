#include "detection/turned_box.h"

#include <gtest/gtest.h>

#include <cmath>

namespace msf {
namespace {

cv::Matx23d Turn(double degrees) {
  const double angle = degrees * CV_PI / 180, c = std::cos(angle), s = std::sin(angle);
  return {c, -s, 50, s, c, 20};
}

TEST(TurnBox, QuarterTurnSwapsSidesHoweverTheBoxIsFilled) {
  for (const double q : {kTurnedCorners, 1.5, kTurnedOutline}) {
    const ImageBox turned = TurnBox({-10, -4, 10, 4}, Turn(90), q);
    EXPECT_NEAR(turned.x0, 46, 1e-4);
    EXPECT_NEAR(turned.y0, 10, 1e-4);
    EXPECT_NEAR(turned.x1, 54, 1e-4);
    EXPECT_NEAR(turned.y1, 30, 1e-4);
  }
}

TEST(TurnBox, CornersAndEllipseByHand) {
  // A square of side 2 by 45 degrees: its corners reach sqrt(2), a circle in it still 1.
  EXPECT_NEAR(TurnBox({-1, -1, 1, 1}, Turn(45), kTurnedCorners).width(), 2 * std::sqrt(2.0), 1e-5);
  EXPECT_NEAR(TurnBox({-1, -1, 1, 1}, Turn(45), kTurnedOutline).width(), 2, 1e-5);
  // Between the two for what is between the two.
  const float rounded = TurnBox({-1, -1, 1, 1}, Turn(45), 1.5).width();
  EXPECT_GT(rounded, 2.1);
  EXPECT_LT(rounded, 2.7);
}

TEST(TurnBox, EllipseHoldsEveryPointOfTheEllipse) {
  const ImageBox box{10, 20, 40, 100};
  const cv::Matx23d map = Turn(33);
  const ImageBox turned = TurnBox(box, map, kTurnedOutline);
  float most_x = -1e9F, least_y = 1e9F;
  for (int i = 0; i < 3600; ++i) {
    const double t = i * CV_PI / 1800;
    const cv::Vec2d p = map * cv::Vec3d(25 + 15 * std::cos(t), 60 + 40 * std::sin(t), 1);
    most_x = std::max(most_x, static_cast<float>(p[0]));
    least_y = std::min(least_y, static_cast<float>(p[1]));
  }
  EXPECT_NEAR(turned.x1, most_x, 1e-3);
  EXPECT_NEAR(turned.y0, least_y, 1e-3);
}

}  // namespace
}  // namespace msf
