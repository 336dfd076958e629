#include "tracking/keyframe_policy.h"

#include <gtest/gtest.h>

namespace msf {
namespace {

// A frame that is tied to the map as well as its reference keyframe.
KeyFrameEvidence WellTracked() {
  return {.since_last_s = 0.2,
          .inliers = 300,
          .reference_points = 320,
          .tracked_close = 250,
          .untracked_close = 20};
}

TEST(KeyFramePolicy, WellTrackedFrameIsNone) {
  EXPECT_FALSE(WantsKeyFrame(WellTracked(), {}, {}));
  KeyFrameEvidence evidence = WellTracked();
  evidence.since_last_s = 10;
  EXPECT_FALSE(WantsKeyFrame(evidence, {}, {})) << "time alone is no reason";
}

TEST(KeyFramePolicy, WeakeningTieIsOneWhenTheMapperIsIdle) {
  KeyFrameEvidence evidence = WellTracked();
  evidence.inliers = 200;
  EXPECT_TRUE(WantsKeyFrame(evidence, {.idle = true}, {}));
  EXPECT_FALSE(WantsKeyFrame(evidence, {.idle = false}, {}));
  evidence.since_last_s = 1.5;
  EXPECT_TRUE(WantsKeyFrame(evidence, {.idle = false}, {})) << "it is due";
}

TEST(KeyFramePolicy, ComesSoonerWhileMoversHideTheRoom) {
  KeyFrameEvidence evidence = WellTracked();
  evidence.hidden_share = 0.4;
  EXPECT_TRUE(WantsKeyFrame(evidence, {.idle = true}, {}));
  EXPECT_FALSE(WantsKeyFrame(evidence, {.idle = true}, {.hidden_exponent = 0}));
  evidence.inliers = evidence.reference_points;
  EXPECT_FALSE(WantsKeyFrame(evidence, {.idle = true}, {})) << "it shows nothing new";
}

TEST(KeyFramePolicy, UrgentOneInterruptsABusyMapperUnlessItsQueueIsFull) {
  KeyFrameEvidence evidence = WellTracked();
  evidence.inliers = 60;
  EXPECT_TRUE(WantsKeyFrame(evidence, {.idle = false, .queued = 2}, {}));
  EXPECT_FALSE(WantsKeyFrame(evidence, {.idle = false, .queued = 3}, {}));
}

TEST(KeyFramePolicy, ManyNewClosePointsAreAReason) {
  KeyFrameEvidence evidence = WellTracked();
  evidence.tracked_close = 60;
  evidence.untracked_close = 100;
  EXPECT_TRUE(WantsKeyFrame(evidence, {.idle = false}, {}));
}

TEST(KeyFramePolicy, NeverWithAlmostNoInliers) {
  KeyFrameEvidence evidence = WellTracked();
  evidence.inliers = 15;
  EXPECT_FALSE(WantsKeyFrame(evidence, {}, {}));
}

}  // namespace
}  // namespace msf
