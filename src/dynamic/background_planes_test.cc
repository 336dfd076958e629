#include "dynamic/background_planes.h"

#include <gtest/gtest.h>

#include <limits>

#include "dynamic/test_scene.h"

namespace msf {
namespace {

constexpr double kNowhere = std::numeric_limits<double>::infinity();
constexpr int kBlock_px = BlockRays::kBlockCells * CoarseDepth::kCellSize;

class BackgroundPlanesTest : public ::testing::Test {
 protected:
  // A floor 1 m below the camera, which looks down on it by 45 degrees, and before it a thing whose
  // depth along the ray of a pixel is `thing` (infinity where it is not).
  template <typename Thing>
  static CoarseDepth FloorAnd(const Thing& thing) {
    const Camera& camera = *TestCamera();
    RgbdFrame frame;
    frame.camera = TestCamera();
    frame.depth = cv::Mat(camera.height, camera.width, CV_16U, cv::Scalar(0));
    const Eigen::Vector3d down = Eigen::Vector3d(0, 1, 1).normalized();
    for (int y = 0; y < camera.height; ++y) {
      for (int x = 0; x < camera.width; ++x) {
        const Eigen::Vector3d ray = camera.Unproject(Eigen::Vector2d(x, y), 1);
        const double z = std::min(1 / down.dot(ray), thing(cv::Point(x, y), ray));
        if (z > 0 && z < 8)
          frame.depth.at<uint16_t>(y, x) = static_cast<uint16_t>(z * camera.depth_factor);
      }
    }
    return CoarseDepth(frame);
  }
  // A ball-like thing in the middle of the image.
  static CoarseDepth FloorAndThing(double radius_m) {
    const Eigen::Vector3d centre(0, 0, 1.4);
    return FloorAnd([&](const cv::Point&, const Eigen::Vector3d& ray) {
      const double a = ray.squaredNorm(), b = ray.dot(centre),
                   c = centre.squaredNorm() - radius_m * radius_m, root = b * b - a * c;
      return root > 0 ? (b - std::sqrt(root)) / a : kNowhere;
    });
  }
  cv::Mat1b Find(const CoarseDepth& depth, const cv::Rect& box_px,
                 const PlaneOptions& options = {}) const {
    cv::Mat1b in_box(rays_.rows(), rays_.cols(), static_cast<uint8_t>(0));
    in_box(cv::Rect(box_px.tl() / kBlock_px, box_px.br() / kBlock_px)) = 255;
    const cv::Mat1b no_mask(in_box.size(), static_cast<uint8_t>(0));
    return FindPlaneBlocks(depth, rays_, in_box, no_mask, options, 1);
  }
  static bool At(const cv::Mat1b& blocks, int x_px, int y_px) {
    return blocks(y_px / kBlock_px, x_px / kBlock_px) != 0;
  }

  const BlockRays rays_{*TestCamera()};
};

TEST_F(BackgroundPlanesTest, TheFloorInABoxIsThePlaneAndTheThingOnItIsNot) {
  const cv::Mat1b blocks = Find(FloorAndThing(0.25), {200, 120, 240, 280});
  EXPECT_TRUE(At(blocks, 100, 300)) << "outside the box";
  EXPECT_TRUE(At(blocks, 215, 380)) << "inside it, beside the thing";
  EXPECT_FALSE(At(blocks, 320, 240)) << "the thing";
}

TEST_F(BackgroundPlanesTest, WhatIsFlatInTheBoxAloneIsNoPlane) {
  const cv::Rect box(160, 120, 320, 240);
  const CoarseDepth depth(DepthFrame(3, {{{200, 160, 240, 160}, 2.0f}}));
  const cv::Mat1b blocks = Find(depth, box);
  EXPECT_FALSE(At(blocks, 320, 240));
  EXPECT_TRUE(At(blocks, 40, 40)) << "the wall";
}

// A sleeve in the box, in the plane of a screen outside of it. Both stand on the floor.
TEST_F(BackgroundPlanesTest, APieceInTheBoxDoesNotHangOnAnotherPlane) {
  const cv::Rect screen(0, 80, 200, 400), sleeve(320, 160, 80, 320), box(260, 120, 200, 240);
  const CoarseDepth depth = FloorAnd([&](const cv::Point& px, const Eigen::Vector3d&) {
    return screen.contains(px) || sleeve.contains(px) ? 1.4 : kNowhere;
  });
  const cv::Mat1b blocks = Find(depth, box);
  EXPECT_TRUE(At(blocks, 100, 160)) << "the screen";
  EXPECT_TRUE(At(blocks, 360, 320)) << "the floor in the box";
  EXPECT_FALSE(At(blocks, 360, 200)) << "the sleeve";
}

TEST_F(BackgroundPlanesTest, TheEdgeOfAnObjectBesideItsBoxIsNoOutside) {
  const cv::Rect back(120, 120, 400, 240), box(120, 120, 310, 240);
  const CoarseDepth depth(DepthFrame(3, {{back, 2.0f}}));
  PlaneOptions options;
  options.min_share = 0.02;  // so that the edge makes a plane
  EXPECT_FALSE(At(Find(depth, box, options), 320, 240));
  EXPECT_TRUE(At(Find(depth, {120, 120, 120, 240}, options), 200, 240)) << "most is outside";
}

TEST_F(BackgroundPlanesTest, WhatWasAnObjectIsNoPlaneHoweverFlat) {
  const cv::Rect back(200, 160, 240, 160);
  const CoarseDepth depth(DepthFrame(3, {{back, 2.0f}}));
  const cv::Mat1b nothing(rays_.rows(), rays_.cols(), static_cast<uint8_t>(0));
  EXPECT_TRUE(At(FindPlaneBlocks(depth, rays_, nothing, nothing, {}, 1), 320, 240));
  cv::Mat1b in_mask = nothing.clone();
  in_mask(cv::Rect(back.tl() / kBlock_px, back.br() / kBlock_px)) = 255;
  const cv::Mat1b blocks = FindPlaneBlocks(depth, rays_, nothing, in_mask, {}, 1);
  EXPECT_FALSE(At(blocks, 320, 240));
  EXPECT_TRUE(At(blocks, 40, 40)) << "the wall behind";
}

TEST_F(BackgroundPlanesTest, WithoutDepthOrOptionsThereIsNone) {
  const cv::Rect box(200, 120, 240, 280);
  EXPECT_EQ(cv::countNonZero(Find(CoarseDepth(DepthFrame(0)), box)), 0);
  EXPECT_EQ(cv::countNonZero(Find(FloorAndThing(0.25), box, {.max_planes = 0})), 0);
  const cv::Rect everything(0, 0, TestCamera()->width, TestCamera()->height);
  EXPECT_EQ(cv::countNonZero(Find(FloorAndThing(0.25), everything)), 0);
}

TEST_F(BackgroundPlanesTest, TheSameSeedGivesTheSameBlocks) {
  const CoarseDepth depth = FloorAndThing(0.25);
  const cv::Rect box(200, 120, 240, 280);
  EXPECT_EQ(cv::countNonZero(Find(depth, box) != Find(depth, box)), 0);
}

TEST(BlockRays, PointsLieWhereTheirDepthWasTaken) {
  const BlockRays rays(*TestCamera());
  EXPECT_EQ(rays.rows(), 60);
  EXPECT_EQ(rays.cols(), 80);
  const Eigen::Vector3f p = rays.Point(CoarseDepth(DepthFrame(2)), 30, 40);
  EXPECT_NEAR(p.z(), 2, 1e-3);
  const Eigen::Vector2d px = TestCamera()->Project(p.cast<double>());
  EXPECT_NEAR(px.x(), 40 * kBlock_px + 2, 1e-2);
  EXPECT_NEAR(px.y(), 30 * kBlock_px + 2, 1e-2);
}

}  // namespace
}  // namespace msf
