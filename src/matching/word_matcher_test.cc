#include "matching/word_matcher.h"

#include <gtest/gtest.h>

#include <numbers>

#include "matching/epipolar_matcher.h"
#include "matching/rotation_consistency.h"
#include "matching/test_features.h"

namespace msf {
namespace {

using Pairs = std::vector<std::pair<int, int>>;

class WordMatcherTest : public ::testing::Test {
 protected:
  // Puts a feature below node 1 (or another).
  static int Add(TestFeatures& side, const Descriptor& descriptor, uint32_t node = 1,
                 float angle_rad = 0) {
    const int feature = side.Add(100, 100, descriptor, 0, -1, angle_rad);
    side.PutBelowNode(node, feature);
    return feature;
  }
  Pairs Match(const WordMatchOptions& options = {.check_rotation = false},
              const std::vector<uint8_t>& usable_a = {},
              const std::vector<uint8_t>& usable_b = {}) {
    return MatchByWords({a_.features, a_.words, usable_a}, {b_.features, b_.words, usable_b},
                        options);
  }
  TestFeatures a_, b_;
};

TEST_F(WordMatcherTest, ComparesOnlyBelowCommonNodes) {
  Add(a_, RandomDescriptor(1), 1);
  Add(a_, RandomDescriptor(2), 3);
  Add(b_, RandomDescriptor(2), 2);  // the same patch, but sorted elsewhere
  Add(b_, FlipBits(RandomDescriptor(2), 10), 3);
  EXPECT_EQ(Match(), (Pairs{{1, 1}}));
}

TEST_F(WordMatcherTest, KeepsToDistanceAndRatio) {
  Add(a_, RandomDescriptor(1));
  Add(b_, FlipBits(RandomDescriptor(1), 30));
  EXPECT_EQ(Match({.max_distance = 29, .check_rotation = false}), Pairs{});
  EXPECT_EQ(Match({.max_distance = 30, .check_rotation = false}), (Pairs{{0, 0}}));
  Add(b_, FlipBits(RandomDescriptor(1), 35));  // nearly as good: which one is it?
  EXPECT_EQ(Match({.ratio = 0.7, .check_rotation = false}), Pairs{});
  EXPECT_EQ(Match({.ratio = 0.9, .check_rotation = false}), (Pairs{{0, 0}}));
}

TEST_F(WordMatcherTest, EachFeatureIsMatchedOnce) {
  Add(a_, FlipBits(RandomDescriptor(1), 20));
  Add(a_, FlipBits(RandomDescriptor(1), 5));
  Add(b_, RandomDescriptor(1));
  EXPECT_EQ(Match(), (Pairs{{1, 0}})) << "the closest suitor";
}

TEST_F(WordMatcherTest, LeavesOutWhatIsNotUsable) {
  Add(a_, RandomDescriptor(1));
  Add(b_, RandomDescriptor(1));
  Add(b_, FlipBits(RandomDescriptor(1), 20));
  EXPECT_EQ(Match({.check_rotation = false}, {}, {0, 1}), (Pairs{{0, 1}}));
  EXPECT_EQ(Match({.check_rotation = false}, {0}, {}), Pairs{});
}

TEST_F(WordMatcherTest, DropsPatchesThatTurnedAnotherWay) {
  for (int i = 0; i < 20; ++i) {
    Add(a_, RandomDescriptor(i), 1, 1.0f);
    Add(b_, RandomDescriptor(i), 1, i == 7 ? 2.5f : 0.6f);
  }
  EXPECT_EQ(Match().size(), 20u);
  const Pairs agreeing = Match({});
  EXPECT_EQ(agreeing.size(), 19u);
  EXPECT_EQ(std::count(agreeing.begin(), agreeing.end(), std::pair(7, 7)), 0);
}

TEST(RotationConsistencyTest, KeepsTheThreeMostCommonTurns) {
  std::vector<float> turns(50, 0.0f);
  turns.insert(turns.end(), 20, 1.0f);
  turns.insert(turns.end(), 10, 2.0f);
  turns.insert(turns.end(), 6, 3.0f);
  const std::vector<bool> kept = ConsistentRotations(turns);
  EXPECT_TRUE(kept[0]);
  EXPECT_TRUE(kept[50]);
  EXPECT_TRUE(kept[70]);
  EXPECT_FALSE(kept[80]) << "the fourth";
}

TEST(RotationConsistencyTest, RareTurnsDoNotCount) {
  std::vector<float> turns(50, 0.0f);
  turns.insert(turns.end(), 4, 1.0f);
  EXPECT_FALSE(ConsistentRotations(turns)[50]);
  turns.push_back(1.0f);
  EXPECT_TRUE(ConsistentRotations(turns)[50]);
}

TEST(RotationConsistencyTest, FullTurnsMakeNoDifference) {
  constexpr float kTurn = 2 * std::numbers::pi_v<float>;
  const std::vector<bool> kept =
      ConsistentRotations({0.5f, 0.5f + kTurn, 0.5f - kTurn, -0.02f, kTurn - 0.02f});
  EXPECT_EQ(kept, std::vector<bool>(5, true));
  EXPECT_TRUE(ConsistentRotations({}).empty());
}

class EpipolarMatcherTest : public ::testing::Test {
 protected:
  EpipolarMatcherTest() {
    Vector6d twist;
    twist << 0.3, 0.05, 0.02, 0.02, -0.05, 0.01;
    T_ab_ = Rigid3d::Exp(twist);
  }
  // Shows a point, given in the coordinates of camera b, to both cameras.
  void Show(const Eigen::Vector3d& p_b, const Descriptor& descriptor, double off_px = 0,
            int level = 0) {
    const Eigen::Vector2d a_px = camera_.Project(T_ab_ * p_b), b_px = camera_.Project(p_b);
    a_.PutBelowNode(1, a_.Add(a_px.x(), a_px.y(), descriptor));
    b_.PutBelowNode(1, b_.Add(b_px.x(), b_px.y() + off_px, descriptor, level));
  }
  Pairs Match(const std::vector<uint8_t>& usable_b = {}) {
    const std::vector<uint8_t> all_a(a_.features.size(), 1), all_b(b_.features.size(), 1);
    return MatchByEpipolarLine({a_.features, a_.words, all_a},
                               {b_.features, b_.words, usable_b.empty() ? all_b : usable_b}, T_ab_,
                               camera_, levels_, {});
  }
  const Camera camera_ = *Camera::Preset("simulated");
  const ScaleLevels levels_{8, 1.2};
  Rigid3d T_ab_;
  TestFeatures a_, b_;
};

TEST_F(EpipolarMatcherTest, AcceptsWhatLiesOnTheLine) {
  Show({0.1, 0.2, 2}, RandomDescriptor(1));
  Show({-0.4, 0.1, 3}, RandomDescriptor(2));
  EXPECT_EQ(Match(), (Pairs{{0, 0}, {1, 1}}));
  EXPECT_EQ(Match({1, 0}), (Pairs{{0, 0}}));
}

// The baseline is nearly horizontal, and so are the lines.
TEST_F(EpipolarMatcherTest, RejectsWhatLiesBesideTheLineByItsLevelsNoise) {
  Show({0.1, 0.2, 2}, RandomDescriptor(1), 1.5);
  Show({-0.4, 0.1, 3}, RandomDescriptor(2), 4);
  Show({-0.2, -0.1, 3}, RandomDescriptor(3), 4, 6);  // a coarse level: sigma is 3 px
  EXPECT_EQ(Match(), (Pairs{{0, 0}, {2, 2}}));
}

TEST_F(EpipolarMatcherTest, RejectsUnlikePatches) {
  Show({0.1, 0.2, 2}, RandomDescriptor(1));
  b_.features.descriptors[0] = FlipBits(RandomDescriptor(1), kStrictDescriptorDistance + 1);
  EXPECT_TRUE(Match().empty());
}

}  // namespace
}  // namespace msf
