#include "tracking/camera_roll.h"

#include <gtest/gtest.h>

#include <cmath>

namespace msf {
namespace {

constexpr double kDegree = M_PI / 180;

// World coordinates with z up: the camera looks along `yaw`, down by `pitch`, and is rolled
// clockwise by `roll`, degrees.
Rigid3d Pose(double yaw, double pitch, double roll) {
  using Eigen::AngleAxisd, Eigen::Vector3d;
  Eigen::Matrix3d level;  // x right, y down, z forward, along the world's x axis
  level << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  const Eigen::Matrix3d R_wc = AngleAxisd(yaw * kDegree, Vector3d::UnitZ()).toRotationMatrix() *
                               level *
                               AngleAxisd(-pitch * kDegree, Vector3d::UnitX()).toRotationMatrix() *
                               AngleAxisd(roll * kDegree, Vector3d::UnitZ()).toRotationMatrix();
  return Rigid3d(R_wc, {1, 2, 3}).Inverse();
}

double TurnDegrees(const CameraRoll& roll) { return roll.TurnUpright_rad() / kDegree; }

TEST(CameraRoll, LevelCamerasAreNotTurned) {
  CameraRoll roll;
  EXPECT_EQ(roll.TurnUpright_rad(), 0) << "before the first pose";
  for (int i = 0; i < 200; ++i) {
    roll.Add(Pose(3 * i, 35 + 20 * std::sin(0.1 * i), 20 * std::sin(0.3 * i)), true);
    EXPECT_EQ(roll.TurnUpright_rad(), 0) << "frame " << i;
  }
}

TEST(CameraRoll, ARolledPictureIsTurnedBack) {
  for (const double angle : {60.0, 90.0, -120.0}) {
    CameraRoll roll;
    for (int i = 0; i < 100; ++i) roll.Add(Pose(0, 30, 0), true);
    for (int i = 0; i <= 20; ++i) roll.Add(Pose(0, 30, angle * i / 20), true);
    // A camera that was turned clockwise shows everything turned the other way.
    EXPECT_NEAR(TurnDegrees(roll), angle, 15) << "the way there tilts the mean a little";
  }
}

// A camera that looks down at a desk and has turned by 120 degrees: the first y axis would be 56
// degrees off now.
TEST(CameraRoll, PitchDoesNotMatterOnceTheCameraHasLookedAround) {
  CameraRoll roll;
  for (int i = 0; i < 300; ++i) roll.Add(Pose(0.4 * i, 40, 0), true);
  for (const double angle : {60.0, -70.0, 90.0, 180.0}) {
    CameraRoll now = roll;
    now.Add(Pose(120, 40, angle), true);
    EXPECT_NEAR(std::remainder(TurnDegrees(now) - angle, 360), 0, 12) << angle;
  }
}

TEST(CameraRoll, ACameraMountedOnItsSide) {
  CameraRoll roll(-M_PI / 2);
  EXPECT_NEAR(TurnDegrees(roll), -90, 1e-9) << "before the first pose, too";
  for (int i = 0; i < 200; ++i) {
    roll.Add(Pose(2 * i, 30, -90 + 10 * std::sin(0.2 * i)), true);
    EXPECT_NEAR(TurnDegrees(roll), -90 + 10 * std::sin(0.2 * i), 20) << "frame " << i;
  }
  roll.Add(Pose(400, 30, 0), true);
  EXPECT_EQ(roll.TurnUpright_rad(), 0);
}

TEST(CameraRoll, DownIsCarriedIntoANewWorld) {
  CameraRoll roll;
  for (int i = 0; i < 300; ++i) roll.Add(Pose(i, 20, 0), true);
  roll.Add(Pose(0, 20, 80), true);
  const double before = TurnDegrees(roll);
  EXPECT_NEAR(before, 80, 5);
  roll.Add(Rigid3d(), false);  // a new map: the world is this camera
  EXPECT_NEAR(TurnDegrees(roll), before, 3);
  // If that was wrong, since the camera was held otherwise meanwhile, it is unlearnt.
  for (int i = 0; i < 200; ++i) roll.Add(Rigid3d(), true);
  EXPECT_EQ(roll.TurnUpright_rad(), 0);
}

TEST(CameraRoll, NothingIsUprightStraightDown) {
  CameraRoll roll;
  for (int i = 0; i < 100; ++i) roll.Add(Pose(3 * i, 20, 0), true);
  roll.Add(Pose(0, 85, 100), true);
  EXPECT_EQ(roll.TurnUpright_rad(), 0);
}

}  // namespace
}  // namespace msf
