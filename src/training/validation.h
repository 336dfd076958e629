// Mean average precision of a network on labelled images, to watch a training.
#pragma once

#include <functional>
#include <vector>

#include "training/augmentation.h"
#include "training/network.h"

namespace msf {

struct ScoredBox {
  int label = 0;
  float score = 0.0F;
  float x0 = 0.0F, y0 = 0.0F, x1 = 0.0F, y1 = 0.0F;
};

// Boxes of one image after non-maximum suppression per class (IoU 0.7), best first, at most 300; `classes`: [A, classes] in [0, 1],
// `boxes`: [A, 4] in pixels.
std::vector<ScoredBox> SelectBoxes(const torch::Tensor& classes, const torch::Tensor& boxes, float min_score);

struct AveragePrecision {
  double ap50 = 0.0;
  double ap50_95 = 0.0;
  int labels = 0;
};

struct Precision {
  double map50 = 0.0;  // over the classes with at least `min_labels` labels
  double map50_95 = 0.0;
  std::vector<AveragePrecision> per_class;
};

// `found` and `wanted`: per image. 101-point interpolation as the COCO and YOLOv8 tools do it.
Precision ScoreDetections(const std::vector<std::vector<ScoredBox>>& found, const std::vector<std::vector<VocObject>>& wanted,
                          int num_classes, int min_labels);

// Runs the network in batches over letterboxed pictures of `side` pixels and scores it. Leaves it in evaluation mode.
Precision Validate(Network& network, const std::vector<LabeledImage>& images, int side, int min_labels, bool bfloat16);

}  // namespace msf
