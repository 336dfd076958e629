#include "dynamic/background.h"

#include <gtest/gtest.h>

#include "dynamic/test_scene.h"

namespace msf {
namespace {

const cv::Rect kThing_px(240, 160, 160, 160);
// Blocks in the middle of the thing and on the wall.
constexpr int kThingRow = 30, kThingCol = 40, kWallRow = 10, kWallCol = 10;

CoarseDepth Wall(float depth_m = 3) { return CoarseDepth(DepthFrame(depth_m)); }
CoarseDepth WallAndThing(float thing_m = 2) {
  return CoarseDepth(DepthFrame(3, {{kThing_px, thing_m}}));
}
Rigid3d Along(double x_m, double z_m) { return {Eigen::Quaterniond::Identity(), {x_m, 0, z_m}}; }

class BackgroundTest : public ::testing::Test {
 protected:
  void Remember(double time_s, const CoarseDepth& depth, bool steady = true) {
    background_.Remember(time_s, depth, {}, {}, steady);
  }
  void RememberThing(double time_s, CellOwner owner) {
    cv::Mat1b owners(120, 160, static_cast<uint8_t>(CellOwner::kWorld));
    owners(cv::Rect(60, 40, 40, 40)) = static_cast<uint8_t>(owner);  // cells of the thing
    background_.Remember(time_s, WallAndThing(), owners, {}, true);
  }
  struct Verdicts {
    BlockVerdict thing, wall;
  };
  Verdicts Compare(double time_s, const CoarseDepth& depth, const Rigid3d& T_cw = {},
                   bool steady = true) const {
    const BlockVerdicts all = background_.Compare(time_s, depth, T_cw, steady);
    EXPECT_EQ(all.rows(), 60);
    EXPECT_EQ(all.cols(), 80);
    return {all.At(kThingRow, kThingCol), all.At(kWallRow, kWallCol)};
  }
  static BackgroundOptions TwoViewsMakeAMemory() {
    BackgroundOptions options;
    options.min_memory_views = 2;
    return options;
  }
  Background background_{TwoViewsMakeAMemory(), *TestCamera()};
};

TEST_F(BackgroundTest, WhatIsStillThereIsConfirmedWhatCameInIsAnIntruder) {
  Remember(0, Wall());
  const auto [thing, wall] = Compare(1, WallAndThing());
  EXPECT_EQ(thing, BlockVerdict::kIntruder);
  EXPECT_EQ(wall, BlockVerdict::kConfirmed);
}

TEST_F(BackgroundTest, WhatWasHiddenIsUnknown) {
  Remember(0, WallAndThing());
  const auto [thing, wall] = Compare(1, Wall());
  EXPECT_EQ(thing, BlockVerdict::kUnknown);
  EXPECT_EQ(wall, BlockVerdict::kConfirmed);
}

TEST_F(BackgroundTest, WithoutDepthNothingIsKnown) {
  Remember(0, Wall());
  EXPECT_EQ(Compare(1, WallAndThing(0)).thing, BlockVerdict::kUnknown);
}

// 0.012 m + 0.01 * 9 m = 0.102 m.
TEST_F(BackgroundTest, NoiseOfDepthIsTolerated) {
  Remember(0, Wall());
  EXPECT_EQ(Compare(1, Wall(3.1f)).wall, BlockVerdict::kConfirmed);
  EXPECT_EQ(Compare(1, Wall(2.85f)).wall, BlockVerdict::kUnknown) << "neither here nor there";
  EXPECT_EQ(Compare(1, Wall(2.7f)).wall, BlockVerdict::kIntruder);
}

TEST_F(BackgroundTest, WhileTheCameraTurnsNothingIsNew) {
  Remember(0, Wall());
  const Verdicts now = Compare(1, WallAndThing(), {}, false);
  EXPECT_EQ(now.thing, BlockVerdict::kUnknown);
  EXPECT_EQ(now.wall, BlockVerdict::kConfirmed);
  background_.Forget();
  Remember(0, Wall(), false);
  const Verdicts then = Compare(1, WallAndThing());
  EXPECT_EQ(then.thing, BlockVerdict::kUnknown);
  EXPECT_EQ(then.wall, BlockVerdict::kConfirmed);
}

TEST_F(BackgroundTest, WhatWasInDoubtThenConfirmsNothing) {
  RememberThing(0, CellOwner::kDoubtful);
  const auto [thing, wall] = Compare(1, WallAndThing());
  EXPECT_EQ(thing, BlockVerdict::kUnknown);
  EXPECT_EQ(wall, BlockVerdict::kConfirmed);
}

TEST_F(BackgroundTest, WhoWasSeenTwiceIsKnownAgainWhileHeIsThere) {
  RememberThing(0, CellOwner::kSomebody);
  EXPECT_EQ(Compare(3, WallAndThing()).thing, BlockVerdict::kUnknown) << "one mask may be wrong";
  RememberThing(2, CellOwner::kSomebody);
  EXPECT_EQ(Compare(3, WallAndThing()).thing, BlockVerdict::kSomebody);
  EXPECT_EQ(Compare(3, WallAndThing()).wall, BlockVerdict::kConfirmed);
  EXPECT_EQ(Compare(3, Wall()).thing, BlockVerdict::kUnknown) << "he has gone";
  Remember(10.5, Wall());
  EXPECT_EQ(Compare(11.2, WallAndThing()).thing, BlockVerdict::kIntruder)
      << "that was too long ago";
}

TEST_F(BackgroundTest, TheMajorityOfViewsSaysWhoseASurfaceIs) {
  RememberThing(0, CellOwner::kSomebody);
  RememberThing(2, CellOwner::kSomebody);
  RememberThing(4, CellOwner::kWorld);
  EXPECT_EQ(Compare(5, WallAndThing()).thing, BlockVerdict::kSomebody);
  RememberThing(6, CellOwner::kWorld);
  EXPECT_EQ(Compare(7, WallAndThing()).thing, BlockVerdict::kConfirmed);
}

TEST_F(BackgroundTest, NobodyIsRememberedWhenNobodyIsToBe) {
  BackgroundOptions options;
  options.min_memory_views = 0;
  background_ = Background(options, *TestCamera());
  RememberThing(0, CellOwner::kSomebody);
  RememberThing(2, CellOwner::kSomebody);
  EXPECT_EQ(Compare(3, WallAndThing()).thing, BlockVerdict::kUnknown);
}

TEST_F(BackgroundTest, OnlyViewsOfSomeAgeCount) {
  Remember(0, Wall());
  EXPECT_EQ(Compare(0.5, Wall()).wall, BlockVerdict::kUnknown);
  EXPECT_EQ(Compare(0.6, Wall()).wall, BlockVerdict::kConfirmed);
  Remember(8.5, Wall());  // the first one is too old now
  EXPECT_EQ(Compare(8.8, Wall()).wall, BlockVerdict::kUnknown);
}

TEST_F(BackgroundTest, ViewsAreKeptNowAndThen) {
  Remember(0, Wall());
  Remember(0.1, WallAndThing());  // too soon
  EXPECT_EQ(Compare(1, WallAndThing()).thing, BlockVerdict::kIntruder);
  Remember(0.2, WallAndThing());
  Remember(0.4, WallAndThing());
  EXPECT_NE(Compare(1, WallAndThing()).thing, BlockVerdict::kIntruder) << "seen there, too";
}

TEST_F(BackgroundTest, TheCamerasMotionIsTakenOut) {
  Remember(0, WallAndThing());
  // 0.5 m back and 0.1 m to the side: the thing is smaller now and 21 px farther right.
  const CoarseDepth now(DepthFrame(3.5f, {{{270, 176, 128, 128}, 2.5f}}));
  const auto [thing, wall] = Compare(1, now, Along(0.1, 0.5));
  EXPECT_EQ(thing, BlockVerdict::kConfirmed);
  EXPECT_EQ(wall, BlockVerdict::kConfirmed);
  EXPECT_NE(Compare(1, now).wall, BlockVerdict::kConfirmed) << "with the wrong pose";
}

TEST_F(BackgroundTest, TheWorldsCoordinatesMayChange) {
  Remember(0, Wall());
  const Rigid3d T_old_new = Along(0, 0.5);
  EXPECT_NE(Compare(1, Wall(), T_old_new).wall, BlockVerdict::kConfirmed);
  background_.ChangeWorld(T_old_new);
  EXPECT_EQ(Compare(1, Wall(), T_old_new).wall, BlockVerdict::kConfirmed);
}

TEST_F(BackgroundTest, NothingIsKnownAtFirstAndAfterForgetting) {
  EXPECT_EQ(Compare(1, Wall()).wall, BlockVerdict::kUnknown);
  Remember(0, Wall());
  background_.Forget();
  EXPECT_EQ(Compare(1, Wall()).wall, BlockVerdict::kUnknown);
}

TEST(BlockVerdicts, CellsBelongToBlocks) {
  EXPECT_EQ(BlockVerdicts().OfCell({3, 3}), BlockVerdict::kUnknown);
  BlockVerdicts verdicts(2, 3);
  verdicts.Set(1, 2, BlockVerdict::kIntruder);
  EXPECT_EQ(verdicts.OfCell({4, 2}), BlockVerdict::kIntruder);
  EXPECT_EQ(verdicts.OfCell({5, 3}), BlockVerdict::kIntruder);
  EXPECT_EQ(verdicts.OfCell({6, 4}), BlockVerdict::kIntruder) << "an odd one at the border";
  EXPECT_EQ(verdicts.OfCell({3, 3}), BlockVerdict::kUnknown);
}

}  // namespace
}  // namespace msf
