#include "training/validation.h"

#include <algorithm>
#include <array>
#include <numeric>

#include <torch/types.h>
#include <torch/utils.h>

#include "training/batch.h"
#include "training/head_decoding.h"
#include "training/mixed_precision.h"

namespace msf {

namespace {

constexpr float kSuppressionIou = 0.7F;
constexpr size_t kMostBoxes = 300;
constexpr int kThresholds = 10;  // IoU 0.50, 0.55, ..., 0.95

template <typename A, typename B>
float Iou(const A& a, const B& b) {
  const float w = std::min(a.x1, b.x1) - std::max(a.x0, b.x0);
  const float h = std::min(a.y1, b.y1) - std::max(a.y0, b.y0);
  if (w <= 0.0F || h <= 0.0F) return 0.0F;
  return w * h / ((a.x1 - a.x0) * (a.y1 - a.y0) + (b.x1 - b.x0) * (b.y1 - b.y0) - w * h);
}

// A detection of one class and at which thresholds it is a true one.
struct Verdict {
  float score = 0.0F;
  std::array<bool, kThresholds> hit{};
};

// Greedy one-to-one matching by decreasing IoU, per threshold.
void JudgeImage(const std::vector<ScoredBox>& found, const std::vector<VocObject>& wanted, int label, std::vector<Verdict>& verdicts) {
  struct Pair {
    float iou;
    size_t found, wanted;
  };
  std::vector<Pair> pairs;
  std::vector<Verdict> own(found.size());
  for (size_t i = 0; i < found.size(); ++i) {
    own[i].score = found[i].score;
    for (size_t j = 0; j < wanted.size(); ++j) {
      if (found[i].label != label || wanted[j].label != label) continue;
      const float iou = Iou(found[i], wanted[j]);
      if (iou >= 0.5F) pairs.push_back({iou, i, j});
    }
  }
  std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.iou > b.iou; });
  for (int t = 0; t < kThresholds; ++t) {
    std::vector<bool> used(wanted.size(), false);
    for (const Pair& pair : pairs) {
      if (pair.iou < 0.5F + 0.05F * t || used[pair.wanted] || own[pair.found].hit[t]) continue;
      used[pair.wanted] = true;
      own[pair.found].hit[t] = true;
    }
  }
  for (size_t i = 0; i < found.size(); ++i) {
    if (found[i].label == label) verdicts.push_back(own[i]);
  }
}

// Boxes end where the image ends, as a user gets them.
void CutToContent(const cv::Rect& content, std::vector<ScoredBox>& boxes) {
  const auto x0 = static_cast<float>(content.x), x1 = x0 + static_cast<float>(content.width);
  const auto y0 = static_cast<float>(content.y), y1 = y0 + static_cast<float>(content.height);
  for (ScoredBox& box : boxes) {
    box.x0 = std::clamp(box.x0, x0, x1);
    box.x1 = std::clamp(box.x1, x0, x1);
    box.y0 = std::clamp(box.y0, y0, y1);
    box.y1 = std::clamp(box.y1, y0, y1);
  }
}

// Area under the precision envelope, sampled at 101 recalls. `verdicts` by decreasing score.
double AreaUnderCurve(const std::vector<Verdict>& verdicts, int threshold, int labels) {
  std::vector<double> recall = {0.0}, precision = {1.0};
  int hits = 0;
  for (size_t i = 0; i < verdicts.size(); ++i) {
    hits += verdicts[i].hit[threshold] ? 1 : 0;
    recall.push_back(static_cast<double>(hits) / labels);
    precision.push_back(static_cast<double>(hits) / static_cast<double>(i + 1));
  }
  recall.push_back(1.0);
  precision.push_back(0.0);
  for (size_t i = precision.size() - 1; i > 0; --i) precision[i - 1] = std::max(precision[i - 1], precision[i]);
  double area = 0.0, previous = 0.0;
  size_t at = 0;
  for (int step = 0; step <= 100; ++step) {
    const double x = step / 100.0;
    while (at + 2 < recall.size() && recall[at + 1] <= x) ++at;
    const double width = recall[at + 1] - recall[at];
    const double part = width > 0.0 ? std::clamp((x - recall[at]) / width, 0.0, 1.0) : 0.0;
    const double value = precision[at] + part * (precision[at + 1] - precision[at]);
    if (step > 0) area += 0.005 * (value + previous);
    previous = value;
  }
  return area;
}

}  // namespace

std::vector<ScoredBox> SelectBoxes(const torch::Tensor& classes, const torch::Tensor& boxes, float min_score) {
  const auto score = classes.accessor<float, 2>();
  const auto box = boxes.accessor<float, 2>();
  std::vector<ScoredBox> candidates;
  for (int64_t a = 0; a < score.size(0); ++a) {
    for (int64_t c = 0; c < score.size(1); ++c) {
      if (score[a][c] > min_score) {
        candidates.push_back({static_cast<int>(c), score[a][c], box[a][0], box[a][1], box[a][2], box[a][3]});
      }
    }
  }
  std::stable_sort(candidates.begin(), candidates.end(), [](const auto& a, const auto& b) { return a.score > b.score; });
  std::vector<ScoredBox> kept;
  for (const ScoredBox& candidate : candidates) {
    const bool covered = std::any_of(kept.begin(), kept.end(), [&](const ScoredBox& other) {
      return other.label == candidate.label && Iou(other, candidate) > kSuppressionIou;
    });
    if (!covered) kept.push_back(candidate);
    if (kept.size() == kMostBoxes) break;
  }
  return kept;
}

Precision ScoreDetections(const std::vector<std::vector<ScoredBox>>& found, const std::vector<std::vector<VocObject>>& wanted,
                          int num_classes, int min_labels) {
  Precision precision;
  precision.per_class.resize(num_classes);
  int counted = 0;
  for (int label = 0; label < num_classes; ++label) {
    AveragePrecision& own = precision.per_class[label];
    std::vector<Verdict> verdicts;
    for (size_t i = 0; i < found.size(); ++i) {
      for (const VocObject& object : wanted[i]) own.labels += object.label == label ? 1 : 0;
      JudgeImage(found[i], wanted[i], label, verdicts);
    }
    if (own.labels == 0) continue;
    std::stable_sort(verdicts.begin(), verdicts.end(), [](const Verdict& a, const Verdict& b) { return a.score > b.score; });
    own.ap50 = AreaUnderCurve(verdicts, 0, own.labels);
    for (int t = 0; t < kThresholds; ++t) own.ap50_95 += AreaUnderCurve(verdicts, t, own.labels) / kThresholds;
    if (own.labels < min_labels) continue;
    precision.map50 += own.ap50;
    precision.map50_95 += own.ap50_95;
    ++counted;
  }
  if (counted > 0) precision.map50 /= counted;
  if (counted > 0) precision.map50_95 /= counted;
  return precision;
}

Precision Validate(Network& network, const std::vector<LabeledImage>& images, int side, int min_labels, bool bfloat16) {
  constexpr size_t kBatch = 16;
  const torch::NoGradGuard no_grad;
  network.set_training(false);
  std::vector<std::vector<ScoredBox>> found;
  std::vector<std::vector<VocObject>> wanted;
  for (size_t begin = 0; begin < images.size(); begin += kBatch) {
    std::vector<LabeledImage> pictures;
    for (size_t i = begin; i < std::min(begin + kBatch, images.size()); ++i) pictures.push_back(LetterboxPicture(images[i], side));
    const HeadOutputs heads = [&] {
      const MixedPrecision mixed(bfloat16);
      return network.Forward(ImagesToTensor(pictures));
    }();
    const DecodedHeads decoded = DecodeHeads(heads, side);
    const torch::Tensor scores = decoded.class_logits.sigmoid();
    for (size_t i = 0; i < pictures.size(); ++i) {
      const auto index = static_cast<int64_t>(i);
      found.push_back(SelectBoxes(scores[index], decoded.boxes[index], 0.001F));
      CutToContent(LetterboxContent(images[begin + i].pixels.size(), side), found.back());
      wanted.push_back(pictures[i].objects);
    }
  }
  return ScoreDetections(found, wanted, static_cast<int>(network.graph().classes.size()), min_labels);
}

}  // namespace msf
