#include "dynamic/point_labels.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace msf {
namespace {

TEST(PointLabels, AllPointsAreStaticAtFirst) {
  const PointLabels labels(3);
  EXPECT_EQ(labels.size(), 3);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(labels.reason[i], PointReason::kStatic);
    EXPECT_EQ(labels.static_probability[i], 1);
  }
  EXPECT_EQ(PointLabels().size(), 0);
}

TEST(PointLabels, CountsReasons) {
  PointLabels labels(5);
  labels.Set(1, PointReason::kObject, 0.05f);
  labels.Set(3, PointReason::kReadmitted, 0.3f);
  labels.Set(4, PointReason::kObject, 0.05f);
  EXPECT_EQ(labels.static_probability, (std::vector<float>{1, 0.05f, 1, 0.3f, 0.05f}));
  EXPECT_EQ(labels.Counts(), (std::array<int, kNumPointReasons>{2, 0, 2, 0, 0, 0, 1}));
}

TEST(PointReason, EachHasAName) {
  std::set<std::string> names;
  for (int i = 0; i < kNumPointReasons; ++i)
    names.insert(ToString(static_cast<PointReason>(static_cast<uint8_t>(i))));
  EXPECT_EQ(names.size(), static_cast<size_t>(kNumPointReasons));
  EXPECT_FALSE(names.contains("unknown"));
}

}  // namespace
}  // namespace msf
