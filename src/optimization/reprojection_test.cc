#include "optimization/reprojection.h"

#include <gtest/gtest.h>

#include "optimization/test_scene.h"

namespace msf {
namespace {

ImageObservation SomeObservation(bool with_depth) {
  ImageObservation observation;
  observation.uv_px = {300, 200};
  observation.disparity_px = with_depth ? 21 : -1;
  observation.inv_sigma2 = 0.7;
  observation.inv_sigma2_disparity = 30;
  observation.weight = 0.8;
  return observation;
}

TEST(Reprojection, JacobianAgreesWithDifferences) {
  const Camera camera = TestCamera();
  for (const double z_m : {1.9, 0.05, -1.0}) {
    const Eigen::Vector3d p_c(0.4, -0.3, z_m);
    const Eigen::Matrix3d jacobian = ReprojectionJacobian(camera, p_c).Matrix();
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d step = 1e-6 * Eigen::Vector3d::Unit(k);
      const Eigen::Vector3d numeric =
          (ReprojectionResidual(camera, p_c + step, SomeObservation(true)) -
           ReprojectionResidual(camera, p_c - step, SomeObservation(true))) /
          2e-6;
      EXPECT_LT((numeric - jacobian.col(k)).norm(), 1e-6 * (1 + numeric.norm())) << z_m << " " << k;
    }
  }
}

TEST(Reprojection, PullIsTheGradientOfTheCost) {
  const Camera camera = TestCamera();
  for (const bool with_depth : {false, true}) {
    for (const bool robust : {false, true}) {
      const ImageObservation observation = SomeObservation(with_depth);
      const Eigen::Vector3d p_c(-0.1, -0.2, 1.9);
      const auto cost = [&](const Eigen::Vector3d& p) {
        return PullOnPoint(camera, p, observation, 6, robust).cost;
      };
      ASSERT_GT(cost(p_c), 6) << "the kernel must be at work";
      Eigen::Vector3d numeric;
      for (int k = 0; k < 3; ++k) {
        const Eigen::Vector3d step = 1e-7 * Eigen::Vector3d::Unit(k);
        numeric[k] = (cost(p_c + step) - cost(p_c - step)) / 2e-7;
      }
      // The cost is the sum of squares without the half: its derivative is twice J^T W r.
      const Eigen::Vector3d gradient =
          2 * PullOnPoint(camera, p_c, observation, 6, robust).gradient;
      EXPECT_LT((numeric - gradient).norm(), 1e-5 * gradient.norm()) << with_depth << robust;
    }
  }
}

// The disparity's own kernel: a wrong depth stops pulling and leaves the position in the image to
// decide.
TEST(Reprojection, DisparityKernelLetsGoOfAWrongDepth) {
  const Camera camera = TestCamera();
  ImageObservation observation = SomeObservation(true);
  observation.inv_knee_disparity = 0.1;
  const Eigen::Vector3d p_c(-0.1, -0.2, 1.9);
  const auto pull = [&](const Eigen::Vector3d& p) {
    return PullOnPoint(camera, p, observation, 1e9, false);
  };
  Eigen::Vector3d numeric;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d step = 1e-6 * Eigen::Vector3d::Unit(k);
    numeric[k] = (pull(p_c + step).cost - pull(p_c - step).cost) / 2e-6;
  }
  EXPECT_LT((numeric - 2 * pull(p_c).gradient).norm(), 1e-5 * numeric.norm());
  observation.disparity_px = 60;
  const double cost_of_wrong_depth = pull(p_c).cost;
  observation.disparity_px = -1;
  EXPECT_LT(cost_of_wrong_depth - pull(p_c).cost, observation.weight / 0.1);
  EXPECT_NEAR(DisparityCost(4, 0), 4, 1e-12);
  EXPECT_NEAR(DisparityWeight(4, 0), 1, 1e-12);
}

TEST(Reprojection, PullInformationIsThatOfTheJacobian) {
  const Camera camera = TestCamera();
  const Eigen::Vector3d p_c(-0.1, -0.2, 1.9);
  for (const bool with_depth : {false, true}) {
    const ImageObservation observation = SomeObservation(with_depth);
    const Eigen::Matrix3d jacobian = ReprojectionJacobian(camera, p_c).Matrix();
    const Eigen::Vector3d information =
        observation.weight * Eigen::Vector3d(observation.inv_sigma2, observation.inv_sigma2,
                                             with_depth ? observation.inv_sigma2_disparity : 0);
    const Eigen::Matrix3d expected = jacobian.transpose() * information.asDiagonal() * jacobian;
    EXPECT_LT((PullOnPoint(camera, p_c, observation, 6, false).information - expected).norm(),
              1e-9 * expected.norm());
  }
}

TEST(Reprojection, HuberIsSmoothAtItsKnee) {
  EXPECT_DOUBLE_EQ(HuberCost(5.991, 5.991), 5.991);
  EXPECT_NEAR(HuberCost(5.992, 5.991), 5.992, 1e-6);
  EXPECT_DOUBLE_EQ(HuberWeight(4 * 5.991, 5.991), 0.5);
  EXPECT_NEAR((HuberCost(40.001, 6) - HuberCost(39.999, 6)) / 0.002, HuberWeight(40, 6), 1e-6);
}

TEST(Reprojection, NoInlierBehindTheCameraButAFiniteContinuousCost) {
  const Camera camera = TestCamera();
  const ImageObservation observation = SomeObservation(true);
  EXPECT_TRUE(std::isinf(ReprojectionChi2(camera, {0.1, 0.1, -1}, observation)));
  const auto cost = [&](double z_m) {
    return PullOnPoint(camera, {0.1, 0.1, z_m}, observation, 7.815, true).cost;
  };
  EXPECT_NEAR(cost(kMinProjectionDepth_m + 1e-9), cost(kMinProjectionDepth_m - 1e-9), 1e-3);
  EXPECT_GT(cost(-1), 100);
  EXPECT_TRUE(std::isfinite(cost(0)));
}

TEST(Reprojection, UnusableObservationsAreRecognised) {
  ImageObservation observation = SomeObservation(true);
  EXPECT_TRUE(observation.Usable());
  observation.weight = 0;
  EXPECT_FALSE(observation.Usable());
  observation = SomeObservation(true);
  observation.uv_px.x() = std::nan("");
  EXPECT_FALSE(observation.Usable());
  observation = SomeObservation(true);
  observation.disparity_px = std::nan("");
  EXPECT_FALSE(observation.Usable());
}

}  // namespace
}  // namespace msf
