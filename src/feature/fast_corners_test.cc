#include "feature/fast_corners.h"

#include <gtest/gtest.h>

#include "feature/test_images.h"

namespace msf {
namespace {

// The definition, literally: the largest contrast at which 9 neighbours on the circle all exceed
// it.
int ScoreByDefinition(const cv::Mat& image, int x, int y) {
  constexpr int kCircle[16][2] = {{0, -3}, {1, -3},  {2, -2},  {3, -1}, {3, 0},  {3, 1},
                                  {2, 2},  {1, 3},   {0, 3},   {-1, 3}, {-2, 2}, {-3, 1},
                                  {-3, 0}, {-3, -1}, {-2, -2}, {-1, -3}};
  const int centre = image.at<uint8_t>(y, x);
  int best = 0;
  for (const int sign : {1, -1}) {
    for (int start = 0; start < 16; ++start) {
      int least = 255;
      for (int i = start; i < start + 9; ++i) {
        const int on_circle = image.at<uint8_t>(y + kCircle[i % 16][1], x + kCircle[i % 16][0]);
        least = std::min(least, sign * (on_circle - centre));
      }
      best = std::max(best, least);
    }
  }
  return best;
}

TEST(FastCorners, ScoresAgreeWithTheDefinition) {
  for (const int width : {7, 20, 38, 39, 70, 101}) {
    const cv::Mat image = TexturedImage(width, 40, width);
    const cv::Rect area(3, 3, width - 6, 34);
    cv::Mat scores(image.size(), CV_8UC1, cv::Scalar(0));
    ComputeFastScores(image, area, scores);
    for (int y = area.y; y < area.y + area.height; ++y) {
      for (int x = area.x; x < area.x + area.width; ++x) {
        ASSERT_EQ(scores.at<uint8_t>(y, x), ScoreByDefinition(image, x, y))
            << x << " " << y << " width " << width;
      }
    }
  }
}

TEST(FastCorners, PeaksExceedAllNeighboursAndTheThreshold) {
  cv::Mat scores(30, 50, CV_8UC1, cv::Scalar(0));
  scores.at<uint8_t>(10, 10) = 30;
  scores.at<uint8_t>(10, 11) = 29;
  scores.at<uint8_t>(20, 40) = 25;  // two equals: neither is a peak
  scores.at<uint8_t>(21, 41) = 25;
  scores.at<uint8_t>(5, 30) = 7;  // not above the threshold
  scores.at<uint8_t>(28, 48) = 8;
  std::vector<Corner> corners;
  FindScorePeaks(scores, {1, 1, 48, 28}, 7, corners);
  ASSERT_EQ(corners.size(), 2u);
  EXPECT_EQ(corners[0].x, 10);
  EXPECT_EQ(corners[0].y, 10);
  EXPECT_EQ(corners[0].score, 30);
  EXPECT_EQ(corners[1].x, 48);
  EXPECT_EQ(corners[1].y, 28);
}

TEST(FastCorners, WeakCornersSurviveOnlyWhereThereAreNoStrongOnes) {
  std::vector<Corner> corners = {{5, 5, 30}, {8, 8, 10}, {45, 5, 10}, {50, 8, 9}, {5, 75, 21}};
  KeepStrongPerCell({0, 0, 80, 80}, 35, 20, corners);
  ASSERT_EQ(corners.size(), 4u);
  EXPECT_EQ(corners[0].score, 30);
  EXPECT_EQ(corners[1].x, 45);
  EXPECT_EQ(corners[2].x, 50);
  EXPECT_EQ(corners[3].score, 21);
}

}  // namespace
}  // namespace msf
