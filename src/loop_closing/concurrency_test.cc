#include <gtest/gtest.h>

#include <thread>

#include "loop_closing/full_bundle.h"
#include "loop_closing/loop_closer.h"
#include "map/test_world.h"
#include "util/bounded_queue.h"

namespace msf {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

// Tracking adds keyframes while loops are closed and the whole map is adjusted: whatever the order
// in which they come, the map stays in one piece.
TEST(LoopClosingConcurrencyTest, TheMapStaysConsistent) {
  TestWorld world(1, 2500);
  SharedMap map(world.EmptyMap());
  KeyFrameDatabase database;
  LoopCloser closer({}, {}, map, database, 1);
  FullBundle bundle({}, {}, map);
  BoundedQueue<KeyFrameId> keyframes(100);
  BoundedQueue<MapId> requests(100);
  std::atomic<bool> cancel = false;
  int found = 0;

  std::thread bundler([&] {
    while (const std::optional<MapId> id = requests.Pop()) bundle.Run(*id, cancel);
  });
  std::thread looper([&] {
    while (const std::optional<KeyFrameId> id = keyframes.Pop()) {
      const LoopClosingSummary summary = closer.Process(*id);
      found += summary.found.has_value();
      if (id->value() % 10 == 9) requests.Push(MapId(0));
    }
    requests.Close();
  });
  std::vector<KeyFrameId> walk;
  Rigid3d T_cw = TestWorld::PoseOnCircle(0), T_cw_true = T_cw;
  Vector6d drift;
  drift << 0.0005, 0.0005, 0.0005, 0.0005, 0.002, -0.0005;
  for (int deg = 0; deg <= 420; deg += 6) {
    const Rigid3d next = TestWorld::PoseOnCircle(deg * kDegree);
    {
      const SharedMap::Writer writer = map.Write();
      if (!walk.empty())
        T_cw = Rigid3d::Exp(drift) * next * T_cw_true.Inverse() * writer->PoseOf(walk.back());
      walk.push_back(world.AddKeyFrame(next, T_cw, *writer));
      if (walk.size() % 9 == 0) writer->CullKeyFrame(walk[walk.size() - 4]);
    }
    T_cw_true = next;
    keyframes.Push(walk.back());
  }
  keyframes.Close();
  looper.join();
  bundler.join();

  EXPECT_GE(found, 1);
  const SharedMap::Reader final_map = map.Read();
  EXPECT_LT(world.Error(*final_map, walk), 0.15);
  int roots = 0;
  for (const KeyFrameId id : final_map->KeyFrameIds()) {
    roots += !final_map->tree().Parent(id).valid();
    const KeyFrame& keyframe = *final_map->FindKeyFrame(id);
    for (size_t i = 0; i < keyframe.points.size(); ++i) {
      if (!keyframe.points[i].valid()) continue;
      const MapPoint* point = final_map->FindPoint(keyframe.points[i]);
      ASSERT_NE(point, nullptr);
      EXPECT_EQ(point->FeatureIn(id), static_cast<int>(i));
    }
  }
  EXPECT_EQ(roots, 1);
}

}  // namespace
}  // namespace msf
