#include "optimization/feature_observation.h"

#include <gtest/gtest.h>

namespace msf {
namespace {

class FeatureObservationTest : public testing::Test {
 protected:
  FeatureObservationTest() {
    camera_.disparity_noise_px = 0.5;
    features_.uv_px = {{100, 50}, {200, 80}};
    features_.depth_m = {2, 0};
    camera_.bf = 40;
    features_.level = {0, 2};
    features_.static_weight = {1, 1};
  }
  ImageObservation Observe(int feature) const {
    return ObserveFeature(features_, feature, camera_, {8, 2}, noise_, 0.7);
  }

  Camera camera_ = *Camera::Preset("simulated");
  FrameFeatures features_;
  NoiseOptions noise_;
};

TEST_F(FeatureObservationTest, DepthIsTrustedAsFarAsTheCamerasCanBe) {
  const ImageObservation observation = Observe(0);
  EXPECT_DOUBLE_EQ(observation.disparity_px, 20);
  EXPECT_DOUBLE_EQ(observation.inv_sigma2, 1);
  EXPECT_DOUBLE_EQ(observation.inv_sigma2_disparity, 4);
  EXPECT_DOUBLE_EQ(observation.weight, 0.7);
}

TEST_F(FeatureObservationTest, TheOptionGoesBeforeTheCamera) {
  noise_.disparity_sigma_px = 0.25;
  EXPECT_DOUBLE_EQ(Observe(0).inv_sigma2_disparity, 16);
}

TEST_F(FeatureObservationTest, NoiseGrowsWithTheLevel) {
  EXPECT_DOUBLE_EQ(Observe(1).inv_sigma2, 1.0 / 16);
  EXPECT_FALSE(Observe(1).HasDepth());
  features_.level[0] = 1;
  EXPECT_DOUBLE_EQ(Observe(0).inv_sigma2_disparity, 1);
  noise_.disparity_level_share = 0;
  EXPECT_DOUBLE_EQ(Observe(0).inv_sigma2_disparity, 4);
}

}  // namespace
}  // namespace msf
