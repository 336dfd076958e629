#include "tracking/first_frame.h"

#include <gtest/gtest.h>

#include "feature/rolling_shutter.h"
#include "map/test_world.h"

namespace msf {
namespace {

constexpr double kInterval_s = 1.0 / 30;

// A camera with a rolling shutter that goes along the circle at 1.5 rad/s.
class FirstFrameTest : public testing::Test {
 protected:
  FirstFrameTest() {
    const auto keyframes =
        world_.Walk(0, 0.3, 0.05, Vector6d::Zero(), TestWorld::PoseOnCircle(0), map_);
    for (const MapPointId id : map_.PointsSeenBy(keyframes)) {
      map_.UpdateNormalAndRange(id);
      points_.emplace_back(*map_.FindPoint(id));
    }
    velocity_ = (next_ * truth_.Inverse()).Log() / kInterval_s;
    features_ = world_.Look(truth_, velocity_).features;
  }
  std::optional<FirstFrame> Settle() {
    return SettleFirstFrame(context_, points_, *features_, kError * truth_, next_, kInterval_s);
  }
  double PoseError(const FirstFrame& first) const {
    return (first.T_cw * truth_.Inverse()).Log().norm();
  }

  const Rigid3d kError{Eigen::Quaterniond::Identity(), Eigen::Vector3d(0.04, 0, 0)};
  const Rigid3d truth_ = TestWorld::PoseOnCircle(0.1);
  Rigid3d next_ = TestWorld::PoseOnCircle(0.15);
  TestWorld world_{1, 5000, 0.025};
  Map map_ = world_.EmptyMap();
  std::vector<PointSnapshot> points_;
  Vector6d velocity_;
  std::shared_ptr<const FrameFeatures> features_;
  const TrackingOptions options_;
  const NoiseOptions noise_;
  const TrackingContext context_{map_.camera(), map_.levels(), options_, noise_};
};

TEST_F(FirstFrameTest, PoseAndFeaturesBecomeThoseOfAStillCamera) {
  const std::optional<FirstFrame> first = Settle();
  ASSERT_TRUE(first);
  EXPECT_LT(PoseError(*first), 0.01);
  EXPECT_GT(first->matches.size(), 100u);
  const FrameFeatures still = UndoRollingShutter(*features_, *world_.camera(), velocity_);
  double bent_px = 0, left_px = 0;
  for (int i = 0; i < still.size(); ++i) {
    bent_px += (features_->uv_px[i] - still.uv_px[i]).norm() / still.size();
    left_px += (first->features->uv_px[i] - still.uv_px[i]).norm() / still.size();
  }
  EXPECT_GT(bent_px, 2);
  EXPECT_LT(left_px, 0.5);
}

TEST_F(FirstFrameTest, WithoutPointsThePoseStays) {
  points_.clear();
  const std::optional<FirstFrame> first = Settle();
  ASSERT_TRUE(first);
  EXPECT_NEAR(PoseError(*first), 0.04, 1e-6);
}

TEST_F(FirstFrameTest, OfASlowCameraNothingIsUndone) {
  features_ = world_.Look(truth_).features;
  next_ = TestWorld::PoseOnCircle(0.101);
  EXPECT_FALSE(Settle());
}

}  // namespace
}  // namespace msf
