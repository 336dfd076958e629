#include "estimation/pnp.h"

#include <gtest/gtest.h>

#include <random>

namespace msf {
namespace {

struct Scene {
  Camera camera = *Camera::Preset("simulated");
  Rigid3d T_cw;
  std::vector<PnpMatch> matches;
  std::vector<uint8_t> is_outlier;

  Scene(double outlier_share, double noise_px, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform(0, 1);
    Vector6d twist;
    for (double& value : twist) value = normal(random);
    T_cw = Rigid3d::Exp(twist);
    for (int i = 0; i < 120; ++i) {
      PnpMatch match;
      match.uv_px = {uniform(random) * camera.width, uniform(random) * camera.height};
      match.p_w = T_cw.Inverse() * camera.Unproject(match.uv_px, 0.5 + 4 * uniform(random));
      match.uv_px += noise_px * Eigen::Vector2d(normal(random), normal(random));
      is_outlier.push_back(uniform(random) < outlier_share);
      if (is_outlier.back())
        match.uv_px = {uniform(random) * camera.width, uniform(random) * camera.height};
      matches.push_back(match);
    }
  }
};

double Error(const Rigid3d& a, const Rigid3d& b) {
  const Rigid3d difference = a * b.Inverse();
  return difference.translation().norm() + difference.Angle();
}

TEST(Pnp, ExactWithoutNoise) {
  const Scene scene(0, 0, 1);
  const auto estimate = EstimatePose(scene.camera, scene.matches, {});
  ASSERT_TRUE(estimate);
  EXPECT_LT(Error(estimate->T_cw, scene.T_cw), 1e-6);
  EXPECT_EQ(estimate->num_inliers, 120);
}

TEST(Pnp, FindsThePoseAmongSixtyPercentOutliers) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const Scene scene(0.6, 0.7, seed);
    const auto estimate = EstimatePose(scene.camera, scene.matches, {});
    ASSERT_TRUE(estimate) << seed;
    EXPECT_LT(Error(estimate->T_cw, scene.T_cw), 0.02) << seed;
    int wrongly_kept = 0;
    for (size_t i = 0; i < scene.matches.size(); ++i)
      wrongly_kept += estimate->inlier[i] && scene.is_outlier[i];
    EXPECT_LE(wrongly_kept, 1) << seed;
  }
}

TEST(Pnp, RepeatsBitForBit) {
  const Scene scene(0.5, 0.7, 1);
  const auto a = EstimatePose(scene.camera, scene.matches, {}),
             b = EstimatePose(scene.camera, scene.matches, {});
  EXPECT_EQ(a->T_cw.translation(), b->T_cw.translation());
  EXPECT_EQ(a->T_cw.rotation().coeffs(), b->T_cw.rotation().coeffs());
  EXPECT_EQ(a->inlier, b->inlier);
}

TEST(Pnp, NothingForWrongOrTooFewMatches) {
  const Scene scene(1, 0, 1);
  EXPECT_FALSE(EstimatePose(scene.camera, scene.matches, {}));
  const Scene good(0, 0, 1);
  EXPECT_FALSE(EstimatePose(good.camera, std::span(good.matches).first(9), {}));
  EXPECT_FALSE(EstimatePose(good.camera, {}, {}));
}

TEST(Pnp, SurvivesDegenerateMatches) {
  Scene scene(0, 0.5, 1);
  for (size_t i = 0; i < scene.matches.size(); i += 6) scene.matches[i].p_w.x() = std::nan("");
  const auto estimate = EstimatePose(scene.camera, scene.matches, {});
  ASSERT_TRUE(estimate);
  EXPECT_FALSE(estimate->inlier[0]);
  for (PnpMatch& match : scene.matches) match.p_w = {1, 1, 1};
  EXPECT_FALSE(EstimatePose(scene.camera, scene.matches, {}));
}

}  // namespace
}  // namespace msf
