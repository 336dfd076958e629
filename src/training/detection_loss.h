// What a detector is trained on: task-aligned assignment of labels to anchors (TOOD, Feng et al.
// 2021) and the loss of the YOLOv8 recipe: 7.5 * (1 - CIoU) + 0.5 * class BCE + 1.5 * distribution
// focal loss.
#pragma once

#include <torch/types.h>

#include <vector>

#include "io/voc_dataset.h"
#include "training/head_decoding.h"

namespace msf {

// Labels of a batch, padded to the same count.
struct BatchLabels {
  torch::Tensor boxes;    // [batch, M, 4] x0, y0, x1, y1 in pixels
  torch::Tensor classes;  // [batch, M] int64
  torch::Tensor valid;    // [batch, M] bool
};

BatchLabels PadLabels(const std::vector<std::vector<VocObject>>& objects);

// Which label each anchor is to predict.
struct Assignment {
  torch::Tensor foreground;     // [batch, A] bool
  torch::Tensor target_boxes;   // [batch, A, 4] in pixels
  torch::Tensor target_scores;  // [batch, A, classes] in [0, 1]
};

// score^0.5 * IoU^6 ranks the anchors whose centre lies inside an object; its ten best are assigned
// to it; an anchor claimed twice goes to the object it overlaps most. Target scores are the
// alignment scaled so that an object's best anchor gets its best IoU.
Assignment AssignLabels(const DecodedHeads& decoded, const BatchLabels& labels);

// IoU of two sets of boxes, minus CIoU's penalties for distance and aspect ratio where `complete`;
// shapes broadcast: [..., 4] -> [...].
torch::Tensor BoxIou(const torch::Tensor& a, const torch::Tensor& b, bool complete);

struct LossTerms {
  torch::Tensor total;  // per image, to be minimised
  double box = 0.0;
  double classes = 0.0;
  double distribution = 0.0;
};

LossTerms DetectionLoss(const DecodedHeads& decoded, const BatchLabels& labels);

}  // namespace msf
