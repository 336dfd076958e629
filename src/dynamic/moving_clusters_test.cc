#include "dynamic/moving_clusters.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

namespace msf {
namespace {

using Clusters = std::vector<std::vector<int>>;

// Nine points, 20 px apart, whose first is at (x, y).
void AddGrid(float x, float y, float depth_m, bool moves, std::vector<TestedPoint>& points) {
  for (int i = 0; i < 9; ++i) {
    const int column = i % 3, row = i / 3;
    const Eigen::Vector2f px(x + 20 * static_cast<float>(column), y + 20 * static_cast<float>(row));
    points.push_back({px, depth_m, moves});
  }
}

std::vector<int> Range(int begin, int end) {
  std::vector<int> range(end - begin);
  std::iota(range.begin(), range.end(), begin);
  return range;
}

TEST(MovingClusters, NeighboursThatMoveBelongTogether) {
  std::vector<TestedPoint> points;
  AddGrid(100, 100, 2, true, points);
  AddGrid(300, 100, 2, false, points);
  EXPECT_EQ(FindMovingClusters(points, {}), Clusters{Range(0, 9)});
}

TEST(MovingClusters, NoPointsNoClusters) { EXPECT_TRUE(FindMovingClusters({}, {}).empty()); }

TEST(MovingClusters, AFewPointsAreNone) {
  std::vector<TestedPoint> points;
  AddGrid(100, 100, 2, true, points);
  points.pop_back();
  EXPECT_EQ(FindMovingClusters(points, {}).size(), 1u);
  points.pop_back();
  EXPECT_TRUE(FindMovingClusters(points, {}).empty());
}

TEST(MovingClusters, DistanceSeparates) {
  std::vector<TestedPoint> points;
  AddGrid(100, 100, 2, true, points);
  AddGrid(180, 100, 2, true, points);  // 40 px from the first
  Clusters clusters = FindMovingClusters(points, {});
  std::sort(clusters.begin(), clusters.end());
  EXPECT_EQ(clusters, (Clusters{Range(0, 9), Range(9, 18)}));
  ObjectTrackOptions options;
  options.cluster_px = 41;
  EXPECT_EQ(FindMovingClusters(points, options), Clusters{Range(0, 18)});
}

TEST(MovingClusters, DepthSeparates) {
  std::vector<TestedPoint> points;
  AddGrid(100, 100, 2, true, points);
  AddGrid(105, 105, 3, true, points);
  EXPECT_EQ(FindMovingClusters(points, {}).size(), 2u);
}

TEST(MovingClusters, PointsWithoutDepthJoinTheirNeighbours) {
  std::vector<TestedPoint> points;
  AddGrid(100, 100, 2, true, points);
  points[4].depth_m = points[7].depth_m = 0;
  EXPECT_EQ(FindMovingClusters(points, {}), Clusters{Range(0, 9)});
}

TEST(MovingClusters, AmongMorePointsThatStandStillTheyAreNone) {
  std::vector<TestedPoint> points;
  AddGrid(100, 100, 2, true, points);
  AddGrid(100, 100, 2, false, points);
  EXPECT_EQ(FindMovingClusters(points, {}).size(), 1u) << "half of them move";
  points.push_back({{120, 120}, 2, false});
  EXPECT_TRUE(FindMovingClusters(points, {}).empty());
}

TEST(MovingClusters, WhatStandsStillFarBehindDoesNotMatter) {
  std::vector<TestedPoint> points;
  AddGrid(100, 100, 2, true, points);
  AddGrid(100, 100, 4, false, points);
  AddGrid(105, 105, 4, false, points);
  EXPECT_EQ(FindMovingClusters(points, {}), Clusters{Range(0, 9)});
}

}  // namespace
}  // namespace msf
