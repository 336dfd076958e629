#include "geometry/rigid3d.h"

#include <gtest/gtest.h>

#include <random>

namespace msf {
namespace {

Vector6d RandomTwist(std::mt19937& random, double angle) {
  std::normal_distribution<double> normal;
  Vector6d twist;
  for (double& value : twist) value = normal(random);
  twist.tail<3>() *= angle / twist.tail<3>().norm();
  return twist;
}

TEST(Rigid3d, ExpAndLogAreInverse) {
  std::mt19937 random(1);
  for (const double angle : {0.0, 1e-10, 1e-6, 0.1, 1.0, 3.0}) {
    const Vector6d twist = RandomTwist(random, angle);
    EXPECT_LT((Rigid3d::Exp(twist).Log() - twist).norm(), 1e-9) << angle;
  }
}

TEST(Rigid3d, ExpIsTheMatrixExponential) {
  std::mt19937 random(2);
  const Vector6d twist = RandomTwist(random, 0.7);
  Eigen::Matrix4d generator = Eigen::Matrix4d::Zero();
  generator.topLeftCorner<3, 3>() = Hat(twist.tail<3>());
  generator.topRightCorner<3, 1>() = twist.head<3>();
  Eigen::Matrix4d sum = Eigen::Matrix4d::Identity(), term = Eigen::Matrix4d::Identity();
  for (int n = 1; n < 30; ++n) sum += term = term * generator / n;
  const Rigid3d motion = Rigid3d::Exp(twist);
  EXPECT_LT((motion.RotationMatrix() - sum.topLeftCorner<3, 3>()).norm(), 1e-12);
  EXPECT_LT((motion.translation() - sum.topRightCorner<3, 1>()).norm(), 1e-12);
}

TEST(Rigid3d, InverseAndComposition) {
  std::mt19937 random(3);
  const Rigid3d a = Rigid3d::Exp(RandomTwist(random, 1.0)),
                b = Rigid3d::Exp(RandomTwist(random, 2.0));
  const Eigen::Vector3d p(1, 2, 3);
  EXPECT_LT(((a * b) * p - a * (b * p)).norm(), 1e-12);
  EXPECT_LT((a.Inverse() * (a * p) - p).norm(), 1e-12);
  EXPECT_NEAR(a.Angle(), 1.0, 1e-12);
}

}  // namespace
}  // namespace msf
