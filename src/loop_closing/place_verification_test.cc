#include "loop_closing/place_verification.h"

#include <gtest/gtest.h>

#include "map/test_world.h"

namespace msf {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

class PlaceVerificationTest : public ::testing::Test {
 protected:
  // A stretch of keyframes around an angle, as a map of its own that believes to start at T_cw.
  KeyFrameId AddStretch(double centre_rad, const Rigid3d& T_cw_start) {
    map_.StartNewMap();
    const std::vector<KeyFrameId> ids =
        world_.Walk(centre_rad - 12 * kDegree, centre_rad + 12.1 * kDegree, 6 * kDegree,
                    Vector6d::Zero(), T_cw_start, map_);
    return ids[2];
  }
  PlaceMatch Verify(KeyFrameId current, KeyFrameId matched) {
    return verifier_.Verify(Window(current, 5), Window(matched, 10), 1);
  }
  PlaceWindow Window(KeyFrameId id, int neighbours) { return *CopyWindow(map_, id, neighbours); }

  TestWorld world_{1};
  Map map_ = world_.EmptyMap();
  const PlaceVerificationOptions options_ = {};
  const PoseOptimizerOptions pose_ = {};
  const NoiseOptions noise_ = {};
  const PlaceVerifier verifier_{*world_.camera(), world_.levels(), options_, pose_, noise_};
};

TEST_F(PlaceVerificationTest, FindsTheMotionBetweenTwoVisits) {
  const KeyFrameId first = AddStretch(0, TestWorld::PoseOnCircle(-12 * kDegree));
  Vector6d somewhere;
  somewhere << 1, 2, 3, 0.3, 0.2, 0.1;
  const KeyFrameId second = AddStretch(4 * kDegree, Rigid3d::Exp(somewhere));

  const PlaceMatch match = Verify(second, first);
  ASSERT_TRUE(match.accepted()) << ToString(match.verdict);
  EXPECT_EQ(match.current, second);
  EXPECT_EQ(match.matched, first);
  EXPECT_GE(match.matches.size(), 80u);
  const Rigid3d truth = world_.Truth(second) * world_.Truth(first).Inverse();
  const Rigid3d error = match.T_c_m * truth.Inverse();
  EXPECT_LT(error.translation().norm(), 0.02);
  EXPECT_LT(error.Angle(), 0.3 * kDegree);
  EXPECT_GE(verifier_.AgreeingNeighbours(match, Window(second, 5), Window(first, 10)).size(), 3u);
}

TEST_F(PlaceVerificationTest, ConfirmsFromANearlyKnownMotion) {
  const KeyFrameId first = AddStretch(0, TestWorld::PoseOnCircle(-12 * kDegree));
  const KeyFrameId second = AddStretch(4 * kDegree, Rigid3d());
  const Rigid3d truth = world_.Truth(second) * world_.Truth(first).Inverse();
  Vector6d off;
  off << 0.01, 0.01, 0.01, 0.002, 0.002, 0.002;
  const KeyFrameView view = Window(second, 0).centre();
  const PlaceMatch match = verifier_.VerifyFrom(Rigid3d::Exp(off) * truth, view, Window(first, 10));
  ASSERT_TRUE(match.accepted()) << ToString(match.verdict);
  EXPECT_LT((match.T_c_m * truth.Inverse()).translation().norm(), 0.01);

  off << 0.5, 0, 0, 0, 0, 0;
  EXPECT_FALSE(verifier_.VerifyFrom(Rigid3d::Exp(off) * truth, view, Window(first, 10)).accepted());
}

TEST_F(PlaceVerificationTest, RejectsAnotherPlace) {
  const KeyFrameId first = AddStretch(0, Rigid3d());
  const KeyFrameId second = AddStretch(90 * kDegree, Rigid3d());
  EXPECT_EQ(Verify(second, first).verdict, PlaceVerdict::kFewWordMatches);
}

// Perceptual aliasing: the same patches, but elsewhere in the picture.
TEST_F(PlaceVerificationTest, RejectsThePatchesOfAPlaceInAnotherOrder) {
  const KeyFrameId first = AddStretch(0, Rigid3d());
  const KeyFrameId second = AddStretch(0, Rigid3d());
  PlaceWindow current = Window(second, 0);
  // Every point takes the position of the next, and every feature that of the next.
  auto features = std::make_shared<FrameFeatures>(*current.centre().features);
  std::rotate(features->uv_px.begin(), features->uv_px.begin() + 7, features->uv_px.end());
  std::rotate(features->depth_m.begin(), features->depth_m.begin() + 7, features->depth_m.end());
  features->BuildGrid(*world_.camera());
  const Rigid3d T_wc = current.centre().T_cw.Inverse();
  for (int i = 0; i < features->size(); ++i) {
    features->u_right_px[i] =
        static_cast<float>(features->uv_px[i].x() - world_.camera()->bf / features->depth_m[i]);
    for (PointSnapshot& point : current.points) {
      if (point.id == current.centre().points[i])
        point.p_w = T_wc * features->PointInCamera(i, *world_.camera());
    }
  }
  current.keyframes.front().features = features;
  const PlaceMatch match = verifier_.Verify(current, Window(first, 10), 1);
  EXPECT_EQ(match.verdict, PlaceVerdict::kNoAlignment) << ToString(match.verdict);
}

// A poster of a place shows everything in the right direction, but not at the right distance.
TEST_F(PlaceVerificationTest, RejectsAFlatPictureOfThePlace) {
  const KeyFrameId first = AddStretch(0, Rigid3d());
  const KeyFrameId second = AddStretch(0, Rigid3d());
  PlaceWindow current = Window(second, 0);
  auto features = std::make_shared<FrameFeatures>(*current.centre().features);
  for (int i = 0; i < features->size(); ++i) {
    features->depth_m[i] = 2;
    features->u_right_px[i] = static_cast<float>(features->uv_px[i].x() - world_.camera()->bf / 2);
  }
  current.keyframes.front().features = features;
  const Rigid3d T_c_m = world_.Truth(second) * world_.Truth(first).Inverse();
  const PlaceMatch match = verifier_.VerifyFrom(T_c_m, current.centre(), Window(first, 10));
  EXPECT_FALSE(match.accepted());
}

TEST_F(PlaceVerificationTest, EqualSeedsGiveEqualResults) {
  const KeyFrameId first = AddStretch(0, Rigid3d());
  const KeyFrameId second = AddStretch(3 * kDegree, Rigid3d());
  const PlaceMatch a = Verify(second, first), b = Verify(second, first);
  EXPECT_EQ(a.T_c_m.translation(), b.T_c_m.translation());
  EXPECT_EQ(a.matches, b.matches);
}

TEST_F(PlaceVerificationTest, AWindowHoldsAllPointsOfItsKeyFrames) {
  const KeyFrameId id = AddStretch(0, Rigid3d());
  const PlaceWindow window = Window(id, 2);
  EXPECT_EQ(window.keyframes.size(), 3u);
  EXPECT_EQ(window.centre().id, id);
  for (const KeyFrameView& view : window.keyframes) {
    for (const MapPointId point : view.points) EXPECT_NE(window.FindPoint(point), nullptr);
  }
  EXPECT_EQ(window.FindPoint(MapPointId()), nullptr);
  EXPECT_FALSE(CopyWindow(map_, KeyFrameId(999), 2));
}

}  // namespace
}  // namespace msf
