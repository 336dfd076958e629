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

TEST(Camera, ValuesThatNoCameraHasAreNamed) {
  struct Case {
    double Camera::*value;
    const char* key;
    std::vector<double> wrong;
  };
  const double nan = std::nan("");
  for (const Case& c :
       {Case{&Camera::fx, "fx is", {0, -525, 0.5, 1e6, nan}}, Case{&Camera::fy, "fy is", {0, nan}},
        Case{&Camera::cx, "cx and cy are", {0, -1, 640, nan}},
        Case{&Camera::cy, "cx and cy are", {0, 480, HUGE_VAL}},
        Case{&Camera::k3, "k3 is", {101, -HUGE_VAL, nan}},
        Case{&Camera::bf, "bf is", {0, -40, 1e6, nan}},
        Case{&Camera::depth_factor, "such as 5000 or 1000", {0, 1e-6, 2e-4, 1e7}},
        Case{&Camera::disparity_noise_px, "noise", {0, -1, nan, HUGE_VAL}},
        Case{&Camera::fps, "fps is", {0, -30, 1e5, nan}},
        Case{&Camera::rolling_shutter_s, "rolling_shutter_s is", {-1, 23, nan}},
        Case{&Camera::stamp_lag_s, "stamp_lag_s is", {6, nan}}}) {
    for (const double wrong : c.wrong) {
      Camera camera = *Camera::Preset("simulated");
      camera.*c.value = wrong;
      EXPECT_NE(camera.Check().message().find(c.key), std::string::npos) << c.key << " " << wrong;
    }
  }
  Camera camera = *Camera::Preset("simulated");
  camera.width = 0;
  EXPECT_FALSE(camera.Check().ok());
}

}  // namespace
}  // namespace msf
