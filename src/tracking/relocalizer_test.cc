#include "tracking/relocalizer.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tracking/test_frame.h"

namespace msf {
namespace {

class RelocalizerTest : public ::testing::Test {
 protected:
  std::optional<Relocalization> Find(const std::vector<KeyFrameId>& candidates,
                                     const TestWorld::View& view) const {
    return Relocalize(at_.context, options_, at_.map, candidates, *view.features, *view.words, 3);
  }

  TrackedWorld at_;
  const RelocalizationOptions options_{};
};

TEST_F(RelocalizerTest, TheCameraIsFoundInTheMap) {
  const std::optional<Relocalization> found = Find({at_.keyframes.back()}, at_.view);
  ASSERT_TRUE(found);
  EXPECT_LT(at_.PoseError(found->T_cw), 0.01);
  EXPECT_EQ(found->keyframe, at_.keyframes.back());
  EXPECT_GE(found->matches.size(), static_cast<size_t>(options_.min_inliers));
  EXPECT_GT(at_.RightShare(found->matches), 0.98);
}

TEST_F(RelocalizerTest, TwiceTheSameIsTheSameToTheBit) {
  const std::optional<Relocalization> a = Find(at_.keyframes, at_.view),
                                      b = Find(at_.keyframes, at_.view);
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->T_cw.translation(), b->T_cw.translation());
  EXPECT_EQ(a->T_cw.rotation().coeffs(), b->T_cw.rotation().coeffs());
}

TEST_F(RelocalizerTest, CandidatesThatDoNotShowThePlaceArePassedOver) {
  TestWorld elsewhere(99);
  const TestWorld::View stranger = elsewhere.Look(TestWorld::PoseOnCircle(0));
  EXPECT_FALSE(Find(at_.keyframes, stranger));
  EXPECT_FALSE(Find({}, at_.view));
  const KeyFrameId bare = at_.world.AddBareKeyFrame(at_.T_cw_true, at_.T_cw_true, at_.map);
  EXPECT_FALSE(Find({bare}, at_.view));
  const std::optional<Relocalization> found = Find({bare, at_.keyframes.back()}, at_.view);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->keyframe, at_.keyframes.back());
}

}  // namespace
}  // namespace msf
