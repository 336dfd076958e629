#include "geometry/alignment.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace msf {
namespace {

std::vector<Eigen::Vector3d> RandomPoints(size_t n) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::vector<Eigen::Vector3d> points(n);
  for (Eigen::Vector3d& p : points) p = {normal(random), normal(random), normal(random)};
  return points;
}

const Rigid3d kMotion(ExpRotation({0.4, -1.2, 2.0}), Eigen::Vector3d(3, -1, 0.5));

std::vector<Eigen::Vector3d> Apply(const Similarity3d& T, std::vector<Eigen::Vector3d> points) {
  for (Eigen::Vector3d& p : points) p = T * p;
  return points;
}

double SquaredError(const Similarity3d& T, const std::vector<Eigen::Vector3d>& from,
                    const std::vector<Eigen::Vector3d>& to) {
  double sum = 0;
  for (size_t i = 0; i < from.size(); ++i) sum += (to[i] - T * from[i]).squaredNorm();
  return sum;
}

TEST(AlignPoints, RecoversExactMotionAndScale) {
  const auto from = RandomPoints(20);
  const auto rigid = AlignPoints(from, Apply({1, kMotion}, from));
  ASSERT_TRUE(rigid);
  EXPECT_EQ(rigid->scale, 1);
  EXPECT_NEAR((rigid->motion.Inverse() * kMotion).Log().norm(), 0, 1e-10);

  const auto scaled = AlignPoints(from, Apply({2.5, kMotion}, from), ScaleEstimation::kFree);
  ASSERT_TRUE(scaled);
  EXPECT_NEAR(scaled->scale, 2.5, 1e-10);
  EXPECT_NEAR((scaled->motion.Inverse() * kMotion).Log().norm(), 0, 1e-10);
}

TEST(AlignPoints, IsTheMinimumUnderNoise) {
  const auto from = RandomPoints(30);
  auto to = Apply({1.3, kMotion}, from);
  std::mt19937 random(4);
  std::normal_distribution<double> noise(0, 0.1);
  for (Eigen::Vector3d& p : to) p += Eigen::Vector3d(noise(random), noise(random), noise(random));
  const Similarity3d best = *AlignPoints(from, to, ScaleEstimation::kFree);
  const double least = SquaredError(best, from, to);
  for (int axis = 0; axis < 6; ++axis) {
    for (const double step : {-1e-3, 1e-3}) {
      Similarity3d moved = best;
      moved.motion = Rigid3d::Exp(step * Vector6d::Unit(axis)) * best.motion;
      EXPECT_GT(SquaredError(moved, from, to), least);
    }
  }
  EXPECT_GT(SquaredError({best.scale * 1.001, best.motion}, from, to), least);
  EXPECT_GT(SquaredError({best.scale * 0.999, best.motion}, from, to), least);
}

TEST(AlignPoints, NeverMirrors) {
  const auto from = RandomPoints(10);
  auto mirrored = from;
  for (Eigen::Vector3d& p : mirrored) p.x() = -p.x();
  const auto T = AlignPoints(from, mirrored);
  ASSERT_TRUE(T);
  EXPECT_NEAR(T->motion.RotationMatrix().determinant(), 1, 1e-12);
}

TEST(AlignPoints, PointsOnALineAlign) {
  const std::vector<Eigen::Vector3d> from = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  const auto to = Apply({1, kMotion}, from);
  const auto T = AlignPoints(from, to);
  ASSERT_TRUE(T);
  EXPECT_NEAR(SquaredError(*T, from, to), 0, 1e-18);
}

TEST(AlignPoints, DegenerateInputGivesNothing) {
  const auto two = RandomPoints(2);
  EXPECT_FALSE(AlignPoints(two, two));
  const std::vector<Eigen::Vector3d> one_place(5, Eigen::Vector3d(1, 2, 3));
  EXPECT_FALSE(AlignPoints(one_place, RandomPoints(5)));
  EXPECT_FALSE(AlignPoints(RandomPoints(5), one_place, ScaleEstimation::kFree));
}

}  // namespace
}  // namespace msf
