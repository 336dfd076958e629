#include "loop_closing/loop_closer.h"

#include <gtest/gtest.h>

#include "map/test_world.h"

namespace msf {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

// Walks keyframe by keyframe, as tracking and mapping would hand them on.
class LoopCloserTest : public ::testing::Test {
 protected:
  void MakeCloser(const LoopClosingOptions& options = {}) {
    closer_ = std::make_unique<LoopCloser>(options, NoiseOptions{}, map_, database_, 7);
  }
  void WalkOn(int from_deg, int to_deg, const Rigid3d& T_cw_start) {
    Vector6d drift;
    drift << 0.0005, 0.0005, 0.0005, 0.0005, 0.002, -0.0005;
    Rigid3d T_cw_true = TestWorld::PoseOnCircle(from_deg * kDegree), T_cw = T_cw_start;
    for (int deg = from_deg; deg <= to_deg; deg += 6) {
      const Rigid3d T_cw_next = TestWorld::PoseOnCircle(deg * kDegree);
      const Rigid3d step = T_cw_next * T_cw_true.Inverse();
      // The next keyframe continues from where the map has the last one by now.
      const bool first = deg == from_deg;
      if (!first) T_cw = Rigid3d::Exp(drift) * step * map_.Read()->PoseOf(keyframes_.back());
      T_cw_true = T_cw_next;
      keyframes_.push_back(world_.AddKeyFrame(T_cw_true, T_cw, *map_.Write()));
      const LoopClosingSummary summary = closer_->Process(keyframes_.back());
      if (summary.found) found_.push_back(summary);
    }
  }

  TestWorld world_{1};
  SharedMap map_{world_.EmptyMap()};
  KeyFrameDatabase database_;
  std::unique_ptr<LoopCloser> closer_;
  std::vector<KeyFrameId> keyframes_;
  std::vector<LoopClosingSummary> found_;
};

TEST_F(LoopCloserTest, ClosesTheLoopWhenTheCameraComesBack) {
  MakeCloser();
  WalkOn(0, 390, TestWorld::PoseOnCircle(0));
  ASSERT_EQ(found_.size(), 1u);
  const LoopClosingSummary& loop = found_.front();
  EXPECT_EQ(loop.found, PlaceKind::kLoop);
  EXPECT_EQ(loop.wants_full_bundle, MapId(0));
  EXPECT_GE(loop.current.value(), 58);
  EXPECT_LE(loop.matched.value(), 8);
  EXPECT_GT(loop.inliers, 50);
  EXPECT_GT(loop.fused_points, 100);
  const Rigid3d truth = world_.Truth(loop.current) * world_.Truth(loop.matched).Inverse();
  EXPECT_LT((loop.T_c_m * truth.Inverse()).Log().norm(), 0.03);
  EXPECT_LT(world_.Error(*map_.Read(), keyframes_), 0.03);
}

TEST_F(LoopCloserTest, FindsNothingWhereItHasNeverBeen) {
  MakeCloser();
  WalkOn(0, 290, TestWorld::PoseOnCircle(0));
  EXPECT_TRUE(found_.empty());
  EXPECT_EQ(map_.Read()->epoch(), 0u);
}

TEST_F(LoopCloserTest, SwitchedOffItStillKeepsTheDatabase) {
  LoopClosingOptions options;
  options.enabled = false;
  MakeCloser(options);
  WalkOn(0, 390, TestWorld::PoseOnCircle(0));
  EXPECT_TRUE(found_.empty());
  EXPECT_EQ(database_.size(), static_cast<int>(keyframes_.size()));
  EXPECT_GT(world_.Error(*map_.Read(), keyframes_), 0.05);
}

TEST_F(LoopCloserTest, ForgetsCulledKeyFrames) {
  MakeCloser();
  WalkOn(0, 60, TestWorld::PoseOnCircle(0));
  map_.Write()->CullKeyFrame(keyframes_[3]);
  WalkOn(66, 66, TestWorld::PoseOnCircle(66 * kDegree));
  EXPECT_EQ(database_.size(), static_cast<int>(keyframes_.size()) - 1);
  map_.Write()->CullKeyFrame(keyframes_[4]);
  EXPECT_FALSE(closer_->Process(keyframes_[4]).found) << "culled before its turn";
  EXPECT_EQ(database_.size(), static_cast<int>(keyframes_.size()) - 2);
}

TEST_F(LoopCloserTest, MergesMapsThatMeet) {
  MakeCloser();
  WalkOn(0, 120, TestWorld::PoseOnCircle(0));
  map_.Write()->StartNewMap();
  Vector6d elsewhere;
  elsewhere << 3, -1, 2, 0.5, 1, -0.4;
  WalkOn(200, 400, Rigid3d::Exp(elsewhere));
  ASSERT_FALSE(found_.empty());
  EXPECT_EQ(found_.front().found, PlaceKind::kMerge);
  EXPECT_EQ(found_.front().wants_full_bundle, MapId(0));
  EXPECT_EQ(map_.Read()->MapIds().size(), 1u);
  EXPECT_LT(world_.Error(*map_.Read(), keyframes_), 0.15);
}

}  // namespace
}  // namespace msf
