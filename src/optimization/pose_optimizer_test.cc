#include "optimization/pose_optimizer.h"

#include <gtest/gtest.h>

#include "optimization/test_scene.h"

namespace msf {
namespace {

struct Case {
  Camera camera = TestCamera();
  BundleProblem problem;
  std::vector<uint8_t> is_outlier;
  std::vector<PoseObservation> observations;
  Rigid3d T_cw_true, T_cw_initial;

  explicit Case(const TestSceneOptions& scene) {
    problem = MakeTestProblem(camera, scene, &is_outlier);
    observations = ObservationsOfPose(problem, 0);
    T_cw_true = problem.poses[0].T_cw;
    Vector6d twist;
    twist << 0.04, -0.03, 0.02, 0.02, -0.03, 0.02;
    T_cw_initial = Rigid3d::Exp(twist) * T_cw_true;
  }
  PoseEstimate Optimize(const PoseOptimizerOptions& options = {}) const {
    return OptimizePose(camera, T_cw_initial, observations, options);
  }
};

TestSceneOptions OnePose(double noise_px, double outlier_share, double depth_share = 0.9) {
  TestSceneOptions scene;
  scene.num_poses = 1;
  scene.noise_px = noise_px;
  scene.outlier_share = outlier_share;
  scene.depth_share = depth_share;
  return scene;
}

TEST(PoseOptimizer, FindsTheExactPoseWithoutNoise) {
  for (const double depth_share : {0.0, 0.5, 1.0}) {
    TestSceneOptions scene = OnePose(0, 0, depth_share);
    scene.disparity_noise_px = 0;
    const Case c(scene);
    const PoseEstimate estimate = c.Optimize();
    EXPECT_LT(PoseError(estimate.T_cw, c.T_cw_true), 1e-8) << depth_share;
    EXPECT_EQ(estimate.num_inliers, static_cast<int>(c.observations.size()));
  }
}

TEST(PoseOptimizer, SeparatesOutliersAmongNoisyMatches) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    TestSceneOptions scene = OnePose(1.0, 0.3);
    scene.seed = seed;
    const Case c(scene);
    const PoseEstimate estimate = c.Optimize();
    EXPECT_LT(PoseError(estimate.T_cw, c.T_cw_true), 0.006) << seed;
    int wrongly_kept = 0, wrongly_dropped = 0, num_true = 0;
    for (size_t i = 0; i < c.observations.size(); ++i) {
      wrongly_kept += c.is_outlier[i] && estimate.inlier[i];
      wrongly_dropped += !c.is_outlier[i] && !estimate.inlier[i];
      num_true += !c.is_outlier[i];
    }
    EXPECT_LE(wrongly_kept, 2) << seed;
    EXPECT_LE(wrongly_dropped, 0.1 * num_true) << "the gate drops 5 % of the good ones";
  }
}

TEST(PoseOptimizer, WeightZeroIsIgnored) {
  Case c(OnePose(0.5, 0));
  const size_t half = c.observations.size() / 2;
  // A moving object: half of the points slid away together.
  for (size_t i = 0; i < half; ++i) {
    c.observations[i].weight = 0;
    c.observations[i].uv_px.x() += 25;
  }
  const PoseEstimate estimate = c.Optimize();
  EXPECT_LT(PoseError(estimate.T_cw, c.T_cw_true), 0.004);
  for (size_t i = 0; i < half; ++i) EXPECT_FALSE(estimate.inlier[i]);
  const std::vector<PoseObservation> rest(c.observations.begin() + half, c.observations.end());
  const PoseEstimate without = OptimizePose(c.camera, c.T_cw_initial, rest, {});
  EXPECT_LT(PoseError(estimate.T_cw, without.T_cw), 1e-9);
}

TEST(PoseOptimizer, SmallWeightPullsLess) {
  Case c(OnePose(0, 0, /*depth_share=*/0));
  for (PoseObservation& observation : c.observations) observation.inv_sigma2 = 1;
  for (size_t i = 0; i < c.observations.size() / 2; ++i) c.observations[i].uv_px.x() += 1;
  const double shift = PoseError(c.Optimize().T_cw, c.T_cw_true);
  for (size_t i = 0; i < c.observations.size() / 2; ++i) c.observations[i].weight = 0.05;
  EXPECT_LT(PoseError(c.Optimize().T_cw, c.T_cw_true), 0.2 * shift);
}

TEST(PoseOptimizer, OutliersOfABadStartComeBack) {
  Case c(OnePose(0.5, 0));
  Vector6d twist;
  twist << 0.2, -0.15, 0.1, 0.1, -0.1, 0.1;
  c.T_cw_initial = Rigid3d::Exp(twist) * c.T_cw_true;
  const PoseEstimate estimate = c.Optimize();
  EXPECT_LT(PoseError(estimate.T_cw, c.T_cw_true), 0.004);
  EXPECT_GT(estimate.num_inliers, 0.9 * c.observations.size());
}

TEST(PoseOptimizer, TooFewObservationsLeaveThePose) {
  const Case c(OnePose(0.5, 0));
  for (int count = 0; count < 4; ++count) {
    const std::vector<PoseObservation> few(c.observations.begin(), c.observations.begin() + count);
    const PoseEstimate estimate = OptimizePose(c.camera, c.T_cw_initial, few, {});
    EXPECT_EQ(estimate.num_inliers, 0);
    EXPECT_EQ(PoseError(estimate.T_cw, c.T_cw_initial), PoseError(c.T_cw_initial, c.T_cw_initial));
    EXPECT_EQ(estimate.inlier, std::vector<uint8_t>(count, 0));
  }
}

TEST(PoseOptimizer, SurvivesPointsBehindTheCameraAndNaN) {
  Case c(OnePose(0.5, 0));
  c.observations[0].p_w = c.T_cw_true.Inverse() * Eigen::Vector3d(0.1, 0.1, -1);
  c.observations[1].p_w = c.T_cw_true.Inverse() * Eigen::Vector3d(0.1, 0.1, 1e-4);
  c.observations[2].p_w.x() = std::nan("");
  c.observations[3].uv_px.y() = std::numeric_limits<double>::infinity();
  c.observations[4].inv_sigma2 = std::nan("");
  const PoseEstimate estimate = c.Optimize();
  EXPECT_LT(PoseError(estimate.T_cw, c.T_cw_true), 0.004);
  for (int i = 0; i < 5; ++i) EXPECT_FALSE(estimate.inlier[i]) << i;
  for (PoseObservation& observation : c.observations) observation.p_w = -observation.p_w;
  EXPECT_EQ(c.Optimize().num_inliers, 0);
}

TEST(PoseOptimizer, SurvivesOnePointSeenManyTimes) {
  Case c(OnePose(0.5, 0));
  for (PoseObservation& observation : c.observations) observation = c.observations[0];
  const PoseEstimate estimate = c.Optimize();
  EXPECT_TRUE(estimate.T_cw.RotationMatrix().allFinite());
  EXPECT_TRUE(estimate.T_cw.translation().allFinite());
}

TEST(PoseOptimizer, OptionsAreChecked) {
  EXPECT_TRUE(PoseOptimizerOptions{}.Check().ok());
  EXPECT_FALSE(PoseOptimizerOptions{.rounds = 0}.Check().ok());
  EXPECT_FALSE(PoseOptimizerOptions{.robust_rounds = 9}.Check().ok());
}

}  // namespace
}  // namespace msf
