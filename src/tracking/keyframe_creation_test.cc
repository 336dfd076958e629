#include "tracking/keyframe_creation.h"

#include <gtest/gtest.h>

#include "tracking/test_frame.h"

namespace msf {
namespace {

// The keyframe itself as a frame: all of its points are tracked.
class KeyFrameCreationTest : public ::testing::Test {
 protected:
  Frame TrackedFrame() const {
    Frame frame = at_.LastFrame();
    frame.reference = at_.keyframes.back();
    return frame;
  }
  KeyFrameEvidence Gather(const Frame& frame) const {
    return GatherEvidence(at_.context, at_.map, frame);
  }

  TrackedWorld at_;
};

TEST_F(KeyFrameCreationTest, AFrameLikeItsReferenceTracksAllOfIt) {
  const KeyFrameEvidence evidence = Gather(TrackedFrame());
  EXPECT_GT(evidence.reference_points, 100);
  EXPECT_GE(evidence.inliers, evidence.reference_points);
  EXPECT_EQ(evidence.hidden_share, 0);
}

TEST_F(KeyFrameCreationTest, WhatSeemsToMoveHidesItsShare) {
  Frame frame = TrackedFrame();
  frame.removed = frame.features;  // as many again
  EXPECT_DOUBLE_EQ(Gather(frame).hidden_share, 0.5);
}

}  // namespace
}  // namespace msf
