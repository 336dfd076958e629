#include "simulation/renderer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>

#include "simulation/camera_path.h"
#include "simulation/lens.h"
#include "simulation/random.h"

namespace msf {
namespace {

// A smooth colourful picture: brightness is a known function of the texture coordinates.
cv::Mat Gradient() {
  cv::Mat picture(256, 256, CV_8UC3);
  for (int y = 0; y < 256; ++y) {
    for (int x = 0; x < 256; ++x)
      picture.at<cv::Vec3b>(y, x) = {uint8_t(x), uint8_t(y), uint8_t(255 - x / 2 - y / 2)};
  }
  return picture;
}

// A wall of 4 x 4 m that faces south (-y) at y = 0 around x = 0, z = 0.
Scene WallScene(const cv::Mat& picture) {
  Scene scene;
  scene.textures.emplace_back(picture);
  scene.mesh.AddPatch({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}, {.texture = 0});
  return scene;
}

Camera TestCamera() { return *Camera::Preset("simulated"); }

RenderedView RenderFrom(const Scene& scene, const Rigid3d& T_wc,
                        const std::vector<PlacedMesh>& movers = {}) {
  Renderer renderer(scene, TestCamera());
  RenderedView view;
  renderer.Render(T_wc.Inverse(), movers, false, view);
  return view;
}

TEST(Renderer, DepthOfASlantedWallIsExact) {
  const Scene scene = WallScene(Gradient());
  const Camera camera = TestCamera();
  const Rigid3d T_wc = LookAlong({0.1, -2.2, 0.15, 62, -13}, 7);
  const RenderedView view = RenderFrom(scene, T_wc);
  int hits = 0;
  for (int y = 5; y < camera.height; y += 37) {
    for (int x = 5; x < camera.width; x += 41) {
      const Eigen::Vector3d ray_w = T_wc.rotation() * camera.Unproject({double(x), double(y)}, 1);
      const double z = -T_wc.translation().y() / ray_w.y();
      const Eigen::Vector3d hit = T_wc.translation() + z * ray_w;
      if (z <= 0 || std::abs(hit.x()) > 1.99 || std::abs(hit.z()) > 1.99) continue;
      ++hits;
      EXPECT_NEAR(view.depth_m.at<float>(y, x), z, 2e-5 * z);
      EXPECT_NEAR(view.cosine.at<float>(y, x), ray_w.y() / ray_w.norm(), 1e-5);
    }
  }
  EXPECT_GT(hits, 80);
}

TEST(Renderer, ColorIsThatOfTheTextureWhereTheRayHits) {
  const Scene scene = WallScene(Gradient());
  const Camera camera = TestCamera();
  for (const Waypoint& from : {Waypoint{0, -1.5, 0, 90, 0}, Waypoint{-0.6, -1.8, 0.4, 70, -20}}) {
    const Rigid3d T_wc = LookAlong(from);
    const RenderedView view = RenderFrom(scene, T_wc);
    for (const Eigen::Vector3d& p_w :
         {Eigen::Vector3d(0.2, 0, 0.1), {-0.3, 0, -0.2}, {0.35, 0, 0.3}}) {
      const Eigen::Vector2d uv_px = camera.Project(T_wc.Inverse() * p_w);
      const cv::Vec4f color =
          view.color.at<cv::Vec4f>(int(std::lround(uv_px.y())), int(std::lround(uv_px.x())));
      EXPECT_NEAR(color[0], (p_w.x() + 2) / 4 * 256, 1.0);
      EXPECT_NEAR(color[1], (2 - p_w.z()) / 4 * 256, 1.0);
    }
  }
}

TEST(Renderer, BacksAreInvisibleAndEmptySpaceHasNoDepth) {
  const Scene scene = WallScene(Gradient());
  const RenderedView behind = RenderFrom(scene, LookAlong({0, 2, 0, -90, 0}));
  EXPECT_EQ(cv::countNonZero(behind.depth_m), 0);
  EXPECT_EQ(cv::sum(behind.color)[0], 0);
}

TEST(Renderer, WallsAreWatertight) {
  Scene scene = WallScene(cv::Mat(64, 64, CV_8UC3, cv::Scalar::all(200)));
  scene.mesh.triangles.clear();
  scene.mesh.vertices.clear();
  scene.mesh.AddPatch({-9, 0, 9}, {18, 0, 0}, {0, 0, -18}, {.texture = 0}, 0.13f);
  Random random(3);
  for (int i = 0; i < 4; ++i) {
    const RenderedView view =
        RenderFrom(scene, LookAlong({0, random.Uniform(-2, -0.02), 0, random.Uniform(60, 120),
                                     random.Uniform(-20, 20)},
                                    random.Uniform(-40, 40)));
    double low = 0;
    cv::minMaxLoc(view.color.reshape(1).colRange(0, 1), &low, nullptr);
    EXPECT_EQ(cv::countNonZero(view.depth_m), 640 * 480);
    std::vector<cv::Mat> channels;
    cv::split(view.color, channels);
    cv::minMaxLoc(channels[1], &low, nullptr);
    EXPECT_NEAR(low, 200, 0.01);
  }
}

TEST(Renderer, NearThingsHideFarOnesAndCarryTheirLabel) {
  const Scene scene = WallScene(Gradient());
  PlacedMesh mover{{}, 3};
  mover.mesh.AddSphere({0, -1, 0}, 0.25f, {.texture = 0}, 48);
  const RenderedView view = RenderFrom(scene, LookAlong({0, -3, 0, 90, 0}), {mover});
  EXPECT_EQ(view.label.at<uint8_t>(240, 320), 3);
  EXPECT_NEAR(view.depth_m.at<float>(240, 320), 1.75, 0.003);
  EXPECT_EQ(view.label.at<uint8_t>(240, 100), 0);
  // The silhouette of a sphere of radius r at distance d has the radius f r / sqrt(d^2 - r^2).
  const double radius_px = 525 * 0.25 / std::sqrt(4 - 0.0625);
  EXPECT_NEAR(cv::countNonZero(view.label), std::numbers::pi * radius_px * radius_px,
              0.01 * 3.14 * radius_px * radius_px);
}

TEST(Renderer, EdgesAreBlended) {
  Scene scene;
  scene.textures.emplace_back(cv::Mat(8, 8, CV_8UC3, cv::Scalar::all(200)));
  // Ends in the middle between two pixel columns plus a quarter pixel: two of four samples of
  // column 420 are covered.
  const float edge = static_cast<float>((420.0 - 319.5) / 525 * 2);
  scene.mesh.AddPatch({-1, 2, 1}, {edge + 1, 0, 0}, {0, 0, -2}, {.texture = 0});
  const RenderedView view = RenderFrom(scene, LookAlong({0, 0, 0, 90, 0}));
  EXPECT_NEAR(view.color.at<cv::Vec4f>(240, 419)[0], 200, 0.01);
  EXPECT_NEAR(view.color.at<cv::Vec4f>(240, 420)[0], 100, 0.01);
  EXPECT_NEAR(view.color.at<cv::Vec4f>(240, 421)[0], 0, 0.01);
}

// Through a lens with distortion every pixel shows what its ray hits.
TEST(Lens, DepthAndColorFollowTheDistortedRays) {
  const Camera camera = *Camera::Preset("tum_fr1");
  const Scene scene = WallScene(Gradient());
  const Lens lens(camera);
  Renderer renderer(scene, lens.ideal());
  RenderedView ideal, view;
  const Rigid3d T_wc = LookAlong({0.1, -1.6, 0.15, 75, -10});
  renderer.Render(T_wc.Inverse(), {}, false, ideal);
  lens.Apply(ideal, view);
  ASSERT_EQ(view.color.size(), cv::Size(640, 480));
  int hits = 0;
  for (int y = 1; y < camera.height; y += 43) {
    for (int x = 1; x < camera.width; x += 37) {
      const Eigen::Vector3d ray_w =
          T_wc.rotation() * camera.Unproject(camera.Undistort({double(x), double(y)}), 1);
      const double z = -T_wc.translation().y() / ray_w.y();
      const Eigen::Vector3d hit = T_wc.translation() + z * ray_w;
      if (std::abs(hit.x()) > 1.95 || std::abs(hit.z()) > 1.95) continue;
      ++hits;
      EXPECT_NEAR(view.depth_m.at<float>(y, x), z, 1e-4 * z);
      EXPECT_NEAR(view.color.at<cv::Vec4f>(y, x)[0], (hit.x() + 2) / 4 * 256, 1.0);
    }
  }
  EXPECT_GT(hits, 100);
}

TEST(Texture, FarAwayItIsItsMean) {
  cv::Mat checker(256, 256, CV_8UC3, cv::Scalar::all(0));
  for (int y = 0; y < 256; ++y) {
    for (int x = y % 2; x < 256; x += 2) checker.at<cv::Vec3b>(y, x) = {240, 120, 60};
  }
  const Texture texture(checker);
  const Color4f color = texture.Sample(0.4f, 0.6f, 5);
  EXPECT_NEAR(color[0], 120, 1.5);
  EXPECT_NEAR(color[1], 60, 1.5);
  EXPECT_NEAR(color[2], 30, 1.5);
  const Color4f texel = texture.Sample(10.5f / 256, 20.5f / 256, 0);
  EXPECT_NEAR(texel[0], 240, 0.01);
}

}  // namespace
}  // namespace msf
