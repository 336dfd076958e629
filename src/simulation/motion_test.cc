// Motion of the camera and of people.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "simulation/body_pose.h"
#include "simulation/camera_path.h"
#include "simulation/scenario.h"
#include "simulation/walk_path.h"

namespace msf {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

// from, from + step, ... below `to`.
std::vector<double> Times(double from, double to, double step) {
  std::vector<double> times(static_cast<size_t>((to - from) / step + 1e-9));
  for (size_t i = 0; i < times.size(); ++i) times[i] = from + step * static_cast<double>(i);
  return times;
}

struct Motion {
  double length_m = 0, fastest_m_s = 0, fastest_deg_s = 0, mean_deg_s = 0, roughest_m_s2 = 0;
};

// Sampled at 100 Hz.
Motion Observe(const CameraPath& path, double from_s, double to_s) {
  Motion motion;
  const double dt = 0.01;
  const std::vector<double> times = Times(from_s, to_s, dt);
  for (const double t : times) {
    const Rigid3d a = path.PoseAt(t), b = path.PoseAt(t + dt), c = path.PoseAt(t + 2 * dt);
    const double step_m = (b.translation() - a.translation()).norm();
    const double turn_deg = (a.Inverse() * b).Angle() / kDegree;
    motion.length_m += step_m;
    motion.fastest_m_s = std::max(motion.fastest_m_s, step_m / dt);
    motion.fastest_deg_s = std::max(motion.fastest_deg_s, turn_deg / dt);
    motion.mean_deg_s += turn_deg / dt;
    const Eigen::Vector3d bend = c.translation() - 2 * b.translation() + a.translation();
    motion.roughest_m_s2 = std::max(motion.roughest_m_s2, bend.norm() / (dt * dt));
  }
  motion.mean_deg_s /= static_cast<double>(times.size());
  return motion;
}

TEST(CameraPath, LooksAlongYawAndPitch) {
  const Rigid3d north = LookAlong({1, 2, 3, 90, 0});
  EXPECT_TRUE(
      (north * Eigen::Vector3d(0, 0, 1)).isApprox(Eigen::Vector3d(1, 3, 3), 1e-12));  // forward
  EXPECT_TRUE((north * Eigen::Vector3d(1, 0, 0))
                  .isApprox(Eigen::Vector3d(2, 2, 3), 1e-12));  // right is east
  EXPECT_TRUE(
      (north * Eigen::Vector3d(0, 1, 0)).isApprox(Eigen::Vector3d(1, 2, 2), 1e-12));  // down
  const Rigid3d down = LookAlong({0, 0, 0, 0, -30});
  EXPECT_NEAR((down * Eigen::Vector3d(0, 0, 1)).z(), -0.5, 1e-12);
}

TEST(CameraPath, HandHeldMotionIsSmoothAndAsFastAsAHand) {
  for (const char* name :
       {"xyz", "rpy", "halfsphere", "static", "walking_xyz", "walking_rpy", "walking_halfsphere"}) {
    const Scenario scenario = *LoadScenario(name);
    const Motion motion = Observe(CameraPath(scenario.path, Random(5)), 0, 25);
    EXPECT_LT(motion.fastest_m_s, 1.2) << name;
    EXPECT_LT(motion.fastest_deg_s, 90) << name;
    EXPECT_LT(motion.roughest_m_s2, 8) << name;
    EXPECT_GT(motion.length_m, 0.1) << name;
  }
}

TEST(CameraPath, LoopIsLongClosesAndIsWalkedCalmly) {
  const Scenario scenario = *LoadScenario("two_room_loop");
  const CameraPath path(scenario.path, Random(5));
  const Motion motion = Observe(path, 1, scenario.duration_s);
  EXPECT_LT(motion.fastest_m_s, 0.9);
  EXPECT_LT(motion.fastest_deg_s, 60);
  EXPECT_LT(motion.mean_deg_s, 25);
  // After a round it sees what the start saw.
  double seen_again_s = 0, length_m = 0, length_at_return_m = 0;
  for (const double t : Times(1, scenario.duration_s, 0.05)) {
    const Rigid3d now = path.PoseAt(t);
    length_m += (path.PoseAt(t + 0.05).translation() - now.translation()).norm();
    if (t < 10) continue;
    double nearest_m = 9;
    for (const double early : Times(0, 6, 0.1)) {
      const Rigid3d between = path.PoseAt(early).Inverse() * now;
      if (between.Angle() < 12 * kDegree)
        nearest_m = std::min(nearest_m, between.translation().norm());
    }
    if (nearest_m > 0.25) continue;
    if (seen_again_s == 0) length_at_return_m = length_m;
    seen_again_s += 0.05;
  }
  EXPECT_GT(length_at_return_m, 20);
  EXPECT_GT(seen_again_s, 2);
}

TEST(WalkPath, PausesAndComesRound) {
  const WalkPath path({{0, 0}, {3, 0, 2.0}, {3, 4}, {0, 4}}, true, 1.0, 0);
  const double arrival_s = 3.6;  // 3 m at 1 m/s plus 0.6 s of ramps
  EXPECT_NEAR(path.ProgressAt(arrival_s + 0.1).distance_m, 3, 1e-9);
  EXPECT_EQ(path.ProgressAt(arrival_s + 1).speed, 0);
  EXPECT_EQ(path.ProgressAt(arrival_s + 1.9).distance_m,
            path.ProgressAt(arrival_s + 0.1).distance_m);
  EXPECT_GT(path.ProgressAt(arrival_s + 3).speed, 0.99);
  // Stops belong to stations; the way home ends a round.
  const double round_s = 3.6 + 2 + 11.6;
  EXPECT_NEAR(path.ProgressAt(round_s + 1.5).distance_m, 14 + path.ProgressAt(1.5).distance_m,
              1e-9);
  EXPECT_LT((path.PlaceAt(14 + 1) - path.PlaceAt(1)).norm(), 1e-9);
}

TEST(WalkPath, RefusesWhatCannotBeWalked) {
  EXPECT_FALSE(WalkPath::Check({}, 1).ok());
  EXPECT_FALSE(WalkPath::Check({{0, 0}, {0, 0.01}}, 1).ok());
  EXPECT_FALSE(WalkPath::Check({{0, 0}, {1, 0}}, 0).ok());
}

TEST(BodyPose, FeetOnTheGroundDoNotSlide) {
  const WalkPath path({{0, 0}, {9, 0}}, false, 1.0, 0);
  const Manner manner(Random(4));
  const double dt = 0.01;
  for (int side = 0; side < 2; ++side) {
    int on_ground = 0, in_air = 0;
    for (const double t : Times(2, 7, dt)) {
      const Eigen::Vector3d now = WalkingPose(path, t, manner, false).ankles_w[side];
      const Eigen::Vector3d next = WalkingPose(path, t + dt, manner, false).ankles_w[side];
      const double speed_m_s = (next - now).head<2>().norm() / dt;
      if (now.z() < body::kAnkleHeight + 1e-6 && next.z() < body::kAnkleHeight + 1e-6) {
        ++on_ground;
        EXPECT_LT(speed_m_s, 1e-6) << "side " << side << " at " << t;
      } else {
        ++in_air;
      }
      EXPECT_LT(speed_m_s, 5);
      EXPECT_GE(now.z(), body::kAnkleHeight - 1e-9);
    }
    EXPECT_GT(on_ground, 100);
    EXPECT_GT(in_air, 100);
  }
}

TEST(BodyPose, LegsReachTheGroundAndOneFootAlwaysStands) {
  const WalkPath path({{0, 0}, {4, 0, 1.5}, {4, 3}, {0, 3}}, true, 1.0, 0);
  const Manner manner(Random(4));
  for (const double t : Times(0, 20, 0.05)) {
    const BodyPose pose = WalkingPose(path, t, manner, false);
    double lowest = 9;
    for (const Eigen::Vector3d& ankle : pose.ankles_w) {
      const Eigen::Vector3d pelvis(pose.place.x(), pose.place.y(), pose.hip_height_m);
      EXPECT_LT((ankle - pelvis).norm(), body::kThigh + body::kShank + 0.06) << t;
      lowest = std::min(lowest, ankle.z());
    }
    EXPECT_LT(lowest, body::kAnkleHeight + 0.055) << t;
  }
}

TEST(BodyPose, SomeoneSeatedStaysOnTheChair) {
  const Manner manner(Random(4));
  double moved = 0;
  const BodyPose first = SittingPose({1, 2}, {1, 0}, 0, manner);
  for (const double t : Times(0, 20, 0.1)) {
    const BodyPose pose = SittingPose({1, 2}, {1, 0}, t, manner);
    EXPECT_EQ(pose.place, Eigen::Vector2d(1, 2));
    EXPECT_EQ(pose.ankles_w[0], first.ankles_w[0]);
    moved = std::max(moved, std::abs(pose.arm_forward[0] - first.arm_forward[0]));
  }
  EXPECT_GT(moved, 0.2);
}

}  // namespace
}  // namespace msf
