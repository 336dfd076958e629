#include "training/validation.h"

#include <torch/types.h>
#include <torch/utils.h>

#include <algorithm>

#include "detection/letterbox.h"
#include "training/head_decoding.h"
#include "training/mixed_precision.h"

namespace msf {

namespace {

constexpr size_t kBatch = 16;
constexpr float kMinScore = 0.001F;

// Images [begin, end) letterboxed to `side`, as [batch, 3, side, side], RGB in [0, 1].
torch::Tensor LetterboxBatch(const std::vector<LabeledImage>& images, size_t begin, size_t end,
                             int side) {
  torch::Tensor pixels =
      torch::empty({static_cast<int64_t>(end - begin), side, side, 3}, torch::kByte);
  for (size_t i = begin; i < end; ++i) {
    const Letterbox letterbox(images[i].pixels.size(), {side, side});
    letterbox.Fill(images[i].pixels, pixels[static_cast<int64_t>(i - begin)].data_ptr<uint8_t>());
  }
  return pixels.to(torch::kFloat).div_(255.0).permute({0, 3, 1, 2});
}

ScoredImage ScoreImage(const LabeledImage& image, int side, const torch::Tensor& scores,
                       const torch::Tensor& boxes) {
  ScoredImage scored;
  for (const VocObject& object : image.objects) {
    scored.truth.push_back({object.label, {object.x0, object.y0, object.x1, object.y1}, false});
  }
  const Letterbox letterbox(image.pixels.size(), {side, side});
  scored.found = SelectDetections(scores, boxes, kMinScore);
  for (Detection& detection : scored.found) detection.box = letterbox.ToImage(detection.box);
  return scored;
}

}  // namespace

std::vector<Detection> SelectDetections(const torch::Tensor& scores, const torch::Tensor& boxes,
                                        float min_score) {
  const auto score = scores.accessor<float, 2>();
  const auto box = boxes.accessor<float, 2>();
  std::vector<Detection> candidates;
  for (int64_t a = 0; a < score.size(0); ++a) {
    for (int64_t c = 0; c < score.size(1); ++c) {
      if (score[a][c] <= min_score) continue;
      candidates.push_back(
          {static_cast<int>(c), score[a][c], {box[a][0], box[a][1], box[a][2], box[a][3]}});
    }
  }
  return SuppressOverlaps(std::move(candidates), OverlapRule{});
}

DetectionMetrics Validate(Network& network, const std::vector<LabeledImage>& images, int side,
                          int min_objects, bool bfloat16) {
  const torch::NoGradGuard no_grad;
  network.set_training(false);
  std::vector<ScoredImage> scored;
  for (size_t begin = 0; begin < images.size(); begin += kBatch) {
    const size_t end = std::min(begin + kBatch, images.size());
    const HeadOutputs heads = [&] {
      const MixedPrecision mixed(bfloat16);
      return network.Forward(LetterboxBatch(images, begin, end, side));
    }();
    const DecodedHeads decoded = DecodeHeads(heads, side);
    const torch::Tensor scores = decoded.class_logits.sigmoid();
    for (size_t i = begin; i < end; ++i) {
      const auto index = static_cast<int64_t>(i - begin);
      scored.push_back(ScoreImage(images[i], side, scores[index], decoded.boxes[index]));
    }
  }
  return ComputeMetrics(scored, static_cast<int>(network.graph().classes.size()), min_objects);
}

}  // namespace msf
