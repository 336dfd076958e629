#include "map/map.h"

#include <gtest/gtest.h>

#include <random>

#include "map/shared_map.h"
#include "util/check.h"

namespace msf {
namespace {

constexpr int kNumFeatures = 40;

// A keyframe whose features lie on a grid, 2 m away, at level 1.
KeyFrame MakeKeyFrame(const Rigid3d& T_cw, unsigned seed = 1) {
  std::mt19937_64 random(seed);
  auto features = std::make_shared<FrameFeatures>();
  for (int i = 0; i < kNumFeatures; ++i) {
    const Eigen::Vector2f uv_px(20 + 60 * (i % 10), 60 + 100 * (i / 10));
    features->uv_px.push_back(uv_px);
    features->image_px.push_back(uv_px);
    features->depth_m.push_back(2);
    features->u_right_px.push_back(uv_px.x() - 20);
    features->angle_rad.push_back(0);
    features->level.push_back(1);
    features->static_weight.push_back(0.75f);
    features->descriptors.push_back({random(), random(), random(), random()});
  }
  KeyFrame keyframe;
  keyframe.T_cw = T_cw;
  keyframe.features = features;
  keyframe.colors_bgr.assign(kNumFeatures, {10, 20, 30});
  return keyframe;
}

Rigid3d At(double x_m) { return {Eigen::Quaterniond::Identity(), Eigen::Vector3d(-x_m, 0, 0)}; }

bool SamePose(const Rigid3d& a, const Rigid3d& b) { return (a * b.Inverse()).Log().norm() < 1e-9; }

class MapTest : public ::testing::Test {
 protected:
  MapTest() : map_(std::make_shared<const Camera>(*Camera::Preset("simulated")), {8, 1.2}) {
    map_.StartNewMap();
  }
  // A keyframe at x that observes `shared` by its first features; its place in the graphs included.
  KeyFrameId Add(double x_m, const std::vector<MapPointId>& shared = {}) {
    const KeyFrameId id = map_.AddKeyFrame(MakeKeyFrame(At(x_m), 1 + map_.KeyFrameIds().size()));
    for (size_t i = 0; i < shared.size(); ++i)
      map_.AddObservation(shared[i], id, static_cast<int>(i));
    map_.UpdateConnections(id);
    return id;
  }
  std::vector<MapPointId> AddPoints(KeyFrameId first, int count, int from_feature = 0) {
    std::vector<MapPointId> points;
    points.reserve(count);
    for (int i = 0; i < count; ++i) {
      points.push_back(map_.AddPoint({0.05 * i - 1, 0, 2}, first, from_feature + i));
    }
    return points;
  }
  std::vector<MapPointId> First(const std::vector<MapPointId>& points, int count) {
    return {points.begin(), points.begin() + count};
  }
  // Points and keyframes name each other, and both sides of every edge agree.
  void ExpectConsistent() const {
    for (const KeyFrameId id : map_.KeyFrameIds()) {
      const KeyFrame& keyframe = *map_.FindKeyFrame(id);
      for (int i = 0; i < kNumFeatures; ++i) {
        if (!keyframe.points[i].valid()) continue;
        const MapPoint* point = map_.FindPoint(keyframe.points[i]);
        ASSERT_NE(point, nullptr);
        EXPECT_EQ(point->FeatureIn(id), i);
        EXPECT_EQ(point->map_id, keyframe.map_id);
      }
      for (const auto& [other, weight] : map_.covisibility().All(id)) {
        EXPECT_EQ(map_.covisibility().Weight(other, id), weight);
        EXPECT_NE(map_.FindKeyFrame(other), nullptr);
      }
      for (const KeyFrameId child : map_.tree().Children(id)) {
        EXPECT_EQ(map_.tree().Parent(child), id);
      }
      KeyFrameId ancestor = id;
      for (int steps = 0; map_.tree().Parent(ancestor).valid(); ++steps) {
        ASSERT_LT(steps, 1000) << "a circle in the tree";
        ancestor = map_.tree().Parent(ancestor);
      }
    }
  }

  Map map_;
};

TEST_F(MapTest, APointTakesItsLooksFromItsFirstKeyFrame) {
  const KeyFrameId id = Add(0);
  const MapPointId point_id = map_.AddPoint({0.5, 0, 2}, id, 7);
  const MapPoint& point = *map_.FindPoint(point_id);
  const FrameFeatures& features = *map_.FindKeyFrame(id)->features;
  EXPECT_EQ(point.descriptor, features.descriptors[7]);
  EXPECT_EQ(point.static_weight, 0.75f);
  EXPECT_EQ(point.color_bgr, (std::array<uint8_t, 3>{10, 20, 30}));
  EXPECT_EQ(point.reference, id);
  EXPECT_EQ(point.FeatureIn(id), 7);
  EXPECT_EQ(map_.FindKeyFrame(id)->points[7], point_id);
  const double distance_m = point.p_w.norm();
  EXPECT_NEAR(point.max_distance_m, distance_m * 1.2, 1e-9);
  EXPECT_NEAR(point.min_distance_m, distance_m * 1.2 / std::pow(1.2, 7), 1e-9);
  EXPECT_TRUE(point.normal.isApprox(point.p_w.normalized(), 1e-9));
  EXPECT_THROW(map_.AddPoint({0, 0, 2}, id, 7), ContractViolation) << "the feature is taken";
}

TEST_F(MapTest, ObservationsAreExclusiveOnBothSides) {
  const KeyFrameId a = Add(0), b = Add(0.1);
  const std::vector<MapPointId> points = AddPoints(a, 2);
  EXPECT_TRUE(map_.AddObservation(points[0], b, 5));
  EXPECT_FALSE(map_.AddObservation(points[1], b, 5)) << "the feature shows another point";
  EXPECT_FALSE(map_.AddObservation(points[0], b, 6)) << "the keyframe sees the point already";
  EXPECT_EQ(map_.FindPoint(points[0])->observations.size(), 2u);
  ExpectConsistent();
}

TEST_F(MapTest, APointWithOneObserverLeftDisappears) {
  const KeyFrameId a = Add(0), b = Add(0.1), c = Add(0.2);
  const MapPointId point = AddPoints(a, 1)[0];
  map_.AddObservation(point, b, 0);
  map_.AddObservation(point, c, 0);
  map_.RemoveObservation(point, a);
  ASSERT_NE(map_.FindPoint(point), nullptr);
  EXPECT_EQ(map_.FindPoint(point)->reference, b) << "the reference is an observer";
  map_.RemoveObservation(point, a);  // not an observer any more: nothing happens
  EXPECT_EQ(map_.FindPoint(point)->observations.size(), 2u);
  map_.RemoveObservation(point, b);
  EXPECT_EQ(map_.FindPoint(point), nullptr);
  EXPECT_FALSE(map_.FindKeyFrame(c)->points[0].valid());
  EXPECT_FALSE(map_.Resolve(point).valid());
}

TEST_F(MapTest, AReplacedPointHandsOnWhatItHad) {
  const KeyFrameId a = Add(0), b = Add(0.1), c = Add(0.2);
  const MapPointId old_id = map_.AddPoint({0, 0, 2}, a, 0), new_id = map_.AddPoint({0, 0, 2}, b, 1);
  map_.AddObservation(old_id, c, 0);
  map_.AddObservation(old_id, b, 2);  // both are seen by b: the new one stays there
  map_.CountVisible(old_id, 4);
  map_.CountFound(old_id, 2);
  map_.ReplacePoint(old_id, new_id);
  EXPECT_EQ(map_.FindPoint(old_id), nullptr);
  EXPECT_EQ(map_.Resolve(old_id), new_id);
  const MapPoint& point = *map_.FindPoint(new_id);
  EXPECT_EQ(point.observations.size(), 3u);
  EXPECT_EQ(point.FeatureIn(b), 1);
  EXPECT_FALSE(map_.FindKeyFrame(b)->points[2].valid());
  EXPECT_EQ(point.visible_count, 6);
  EXPECT_EQ(point.found_count, 4);
  const MapPointId newest = map_.AddPoint({0, 0, 2}, c, 9);
  map_.ReplacePoint(new_id, newest);
  EXPECT_EQ(map_.Resolve(old_id), newest) << "over two steps";
  map_.RemovePoint(newest);
  EXPECT_FALSE(map_.Resolve(old_id).valid());
  EXPECT_THROW(map_.ReplacePoint(newest, newest), ContractViolation);
  ExpectConsistent();
}

TEST_F(MapTest, TheStaticProbabilityFollowsWhatImagesSay) {
  const MapPointId point = map_.AddPoint({0, 0, 2}, map_.AddKeyFrame(MakeKeyFrame(At(0))), 0);
  const auto probability = [&] { return map_.FindPoint(point)->static_weight; };
  map_.ObserveStaticProbability(point, 0.05f);
  EXPECT_LT(probability(), 0.75f);
  EXPECT_GT(probability(), 0.3f) << "one image does not decide";
  for (int i = 0; i < 20; ++i) map_.ObserveStaticProbability(point, 0.05f);
  EXPECT_LT(probability(), 0.3f);
  EXPECT_GT(probability(), 0.05f);
  for (int i = 0; i < 100; ++i) map_.ObserveStaticProbability(point, 1);
  EXPECT_NEAR(probability(), 0.98, 0.01);
  for (int i = 0; i < 100; ++i) map_.ObserveStaticProbability(point, 0);
  EXPECT_NEAR(probability(), 0.02, 0.01) << "clamped: it can come back";
}

TEST_F(MapTest, PointsSeenByKeyFramesAreListedOnce) {
  const KeyFrameId a = Add(0);
  const std::vector<MapPointId> points = AddPoints(a, 5);
  const KeyFrameId b = Add(0.1, {points[3], points[1]});
  EXPECT_EQ(map_.PointsSeenBy(std::vector{b, a, b}), points);
  EXPECT_EQ(map_.PointsSeenBy(std::vector{b, KeyFrameId(99)}),
            (std::vector<MapPointId>{points[1], points[3]}));
}

TEST_F(MapTest, TheAppearanceIsTheMostTypicalDescriptor) {
  const KeyFrameId a = Add(0);
  const MapPointId point = map_.AddPoint({0, 0, 2}, a, 0);
  // Two keyframes with equal descriptors outvote the first.
  for (int k = 0; k < 2; ++k) {
    const KeyFrameId id = map_.AddKeyFrame(MakeKeyFrame(At(0.1), 77));
    map_.AddObservation(point, id, 0);
  }
  map_.UpdateAppearance(point);
  EXPECT_EQ(map_.FindPoint(point)->descriptor, MakeKeyFrame(At(0), 77).features->descriptors[0]);
}

TEST_F(MapTest, CovisibilityCountsSharedPoints) {
  const KeyFrameId a = Add(0);
  const std::vector<MapPointId> points = AddPoints(a, 30);
  const KeyFrameId b = Add(0.1, points), c = Add(0.2, First(points, 16)),
                   d = Add(0.3, First(points, 3));
  EXPECT_EQ(map_.covisibility().Weight(a, b), 30);
  EXPECT_EQ(map_.covisibility().Weight(c, a), 16);
  // Too few to be neighbours, but the best there is.
  EXPECT_EQ(map_.covisibility().All(d).size(), 1u);
  EXPECT_EQ(map_.covisibility().Best(a, 2), (std::vector<KeyFrameId>{b, c}));
  EXPECT_EQ(map_.covisibility().WithWeight(a, 17), std::vector<KeyFrameId>{b});
  ExpectConsistent();

  for (int i = 0; i < 30; ++i) map_.RemoveObservation(points[i], b);
  map_.UpdateConnections(b);
  EXPECT_EQ(map_.covisibility().Weight(a, b), 0);
  ExpectConsistent();
}

TEST_F(MapTest, KeyFramesHangOnTheOneTheyShareMostWith) {
  const KeyFrameId a = Add(0);
  const std::vector<MapPointId> points = AddPoints(a, 20);
  const KeyFrameId b = Add(0.1, First(points, 10));
  AddPoints(b, 20, 20);
  std::vector<MapPointId> of_b;
  for (int i = 20; i < 40; ++i) of_b.push_back(map_.FindKeyFrame(b)->points[i]);
  const KeyFrameId c = Add(0.2, of_b), lonely = Add(5);
  EXPECT_FALSE(map_.tree().Parent(a).valid());
  EXPECT_EQ(map_.tree().Parent(b), a);
  EXPECT_EQ(map_.tree().Parent(c), b);
  EXPECT_EQ(map_.tree().Parent(lonely), c) << "sharing nothing, it follows its predecessor";
  ExpectConsistent();
}

TEST_F(MapTest, ACulledKeyFrameKeepsItsPlaceBesideItsParent) {
  const KeyFrameId a = Add(0);
  const std::vector<MapPointId> points = AddPoints(a, 20);
  const KeyFrameId b = Add(0.1, points), c = Add(0.2, points), d = Add(0.3, First(points, 18));
  map_.SetParent(c, b);
  map_.SetParent(d, c);
  const Rigid3d T_ca = map_.PoseOf(c) * map_.PoseOf(a).Inverse();
  map_.CullKeyFrame(c);
  map_.CullKeyFrame(b);
  EXPECT_EQ(map_.FindKeyFrame(c), nullptr);
  EXPECT_TRUE(map_.Knows(c));
  EXPECT_EQ(map_.MapOf(c), map_.MapOf(a));
  EXPECT_EQ(map_.NumKeyFrames(map_.active_map()), 2);
  Vector6d twist;
  twist << 1, 2, 3, 0.1, 0.2, 0.3;
  map_.SetPose(a, Rigid3d::Exp(twist));
  EXPECT_TRUE(SamePose(map_.PoseOf(c), T_ca * Rigid3d::Exp(twist))) << "over two culled ones";
  EXPECT_EQ(map_.tree().Parent(d), a);
  EXPECT_EQ(map_.covisibility().Weight(a, c), 0);
  ExpectConsistent();
}

TEST_F(MapTest, CullingTheRootMakesAChildTheRoot) {
  const KeyFrameId a = Add(0);
  const std::vector<MapPointId> points = AddPoints(a, 20);
  const KeyFrameId b = Add(0.1, points), c = Add(0.2, points);
  map_.CullKeyFrame(a);
  EXPECT_FALSE(map_.tree().Parent(b).valid());
  EXPECT_EQ(map_.tree().Parent(c), b);
  EXPECT_TRUE(SamePose(map_.PoseOf(a), At(0)));
  map_.CullKeyFrame(c);
  EXPECT_THROW(map_.CullKeyFrame(b), ContractViolation) << "the last one stays";
}

TEST_F(MapTest, MakeRootTurnsTheTreeAround) {
  const KeyFrameId a = Add(0);
  const std::vector<MapPointId> points = AddPoints(a, 20);
  const KeyFrameId b = Add(0.1, points), c = Add(0.2, points), d = Add(0.3, points);
  map_.SetParent(c, b);
  map_.SetParent(d, b);
  map_.MakeRoot(c);
  EXPECT_FALSE(map_.tree().Parent(c).valid());
  EXPECT_EQ(map_.tree().Parent(b), c);
  EXPECT_EQ(map_.tree().Parent(a), b);
  EXPECT_EQ(map_.tree().Parent(d), b);
  ExpectConsistent();
}

TEST_F(MapTest, LoopEdgesJoinBothEndsAndGoWithThem) {
  const KeyFrameId a = Add(0);
  const std::vector<MapPointId> points = AddPoints(a, 20);
  const KeyFrameId b = Add(0.1, points), c = Add(0.2, points);
  map_.AddLoopEdge(a, c);
  EXPECT_TRUE(map_.tree().LoopEdges(a).contains(c));
  EXPECT_TRUE(map_.tree().LoopEdges(c).contains(a));
  EXPECT_TRUE(map_.tree().LoopEdges(b).empty());
  map_.CullKeyFrame(c);
  EXPECT_TRUE(map_.tree().LoopEdges(a).empty());
}

TEST_F(MapTest, ADroppedMapIsForgottenAltogether) {
  const KeyFrameId kept = Add(0);
  const MapPointId kept_point = AddPoints(kept, 1)[0];
  const MapId second = map_.StartNewMap();
  const KeyFrameId a = Add(0);
  const std::vector<MapPointId> points = AddPoints(a, 20);
  const KeyFrameId b = Add(0.1, points), c = Add(0.2, points);
  map_.CullKeyFrame(c);
  map_.DropMap(second);
  for (const KeyFrameId id : {a, b, c}) {
    EXPECT_EQ(map_.FindKeyFrame(id), nullptr);
    EXPECT_FALSE(map_.Knows(id));
    EXPECT_FALSE(map_.MapOf(id).valid());
  }
  EXPECT_EQ(map_.FindPoint(points[0]), nullptr);
  EXPECT_NE(map_.FindPoint(kept_point), nullptr);
  EXPECT_EQ(map_.MapIds(), std::vector<MapId>{MapId(0)});
  EXPECT_EQ(map_.KeyFrameIds(), std::vector<KeyFrameId>{kept});
  const KeyFrameId later = Add(0);
  EXPECT_GT(later, c) << "ids are never used again";
}

TEST_F(MapTest, AMovedMapBecomesPartOfTheOther) {
  const KeyFrameId old_keyframe = Add(0);
  const MapId second = map_.StartNewMap();
  const KeyFrameId a = Add(0);
  const std::vector<MapPointId> points = AddPoints(a, 20);
  const KeyFrameId b = Add(0.1, points);
  Add(0.2, points);
  map_.CullKeyFrame(b);
  const Eigen::Vector3d p_c = map_.PoseOf(a) * map_.FindPoint(points[3])->p_w;
  const Eigen::Vector3d normal_c = map_.PoseOf(a).rotation() * map_.FindPoint(points[3])->normal;
  const Rigid3d T_ba = map_.PoseOf(b) * map_.PoseOf(a).Inverse();
  Vector6d twist;
  twist << 1, 2, 3, 0.1, 0.2, 0.3;
  const Rigid3d T_to_from = Rigid3d::Exp(twist), T_old = map_.PoseOf(old_keyframe);

  map_.MoveMap(second, MapId(0), T_to_from);
  EXPECT_EQ(map_.active_map(), MapId(0));
  EXPECT_EQ(map_.NumKeyFrames(MapId(0)), 3);
  EXPECT_EQ(map_.NumKeyFrames(second), 0);
  EXPECT_EQ(map_.NumPoints(second), 0);
  EXPECT_TRUE(SamePose(map_.PoseOf(old_keyframe), T_old));
  EXPECT_TRUE(SamePose(map_.PoseOf(a), At(0) * T_to_from.Inverse()));
  EXPECT_TRUE(SamePose(map_.PoseOf(b), T_ba * map_.PoseOf(a))) << "culled ones move along";
  EXPECT_LT((map_.PoseOf(a) * map_.FindPoint(points[3])->p_w - p_c).norm(), 1e-9);
  EXPECT_LT((map_.PoseOf(a).rotation() * map_.FindPoint(points[3])->normal - normal_c).norm(),
            1e-9);
  ExpectConsistent();
}

TEST_F(MapTest, VersionsCountChangesAndEpochsCorrections) {
  const KeyFrameId a = Add(0);
  const uint64_t version = map_.version();
  const MapPointId point = AddPoints(a, 1)[0];
  EXPECT_GT(map_.version(), version);
  const uint64_t before_move = map_.version();
  map_.SetPosition(point, {1, 2, 3});
  EXPECT_GT(map_.version(), before_move);
  EXPECT_EQ(map_.epoch(), 0u);
  map_.StartNewEpoch();
  EXPECT_EQ(map_.epoch(), 1u);
}

TEST_F(MapTest, FeaturesMayMoveButStayThoseOfTheirPoints) {
  const KeyFrameId a = Add(0);
  AddPoints(a, 5);
  const uint64_t version = map_.version();
  auto moved = std::make_shared<FrameFeatures>(*map_.FindKeyFrame(a)->features);
  moved->uv_px[0].x() += 3;
  map_.SetFeatures(a, moved);
  EXPECT_EQ(map_.FindKeyFrame(a)->features, moved);
  EXPECT_GT(map_.version(), version);
  EXPECT_THROW(map_.SetFeatures(a, std::make_shared<const FrameFeatures>()), ContractViolation);
}

TEST_F(MapTest, ContractsAreChecked) {
  EXPECT_THROW(map_.SetPose(KeyFrameId(0), Rigid3d()), ContractViolation);
  EXPECT_THROW(map_.RemovePoint(MapPointId(0)), ContractViolation);
  Map empty(std::make_shared<const Camera>(*Camera::Preset("simulated")), {8, 1.2});
  EXPECT_THROW(empty.AddKeyFrame(MakeKeyFrame(At(0))), ContractViolation) << "no map yet";
  EXPECT_EQ(empty.FindKeyFrame(KeyFrameId()), nullptr);
  EXPECT_EQ(empty.FindPoint(MapPointId(3)), nullptr);
  EXPECT_FALSE(empty.Knows(KeyFrameId(0)));
}

TEST_F(MapTest, TheTreeSurvivesRandomCulling) {
  std::mt19937 random(5);
  std::vector<MapPointId> points;
  std::vector<KeyFrameId> keyframes;
  for (int k = 0; k < 40; ++k) {
    keyframes.push_back(Add(0.1 * k, points));
    const int used = static_cast<int>(points.size());
    std::vector<MapPointId> fresh = AddPoints(keyframes.back(), kNumFeatures - used, used);
    points.insert(points.end(), fresh.begin(), fresh.end());
    points.erase(points.begin(), points.begin() + 1 + random() % 20);
    std::erase_if(points, [&](MapPointId id) { return !map_.FindPoint(id); });
  }
  for (int k = 0; k < 30; ++k) {
    const size_t victim = random() % keyframes.size();
    const Rigid3d before = map_.PoseOf(keyframes[victim]);
    map_.CullKeyFrame(keyframes[victim]);
    EXPECT_TRUE(SamePose(map_.PoseOf(keyframes[victim]), before));
    keyframes.erase(keyframes.begin() + victim);
    ExpectConsistent();
  }
  int roots = 0;
  for (const KeyFrameId id : keyframes) roots += !map_.tree().Parent(id).valid();
  EXPECT_EQ(roots, 1);
}

TEST_F(MapTest, ManyReadOneWrites) {
  SharedMap shared(std::move(map_));
  {
    const SharedMap::Reader a = shared.Read(), b = shared.Read();
    EXPECT_EQ(a->active_map(), b->active_map());
  }
  shared.Write()->StartNewMap();
  EXPECT_EQ(shared.Read()->active_map(), MapId(1));
}

}  // namespace
}  // namespace msf
