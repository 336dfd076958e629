#include "tracking/hindsight.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tracking/test_frame.h"

namespace msf {
namespace {

constexpr double kMapsOwnError = 0.008;  // of a pose in the test map, m and rad

TEST(FrameDelayTest, FramesAreDueWhenNewerOnesHaveCome) {
  FrameDelay delay(1);
  for (int i = 0; i < 4; ++i) delay.Add({.id = FrameId(i), .time_s = 0.5 * i});
  const std::vector<TrackedFrame> due = delay.TakeDue();
  ASSERT_EQ(due.size(), 2u);
  EXPECT_EQ(due[0].id, FrameId(0));
  EXPECT_EQ(due[1].id, FrameId(1));
  EXPECT_TRUE(delay.TakeDue().empty());
  EXPECT_EQ(delay.TakeAll().size(), 2u);
  EXPECT_TRUE(delay.TakeAll().empty());
}

TEST(HindsightOptionsTest, NonsenseIsRefused) {
  TrackingOptions options;
  EXPECT_TRUE(options.Check().ok());
  options.hindsight.max_frames = 0;
  EXPECT_NE(options.Check().message().find("hindsight"), std::string::npos);
  options.hindsight = {.after_s = std::nan("")};
  EXPECT_NE(options.Check().message().find("hindsight"), std::string::npos);
}

class HindsightTest : public testing::Test {
 protected:
  // What tracking left of the frame that `at_` looks at: a pose that is off, and the points that
  // the newest keyframe shows.
  TrackedFrame Tracked(int id, const Rigid3d& error) {
    TrackedFrame frame{.id = FrameId(id),
                       .features = at_.view.features,
                       .points = std::vector<MapPointId>(at_.view.features->size()),
                       .reference = at_.keyframes.back()};
    for (const PointMatch& match :
         MatchLastFrame(at_.context, at_.map, at_.LastFrame(), *at_.view.features, at_.T_cw_true))
      frame.points[match.feature] = match.point;
    frame.T_c_reference = error * at_.T_cw_true * at_.map.PoseOf(at_.keyframes.back()).Inverse();
    return frame;
  }
  static ResolvedFrame Resolved(const TrackedFrame& frame, const Map& map) {
    return {.frame_id = frame.id,
            .state = TrackingState::kTracking,
            .T_wc = (frame.T_c_reference * map.PoseOf(frame.reference)).Inverse(),
            .map_id = map.active_map()};
  }
  static Rigid3d Shift(double x_m) {
    return {Eigen::Quaterniond::Identity(), Eigen::Vector3d(x_m, 0, 0)};
  }
  Hindsight Make(SharedMap& map) const {
    return {{*at_.world.camera(), at_.world.levels(), options_, at_.noise}, map};
  }

  TrackedWorld at_;
  TrackingOptions options_;
};

TEST_F(HindsightTest, APoseThatIsOffIsPutRight) {
  const TrackedFrame other = Tracked(2, Shift(0.01)), frame = Tracked(3, Shift(0.03));
  SharedMap map(std::move(at_.map));
  Hindsight hindsight = Make(map);
  hindsight.Match(frame);
  std::vector<ResolvedFrame> frames = {Resolved(other, *map.Read()), Resolved(frame, *map.Read())};
  hindsight.Revise(*map.Read(), frames);
  EXPECT_LT(at_.PoseError(frames[1].T_wc->Inverse()), kMapsOwnError);
  EXPECT_NEAR(at_.PoseError(frames[0].T_wc->Inverse()), 0.01, 1e-6) << "it was not matched";
}

TEST_F(HindsightTest, ThePoseFollowsThePointsOfTheFinalMap) {
  const TrackedFrame frame = Tracked(3, {});
  SharedMap map(std::move(at_.map));
  Hindsight hindsight = Make(map);
  hindsight.Match(frame);
  std::vector<ResolvedFrame> frames = {Resolved(frame, *map.Read())};
  {
    SharedMap::Writer writer = map.Write();
    for (const MapPointId id : writer->PointIds(writer->active_map()))
      writer->MovePoint(id, Shift(0.05));
  }
  hindsight.Revise(*map.Read(), frames);
  const Rigid3d T_cw_expected = at_.T_cw_true * Shift(-0.05);
  EXPECT_LT((frames[0].T_wc->Inverse() * T_cw_expected.Inverse()).Log().norm(), kMapsOwnError);
}

TEST_F(HindsightTest, PointsThatCameAfterTheFrameAreFound) {
  TrackedFrame frame = Tracked(3, Shift(0.03));
  // Few points were known at the time, too few to tell a pose.
  int known = 0;
  for (MapPointId& point : frame.points) {
    if (point.valid() && ++known > options_.min_local_inliers / 2) point = MapPointId();
  }
  SharedMap map(std::move(at_.map));
  Hindsight hindsight = Make(map);
  hindsight.Match(frame);
  std::vector<ResolvedFrame> frames = {Resolved(frame, *map.Read())};
  hindsight.Revise(*map.Read(), frames);
  EXPECT_LT(at_.PoseError(frames[0].T_wc->Inverse()), kMapsOwnError);
}

TEST_F(HindsightTest, WithTooFewPointsLeftTheFrameStaysAsItWasTracked) {
  const TrackedFrame frame = Tracked(3, Shift(0.03));
  SharedMap map(std::move(at_.map));
  Hindsight hindsight = Make(map);
  hindsight.Match(frame);
  std::vector<ResolvedFrame> frames = {Resolved(frame, *map.Read())};
  {
    SharedMap::Writer writer = map.Write();
    for (const MapPointId id : writer->PointIds(writer->active_map())) writer->RemovePoint(id);
  }
  hindsight.Revise(*map.Read(), frames);
  EXPECT_NEAR(at_.PoseError(frames[0].T_wc->Inverse()), 0.03, 1e-6);
}

TEST_F(HindsightTest, OnlyTheNewestFramesAreRevised) {
  options_.hindsight.max_frames = 1;
  const TrackedFrame older = Tracked(3, Shift(0.03)), newer = Tracked(4, Shift(0.03));
  SharedMap map(std::move(at_.map));
  Hindsight hindsight = Make(map);
  hindsight.Match(older);
  EXPECT_EQ(hindsight.num_left_out(), 0);
  hindsight.Match(newer);
  EXPECT_EQ(hindsight.num_left_out(), 1);
  std::vector<ResolvedFrame> frames = {Resolved(older, *map.Read()), Resolved(newer, *map.Read())};
  hindsight.Revise(*map.Read(), frames);
  EXPECT_NEAR(at_.PoseError(frames[0].T_wc->Inverse()), 0.03, 1e-6);
  EXPECT_LT(at_.PoseError(frames[1].T_wc->Inverse()), kMapsOwnError);
}

// A camera with a rolling shutter that turns; its first two frames are keyframes.
class HindsightOfTheFirstFrameTest : public testing::Test {
 protected:
  HindsightOfTheFirstFrameTest() {
    const auto seen = world_.Walk(0, 0.3, 0.05, Vector6d::Zero(), TestWorld::PoseOnCircle(0), map_);
    for (const MapPointId id : map_.PointsSeenBy(seen)) map_.UpdateNormalAndRange(id);
    const double interval_s = 1.0 / 30;
    const Vector6d velocity = (Truth(1) * Truth(0).Inverse()).Log() / interval_s;
    for (int i = 0; i < 2; ++i) {
      const auto view = world_.Look(Truth(i), velocity);
      KeyFrame keyframe;
      keyframe.T_cw = (i == 0 ? kError : Rigid3d()) * Truth(i);
      keyframe.features = view.features;
      keyframe.words = view.words;
      keyframe.colors_bgr.resize(view.landmarks.size());
      frames_.push_back({.id = FrameId(i),
                         .time_s = interval_s * i,
                         .features = view.features,
                         .shutter_left_in = i == 0,
                         .points = map_.PointsSeenBy(seen),
                         .reference = map_.AddKeyFrame(keyframe),
                         .T_c_reference = {}});
    }
  }
  static Rigid3d Truth(int i) { return TestWorld::PoseOnCircle(0.1 + 0.05 * i); }
  // Of the first keyframe after both frames have been matched.
  KeyFrame FirstKeyFrame() {
    SharedMap map(std::move(map_));
    Hindsight hindsight({*world_.camera(), world_.levels(), options_, noise_}, map);
    for (const TrackedFrame& frame : frames_) hindsight.Match(frame);
    return *map.Read()->FindKeyFrame(frames_[0].reference);
  }
  static double PoseError(const KeyFrame& first) {
    return (first.T_cw * Truth(0).Inverse()).Log().norm();
  }

  const Rigid3d kError{Eigen::Quaterniond::Identity(), Eigen::Vector3d(0.03, 0, 0)};
  TestWorld world_{1, 5000, 0.025};
  Map map_ = world_.EmptyMap();
  std::vector<TrackedFrame> frames_;
  const TrackingOptions options_;
  const NoiseOptions noise_;
};

TEST_F(HindsightOfTheFirstFrameTest, ItsKeyFrameIsPutRight) {
  const KeyFrame first = FirstKeyFrame();
  EXPECT_LT(PoseError(first), 0.012);
  EXPECT_NE(first.features, frames_[0].features);
}

TEST_F(HindsightOfTheFirstFrameTest, WhoseShutterWasUndoneStays) {
  frames_[0].shutter_left_in = false;
  const KeyFrame first = FirstKeyFrame();
  EXPECT_NEAR(PoseError(first), 0.03, 1e-6);
  EXPECT_EQ(first.features, frames_[0].features);
}

TEST_F(HindsightOfTheFirstFrameTest, AFrameThatBeginsAnewDoesNotTellTheVelocity) {
  frames_[1].shutter_left_in = true;
  EXPECT_NEAR(PoseError(FirstKeyFrame()), 0.03, 1e-6);
}

TEST_F(HindsightOfTheFirstFrameTest, AFrameAfterAGapDoesNotTellTheVelocity) {
  frames_[1].time_s += 1;
  EXPECT_NEAR(PoseError(FirstKeyFrame()), 0.03, 1e-6);
}

}  // namespace
}  // namespace msf
