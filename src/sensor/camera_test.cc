#include "sensor/camera.h"

#include <gtest/gtest.h>

#include <cmath>

namespace msf {
namespace {

TEST(Camera, UndistortInvertsDistort) {
  for (const std::string& name : Camera::PresetNames()) {
    const Camera camera = *Camera::Preset(name);
    EXPECT_TRUE(camera.Check().ok());
    for (int u = 20; u < 640; u += 60) {
      for (int v = 20; v < 480; v += 60) {
        const Eigen::Vector2d image_px(u, v);
        EXPECT_LT((camera.Distort(camera.Undistort(image_px)) - image_px).norm(), 1e-4)
            << name << " " << u << " " << v;
      }
    }
  }
}

TEST(Camera, UnprojectInvertsProject) {
  const Camera camera = *Camera::Preset("tum_fr3");
  const Eigen::Vector3d p_c(0.3, -0.2, 1.7);
  EXPECT_LT((camera.Unproject(camera.Project(p_c), p_c.z()) - p_c).norm(), 1e-12);
}

TEST(Camera, UnknownPresetListsTheKnown) {
  EXPECT_NE(Camera::Preset("tum_fr9").message().find("tum_fr1"), std::string::npos);
  EXPECT_FALSE(Camera{}.Check().ok());
}

TEST(Camera, NoiseOfDepthMustBePositive) {
  for (const double noise_px : {0.0, -1.0, std::nan(""), HUGE_VAL}) {
    Camera camera = *Camera::Preset("simulated");
    camera.disparity_noise_px = noise_px;
    EXPECT_FALSE(camera.Check().ok()) << noise_px;
  }
}

}  // namespace
}  // namespace msf
