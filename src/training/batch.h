// Batches of training pictures as tensors.
#pragma once

#include <torch/types.h>

#include <vector>

#include "training/augmentation.h"
#include "training/detection_loss.h"

namespace msf {

// Pictures of one size (BGR, 8 bit) as [batch, 3, h, w], RGB in [0, 1], channels last.
torch::Tensor ImagesToTensor(const std::vector<LabeledImage>& pictures);

struct Batch {
  torch::Tensor images;
  BatchLabels labels;
  torch::Tensor angles;  // [batch] by which the pictures were rotated, radians
};

// All images in memory, decoded. A file that is no image is an error that names it.
StatusOr<std::vector<LabeledImage>> DecodeImages(const std::vector<VocImage>& set);

struct SamplingOptions {
  int side = 320;        // pictures are square, pixels
  int batch = 8;         // pictures per batch
  double balance = 0.5;  // see BalancingWeights
  AugmentationOptions augmentation;
};

// How often images are shown, relative to each other: an image with a class that only a share s of
// all images shows counts (0.15 / s)^balance, at least 1, at most 4. 0: all alike.
std::vector<double> BalancingWeights(const std::vector<LabeledImage>& images, double balance);

// Serves the pictures of one epoch: as many as there are images, drawn by BalancingWeights.
// Everything random depends only on (seed, epoch, place in the epoch), so that a resumed training
// sees what the uninterrupted one would have seen.
class EpochSampler {
 public:
  EpochSampler(const std::vector<LabeledImage>& images, const SamplingOptions& options,
               uint64_t seed, int epoch);

  int num_batches() const;
  Batch Make(int index) const;

 private:
  const std::vector<LabeledImage>& images_;
  SamplingOptions options_;
  uint64_t seed_;
  std::vector<size_t> order_;
};

}  // namespace msf
