#include "estimation/rigid_alignment_ransac.h"

#include <gtest/gtest.h>

#include <random>

namespace msf {
namespace {

struct Scene {
  Camera camera = *Camera::Preset("simulated");
  Rigid3d T_c1_c2;
  std::vector<RigidMatch> matches;
  std::vector<uint8_t> is_outlier;

  Scene(double outlier_share, double noise, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform(0, 1);
    Vector6d twist;
    for (double& value : twist) value = 0.2 * normal(random);
    T_c1_c2 = Rigid3d::Exp(twist);
    // Noise of a depth camera: sigma = noise * z^2 along the ray.
    const auto noisy = [&](const Eigen::Vector3d& p) -> Eigen::Vector3d {
      return p * (1 + noise * p.z() * normal(random)) +
             0.3 * noise * Eigen::Vector3d(normal(random), normal(random), 0);
    };
    const auto somewhere = [&]() -> Eigen::Vector3d {
      return camera.Unproject({uniform(random) * camera.width, uniform(random) * camera.height},
                              1 + 3 * uniform(random));
    };
    for (int i = 0; i < 100; ++i) {
      const Eigen::Vector3d p_c2 = somewhere();
      is_outlier.push_back(uniform(random) < outlier_share);
      matches.push_back({noisy(is_outlier.back() ? somewhere() : T_c1_c2 * p_c2), noisy(p_c2)});
    }
  }
};

double Error(const Rigid3d& a, const Rigid3d& b) {
  const Rigid3d difference = a * b.Inverse();
  return difference.translation().norm() + difference.Angle();
}

TEST(RigidAlignmentRansac, ExactWithoutNoise) {
  const Scene scene(0, 0, 1);
  const auto alignment = AlignRigidly(scene.camera, scene.matches, {});
  ASSERT_TRUE(alignment);
  EXPECT_LT(Error(alignment->T_c1_c2, scene.T_c1_c2), 1e-9);
}

TEST(RigidAlignmentRansac, FindsTheMotionAmongSixtyPercentOutliers) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const Scene scene(0.6, 0.0015, seed);
    const auto alignment = AlignRigidly(scene.camera, scene.matches, {});
    ASSERT_TRUE(alignment) << seed;
    EXPECT_LT(Error(alignment->T_c1_c2, scene.T_c1_c2), 0.03) << seed;
    int wrongly_kept = 0;
    for (size_t i = 0; i < scene.matches.size(); ++i)
      wrongly_kept += alignment->inlier[i] && scene.is_outlier[i];
    EXPECT_LE(wrongly_kept, 1) << seed;
    EXPECT_GE(alignment->num_inliers, 25) << seed;
  }
}

TEST(RigidAlignmentRansac, RepeatsBitForBit) {
  const Scene scene(0.5, 0.0015, 2);
  const auto a = AlignRigidly(scene.camera, scene.matches, {}),
             b = AlignRigidly(scene.camera, scene.matches, {});
  EXPECT_EQ(a->T_c1_c2.translation(), b->T_c1_c2.translation());
  EXPECT_EQ(a->inlier, b->inlier);
}

TEST(RigidAlignmentRansac, NothingForWrongMatchesOrPointsOnALine) {
  const Scene wrong(1, 0, 1);
  EXPECT_FALSE(AlignRigidly(wrong.camera, wrong.matches, {}));
  Scene line(0, 0, 1);
  for (size_t i = 0; i < line.matches.size(); ++i) {
    line.matches[i].p_c2 = {0, 0, 1 + 0.01 * i};
    line.matches[i].p_c1 = line.T_c1_c2 * line.matches[i].p_c2;
  }
  EXPECT_FALSE(AlignRigidly(line.camera, line.matches, {}));
}

TEST(RigidAlignmentRansac, NoInlierBehindACameraOrWithoutNumber) {
  Scene scene(0, 0, 1);
  scene.matches[3].p_c1 *= -1;
  scene.matches[4].p_c2.y() = std::nan("");
  const auto alignment = AlignRigidly(scene.camera, scene.matches, {});
  ASSERT_TRUE(alignment);
  EXPECT_FALSE(alignment->inlier[3]);
  EXPECT_FALSE(alignment->inlier[4]);
  EXPECT_EQ(alignment->num_inliers, 98);
}

}  // namespace
}  // namespace msf
