#include "place_recognition/vocabulary.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <iterator>
#include <random>

#include "feature/orb_extractor.h"
#include "feature/test_images.h"
#include "place_recognition/binary_clustering.h"
#include "place_recognition/similarity.h"
#include "place_recognition/vocabulary_file.h"
#include "place_recognition/vocabulary_training.h"

namespace msf {
namespace {

Descriptor RandomDescriptor(std::mt19937_64& random) {
  return {random(), random(), random(), random()};
}

Descriptor WithNoise(Descriptor descriptor, int flips, std::mt19937_64& random) {
  for (int i = 0; i < flips; ++i) {
    const uint64_t bit = random() % 256;
    descriptor[bit / 64] ^= uint64_t{1} << (bit % 64);
  }
  return descriptor;
}

// Images that each show some of 200 things, every one a noisy copy of its descriptor.
class World {
 public:
  World() {
    for (int i = 0; i < 200; ++i) things_.push_back(RandomDescriptor(random_));
  }
  std::vector<Descriptor> Image(int first_thing, int count) {
    std::vector<Descriptor> image;
    image.reserve(count);
    for (int i = 0; i < count; ++i)
      image.push_back(WithNoise(things_[(first_thing + i) % 200], 10, random_));
    return image;
  }
  std::vector<std::vector<Descriptor>> Images(int count) {
    std::vector<std::vector<Descriptor>> images;
    images.reserve(count);
    for (int i = 0; i < count; ++i) images.push_back(Image(7 * i, 30));
    return images;
  }

 private:
  std::mt19937_64 random_{5};
  std::vector<Descriptor> things_;
};

Vocabulary TrainOn(const std::vector<std::vector<Descriptor>>& images) {
  return *TrainVocabulary(images, {.branching = 8, .levels = 3}, {});
}

TEST(BinaryClustering, FindsTheThingsBehindNoisyCopies) {
  std::mt19937_64 random(3);
  std::vector<Descriptor> things, copies;
  for (int i = 0; i < 6; ++i) things.push_back(RandomDescriptor(random));
  for (int i = 0; i < 600; ++i) copies.push_back(WithNoise(things[i % 6], 25, random));
  const BinaryClusters clusters = ClusterBinary(copies, 6, 10, random);
  ASSERT_EQ(clusters.centres.size(), 6u);
  for (int i = 0; i < 600; ++i) {
    EXPECT_EQ(clusters.members[i], clusters.members[i % 6]);
    EXPECT_LE(DescriptorDistance(clusters.centres[clusters.members[i]], things[i % 6]), 3);
  }
}

TEST(BinaryClustering, FewerDistinctDescriptorsThanClusters) {
  std::mt19937_64 random(3);
  const std::vector<Descriptor> copies(20, RandomDescriptor(random));
  const BinaryClusters clusters = ClusterBinary(copies, 5, 10, random);
  ASSERT_EQ(clusters.centres.size(), 1u);
  EXPECT_EQ(clusters.centres[0], copies[0]);
}

TEST(Vocabulary, TreeIsWellFormedAndEveryWordIsReachable) {
  World world;
  const std::vector<std::vector<Descriptor>> images = world.Images(60);
  const Vocabulary vocabulary = TrainOn(images);
  EXPECT_TRUE(vocabulary.tree().Check().ok());
  EXPECT_GE(vocabulary.num_words(), 200);
  for (uint32_t node = 0; node < static_cast<uint32_t>(vocabulary.tree().num_nodes()); ++node) {
    if (vocabulary.tree().IsWord(node)) {
      EXPECT_GT(vocabulary.tree().weights[node], 0);
    } else {
      EXPECT_EQ(vocabulary.tree().weights[node], 0);
    }
  }
}

TEST(Vocabulary, TransformGroupsEveryDescriptorOnceAndNormalisesWeights) {
  World world;
  const Vocabulary vocabulary = TrainOn(world.Images(60));
  const std::vector<Descriptor> image = world.Image(20, 90);
  const BagOfWords bag = vocabulary.Transform(image);
  double sum = 0;
  for (size_t i = 0; i < bag.words.size(); ++i) {
    sum += bag.words[i].second;
    EXPECT_TRUE(i == 0 || bag.words[i - 1].first < bag.words[i].first);
  }
  EXPECT_NEAR(sum, 1, 1e-5);
  std::vector<int> seen(image.size(), 0);
  for (size_t i = 0; i < bag.nodes.size(); ++i) {
    EXPECT_TRUE(i == 0 || bag.nodes[i - 1].first < bag.nodes[i].first);
    for (const int index : bag.nodes[i].second) ++seen[index];
  }
  EXPECT_EQ(seen, std::vector<int>(image.size(), 1));
}

TEST(Vocabulary, ScoresRankOverlap) {
  World world;
  const Vocabulary vocabulary = TrainOn(world.Images(60));
  const BagOfWords image = vocabulary.Transform(world.Image(0, 60));
  EXPECT_NEAR(SimilarityScore(image, image), 1, 1e-5);
  const double most = SimilarityScore(image, vocabulary.Transform(world.Image(10, 60)));
  const double half = SimilarityScore(image, vocabulary.Transform(world.Image(30, 60)));
  const double none = SimilarityScore(image, vocabulary.Transform(world.Image(100, 60)));
  EXPECT_GT(most, half);
  EXPECT_GT(half, none + 0.1);
  EXPECT_EQ(SimilarityScore(image, BagOfWords{}), 0);
}

TEST(Vocabulary, NoDescriptorsGiveAnEmptyBag) {
  World world;
  EXPECT_TRUE(TrainOn(world.Images(10)).Transform({}).empty());
  EXPECT_FALSE(TrainVocabulary({{}, {}}, {}, {}).ok());
  EXPECT_FALSE(TrainVocabulary(world.Images(2), {.branching = 1}, {}).ok());
}

TEST(Vocabulary, TrainingIsReproducible) {
  World world;
  const std::vector<std::vector<Descriptor>> images = world.Images(30);
  const Vocabulary a = TrainOn(images), b = TrainOn(images);
  EXPECT_EQ(a.tree().centres, b.tree().centres);
  EXPECT_EQ(a.tree().weights, b.tree().weights);
}

TEST(Vocabulary, RecognisesRenderedPlacesSeenFromElsewhere) {
  OrbExtractor extractor({.num_features = 400});
  const auto describe = [&](const cv::Mat& image) {
    return extractor.Extract(FrameOf(image)).descriptors;
  };
  std::vector<cv::Mat> places;
  std::vector<std::vector<Descriptor>> images;
  for (unsigned seed = 0; seed < 12; ++seed) {
    places.push_back(TexturedImage(400, 300, seed));
    images.push_back(describe(places.back()));
  }
  const Vocabulary vocabulary = TrainOn(images);
  std::vector<BagOfWords> bags;
  bags.reserve(images.size());
  for (const auto& image : images) bags.push_back(vocabulary.Transform(image));
  for (size_t i = 0; i < places.size(); ++i) {
    cv::Mat seen_again;
    const cv::Mat turn = cv::getRotationMatrix2D({200, 150}, 25, 0.8);
    cv::warpAffine(places[i], seen_again, turn, places[i].size(), cv::INTER_LINEAR,
                   cv::BORDER_REFLECT);
    const BagOfWords query = vocabulary.Transform(describe(seen_again));
    const double score = SimilarityScore(query, bags[i]);
    for (size_t k = 0; k < places.size(); ++k) {
      if (k != i) {
        EXPECT_GT(score, SimilarityScore(query, bags[k])) << "place " << i << " taken for " << k;
      }
    }
  }
}

class VocabularyFile : public testing::Test {
 protected:
  void SetUp() override {
    const Status saved = vocabulary_.Save(file_);
    ASSERT_TRUE(saved.ok()) << saved.message();
    std::ifstream stream(file_, std::ios::binary);
    content_.assign(std::istreambuf_iterator<char>(stream), {});
  }
  void TearDown() override { std::filesystem::remove(file_); }

  // The message of loading other content.
  std::string MessageFor(const std::string& content) {
    std::ofstream(file_, std::ios::binary | std::ios::trunc) << content;
    const StatusOr<Vocabulary> loaded = Vocabulary::Load(file_);
    EXPECT_FALSE(loaded.ok());
    EXPECT_NE(loaded.message().find(file_.string()), std::string::npos);
    return loaded.message();
  }

  World world_;
  Vocabulary vocabulary_ = TrainOn(world_.Images(20));
  const std::filesystem::path file_ =
      std::filesystem::path(testing::TempDir()) / ("msf_vocabulary_" + std::to_string(getpid()));
  std::string content_;
};

TEST_F(VocabularyFile, RoundTrip) {
  const StatusOr<Vocabulary> loaded = Vocabulary::Load(file_);
  ASSERT_TRUE(loaded.ok()) << loaded.message();
  EXPECT_EQ(loaded->tree().centres, vocabulary_.tree().centres);
  EXPECT_EQ(loaded->tree().first_child, vocabulary_.tree().first_child);
  EXPECT_EQ(loaded->tree().weights, vocabulary_.tree().weights);
  EXPECT_EQ(loaded->tree().branching, 8u);
  EXPECT_EQ(loaded->num_words(), vocabulary_.num_words());
}

TEST_F(VocabularyFile, BadFilesGetASentence) {
  EXPECT_NE(MessageFor("").find("no vocabulary"), std::string::npos);
  EXPECT_NE(MessageFor("%YAML:1.0 something else that is long enough to hold a header")
                .find("no vocabulary"),
            std::string::npos);
  EXPECT_NE(MessageFor(content_.substr(0, 30)).find("cut off"), std::string::npos);
  EXPECT_NE(MessageFor(content_.substr(0, content_.size() / 2)).find("cut off"), std::string::npos);
  std::string damaged = content_;
  damaged[damaged.size() / 2] ^= 4;
  EXPECT_NE(MessageFor(damaged).find("checksum"), std::string::npos);
  std::string newer = content_;
  newer[8] = 9;
  EXPECT_NE(MessageFor(newer).find("version 9"), std::string::npos);
}

TEST_F(VocabularyFile, MissingFileAndFolder) {
  EXPECT_NE(Vocabulary::Load("/no/such/file").message().find("/no/such/file"), std::string::npos);
  EXPECT_FALSE(Vocabulary::Load(testing::TempDir()).ok());
  EXPECT_FALSE(vocabulary_.Save("/no/such/folder/file").ok());
}

TEST_F(VocabularyFile, ATreeThatIsNoneIsRefused) {
  VocabularyTree tree = vocabulary_.tree();
  tree.first_child[1] = 0;  // a loop
  ASSERT_TRUE(WriteVocabularyFile(tree, file_).ok());
  EXPECT_NE(Vocabulary::Load(file_).message().find("damaged"), std::string::npos);
}

}  // namespace
}  // namespace msf
