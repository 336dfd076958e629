#include "training/batch.h"

#include <torch/types.h>
#include <torch/utils.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <set>

namespace msf {

torch::Tensor ImagesToTensor(const std::vector<LabeledImage>& pictures) {
  const int height = pictures[0].pixels.rows, width = pictures[0].pixels.cols;
  torch::Tensor pixels =
      torch::empty({static_cast<int64_t>(pictures.size()), height, width, 3}, torch::kByte);
  for (size_t i = 0; i < pictures.size(); ++i) {
    cv::Mat target(height, width, CV_8UC3, pixels[static_cast<int64_t>(i)].data_ptr());
    pictures[i].pixels.copyTo(target);
  }
  return pixels.to(torch::kFloat).div_(255.0).flip({3}).permute({0, 3, 1, 2});
}

StatusOr<std::vector<LabeledImage>> DecodeImages(const std::vector<VocImage>& set) {
  std::vector<LabeledImage> images;
  images.reserve(set.size());
  for (const VocImage& entry : set) {
    LabeledImage image{cv::imread(entry.file.string(), cv::IMREAD_COLOR), entry.objects};
    if (image.pixels.empty())
      return Status::Error(entry.file.string() + ": is not an image that can be decoded");
    if (image.pixels.cols != entry.width || image.pixels.rows != entry.height) {
      return Status::Error(entry.file.string() + ": is " + std::to_string(image.pixels.cols) + "x" +
                           std::to_string(image.pixels.rows) + ", its annotation says " +
                           std::to_string(entry.width) + "x" + std::to_string(entry.height));
    }
    images.push_back(std::move(image));
  }
  return images;
}

std::vector<double> BalancingWeights(const std::vector<LabeledImage>& images, double balance) {
  constexpr double kCommon = 0.15, kMost = 4.0;
  std::map<int, double> share;
  for (const LabeledImage& image : images) {
    std::set<int> labels;
    for (const VocObject& object : image.objects) labels.insert(object.label);
    for (int label : labels) share[label] += 1.0 / static_cast<double>(images.size());
  }
  std::vector<double> weights;
  for (const LabeledImage& image : images) {
    double weight = 1.0;
    for (const VocObject& object : image.objects)
      weight = std::max(weight, std::pow(kCommon / share[object.label], balance));
    weights.push_back(std::min(weight, kMost));
  }
  return weights;
}

EpochSampler::EpochSampler(const std::vector<LabeledImage>& images, const SamplingOptions& options,
                           uint64_t seed, int epoch)
    : images_(images), options_(options), order_(images.size()) {
  std::seed_seq mix{seed, static_cast<uint64_t>(epoch)};
  Random random(mix);
  seed_ = random();
  const std::vector<double> weights = BalancingWeights(images, options.balance);
  std::discrete_distribution<size_t> draw(weights.begin(), weights.end());
  for (size_t& index : order_) index = draw(random);
}

int EpochSampler::num_batches() const {
  return std::max(1, static_cast<int>(order_.size()) / options_.batch);
}

Batch EpochSampler::Make(int index) const {
  std::vector<LabeledImage> pictures;
  std::vector<std::vector<VocObject>> objects;
  std::vector<double> angles;
  for (int i = 0; i < options_.batch; ++i) {
    const size_t place = static_cast<size_t>(index) * options_.batch + i;
    std::seed_seq mix{seed_ >> 32, seed_ & 0xFFFFFFFFU, static_cast<uint64_t>(place)};
    Random random(mix);
    pictures.push_back(MakeTrainingPicture(images_, order_[place % order_.size()], options_.side,
                                           options_.augmentation, random));
    objects.push_back(pictures.back().objects);
    angles.push_back(pictures.back().angle);
  }
  return {ImagesToTensor(pictures), PadLabels(objects), torch::tensor(angles, torch::kDouble)};
}

}  // namespace msf
