#include "tracking/stamp_lag.h"

#include <gtest/gtest.h>

namespace msf {
namespace {

constexpr double kTurn_per_s = 0.7, kSpeed_m_s = 0.4;

// On a circle.
Rigid3d PoseAt(double time_s) {
  Vector6d twist;
  twist << kSpeed_m_s, 0, 0, 0, 0, kTurn_per_s;
  return Rigid3d::Exp(twist * time_s);
}

ResolvedFrame FrameAt(double time_s, double lag_s) {
  ResolvedFrame frame;
  frame.time_s = time_s;
  frame.T_wc = PoseAt(time_s - lag_s);
  frame.map_id = MapId(0);
  return frame;
}

double Distance(const Rigid3d& a, const Rigid3d& b) { return (a.Inverse() * b).Log().norm(); }

class UndoStampLagTest : public testing::TestWithParam<double> {};

TEST_P(UndoStampLagTest, GivesPosesAtTheTimeStamps) {
  std::vector<ResolvedFrame> frames(5);
  for (int i = 0; i < 5; ++i) frames[i] = FrameAt(i / 30.0, GetParam());
  const std::vector<ResolvedFrame> moved = UndoStampLag(frames, GetParam());
  ASSERT_EQ(moved.size(), frames.size());
  for (const ResolvedFrame& frame : moved)
    EXPECT_LT(Distance(*frame.T_wc, PoseAt(frame.time_s)), 1e-9) << frame.time_s;
}

INSTANTIATE_TEST_SUITE_P(Lags, UndoStampLagTest, testing::Values(0.008, -0.01, 0.0));

TEST(UndoStampLag, LooksAtNoOtherMapAndNotAcrossAGap) {
  constexpr double kLag_s = 0.01;
  std::vector<ResolvedFrame> frames = {FrameAt(0, kLag_s), FrameAt(1, kLag_s),
                                       FrameAt(1.03, kLag_s), FrameAt(1.06, kLag_s),
                                       FrameAt(1.1, kLag_s)};
  frames[2].map_id = MapId(1);
  frames[3].T_wc.reset();
  const std::vector<ResolvedFrame> moved = UndoStampLag(frames, kLag_s);
  EXPECT_FALSE(moved[3].T_wc.has_value());
  for (const size_t alone : {0u, 1u, 2u, 4u})
    EXPECT_EQ(Distance(*moved[alone].T_wc, *frames[alone].T_wc), 0) << alone;
}

}  // namespace
}  // namespace msf
