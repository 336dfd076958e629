#include "mapping/keyframe_culling.h"

#include <gtest/gtest.h>

#include "map/test_world.h"

namespace msf {
namespace {

class KeyFrameCullingTest : public ::testing::Test {
 protected:
  std::vector<KeyFrameId> Walk(double to_rad, double step_rad) {
    return world_.Walk(0, to_rad, step_rad, Vector6d::Zero(), TestWorld::PoseOnCircle(0), map_);
  }

  TestWorld world_{1};
  Map map_ = world_.EmptyMap();
  const MappingOptions options_{};
};

TEST_F(KeyFrameCullingTest, KeyFramesThatShowNothingNewGo) {
  const std::vector<KeyFrameId> keyframes = Walk(0.0095, 0.001);
  const std::vector<KeyFrameId> culled = CullRedundantKeyFrames(options_, keyframes.back(), map_);
  EXPECT_FALSE(culled.empty());
  for (const KeyFrameId id : culled) EXPECT_EQ(map_.FindKeyFrame(id), nullptr);
  EXPECT_NE(map_.FindKeyFrame(keyframes.front()), nullptr) << "the root of the tree";
  EXPECT_NE(map_.FindKeyFrame(keyframes.back()), nullptr) << "the newest";
  // What is left still sees what was seen, often enough not to be redundant itself.
  EXPECT_TRUE(CullRedundantKeyFrames(options_, keyframes.back(), map_).empty());
  EXPECT_GE(map_.KeyFrameIds().size(), static_cast<size_t>(options_.redundant_observers));
}

TEST_F(KeyFrameCullingTest, KeyFramesWithAViewOfTheirOwnStay) {
  const std::vector<KeyFrameId> keyframes = Walk(1.0, 0.25);
  EXPECT_TRUE(CullRedundantKeyFrames(options_, keyframes.back(), map_).empty());
}

TEST_F(KeyFrameCullingTest, EndsOfLoopsStay) {
  const std::vector<KeyFrameId> keyframes = Walk(0.0095, 0.001);
  for (size_t i = 2; i + 1 < keyframes.size(); i += 2)
    map_.AddLoopEdge(keyframes[i], keyframes[i + 1]);
  map_.AddLoopEdge(keyframes[1], keyframes.back());
  EXPECT_TRUE(CullRedundantKeyFrames(options_, keyframes.back(), map_).empty());
}

}  // namespace
}  // namespace msf
