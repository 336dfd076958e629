#include "feature/rolling_shutter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace msf {
namespace {

Camera RollingCamera() {
  Camera camera = *Camera::Preset("simulated");
  camera.rolling_shutter_s = 0.025;
  return camera;
}

// What a moving camera sees of points, given in its coordinates at the time of the middle row.
FrameFeatures SeenByRows(const Camera& camera, const std::vector<Eigen::Vector3d>& points,
                         const Vector6d& velocity, bool with_depth) {
  FrameFeatures features;
  for (const Eigen::Vector3d& p : points) {
    // The row decides the time and the time the row.
    Eigen::Vector3d p_row = p;
    for (int i = 0; i < 20; ++i) {
      const double row_share = camera.Project(p_row).y() / (camera.height - 1) - 0.5;
      p_row = Rigid3d::Exp(velocity * (row_share * camera.rolling_shutter_s)) * p;
    }
    const Eigen::Vector2f uv_px = camera.Project(p_row).cast<float>();
    const float depth_m = with_depth ? static_cast<float>(p_row.z()) : 0.0f;
    features.image_px.push_back(uv_px);
    features.uv_px.push_back(uv_px);
    features.depth_m.push_back(depth_m);
    features.u_right_px.push_back(with_depth ? uv_px.x() - static_cast<float>(camera.bf) / depth_m
                                             : -1.0f);
    features.angle_rad.push_back(0);
    features.level.push_back(0);
    features.static_weight.push_back(1);
    features.descriptors.emplace_back();
  }
  features.BuildGrid(camera);
  return features;
}

std::vector<Eigen::Vector3d> PointsInView(const Camera& camera, double nearest_m,
                                          double farthest_m) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> u(40, 600), v(40, 440), z(nearest_m, farthest_m);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector2d uv_px(u(random), v(random));
    points.push_back(camera.Unproject(uv_px, z(random)));
  }
  return points;
}

Vector6d Velocity(double metres_per_s, double rad_per_s) {
  Vector6d velocity;
  velocity << metres_per_s * Eigen::Vector3d(0.6, -0.5, 0.62),
      rad_per_s * Eigen::Vector3d(0.7, 0.5, -0.5);
  return velocity;
}

TEST(UndoRollingShutter, PointsWithDepthComeWhereTheMiddleRowWouldShowThem) {
  const Camera camera = RollingCamera();
  const std::vector<Eigen::Vector3d> points = PointsInView(camera, 0.8, 4);
  const FrameFeatures seen = SeenByRows(camera, points, Velocity(0.5, 1), true);
  const FrameFeatures still = UndoRollingShutter(seen, camera, Velocity(0.5, 1));
  double largest_shift_px = 0;
  for (int i = 0; i < seen.size(); ++i) {
    const Eigen::Vector2f truth_px = camera.Project(points[i]).cast<float>();
    largest_shift_px = std::max<double>(largest_shift_px, (seen.uv_px[i] - truth_px).norm());
    EXPECT_LT((still.uv_px[i] - truth_px).norm(), 1e-2);
    EXPECT_NEAR(still.depth_m[i], points[i].z(), 1e-4);
    EXPECT_NEAR(still.u_right_px[i], truth_px.x() - camera.bf / points[i].z(), 2e-2);
    EXPECT_EQ(still.image_px[i], seen.image_px[i]) << "the image stays as it is";
  }
  EXPECT_GT(largest_shift_px, 5);
}

TEST(UndoRollingShutter, OfFarPointsWithoutDepthTheTurnIsUndone) {
  const Camera camera = RollingCamera();
  const std::vector<Eigen::Vector3d> points = PointsInView(camera, 40, 60);
  const FrameFeatures seen = SeenByRows(camera, points, Velocity(0.2, 1), false);
  const FrameFeatures still = UndoRollingShutter(seen, camera, Velocity(0.2, 1));
  for (int i = 0; i < seen.size(); ++i) {
    const Eigen::Vector2f truth_px = camera.Project(points[i]).cast<float>();
    EXPECT_LT((still.uv_px[i] - truth_px).norm(), 0.1);
    EXPECT_FALSE(still.HasDepth(i));
    EXPECT_LT(still.u_right_px[i], 0);
  }
}

TEST(UndoRollingShutter, PointsAreFoundWhereTheyAreMovedTo) {
  const Camera camera = RollingCamera();
  const std::vector<Eigen::Vector3d> points = PointsInView(camera, 0.8, 4);
  const FrameFeatures still = UndoRollingShutter(SeenByRows(camera, points, Velocity(0.5, 1), true),
                                                 camera, Velocity(0.5, 1));
  for (int i = 0; i < still.size(); ++i) {
    std::vector<int> found;
    still.FindInArea(camera.Project(points[i]), 0.5, 0, 7, found);
    EXPECT_TRUE(std::find(found.begin(), found.end(), i) != found.end());
  }
}

TEST(UndoRollingShutter, ACameraAtRestSeesWhatItSees) {
  const Camera camera = RollingCamera();
  const FrameFeatures seen =
      SeenByRows(camera, PointsInView(camera, 0.8, 4), Vector6d::Zero(), true);
  const FrameFeatures still = UndoRollingShutter(seen, camera, Vector6d::Zero());
  for (int i = 0; i < seen.size(); ++i) EXPECT_LT((still.uv_px[i] - seen.uv_px[i]).norm(), 1e-3);
}

}  // namespace
}  // namespace msf
