#include "simulation/body_pose.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace msf {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kStanceShare = 0.56;  // of the cycle that a foot is on the ground

double SmoothStep(double t) {
  t = std::clamp(t, 0., 1.);
  return t * t * (3 - 2 * t);
}

Eigen::Vector2d LeftOf(const Eigen::Vector2d& heading) { return {-heading.y(), heading.x()}; }

struct Footfall {
  double distance_m;  // along the way
  double lift_m;
  double pitch;  // toes down, rad
};

// Where a foot is when the body has walked `distance_m`: planted half a stance ahead of the body,
// passed over, lifted, swung to the next place. `offset_m` shifts the two feet against each other.
Footfall FootAt(double distance_m, double offset_m, double step_m) {
  const double cycle_m = 2 * step_m;
  const double cycles = (distance_m - offset_m) / cycle_m + kStanceShare / 2;
  const double count = std::floor(cycles), share = cycles - count;
  const double planted_m = offset_m + count * cycle_m;
  if (share < kStanceShare) {
    const double heel_off = SmoothStep((share / kStanceShare - 0.65) / 0.35);
    return {planted_m, 0.05 * heel_off, 0.45 * heel_off};
  }
  const double swing = (share - kStanceShare) / (1 - kStanceShare);
  return {planted_m + cycle_m * SmoothStep(swing),
          0.05 * (1 - swing) + 0.07 * std::sin(kPi * swing),
          0.45 * std::cos(kPi * std::min(1., 1.25 * swing)) * (1 - swing)};
}

double Rhythm(double time_s, double frequency_hz, double phase) {
  return std::sin(2 * kPi * frequency_hz * time_s + phase) +
         0.5 * std::sin(2 * kPi * 2.3 * frequency_hz * time_s + 2 * phase);
}

}  // namespace

Manner::Manner(Random random)
    : step_m(random.Uniform(0.54, 0.6)), arm_swing(random.Uniform(0.35, 0.55)) {
  for (double& phase : phases) phase = random.Uniform(0, 2 * kPi);
}

BodyPose WalkingPose(const WalkPath& path, double time_s, const Manner& manner,
                     bool carries_something) {
  const WalkPath::Progress progress = path.ProgressAt(time_s);
  const double walking = SmoothStep(progress.speed);
  const double cycle = 2 * kPi * progress.distance_m / (2 * manner.step_m);
  BodyPose pose;
  pose.place = path.PlaceAt(progress.distance_m);
  pose.heading = path.HeadingAt(progress.distance_m);
  const double sway =
      0.02 * walking * std::cos(cycle) + 0.008 * std::sin(0.9 * time_s + manner.phases[0]);
  pose.hip_height_m += 0.012 * walking * std::cos(2 * cycle);
  pose.lean = 0.04 + 0.03 * walking;
  pose.twist = -0.12 * walking * std::sin(cycle);
  pose.head_turn = 0.25 * Rhythm(time_s, 0.11, manner.phases[1]);
  pose.head_nod = 0.08 * Rhythm(time_s, 0.17, manner.phases[2]);
  for (int side = 0; side < 2; ++side) {
    const double outward = (side == 0 ? 1 : -1) * body::kHipOffset;
    const Footfall foot = FootAt(progress.distance_m, side == 0 ? 0 : manner.step_m, manner.step_m);
    const Eigen::Vector2d step =
        path.PlaceAt(foot.distance_m) + outward * LeftOf(path.HeadingAt(foot.distance_m));
    const Eigen::Vector2d stand = pose.place + outward * LeftOf(pose.heading);
    const Eigen::Vector2d place = stand + walking * (step - stand);
    pose.ankles_w[side] = {place.x(), place.y(), body::kAnkleHeight + walking * foot.lift_m};
    pose.foot_pitch[side] = walking * foot.pitch;
    // The arm swings with the other leg.
    const double swing = (side == 0 ? 1 : -1) * std::sin(cycle);
    pose.arm_forward[side] =
        manner.arm_swing * walking * swing + 0.05 * Rhythm(time_s, 0.21, manner.phases[3 + side]);
    pose.elbow_bend[side] = 0.35 + 0.25 * walking * std::max(0., swing);
    if (!carries_something) continue;
    pose.arm_forward[side] = 0.55 + 0.02 * std::sin(cycle);
    pose.arm_out[side] = 0.05;
    pose.elbow_bend[side] = 1.15;
  }
  pose.place += sway * LeftOf(pose.heading);
  return pose;
}

BodyPose SittingPose(const Eigen::Vector2d& place, const Eigen::Vector2d& heading, double time_s,
                     const Manner& manner) {
  BodyPose pose;
  pose.place = place;
  pose.heading = heading;
  pose.hip_height_m = 0.55;
  pose.lean = 0.1 + 0.06 * Rhythm(time_s, 0.09, manner.phases[0]);
  pose.twist = 0.15 * Rhythm(time_s, 0.12, manner.phases[1]);
  pose.head_turn = 0.35 * Rhythm(time_s, 0.16, manner.phases[2]);
  pose.head_nod = 0.1 * Rhythm(time_s, 0.3, manner.phases[3]);
  for (int side = 0; side < 2; ++side) {
    const double outward = (side == 0 ? 1 : -1) * 1.3 * body::kHipOffset;
    const Eigen::Vector2d foot = place + 0.45 * heading + outward * LeftOf(heading);
    pose.ankles_w[side] = {foot.x(), foot.y(), body::kAnkleHeight};
    // Gestures come and go.
    const double gesture =
        SmoothStep(0.5 + 0.8 * std::sin(0.35 * time_s + manner.phases[4] + 2.1 * side));
    pose.arm_forward[side] =
        0.35 + gesture * (0.35 + 0.25 * Rhythm(time_s, 0.45, manner.phases[5] + side));
    pose.arm_out[side] =
        0.15 + gesture * 0.15 * (1 + Rhythm(time_s, 0.31, manner.phases[4] - side) / 1.5);
    pose.elbow_bend[side] = 1.2 + gesture * 0.35 * Rhythm(time_s, 0.6, manner.phases[3] + side);
  }
  return pose;
}

}  // namespace msf
