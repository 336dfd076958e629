#include "tracking/static_evidence.h"

#include <gtest/gtest.h>

#include "tracking/local_map.h"
#include "tracking/test_frame.h"

namespace msf {
namespace {

class StaticEvidenceTest : public ::testing::Test {
 protected:
  void SetUp() override { local_.Update(at_.map, at_.LastFrame(), 80, 10); }
  std::vector<StaticEvidence> Gather(const FrameFeatures& features,
                                     const std::vector<PointMatch>& matches,
                                     const FrameFeatures& removed) const {
    return GatherStaticEvidence(
        features, matches, removed,
        FindSuspects(at_.context, local_.points(), removed, at_.T_cw_true, matches));
  }
  std::vector<PointMatch> Match() const {
    return MatchLastFrame(at_.context, at_.map, at_.LastFrame(), *at_.view.features, at_.T_cw_true);
  }

  TrackedWorld at_;
  LocalMap local_;
};

TEST_F(StaticEvidenceTest, AWorldThatStandsStillSaysNothing) {
  EXPECT_TRUE(Gather(*at_.view.features, Match(), {}).empty());
}

TEST_F(StaticEvidenceTest, PointsThatLookLikeRemovedFeaturesAreDoubted) {
  FrameFeatures removed = *at_.view.features;
  removed.static_weight.assign(removed.static_weight.size(), 0.05f);
  const std::vector<StaticEvidence> evidence = Gather({}, {}, removed);
  EXPECT_GT(evidence.size(), 200u);
  for (const StaticEvidence& one : evidence) EXPECT_EQ(one.static_probability, 0.05f);
}

TEST_F(StaticEvidenceTest, MatchedPointsTakeTheProbabilityOfTheirFeature) {
  FrameFeatures features = *at_.view.features;
  features.static_weight.assign(features.static_weight.size(), 0.35f);
  std::vector<PointMatch> matches = Match();
  for (PointMatch& match : matches) match.weight = 0.35;
  const std::vector<StaticEvidence> evidence = Gather(features, matches, features);
  EXPECT_EQ(evidence.front().static_probability, 0.35f);
  // Each point once, although the removed features would show it, too.
  std::vector<MapPointId> ids;
  ids.reserve(evidence.size());
  for (const StaticEvidence& one : evidence) ids.push_back(one.point);
  std::sort(ids.begin(), ids.end());
  EXPECT_EQ(std::unique(ids.begin(), ids.end()), ids.end());
  EXPECT_GE(ids.size(), matches.size());
}

}  // namespace
}  // namespace msf
