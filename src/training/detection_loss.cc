#include "training/detection_loss.h"

#include <torch/types.h>
#include <torch/utils.h>

#include <algorithm>

namespace msf {

namespace {

constexpr double kBoxGain = 7.5;
constexpr double kClassGain = 0.5;
constexpr double kDistributionGain = 1.5;

// Cross entropy of the two bins beside the wanted distance, weighted by nearness (Li et al. 2020);
// [N, 4, bins], [N, 4] -> [N].
torch::Tensor DistributionFocalLoss(const torch::Tensor& logits, const torch::Tensor& distances) {
  const torch::Tensor wanted = distances.clamp(0.0, kBoxBins - 1 - 0.01);
  const torch::Tensor left = wanted.floor();
  const torch::Tensor right_weight = wanted - left;
  const torch::Tensor index = left.to(torch::kLong).unsqueeze(-1);
  const torch::Tensor log_p = logits.log_softmax(-1);
  const torch::Tensor left_term = log_p.gather(-1, index).squeeze(-1) * (1.0 - right_weight);
  const torch::Tensor right_term = log_p.gather(-1, index + 1).squeeze(-1) * right_weight;
  return -(left_term + right_term).mean(-1);
}

}  // namespace

BatchLabels PadLabels(const std::vector<std::vector<VocObject>>& objects) {
  size_t most = 1;
  for (const auto& list : objects) most = std::max(most, list.size());
  const auto batch = static_cast<int64_t>(objects.size()), padded = static_cast<int64_t>(most);
  BatchLabels labels{torch::zeros({batch, padded, 4}), torch::zeros({batch, padded}, torch::kLong),
                     torch::zeros({batch, padded}, torch::kBool)};
  auto boxes = labels.boxes.accessor<float, 3>();
  auto classes = labels.classes.accessor<int64_t, 2>();
  auto valid = labels.valid.accessor<bool, 2>();
  for (size_t i = 0; i < objects.size(); ++i) {
    for (size_t j = 0; j < objects[i].size(); ++j) {
      const VocObject& object = objects[i][j];
      boxes[i][j][0] = object.x0;
      boxes[i][j][1] = object.y0;
      boxes[i][j][2] = object.x1;
      boxes[i][j][3] = object.y1;
      classes[i][j] = object.label;
      valid[i][j] = true;
    }
  }
  return labels;
}

torch::Tensor BoxIou(const torch::Tensor& a, const torch::Tensor& b, bool complete) {
  constexpr double kEpsilon = 1e-7;
  const auto a_min = a.narrow(-1, 0, 2), a_max = a.narrow(-1, 2, 2), b_min = b.narrow(-1, 0, 2),
             b_max = b.narrow(-1, 2, 2);
  const torch::Tensor overlap =
      (torch::minimum(a_max, b_max) - torch::maximum(a_min, b_min)).clamp_min(0.0).prod(-1);
  const torch::Tensor a_size = a_max - a_min, b_size = b_max - b_min;
  const torch::Tensor iou = overlap / (a_size.prod(-1) + b_size.prod(-1) - overlap + kEpsilon);
  if (!complete) return iou;
  const torch::Tensor hull = torch::maximum(a_max, b_max) - torch::minimum(a_min, b_min);
  const torch::Tensor distance = (a_min + a_max - b_min - b_max).square().sum(-1) / 4.0;
  const torch::Tensor a_angle =
      torch::atan(a_size.select(-1, 0) / (a_size.select(-1, 1) + kEpsilon));
  const torch::Tensor b_angle =
      torch::atan(b_size.select(-1, 0) / (b_size.select(-1, 1) + kEpsilon));
  const torch::Tensor v = (b_angle - a_angle).square() * (4.0 / (M_PI * M_PI));
  const torch::Tensor alpha = (v / (v - iou + 1.0 + kEpsilon)).detach();
  return iou - distance / (hull.square().sum(-1) + kEpsilon) - v * alpha;
}

Assignment AssignLabels(const DecodedHeads& decoded, const BatchLabels& labels) {
  constexpr int kBest = 10;
  const torch::NoGradGuard no_grad;
  const torch::Tensor scores = decoded.class_logits.detach().sigmoid();
  const int64_t batch = scores.size(0), anchors = scores.size(1), classes = scores.size(2),
                count = labels.boxes.size(1);
  const torch::Tensor boxes = labels.boxes.unsqueeze(2);  // [B, M, 1, 4]
  const torch::Tensor centre = decoded.anchors.view({1, 1, anchors, 2});
  const torch::Tensor margin =
      torch::cat({centre - boxes.narrow(-1, 0, 2), boxes.narrow(-1, 2, 2) - centre}, -1);
  const torch::Tensor eligible =
      margin.amin(-1).gt(1e-9) & labels.valid.unsqueeze(-1);  // [B, M, A]

  const torch::Tensor iou = BoxIou(boxes, decoded.boxes.detach().unsqueeze(1), false) * eligible;
  const torch::Tensor label_index = labels.classes.unsqueeze(1).expand({batch, anchors, count});
  const torch::Tensor label_score = scores.gather(2, label_index).transpose(1, 2);
  const torch::Tensor alignment = label_score.sqrt() * iou.pow(6) * eligible;

  const torch::Tensor best = std::get<1>(alignment.topk(std::min<int64_t>(kBest, anchors), -1));
  torch::Tensor claimed =
      torch::zeros_like(alignment, torch::kBool).scatter_(-1, best, true) & eligible;
  // Claimed twice: only the claim with the largest overlap stays.
  const torch::Tensor winner =
      iou.masked_fill(claimed.logical_not(), -1.0).argmax(1, true);  // [B, 1, A]
  claimed = claimed & torch::zeros_like(claimed).scatter_(1, winner, true);

  Assignment assignment;
  assignment.foreground = claimed.any(1);
  const torch::Tensor owner = winner.squeeze(1);  // [B, A]
  assignment.target_boxes = labels.boxes.gather(1, owner.unsqueeze(-1).expand({batch, anchors, 4}));
  const torch::Tensor kept = alignment * claimed;
  const torch::Tensor scale = (iou * claimed).amax(-1, true) / (kept.amax(-1, true) + 1e-9);
  const torch::Tensor strength = (kept * scale).amax(1);  // [B, A]
  const torch::Tensor owner_class = labels.classes.gather(1, owner);
  assignment.target_scores = torch::zeros({batch, anchors, classes});
  assignment.target_scores.scatter_(2, owner_class.unsqueeze(-1), strength.unsqueeze(-1));
  return assignment;
}

LossTerms DetectionLoss(const DecodedHeads& decoded, const BatchLabels& labels) {
  const Assignment assignment = AssignLabels(decoded, labels);
  const torch::Tensor normaliser = assignment.target_scores.sum().clamp_min(1.0);
  const torch::Tensor class_loss =
      at::binary_cross_entropy_with_logits(decoded.class_logits, assignment.target_scores, {}, {},
                                           at::Reduction::Sum) /
      normaliser;

  const torch::Tensor chosen = assignment.foreground.flatten().nonzero().squeeze(1);
  const auto pick = [&](const torch::Tensor& all) {
    return all.flatten(0, 1).index_select(0, chosen);
  };
  const torch::Tensor weight = pick(assignment.target_scores).sum(-1);
  const torch::Tensor boxes = pick(decoded.boxes), targets = pick(assignment.target_boxes);
  const torch::Tensor box_loss = ((1.0 - BoxIou(boxes, targets, true)) * weight).sum() / normaliser;

  const torch::Tensor anchor =
      decoded.anchors.index_select(0, chosen.remainder(decoded.anchors.size(0)));
  const torch::Tensor stride =
      decoded.strides.index_select(0, chosen.remainder(decoded.anchors.size(0))).unsqueeze(-1);
  const torch::Tensor distances =
      torch::cat({anchor - targets.narrow(-1, 0, 2), targets.narrow(-1, 2, 2) - anchor}, -1) /
      stride;
  const torch::Tensor distribution_loss =
      (DistributionFocalLoss(pick(decoded.side_logits), distances) * weight).sum() / normaliser;

  LossTerms terms;
  terms.total =
      kBoxGain * box_loss + kClassGain * class_loss + kDistributionGain * distribution_loss;
  terms.box = box_loss.item<double>();
  terms.classes = class_loss.item<double>();
  terms.distribution = distribution_loss.item<double>();
  return terms;
}

}  // namespace msf
