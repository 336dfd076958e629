#include "tracking/trajectory_smoothing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace msf {
namespace {

const SmoothingOptions kWidths;
const SmoothingOptions kNone{.position_s = 0, .rotation_s = 0};

// A hand that swings once a second while it turns.
Rigid3d PoseAt(double time_s) {
  Vector6d twist;
  twist << 0.1 * std::sin(6.3 * time_s), 0, 0.05 * std::cos(6.3 * time_s), 0, 0.4 * time_s, 0;
  return Rigid3d::Exp(twist);
}

std::vector<ResolvedFrame> Swing(int count, double sigma) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0, sigma);
  std::vector<ResolvedFrame> frames(count);
  for (int i = 0; i < count; ++i) {
    Vector6d noise = Vector6d::Zero();
    if (sigma > 0) noise = noise.unaryExpr([&](double) { return normal(random); });
    frames[i].time_s = i / 30.0;
    frames[i].map_id = MapId(0);
    frames[i].T_wc = PoseAt(frames[i].time_s) * Rigid3d::Exp(noise);
  }
  return frames;
}

double Distance(const Rigid3d& a, const Rigid3d& b) { return (a.Inverse() * b).Log().norm(); }

double MeanError(const std::vector<ResolvedFrame>& frames) {
  double sum = 0;
  for (const ResolvedFrame& frame : frames) sum += Distance(*frame.T_wc, PoseAt(frame.time_s));
  return sum / static_cast<double>(frames.size());
}

TEST(SmoothTrajectory, TakesNoiseOutOfTheMotion) {
  const std::vector<ResolvedFrame> frames = Swing(300, 0.003);
  EXPECT_LT(MeanError(SmoothTrajectory(frames, kWidths)), 0.8 * MeanError(frames));
}

TEST(SmoothTrajectory, LeavesTheMotionOfAHand) {
  EXPECT_LT(MeanError(SmoothTrajectory(Swing(300, 0), kWidths)), 1e-4);
}

TEST(SmoothTrajectory, LeavesAllAsItWasWithAWidthOfZero) {
  const std::vector<ResolvedFrame> frames = Swing(30, 0.003);
  const std::vector<ResolvedFrame> same = SmoothTrajectory(frames, kNone);
  for (size_t i = 0; i < frames.size(); ++i)
    EXPECT_LT(Distance(*same[i].T_wc, *frames[i].T_wc), 1e-12) << i;
}

TEST(SmoothTrajectory, SmoothsPositionsAndRotationsApart) {
  const std::vector<ResolvedFrame> frames = Swing(60, 0.003);
  const std::vector<ResolvedFrame> moved = SmoothTrajectory(frames, {.rotation_s = 0});
  const std::vector<ResolvedFrame> turned = SmoothTrajectory(frames, {.position_s = 0});
  const Rigid3d &found = *frames[30].T_wc, &shifted = *moved[30].T_wc, &rotated = *turned[30].T_wc;
  EXPECT_LT(found.rotation().angularDistance(shifted.rotation()), 1e-9);
  EXPECT_GT((found.translation() - shifted.translation()).norm(), 1e-5);
  EXPECT_GT(found.rotation().angularDistance(rotated.rotation()), 1e-5);
  EXPECT_LT((found.translation() - rotated.translation()).norm(), 1e-12);
}

TEST(SmoothTrajectory, FitsOnlyWhatHangsTogether) {
  std::vector<ResolvedFrame> frames = Swing(30, 0.003);
  for (int i = 10; i < 30; ++i) frames[i].T_wc = Rigid3d::Exp(Vector6d::Ones()) * *frames[i].T_wc;
  for (int i = 10; i < 20; ++i) frames[i].map_id = MapId(1);
  frames[9].T_wc.reset();
  frames[22].T_wc.reset();  // leaves two frames between it and the other map
  const std::vector<ResolvedFrame> smooth = SmoothTrajectory(frames, kWidths);
  EXPECT_FALSE(smooth[9].T_wc.has_value());
  for (const size_t i : {8u, 10u, 19u, 23u})
    EXPECT_LT(Distance(*smooth[i].T_wc, *frames[i].T_wc), 0.02) << i;
  for (const size_t i : {20u, 21u})
    EXPECT_LT(Distance(*smooth[i].T_wc, *frames[i].T_wc), 1e-12) << i;
}

TEST(SmoothTrajectory, NeedsMoreFramesThanItFits) {
  const std::vector<ResolvedFrame> few = Swing(6, 0.003);
  const std::vector<ResolvedFrame> same = SmoothTrajectory(few, kWidths);
  for (size_t i = 0; i < few.size(); ++i)
    EXPECT_LT(Distance(*same[i].T_wc, *few[i].T_wc), 1e-12) << i;
  EXPECT_TRUE(SmoothTrajectory({}, kWidths).empty());
}

}  // namespace
}  // namespace msf
