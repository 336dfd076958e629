#include "training/batch.h"

#include <algorithm>
#include <numeric>

#include <opencv2/imgcodecs.hpp>
#include <torch/types.h>
#include <torch/utils.h>

namespace msf {

torch::Tensor ImagesToTensor(const std::vector<LabeledImage>& pictures) {
  const int height = pictures[0].pixels.rows, width = pictures[0].pixels.cols;
  torch::Tensor pixels = torch::empty({static_cast<int64_t>(pictures.size()), height, width, 3}, torch::kByte);
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
    if (image.pixels.empty()) return Status::Error(entry.file.string() + ": is not an image that can be decoded");
    if (image.pixels.cols != entry.width || image.pixels.rows != entry.height) {
      return Status::Error(entry.file.string() + ": is " + std::to_string(image.pixels.cols) + "x" +
                           std::to_string(image.pixels.rows) + ", its annotation says " + std::to_string(entry.width) + "x" +
                           std::to_string(entry.height));
    }
    images.push_back(std::move(image));
  }
  return images;
}

EpochSampler::EpochSampler(const std::vector<LabeledImage>& images, const AugmentationOptions& options, int side, int batch,
                           uint64_t seed, int epoch)
    : images_(images), options_(options), side_(side), batch_(batch), order_(images.size()) {
  std::seed_seq mix{seed, static_cast<uint64_t>(epoch)};
  Random random(mix);
  seed_ = random();
  std::iota(order_.begin(), order_.end(), size_t{0});
  for (size_t i = order_.size(); i > 1; --i) std::swap(order_[i - 1], order_[random() % i]);
}

int EpochSampler::num_batches() const {
  return std::max<int>(1, static_cast<int>(order_.size()) / batch_);
}

Batch EpochSampler::Make(int index) const {
  std::vector<LabeledImage> pictures;
  std::vector<std::vector<VocObject>> objects;
  for (int i = 0; i < batch_; ++i) {
    const size_t place = static_cast<size_t>(index) * batch_ + i;
    std::seed_seq mix{seed_ >> 32, seed_ & 0xFFFFFFFFU, static_cast<uint64_t>(place)};
    Random random(mix);
    pictures.push_back(MakeTrainingPicture(images_, order_[place % order_.size()], side_, options_, random));
    objects.push_back(pictures.back().objects);
  }
  return {ImagesToTensor(pictures), PadLabels(objects)};
}

}  // namespace msf
