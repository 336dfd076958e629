#include "place_recognition/keyframe_database.h"

#include <gtest/gtest.h>

#include <numeric>
#include <thread>

namespace msf {
namespace {

std::shared_ptr<const BagOfWords> Bag(const std::vector<uint32_t>& words) {
  auto bag = std::make_shared<BagOfWords>();
  for (const uint32_t word : words) bag->words.emplace_back(word, 1.0f / words.size());
  return bag;
}

// Words first .. first + count - 1.
std::shared_ptr<const BagOfWords> Range(uint32_t first, uint32_t count) {
  std::vector<uint32_t> words(count);
  std::iota(words.begin(), words.end(), first);
  return Bag(words);
}

std::vector<KeyFrameId> Ids(const std::vector<int>& values) {
  return std::vector<KeyFrameId>(values.begin(), values.end());
}

const KeyFrameDatabase::Neighbours kAlone = [](KeyFrameId) { return std::vector<KeyFrameId>(); };

TEST(KeyFrameDatabase, FindsNothingInNothing) {
  const KeyFrameDatabase database;
  EXPECT_TRUE(database.RelocalizationCandidates(*Range(0, 10), kAlone).empty());
  EXPECT_TRUE(database.PlaceCandidates(*Range(0, 10), {}, {}, kAlone, 3).empty());
}

TEST(KeyFrameDatabase, RelocalizationNeedsMostOfTheCommonWords) {
  KeyFrameDatabase database;
  database.Add(KeyFrameId(1), Range(0, 10));  // shares 10
  database.Add(KeyFrameId(2), Range(1, 10));  // shares 9
  database.Add(KeyFrameId(3), Range(5, 10));  // shares 5
  database.Add(KeyFrameId(4), Range(50, 10));
  EXPECT_EQ(database.RelocalizationCandidates(*Range(0, 10), kAlone), Ids({1, 2}));
}

TEST(KeyFrameDatabase, NeighboursLendTheirScoreAndTheBestOfTheGroupIsNamed) {
  KeyFrameDatabase database;
  database.Add(KeyFrameId(1), Range(0, 10));
  database.Add(KeyFrameId(5), Range(1, 10));
  database.Add(KeyFrameId(6), Range(1, 10));
  const auto neighbours = [](KeyFrameId id) {
    if (id == KeyFrameId(5)) return Ids({6, 77});  // 77 is not in the database
    if (id == KeyFrameId(6)) return Ids({5});
    return Ids({});
  };
  // 5 and 6 together outweigh 1, which falls below three quarters of their sum.
  EXPECT_EQ(database.RelocalizationCandidates(*Range(0, 10), neighbours), Ids({5}));
}

TEST(KeyFrameDatabase, RemovedAndReplacedKeyFramesAreForgotten) {
  KeyFrameDatabase database;
  database.Add(KeyFrameId(1), Range(0, 10));
  database.Add(KeyFrameId(2), Range(0, 10));
  database.Remove(KeyFrameId(1));
  database.Remove(KeyFrameId(9));
  EXPECT_EQ(database.size(), 1);
  EXPECT_EQ(database.RelocalizationCandidates(*Range(0, 10), kAlone), Ids({2}));
  database.Add(KeyFrameId(2), Range(100, 10));
  EXPECT_TRUE(database.RelocalizationCandidates(*Range(0, 10), kAlone).empty());
  database.Add(KeyFrameId(3), Range(0, 10));  // takes a freed place
  EXPECT_EQ(database.RelocalizationCandidates(*Range(0, 10), kAlone), Ids({3}));
}

TEST(KeyFrameDatabase, PlacesAreFilteredBeforeTheyAreRanked) {
  KeyFrameDatabase database;
  for (int id = 0; id < 8; ++id) database.Add(KeyFrameId(id), Range(id, 20));
  const auto even = [](KeyFrameId id) { return id.value() % 2 == 0; };
  EXPECT_EQ(database.PlaceCandidates(*Range(0, 20), {KeyFrameId(0), KeyFrameId(1)}, {}, kAlone, 3),
            Ids({2, 3, 4}));
  EXPECT_EQ(database.PlaceCandidates(*Range(0, 20), {KeyFrameId(0)}, even, kAlone, 2), Ids({2, 4}));
  EXPECT_EQ(database.PlaceCandidates(*Range(0, 20), {}, even, kAlone, 0), Ids({}));
}

TEST(KeyFrameDatabase, OrderOfInsertionDoesNotMatter) {
  KeyFrameDatabase forward, backward;
  for (int id = 0; id < 6; ++id) forward.Add(KeyFrameId(id), Range(0, 10));
  for (int id = 5; id >= 0; --id) backward.Add(KeyFrameId(id), Range(0, 10));
  EXPECT_EQ(forward.RelocalizationCandidates(*Range(0, 10), kAlone), Ids({0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(backward.RelocalizationCandidates(*Range(0, 10), kAlone), Ids({0, 1, 2, 3, 4, 5}));
}

TEST(KeyFrameDatabase, QueriesRunBesideChanges) {
  KeyFrameDatabase database;
  std::thread writer([&] {
    for (int i = 0; i < 300; ++i) {
      database.Add(KeyFrameId(i), Range(i % 10, 20));
      if (i >= 10) database.Remove(KeyFrameId(i - 10));
    }
  });
  // The callback comes back to the database: it must not be locked meanwhile.
  const auto neighbours = [&](KeyFrameId) { return database.size() > 0 ? Ids({0}) : Ids({}); };
  for (int i = 0; i < 300; ++i) {
    for (const KeyFrameId id : database.RelocalizationCandidates(*Range(0, 20), neighbours))
      EXPECT_TRUE(id.valid());
  }
  writer.join();
  EXPECT_EQ(database.size(), 10);
}

}  // namespace
}  // namespace msf
