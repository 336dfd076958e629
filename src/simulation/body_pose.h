// How a person holds the body at one time.
#pragma once

#include <Eigen/Core>
#include <array>

#include "simulation/random.h"
#include "simulation/walk_path.h"

namespace msf {

// Joint measures of a grown-up, m.
namespace body {
inline constexpr double kHipHeight = 0.90;  // standing, of the hip joints
inline constexpr double kHipOffset = 0.09;  // of a hip joint from the middle
inline constexpr double kAnkleHeight = 0.08;
inline constexpr double kThigh = 0.46, kShank = 0.46;
inline constexpr double kShoulderOffset = 0.19;
inline constexpr double kShoulderHeight = 0.47;  // above the hip joints
inline constexpr double kUpperArm = 0.29, kForearm = 0.26;
}  // namespace body

// Angles in rad. Side 0 is left, 1 is right.
struct BodyPose {
  Eigen::Vector2d place;    // of the pelvis on the floor, m
  Eigen::Vector2d heading;  // unit
  double hip_height_m = body::kHipHeight;
  double lean = 0;       // of the trunk, forward
  double twist = 0;      // of the shoulders, to the left
  double head_turn = 0;  // to the left
  double head_nod = 0;   // down
  std::array<Eigen::Vector3d, 2> ankles_w;
  std::array<double, 2> foot_pitch = {0, 0};  // toes down
  std::array<double, 2> arm_forward = {0, 0};
  std::array<double, 2> arm_out = {0.12, 0.12};
  std::array<double, 2> elbow_bend = {0.3, 0.3};
};

// The rhythms that tell two people apart.
struct Manner {
  explicit Manner(Random random);
  double step_m;
  double arm_swing;
  std::array<double, 6> phases{};
};

// A walker's pose; feet on the ground do not slide while the walk is at full speed.
BodyPose WalkingPose(const WalkPath& path, double time_s, const Manner& manner,
                     bool carries_something);
// Someone who sits on a chair of 0.46 m, talks and moves arms and head.
BodyPose SittingPose(const Eigen::Vector2d& place, const Eigen::Vector2d& heading, double time_s,
                     const Manner& manner);

}  // namespace msf
