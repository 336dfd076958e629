#include "optimization/bundle_adjustment.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "optimization/test_ceres_bundle.h"
#include "optimization/test_scene.h"

namespace msf {
namespace {

double MaxPoseError(const BundleProblem& a, const BundleProblem& b) {
  double error = 0;
  for (size_t i = 0; i < a.poses.size(); ++i)
    error = std::max(error, PoseError(a.poses[i].T_cw, b.poses[i].T_cw));
  return error;
}

double MedianPointError(const BundleProblem& a, const BundleProblem& b) {
  std::vector<double> errors;
  for (size_t i = 0; i < a.points.size(); ++i)
    errors.push_back((a.points[i].p_w - b.points[i].p_w).norm());
  std::nth_element(errors.begin(), errors.begin() + errors.size() / 2, errors.end());
  return errors[errors.size() / 2];
}

BundleOptions Exact() {
  BundleOptions options;
  options.robust_iterations = 20;
  options.final_iterations = 20;
  options.function_tolerance = 0;
  return options;
}

TEST(BundleAdjustment, FindsTheExactSceneWithoutNoise) {
  TestSceneOptions scene;
  scene.noise_px = scene.disparity_noise_px = 0;
  const BundleProblem truth = [&] {
    BundleProblem problem = MakeTestProblem(TestCamera(), scene);
    problem.poses[0].fixed = true;
    return problem;
  }();
  BundleProblem problem = truth;
  Perturb(problem, 0.01, 0.03, 7);
  const BundleResult result = SolveBundle(TestCamera(), problem, Exact());
  EXPECT_TRUE(result.usable);
  EXPECT_LT(MaxPoseError(problem, truth), 1e-7);
  EXPECT_LT(MedianPointError(problem, truth), 1e-7);
  EXPECT_LT(result.final_cost, 1e-9 * result.initial_cost);
}

TEST(BundleAdjustment, RecoversTheSceneAndFindsTheOutliers) {
  TestSceneOptions scene;
  scene.noise_px = 1;
  scene.outlier_share = 0.1;
  std::vector<uint8_t> is_outlier;
  BundleProblem truth = MakeTestProblem(TestCamera(), scene, &is_outlier);
  truth.poses[0].fixed = truth.poses[9].fixed = true;
  BundleProblem problem = truth;
  Perturb(problem, 0.005, 0.02, 3);
  const BundleResult result = SolveBundle(TestCamera(), problem, {});
  EXPECT_TRUE(result.usable);
  EXPECT_LT(MaxPoseError(problem, truth), 0.006);
  EXPECT_LT(MedianPointError(problem, truth), 0.01);
  int agree = 0;
  for (size_t i = 0; i < is_outlier.size(); ++i) agree += result.inlier[i] != is_outlier[i];
  EXPECT_GT(agree, 0.93 * is_outlier.size());
}

TEST(BundleAdjustment, FixedPosesAndPointsStay) {
  BundleProblem problem = MakeTestProblem(TestCamera(), {});
  Perturb(problem, 0.005, 0.02, 3);
  problem.poses[0].fixed = problem.poses[4].fixed = true;
  for (size_t i = 0; i < problem.points.size(); i += 3) problem.points[i].fixed = true;
  const BundleProblem before = problem;
  ASSERT_TRUE(SolveBundle(TestCamera(), problem, {}).usable);
  for (size_t i = 0; i < problem.poses.size(); ++i) {
    const bool same = problem.poses[i].T_cw.translation() == before.poses[i].T_cw.translation();
    EXPECT_EQ(same, problem.poses[i].fixed) << i;
  }
  for (size_t i = 0; i < problem.points.size(); ++i) {
    EXPECT_EQ(problem.points[i].p_w == before.points[i].p_w, problem.points[i].fixed) << i;
  }
}

// Ceres' Huber counts rows of one residual block together, as ours does: the minima are the same.
TEST(BundleAdjustment, AgreesWithCeres) {
  for (const bool robust : {false, true}) {
    BundleProblem ours = MakeTestProblem(
        TestCamera(), {.noise_px = 1, .depth_share = 0.7, .outlier_share = robust ? 0.05 : 0});
    ours.poses[0].fixed = ours.poses[1].fixed = true;
    for (size_t i = 0; i < ours.points.size(); i += 10) ours.points[i].fixed = true;
    for (size_t i = 0; i < ours.observations.size(); i += 5) ours.observations[i].weight = 0.3;
    Perturb(ours, 0.003, 0.01, 3);
    BundleProblem ceres = ours;
    BundleOptions options = Exact();
    options.robust_iterations = robust ? 100 : 0;
    options.final_iterations = robust ? 0 : 100;
    if (!robust) options.chi2_two = options.chi2_three = 1e9;  // keep everything
    SolveBundle(TestCamera(), ours, options);
    SolveBundleWithCeres(TestCamera(), ceres, options, robust, 200);
    EXPECT_LT(MaxPoseError(ours, ceres), 1e-6) << robust;
    EXPECT_LT(MedianPointError(ours, ceres), 1e-6) << robust;
  }
}

TEST(BundleAdjustment, SparseAndDenseCameraSystemsAgree) {
  BundleProblem truth =
      MakeTestProblem(TestCamera(), {.num_poses = 30, .num_points = 600, .window = 6});
  truth.poses[0].fixed = true;
  Perturb(truth, 0.005, 0.02, 3);
  BundleProblem dense = truth, sparse = truth;
  BundleOptions options = Exact();
  SolveBundle(TestCamera(), dense, options);
  options.max_dense_poses = 0;
  SolveBundle(TestCamera(), sparse, options);
  EXPECT_LT(MaxPoseError(dense, sparse), 1e-7);
}

TEST(BundleAdjustment, WeightZeroIsIgnored) {
  BundleProblem all = MakeTestProblem(TestCamera(), {});
  all.poses[0].fixed = true;
  Perturb(all, 0.005, 0.02, 3);
  BundleProblem rest = all;
  rest.observations.clear();
  for (size_t i = 0; i < all.observations.size(); ++i) {
    if (i % 4 == 0) {
      all.observations[i].weight = 0;
      all.observations[i].uv_px.x() += 40;
    } else {
      rest.observations.push_back(all.observations[i]);
    }
  }
  const BundleResult result = SolveBundle(TestCamera(), all, {});
  SolveBundle(TestCamera(), rest, {});
  EXPECT_EQ(MaxPoseError(all, rest), MaxPoseError(all, all));
  for (size_t i = 0; i < all.observations.size(); i += 4) EXPECT_FALSE(result.inlier[i]);
}

TEST(BundleAdjustment, RepeatsBitForBit) {
  BundleProblem a = MakeTestProblem(TestCamera(), {.outlier_share = 0.05});
  a.poses[0].fixed = true;
  Perturb(a, 0.005, 0.02, 3);
  BundleProblem b = a;
  const BundleResult result_a = SolveBundle(TestCamera(), a, {}),
                     result_b = SolveBundle(TestCamera(), b, {});
  EXPECT_EQ(result_a.final_cost, result_b.final_cost);
  for (size_t i = 0; i < a.poses.size(); ++i) {
    EXPECT_EQ(a.poses[i].T_cw.translation(), b.poses[i].T_cw.translation());
    EXPECT_EQ(a.poses[i].T_cw.rotation().coeffs(), b.poses[i].T_cw.rotation().coeffs());
  }
  for (size_t i = 0; i < a.points.size(); ++i) EXPECT_EQ(a.points[i].p_w, b.points[i].p_w);
}

TEST(BundleAdjustment, CancelledBeforeTheStartChangesNothing) {
  BundleProblem problem = MakeTestProblem(TestCamera(), {});
  Perturb(problem, 0.005, 0.02, 3);
  const BundleProblem before = problem;
  const std::atomic<bool> cancel = true;
  const BundleResult result = SolveBundle(TestCamera(), problem, {}, &cancel);
  EXPECT_TRUE(result.cancelled);
  EXPECT_FALSE(result.usable);
  EXPECT_EQ(result.iterations, 0);
  for (size_t i = 0; i < problem.points.size(); ++i)
    EXPECT_EQ(problem.points[i].p_w, before.points[i].p_w);
}

TEST(BundleAdjustment, SurvivesDegenerateInput) {
  BundleProblem empty;
  EXPECT_FALSE(SolveBundle(TestCamera(), empty, {}).usable);

  BundleProblem problem = MakeTestProblem(TestCamera(), {.num_points = 60, .depth_share = 0.5});
  problem.poses[0].fixed = true;
  problem.points.push_back({{1, 2, 3}});   // seen by nobody
  problem.points.push_back({{0, 0, -3}});  // behind the camera that claims to see it
  problem.points.push_back({{std::nan(""), 0, 1}});
  problem.poses.push_back({problem.poses[3].T_cw});  // sees nothing
  BundleObservation observation = problem.observations[0];
  for (int point = 61; point <= 62; ++point) {
    observation.point = point;
    problem.observations.push_back(observation);
  }
  problem.observations.push_back(problem.observations[0]);  // the same sighting twice
  problem.observations[1].uv_px.x() = std::nan("");
  const BundleResult result = SolveBundle(TestCamera(), problem, {});
  EXPECT_TRUE(result.usable);
  EXPECT_FALSE(result.inlier[1]);
  EXPECT_FALSE(result.inlier[problem.observations.size() - 2]);
  for (const BundlePose& pose : problem.poses) EXPECT_TRUE(pose.T_cw.translation().allFinite());
  EXPECT_EQ(problem.points[60].p_w, Eigen::Vector3d(1, 2, 3));
}

TEST(BundleAdjustment, AnObservationOfNothingIsABrokenContract) {
  BundleProblem problem = MakeTestProblem(TestCamera(), {.num_points = 20});
  problem.observations[0].point = 20;
  EXPECT_THROW(SolveBundle(TestCamera(), problem, {}), ContractViolation);
}

}  // namespace
}  // namespace msf
