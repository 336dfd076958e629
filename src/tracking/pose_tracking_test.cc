#include "tracking/pose_tracking.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tracking/local_map.h"
#include "tracking/test_frame.h"

namespace msf {
namespace {

class PoseTrackingTest : public ::testing::Test {
 protected:
  std::vector<PointMatch> Match() const {
    return MatchLastFrame(at_.context, at_.map, at_.LastFrame(), *at_.view.features, at_.T_cw_true);
  }

  TrackedWorld at_;
};

TEST_F(PoseTrackingTest, PointsOfTheLastFrameAreFoundAgain) {
  const std::vector<PointMatch> matches = Match();
  EXPECT_GT(matches.size(), 200u);
  EXPECT_GT(at_.RightShare(matches), 0.98);
}

TEST_F(PoseTrackingTest, ABadPredictionIsSearchedTwiceAsWide) {
  // Standing still is predicted; the camera turned by 0.03 rad, 16 pixels.
  const std::vector<PointMatch> matches =
      MatchLastFrame(at_.context, at_.map, at_.LastFrame(), *at_.view.features,
                     at_.map.PoseOf(at_.keyframes.back()));
  EXPECT_GT(matches.size(), 20u);
  EXPECT_GT(at_.RightShare(matches), 0.9);
}

TEST_F(PoseTrackingTest, PointsThatAreGoneAreNotSearched) {
  const Frame last = at_.LastFrame();
  for (const MapPointId id : last.points) {
    if (id.valid()) at_.map.RemovePoint(id);
  }
  EXPECT_TRUE(
      MatchLastFrame(at_.context, at_.map, last, *at_.view.features, at_.T_cw_true).empty());
}

TEST_F(PoseTrackingTest, PointsOfAKeyFrameAreFoundByTheirWords) {
  const KeyFrame& keyframe = *at_.map.FindKeyFrame(at_.keyframes.back());
  const std::vector<PointMatch> matches =
      MatchKeyFrame(at_.map, keyframe, *keyframe.words, *at_.view.features, *at_.view.words, 0.8);
  EXPECT_GT(matches.size(), 200u);
  EXPECT_GT(at_.RightShare(matches), 0.98);
}

TEST_F(PoseTrackingTest, LocalPointsAddWhatTheLastFrameDidNotShow) {
  LocalMap local;
  local.Update(at_.map, at_.LastFrame(), 80, 10);
  std::vector<PointMatch> known = Match();
  const size_t num_shown = known.size();
  known.resize(num_shown / 2);
  const LocalMatches more =
      MatchLocalPoints(at_.context, local.points(), *at_.view.features, at_.T_cw_true, known, 1);
  EXPECT_GT(known.size() + more.matches.size(), num_shown * 8 / 10);
  EXPECT_GT(at_.RightShare(more.matches), 0.98);
  EXPECT_GE(more.expected.size(), known.size() + more.matches.size());
  for (const PointMatch& match : more.matches) {
    EXPECT_TRUE(std::none_of(known.begin(), known.end(), [&](const PointMatch& other) {
      return other.feature == match.feature || other.point == match.point;
    }));
  }
}

TEST_F(PoseTrackingTest, ThePoseIsFoundAndWrongMatchesGo) {
  std::vector<PointMatch> matches = Match();
  const size_t num_right = matches.size();
  for (size_t i = 0; i + 1 < num_right; i += 10) {
    PointMatch wrong = matches[i];
    wrong.p_w = matches[i + 1].p_w + Eigen::Vector3d(0.5, 0.5, 0.5);
    matches.push_back(wrong);
  }
  Rigid3d T_cw = at_.map.PoseOf(at_.keyframes.back());
  EXPECT_TRUE(OptimizeFramePose(at_.context, *at_.view.features, 30, matches, T_cw));
  EXPECT_LT(at_.PoseError(T_cw), 0.01);
  EXPECT_LE(matches.size(), num_right);
  EXPECT_GT(matches.size(), num_right * 8 / 10);
}

TEST_F(PoseTrackingTest, TooFewInliersLeaveThePoseAsItWas) {
  std::vector<PointMatch> matches = Match();
  const Rigid3d before = at_.map.PoseOf(at_.keyframes.back());
  Rigid3d T_cw = before;
  EXPECT_FALSE(OptimizeFramePose(at_.context, *at_.view.features, 100000, matches, T_cw));
  EXPECT_EQ(T_cw.translation(), before.translation());
  matches.clear();
  EXPECT_FALSE(OptimizeFramePose(at_.context, *at_.view.features, 0, matches, T_cw));
}

TEST_F(PoseTrackingTest, AMatchWeighsAsMuchAsTheLessCertainOfPointAndFeature) {
  const MapPointId id = Match().front().point;
  at_.map.ObserveStaticProbability(id, 0.25f);
  const MapPoint& point = *at_.map.FindPoint(id);
  EXPECT_LT(point.static_weight, 1);
  EXPECT_DOUBLE_EQ(MakePointMatch(point, *at_.view.features, 0).weight, point.static_weight);
}

}  // namespace
}  // namespace msf
