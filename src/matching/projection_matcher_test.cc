#include "matching/projection_matcher.h"

#include <gtest/gtest.h>

#include "matching/point_projection.h"
#include "matching/test_features.h"

namespace msf {
namespace {

class ProjectionMatcherTest : public ::testing::Test {
 protected:
  // Looks for `descriptor` around (u, v), all levels.
  static ProjectionQuery Near(double u_px, double v_px, const Descriptor& descriptor) {
    return {.uv_px = {u_px, v_px}, .radius_px = 10, .max_level = 7, .descriptor = descriptor};
  }
  std::vector<int> Match(const std::vector<ProjectionQuery>& queries,
                         const ProjectionMatchOptions& options = {},
                         const std::vector<uint8_t>& taken = {}) {
    features_.features.BuildGrid(*Camera::Preset("simulated"));
    return MatchByProjection(features_.features, queries, options, taken);
  }
  TestFeatures features_;
};

TEST_F(ProjectionMatcherTest, FindsTheClosestDescriptorNearby) {
  features_.Add(100, 100, RandomDescriptor(1));
  features_.Add(105, 100, FlipBits(RandomDescriptor(2), 5));
  features_.Add(300, 100, RandomDescriptor(2));  // a perfect match, but elsewhere
  EXPECT_EQ(Match({Near(102, 100, RandomDescriptor(2))}), std::vector<int>{1});
  EXPECT_EQ(Match({Near(200, 100, RandomDescriptor(2))}), std::vector<int>{-1});
}

TEST_F(ProjectionMatcherTest, KeepsToTheDistanceLimit) {
  features_.Add(100, 100, FlipBits(RandomDescriptor(1), 50));
  EXPECT_EQ(Match({Near(100, 100, RandomDescriptor(1))}, {.max_distance = 50})[0], 0);
  EXPECT_EQ(Match({Near(100, 100, RandomDescriptor(1))}, {.max_distance = 49})[0], -1);
}

TEST_F(ProjectionMatcherTest, KeepsToTheLevels) {
  features_.Add(100, 100, RandomDescriptor(1), /*level=*/3);
  ProjectionQuery query = Near(100, 100, RandomDescriptor(1));
  query.min_level = 2;
  query.max_level = 3;
  EXPECT_EQ(Match({query})[0], 0);
  query.min_level = 4;
  query.max_level = 5;
  EXPECT_EQ(Match({query})[0], -1);
}

TEST_F(ProjectionMatcherTest, LeavesTakenFeaturesOut) {
  features_.Add(100, 100, RandomDescriptor(1));
  features_.Add(104, 100, FlipBits(RandomDescriptor(1), 20));
  EXPECT_EQ(Match({Near(100, 100, RandomDescriptor(1))}, {}, {1, 0})[0], 1);
}

TEST_F(ProjectionMatcherTest, ChecksTheVirtualRightImage) {
  features_.Add(100, 100, RandomDescriptor(1), 0, /*u_right_px=*/80);
  ProjectionQuery query = Near(100, 100, RandomDescriptor(1));
  query.u_right_px = 85;
  EXPECT_EQ(Match({query})[0], 0);
  query.u_right_px = 91;
  EXPECT_EQ(Match({query})[0], -1) << "11 px off, radius 10";
  features_.features.u_right_px[0] = -1;
  EXPECT_EQ(Match({query})[0], 0) << "without depth there is nothing to check";
}

TEST_F(ProjectionMatcherTest, TheRatioComparesFeaturesOfOneLevel) {
  features_.Add(100, 100, FlipBits(RandomDescriptor(1), 20), 2);
  features_.Add(104, 100, FlipBits(RandomDescriptor(1), 22), 2);
  const std::vector<ProjectionQuery> query = {Near(100, 100, RandomDescriptor(1))};
  EXPECT_EQ(Match(query, {.ratio = 1})[0], 0);
  EXPECT_EQ(Match(query, {.ratio = 0.8})[0], -1);
  features_.features.level[1] = 3;  // the same corner one level up is no rival
  EXPECT_EQ(Match(query, {.ratio = 0.8})[0], 0);
}

TEST_F(ProjectionMatcherTest, AFeatureGoesToTheClosestOfItsSuitors) {
  features_.Add(100, 100, RandomDescriptor(1));
  const auto far = Near(101, 100, FlipBits(RandomDescriptor(1), 30));
  const auto close = Near(99, 100, FlipBits(RandomDescriptor(1), 10));
  EXPECT_EQ(Match({far, close}), (std::vector<int>{-1, 0}));
  EXPECT_EQ(Match({close, far}), (std::vector<int>{0, -1}));
  EXPECT_EQ(Match({close, close}), (std::vector<int>{0, -1})) << "the first of equals";
}

class PointProjectionTest : public ::testing::Test {
 protected:
  PointProjectionTest() {
    point_.p_w = {0.2, 0.1, 2};
    point_.normal = point_.p_w.normalized();
    point_.max_distance_m = point_.p_w.norm() * levels_.scale(2);
    point_.min_distance_m = point_.max_distance_m / levels_.scale(7);
  }
  std::optional<ProjectedPoint> ProjectFrom(const Eigen::Vector3d& centre_w, double yaw_rad = 0) {
    const Eigen::Quaterniond R_wc(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitY()));
    return ViewProjector(Rigid3d(R_wc, centre_w).Inverse(), camera_, levels_)(point_);
  }
  const Camera camera_ = *Camera::Preset("simulated");
  const ScaleLevels levels_{8, 1.2};
  PointSnapshot point_;
};

TEST_F(PointProjectionTest, PredictsPlaceDisparityAndLevel) {
  const std::optional<ProjectedPoint> seen = ProjectFrom(Eigen::Vector3d::Zero());
  ASSERT_TRUE(seen);
  EXPECT_NEAR(seen->uv_px.x(), camera_.fx * 0.1 + camera_.cx, 1e-9);
  EXPECT_NEAR(seen->uv_px.y(), camera_.fy * 0.05 + camera_.cy, 1e-9);
  EXPECT_NEAR(seen->u_right_px, seen->uv_px.x() - camera_.bf / 2, 1e-9);
  EXPECT_NEAR(seen->view_cosine, 1, 1e-9);
  EXPECT_NEAR(seen->level, 2, 1);
  // From twice as near it looks larger: a higher level.
  EXPECT_GT(ProjectFrom(0.5 * point_.p_w)->level, seen->level);
}

// Undistorted, the image of a lens with barrel distortion reaches beyond its own rectangle.
TEST_F(PointProjectionTest, TheImageEndsWhereTheLensShowsNoMore) {
  Camera barrel = camera_;
  barrel.k1 = -0.2;
  point_.p_w = {-1.3, 0, 2};  // 341 px left of the middle, 319.5 px are half of the width
  point_.normal = point_.p_w.normalized();
  point_.max_distance_m = point_.p_w.norm() * levels_.scale(2);
  const Rigid3d here;
  EXPECT_FALSE(ViewProjector(here, camera_, levels_)(point_));
  EXPECT_TRUE(ViewProjector(here, barrel, levels_)(point_));
}

TEST_F(PointProjectionTest, LeavesOutWhatCannotBeSeen) {
  EXPECT_FALSE(ProjectFrom({0, 0, 3})) << "behind";
  EXPECT_FALSE(ProjectFrom({3, 0, 0})) << "beside the image";
  EXPECT_FALSE(ProjectFrom({0.2, 0.1, -3})) << "too far away to be recognised";
  EXPECT_FALSE(ProjectFrom(0.7 * point_.p_w)) << "too near";
  // From the side, 70 degrees off the direction it was seen from, looking at it.
  const double angle_rad = 70 * M_PI / 180;
  const Eigen::Vector3d from =
      point_.p_w - 2 * Eigen::Vector3d(std::sin(angle_rad), 0, std::cos(angle_rad));
  point_.normal = {0, 0, 1};
  EXPECT_FALSE(ProjectFrom(from, angle_rad));
  const double less_rad = 50 * M_PI / 180;
  EXPECT_TRUE(ProjectFrom(
      point_.p_w - 2 * Eigen::Vector3d(std::sin(less_rad), 0, std::cos(less_rad)), less_rad));
}

}  // namespace
}  // namespace msf
