#include "estimation/triangulation.h"

#include <gtest/gtest.h>

#include <cmath>

namespace msf {
namespace {

class Triangulation : public testing::Test {
 protected:
  Triangulation() {
    Vector6d twist;
    twist << 0.2, -0.05, 0.03, 0.02, -0.1, 0.05;
    T_1w_ = Rigid3d::Exp(twist);
    twist << -0.1, 0.02, 0.1, -0.03, 0.05, -0.2;
    T_2w_ = Rigid3d::Exp(twist);
    uv1_px_ = camera_.Project(T_1w_ * p_w_);
    uv2_px_ = camera_.Project(T_2w_ * p_w_);
  }
  const Camera camera_ = *Camera::Preset("tum_fr3");
  const Eigen::Vector3d p_w_{0.3, -0.2, 2.5};
  Rigid3d T_1w_, T_2w_;
  Eigen::Vector2d uv1_px_, uv2_px_;
};

TEST_F(Triangulation, FindsThePoint) {
  const auto p_w = Triangulate(camera_, T_1w_, uv1_px_, T_2w_, uv2_px_);
  ASSERT_TRUE(p_w);
  EXPECT_LT((*p_w - p_w_).norm(), 1e-9);
}

TEST_F(Triangulation, ErrorOfAPixelIsThatOfTheGeometry) {
  const auto p_w = Triangulate(camera_, T_1w_, uv1_px_ + Eigen::Vector2d(0.5, 0), T_2w_, uv2_px_);
  ASSERT_TRUE(p_w);
  EXPECT_LT((*p_w - p_w_).norm(), 0.05);  // z^2 / (f b) * 0.5 px = 0.02 m
  EXPECT_LT((camera_.Project(T_1w_ * *p_w) - uv1_px_).norm(), 1);
}

TEST_F(Triangulation, NothingBehindOrAtInfinity) {
  const Eigen::Vector3d behind_w = T_1w_.Inverse() * Eigen::Vector3d(0.2, 0.1, -2);
  EXPECT_FALSE(Triangulate(camera_, T_1w_, camera_.Project(T_1w_ * behind_w), T_2w_,
                           camera_.Project(T_2w_ * behind_w)));
  EXPECT_FALSE(Triangulate(camera_, T_1w_, uv1_px_, T_1w_, uv1_px_));
}

}  // namespace
}  // namespace msf
