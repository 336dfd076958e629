#include "loop_closing/loop_corrector.h"

#include <gtest/gtest.h>

#include "loop_closing/full_bundle.h"
#include "loop_closing/map_merger.h"
#include "map/test_world.h"

namespace msf {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

Vector6d Drift() {
  Vector6d drift;
  drift << 0.0005, 0.0005, 0.0005, 0.0005, 0.002, -0.0005;
  return drift;
}

class CorrectionTest : public ::testing::Test {
 protected:
  // Verifies the place and takes it for recognised.
  Recognition Recognise(PlaceKind kind, KeyFrameId current, KeyFrameId matched) {
    const SharedMap::Reader map = map_.Read();
    const PlaceVerifier verifier(*world_.camera(), world_.levels(), options_.verification,
                                 options_.pose, noise_);
    const PlaceWindow a = *CopyWindow(*map, current, 5), b = *CopyWindow(*map, matched, 10);
    Recognition place{kind, verifier.Verify(a, b, 1), {}};
    EXPECT_TRUE(place.match.accepted()) << ToString(place.match.verdict);
    place.supporting = verifier.AgreeingNeighbours(place.match, a, b);
    return place;
  }
  std::vector<KeyFrameId> WalkWithDrift(double from_deg, double to_deg, const Rigid3d& T_cw_start) {
    return world_.Walk(from_deg * kDegree, to_deg * kDegree, 6 * kDegree, Drift(), T_cw_start,
                       *map_.Write());
  }

  TestWorld world_{1};
  SharedMap map_{world_.EmptyMap()};
  const LoopClosingOptions options_ = {};
  const NoiseOptions noise_ = {};
};

TEST_F(CorrectionTest, ALoopRemovesDriftAndDuplicates) {
  const std::vector<KeyFrameId> walk = WalkWithDrift(0, 372, TestWorld::PoseOnCircle(0));
  const double error_before_m = world_.Error(*map_.Read(), walk);
  const int points_before = map_.Read()->NumPoints(MapId(0));
  const Recognition loop = Recognise(PlaceKind::kLoop, walk.back(), walk[2]);

  const std::optional<int> fused = CloseLoop(options_, loop, map_);
  ASSERT_TRUE(fused);
  EXPECT_GT(*fused, 200);
  const SharedMap::Reader map = map_.Read();
  EXPECT_LT(map->NumPoints(MapId(0)), points_before - 100);
  EXPECT_GT(error_before_m, 0.1);
  EXPECT_LT(world_.Error(*map, walk), error_before_m / 4);
  EXPECT_TRUE(map->tree().LoopEdges(walk.back()).contains(walk[2]));
  EXPECT_GT(map->covisibility().Weight(walk.back(), walk[2]), 50);
  EXPECT_EQ(map->epoch(), 1u);
}

TEST_F(CorrectionTest, AFullBundleImprovesAClosedLoop) {
  const std::vector<KeyFrameId> walk = WalkWithDrift(0, 372, TestWorld::PoseOnCircle(0));
  ASSERT_TRUE(CloseLoop(options_, Recognise(PlaceKind::kLoop, walk.back(), walk[2]), map_));
  const double error_m = world_.Error(*map_.Read(), walk);
  FullBundle bundle(options_, noise_, map_);
  std::atomic<bool> cancel = true;
  EXPECT_FALSE(bundle.Run(MapId(0), cancel));
  EXPECT_EQ(world_.Error(*map_.Read(), walk), error_m);
  cancel = false;
  EXPECT_TRUE(bundle.Run(MapId(0), cancel));
  EXPECT_LT(world_.Error(*map_.Read(), walk), error_m / 2);
  EXPECT_FALSE(bundle.Run(MapId(7), cancel));
}

TEST_F(CorrectionTest, NothingHappensWhenAnEndOfTheLoopIsGone) {
  const std::vector<KeyFrameId> walk = WalkWithDrift(0, 372, TestWorld::PoseOnCircle(0));
  const Recognition loop = Recognise(PlaceKind::kLoop, walk.back(), walk[2]);
  map_.Write()->CullKeyFrame(walk[2]);
  const double error_m = world_.Error(*map_.Read(), walk);
  EXPECT_FALSE(CloseLoop(options_, loop, map_));
  EXPECT_EQ(world_.Error(*map_.Read(), walk), error_m);
}

TEST_F(CorrectionTest, MergingBringsTheYoungerMapIntoTheOlder) {
  const std::vector<KeyFrameId> first = WalkWithDrift(0, 90, TestWorld::PoseOnCircle(0));
  const Rigid3d T_cw_origin = map_.Read()->PoseOf(first.front());
  map_.Write()->StartNewMap();
  Vector6d elsewhere;
  elsewhere << 3, -1, 2, 0.5, 1, -0.4;
  const std::vector<KeyFrameId> second = WalkWithDrift(-90, 30, Rigid3d::Exp(elsewhere));
  const Recognition merge = Recognise(PlaceKind::kMerge, second.back(), first[5]);

  const std::optional<MergeOutcome> outcome = MergeMaps(options_, noise_, merge, map_);
  ASSERT_TRUE(outcome);
  EXPECT_EQ(outcome->map_id, MapId(0));
  EXPECT_GT(outcome->fused, 200);
  const SharedMap::Reader map = map_.Read();
  EXPECT_EQ(map->MapIds(), std::vector<MapId>{MapId(0)});
  EXPECT_EQ(map->active_map(), MapId(0));
  // The older map stays; the younger continues it, with no more than its own drift.
  EXPECT_EQ(map->PoseOf(first.front()).translation(), T_cw_origin.translation());
  std::vector<KeyFrameId> both = first;
  both.insert(both.end(), second.begin(), second.end());
  EXPECT_LT(world_.Error(*map, both), 0.1);
  EXPECT_GT(map->covisibility().Weight(second.back(), first[5]), 50);
  // One tree: every keyframe's ancestors end at the older map's root.
  for (KeyFrameId id : both) {
    while (map->tree().Parent(id).valid()) id = map->tree().Parent(id);
    EXPECT_EQ(id, first.front());
  }
}

TEST_F(CorrectionTest, OneMapIsNotMergedWithItself) {
  const std::vector<KeyFrameId> walk = WalkWithDrift(0, 60, TestWorld::PoseOnCircle(0));
  const Recognition merge = Recognise(PlaceKind::kMerge, walk[5], walk[4]);
  EXPECT_FALSE(MergeMaps(options_, noise_, merge, map_));
}

// Relocalisation can make an old map the active one, so that the younger map is the matched one.
TEST_F(CorrectionTest, MergingWorksFromTheOlderMapToo) {
  const std::vector<KeyFrameId> first = WalkWithDrift(0, 60, TestWorld::PoseOnCircle(0));
  map_.Write()->StartNewMap();
  const std::vector<KeyFrameId> second = WalkWithDrift(30, 90, Rigid3d());
  map_.Write()->SetActiveMap(MapId(0));
  const Recognition merge = Recognise(PlaceKind::kMerge, first.back(), second[5]);
  const std::optional<MergeOutcome> outcome = MergeMaps(options_, noise_, merge, map_);
  ASSERT_TRUE(outcome);
  const SharedMap::Reader map = map_.Read();
  EXPECT_EQ(outcome->map_id, MapId(0));
  EXPECT_EQ(map->active_map(), MapId(0));
  std::vector<KeyFrameId> both = first;
  both.insert(both.end(), second.begin(), second.end());
  EXPECT_LT(world_.Error(*map, both), 0.1);
}

}  // namespace
}  // namespace msf
