#include "feature/even_distribution.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

namespace msf {
namespace {

constexpr int kWidth = 600, kHeight = 400;
const cv::Rect kArea(20, 30, kWidth, kHeight);

// Corners at distinct places; nine in ten in the left upper ninth.
std::vector<Corner> CrowdedCorners(int count) {
  std::mt19937 random(1);
  std::set<std::pair<int, int>> places;
  std::vector<Corner> corners;
  while (static_cast<int>(corners.size()) < count) {
    const bool crowd = random() % 10 != 0;
    const int x = static_cast<int>(random() % (crowd ? kWidth / 3 : kWidth));
    const int y = static_cast<int>(random() % (crowd ? kHeight / 3 : kHeight));
    if (!places.insert({x, y}).second) continue;
    corners.push_back({static_cast<int16_t>(kArea.x + x), static_cast<int16_t>(kArea.y + y),
                       static_cast<uint8_t>(10 + random() % 200)});
  }
  return corners;
}

std::set<std::pair<int, int>> Places(const std::vector<Corner>& corners) {
  std::set<std::pair<int, int>> places;
  for (const Corner& corner : corners) places.insert({corner.x, corner.y});
  return places;
}

TEST(EvenDistribution, GivesDistinctCornersAndAsManyAsAsked) {
  for (const int count : {1, 5, 20, 150, 399}) {
    for (const double even_share : {0.0, 0.5, 1.0}) {
      std::vector<Corner> corners = CrowdedCorners(400);
      const std::set<std::pair<int, int>> all = Places(corners);
      const std::vector<Corner> chosen = DistributeEvenly(kArea, count, even_share, corners);
      EXPECT_EQ(static_cast<int>(chosen.size()), count);
      EXPECT_EQ(Places(chosen).size(), chosen.size());
      for (const auto& place : Places(chosen)) EXPECT_TRUE(all.contains(place));
    }
  }
}

TEST(EvenDistribution, TakesAllWhenThereAreFew) {
  std::vector<Corner> corners = CrowdedCorners(50);
  EXPECT_EQ(DistributeEvenly(kArea, 200, 0.7, corners).size(), 50u);
  corners.clear();
  EXPECT_TRUE(DistributeEvenly(kArea, 200, 0.7, corners).empty());
  corners = CrowdedCorners(50);
  EXPECT_TRUE(DistributeEvenly(kArea, 0, 0.7, corners).empty());
}

TEST(EvenDistribution, TheCrowdDoesNotTakeIt) {
  std::vector<Corner> corners = CrowdedCorners(3000);
  const std::vector<Corner> chosen = DistributeEvenly(kArea, 200, 1, corners);
  const auto in_crowd = std::count_if(chosen.begin(), chosen.end(), [](const Corner& c) {
    return c.x < kArea.x + kWidth / 3 && c.y < kArea.y + kHeight / 3;
  });
  // The crowd is 91 % of the corners on 11 % of the area.
  EXPECT_LT(in_crowd, 90);
}

TEST(EvenDistribution, WithoutEvennessTheStrongestWin) {
  std::vector<Corner> corners = CrowdedCorners(1000);
  std::vector<Corner> sorted = corners;
  std::sort(sorted.begin(), sorted.end(),
            [](const Corner& a, const Corner& b) { return a.score > b.score; });
  const std::vector<Corner> chosen = DistributeEvenly(kArea, 100, 0, corners);
  for (const Corner& corner : chosen) EXPECT_GE(corner.score, sorted[100].score);
}

TEST(EvenDistribution, ManyCornersAtOnePlaceEnd) {
  std::vector<Corner> corners(100, Corner{50, 60, 30});
  EXPECT_EQ(Places(DistributeEvenly(kArea, 40, 1, corners)).size(), 1u);
}

}  // namespace
}  // namespace msf
