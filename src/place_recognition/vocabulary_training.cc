#include "place_recognition/vocabulary_training.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "place_recognition/binary_clustering.h"

namespace msf {
namespace {

// A descriptor and the image it comes from.
struct Sample {
  Descriptor descriptor;
  uint32_t image;
};

// A node and its samples, a contiguous part of the list.
struct Part {
  size_t begin = 0, end = 0;
};

class TreeBuilder {
 public:
  TreeBuilder(const std::vector<std::vector<Descriptor>>& images,
              const VocabularyTrainingOptions& options,
              const std::function<void(int, int)>& progress)
      : num_images_(images.size()), options_(options), progress_(progress), random_(options.seed) {
    for (uint32_t image = 0; image < images.size(); ++image) {
      for (const Descriptor& descriptor : images[image]) samples_.push_back({descriptor, image});
    }
  }

  VocabularyTree Build() {
    tree_.branching = static_cast<uint32_t>(options_.branching);
    tree_.levels = static_cast<uint32_t>(options_.levels);
    tree_.centres = {Descriptor{}};
    std::vector<Part> level = {{0, samples_.size()}};
    for (int depth = 0; depth < options_.levels; ++depth) {
      std::vector<Part> next;
      for (size_t i = 0; i < level.size(); ++i) {
        SplitNode(level[i], next);
        if (progress_ && i % 64 == 0)
          Report(depth, static_cast<double>(level[i].end) / samples_.size());
      }
      level = std::move(next);
    }
    for (const Part& part : level) AddWord(part);
    tree_.first_child.push_back(static_cast<uint32_t>(tree_.centres.size()));
    if (progress_) Report(options_.levels, 0);
    return std::move(tree_);
  }

 private:
  // Nodes are visited in the order of their numbers, so each one's children start where those of
  // the one before end.
  void SplitNode(const Part& part, std::vector<Part>& next) {
    if (IsUniform(part)) {
      AddWord(part);
      return;
    }
    tree_.first_child.push_back(static_cast<uint32_t>(tree_.centres.size()));
    tree_.weights.push_back(0);
    std::vector<Descriptor> descriptors;
    descriptors.reserve(part.end - part.begin);
    for (size_t i = part.begin; i < part.end; ++i) descriptors.push_back(samples_[i].descriptor);
    const BinaryClusters clusters =
        ClusterBinary(descriptors, options_.branching, options_.max_iterations, random_);
    tree_.centres.insert(tree_.centres.end(), clusters.centres.begin(), clusters.centres.end());
    SortByCluster(part, clusters, next);
  }

  void AddWord(const Part& part) {
    std::vector<uint32_t> images;
    for (size_t i = part.begin; i < part.end; ++i) images.push_back(samples_[i].image);
    std::sort(images.begin(), images.end());
    const auto containing = std::unique(images.begin(), images.end()) - images.begin();
    tree_.first_child.push_back(static_cast<uint32_t>(tree_.centres.size()));
    tree_.weights.push_back(
        static_cast<float>(std::log(static_cast<double>(num_images_) / containing)));
  }

  bool IsUniform(const Part& part) const {
    return std::all_of(
        samples_.begin() + part.begin, samples_.begin() + part.end,
        [&](const Sample& sample) { return sample.descriptor == samples_[part.begin].descriptor; });
  }

  void SortByCluster(const Part& part, const BinaryClusters& clusters, std::vector<Part>& next) {
    std::vector<std::vector<Sample>> sorted(clusters.centres.size());
    for (size_t i = part.begin; i < part.end; ++i)
      sorted[clusters.members[i - part.begin]].push_back(samples_[i]);
    size_t begin = part.begin;
    for (const std::vector<Sample>& members : sorted) {
      std::copy(members.begin(), members.end(), samples_.begin() + begin);
      next.push_back({begin, begin + members.size()});
      begin += members.size();
    }
  }

  void Report(int depth, double part_of_level) const {
    constexpr int kSteps = 1000;
    progress_(static_cast<int>(kSteps * (depth + part_of_level) / options_.levels), kSteps);
  }

  const size_t num_images_;
  const VocabularyTrainingOptions& options_;
  const std::function<void(int, int)>& progress_;
  std::mt19937_64 random_;
  std::vector<Sample> samples_;
  VocabularyTree tree_;
};

}  // namespace

Status VocabularyTrainingOptions::Check() const {
  if (branching < 2 || branching > 100) return Status::Error("branching must be from 2 to 100");
  if (levels < 1 || levels > 8) return Status::Error("levels must be from 1 to 8");
  if (max_iterations < 1) return Status::Error("max_iterations must be at least 1");
  return Status::Ok();
}

StatusOr<Vocabulary> TrainVocabulary(const std::vector<std::vector<Descriptor>>& images,
                                     const VocabularyTrainingOptions& options,
                                     const std::function<void(int, int)>& progress) {
  MSF_RETURN_IF_ERROR(options.Check());
  const bool empty =
      std::all_of(images.begin(), images.end(), [](const auto& image) { return image.empty(); });
  if (empty) return Status::Error("there are no descriptors to learn a vocabulary from");
  return Vocabulary(TreeBuilder(images, options, progress).Build());
}

}  // namespace msf
