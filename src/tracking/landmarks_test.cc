#include "tracking/landmarks.h"

#include <gtest/gtest.h>

#include "tracking/test_frame.h"

namespace msf {
namespace {

class LandmarksTest : public ::testing::Test {
 protected:
  void SetUp() override {
    RgbdFrame image;
    image.time_s = 100;  // long after the keyframes
    frame_.image = std::make_shared<const RgbdFrame>(image);
    frame_.features = at_.view.features;
    frame_.T_cw = at_.T_cw_true;
    matches_ =
        MatchLastFrame(at_.context, at_.map, at_.LastFrame(), *at_.view.features, at_.T_cw_true);
    ASSERT_GT(matches_.size(), 150u);
  }
  std::vector<Landmark> Find(const TrackingOptions& options) const {
    const TrackingContext context{at_.map.camera(), at_.map.levels(), options, at_.noise};
    return FindLandmarks(context, at_.map, frame_, *at_.view.features, matches_);
  }

  TrackedWorld at_;
  Frame frame_;
  std::vector<PointMatch> matches_;
};

TEST_F(LandmarksTest, AreWhereTheImageShowsThem) {
  const std::vector<Landmark> landmarks = Find({.max_landmarks = 10000});
  ASSERT_EQ(landmarks.size(), matches_.size());
  for (size_t k = 0; k < landmarks.size(); ++k) {
    const int feature = matches_[k].feature;
    EXPECT_EQ(landmarks[k].image_px, at_.view.features->image_px[feature]);
    const Eigen::Vector2d px = at_.map.camera().Project(landmarks[k].p_c);
    EXPECT_LT((px - at_.view.features->uv_px[feature].cast<double>()).norm(), 1e-3);
    EXPECT_NEAR(landmarks[k].p_c.z(), (at_.T_cw_true * matches_[k].p_w).z(), 0.05);
  }
}

TEST_F(LandmarksTest, AreNoYoungPoints) { EXPECT_TRUE(Find({.landmark_age_s = 1000}).empty()); }

TEST_F(LandmarksTest, AreNoPointsInDoubt) {
  const size_t all = Find({.max_landmarks = 10000}).size();
  for (int k = 0; k < 20; ++k) {
    for (int times = 0; times < 10; ++times)
      at_.map.ObserveStaticProbability(matches_[k].point, 0.1f);
  }
  EXPECT_EQ(Find({.max_landmarks = 10000}).size(), all - 20);
}

TEST_F(LandmarksTest, AreAtMostSoManyFromEverywhere) {
  const std::vector<Landmark> all = Find({.max_landmarks = 10000}),
                              few = Find({.max_landmarks = 50});
  ASSERT_EQ(few.size(), 50u);
  EXPECT_EQ(few.front().image_px, all.front().image_px);
  EXPECT_EQ(few[25].image_px, all[all.size() / 2].image_px);
  EXPECT_TRUE(Find({.max_landmarks = 0}).empty());
}

TEST_F(LandmarksTest, AreNoRemovedFeaturesThatCameBack) {
  matches_.resize(10);
  matches_.back().feature = at_.view.features->size();
  EXPECT_EQ(Find({}).size(), 9u);
}

}  // namespace
}  // namespace msf
