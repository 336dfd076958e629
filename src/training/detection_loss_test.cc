#include "training/detection_loss.h"

#include <gtest/gtest.h>
#include <torch/types.h>

#include <cmath>

namespace msf {
namespace {

float Iou(std::vector<float> a, std::vector<float> b, bool complete) {
  return BoxIou(torch::tensor(a).view({1, 4}), torch::tensor(b).view({1, 4}), complete)
      .item<float>();
}

// Heads for a square picture of `side` pixels: all sides reach `reach` cells, all classes have the
// logit `logit`.
HeadOutputs UniformHeads(int side, int classes, int reach, float logit) {
  HeadOutputs heads;
  for (int stride : {8, 16, 32}) {
    const int cells = side / stride;
    torch::Tensor box = torch::full({1, 4, kBoxBins, cells, cells}, -20.0F);
    box.select(2, reach).fill_(20.0F);
    heads.boxes.push_back(box.view({1, 4 * kBoxBins, cells, cells}));
    heads.classes.push_back(torch::full({1, classes, cells, cells}, logit));
  }
  return heads;
}

TEST(HeadDecodingTest, SidesAreMeasuredFromTheCellsCentre) {
  const DecodedHeads decoded = DecodeHeads(UniformHeads(64, 2, 3, 0.0F), 64);
  EXPECT_EQ(decoded.boxes.size(1), 64 + 16 + 4);
  // The second cell of the first row at stride 8: centre (12, 4), 3 cells to every side.
  const torch::Tensor box = decoded.boxes[0][1];
  EXPECT_NEAR(box[0].item<float>(), 12 - 24, 1e-3);
  EXPECT_NEAR(box[1].item<float>(), 4 - 24, 1e-3);
  EXPECT_NEAR(box[2].item<float>(), 12 + 24, 1e-3);
  EXPECT_NEAR(box[3].item<float>(), 4 + 24, 1e-3);
}

TEST(BoxIouTest, HandComputedCases) {
  EXPECT_NEAR(Iou({0, 0, 10, 10}, {0, 0, 10, 10}, false), 1.0, 1e-5);
  EXPECT_NEAR(Iou({0, 0, 10, 10}, {5, 0, 15, 10}, false), 1.0 / 3.0, 1e-5);
  EXPECT_NEAR(Iou({0, 0, 10, 10}, {20, 0, 30, 10}, false), 0.0, 1e-5);
  // Same shape, 5 apart: the penalty is 25 over the hull's squared diagonal, 15^2 + 10^2.
  EXPECT_NEAR(Iou({0, 0, 10, 10}, {5, 0, 15, 10}, true), 1.0 / 3.0 - 25.0 / 325.0, 1e-4);
  // Same centre, 10x10 and 20x5: IoU 1/3, v = 4/pi^2 (atan 4 - atan 1)^2, weight v / (v - IoU + 1).
  const double v = 4.0 / (M_PI * M_PI) * std::pow(std::atan(4.0) - std::atan(1.0), 2);
  EXPECT_NEAR(Iou({5, 5, 15, 15}, {0, 7.5, 20, 12.5}, true),
              1.0 / 3.0 - v * v / (v - 1.0 / 3.0 + 1.0), 1e-4);
}

TEST(AssignmentTest, OnlyCentresInsideAnObjectAndAtMostTen) {
  const DecodedHeads decoded = DecodeHeads(UniformHeads(64, 2, 2, 0.0F), 64);
  const BatchLabels labels = PadLabels({{{1, 0, 0, 40, 40, false}}});
  const Assignment assignment = AssignLabels(decoded, labels);
  const torch::Tensor chosen = assignment.foreground[0].nonzero().squeeze(1);
  EXPECT_EQ(chosen.size(0), 10);
  for (int64_t i = 0; i < chosen.size(0); ++i) {
    const torch::Tensor anchor = decoded.anchors[chosen[i].item<int64_t>()];
    EXPECT_LT(anchor.max().item<float>(), 40.0F);
  }
  // Scores only for the object's class; the best anchor's is the best IoU.
  EXPECT_EQ(assignment.target_scores.select(2, 0).max().item<float>(), 0.0F);
  const torch::Tensor iou =
      BoxIou(decoded.boxes[0], torch::tensor({0.0F, 0.0F, 40.0F, 40.0F}), false);
  const torch::Tensor inside = decoded.anchors.amax(-1).lt(40.0);
  EXPECT_NEAR(assignment.target_scores.max().item<float>(), (iou * inside).max().item<float>(),
              1e-4);
}

TEST(AssignmentTest, AnchorClaimedTwiceGoesToTheLargerOverlap) {
  const DecodedHeads decoded = DecodeHeads(UniformHeads(64, 2, 2, 0.0F), 64);
  const BatchLabels labels = PadLabels({{{0, 0, 0, 40, 40, false}, {1, 0, 0, 36, 36, false}}});
  const Assignment assignment = AssignLabels(decoded, labels);
  const torch::Tensor per_class = assignment.target_scores[0].gt(0).sum(-1);
  EXPECT_LE(per_class.max().item<int64_t>(), 1);
  const torch::Tensor chosen = assignment.foreground[0].nonzero().squeeze(1);
  for (int64_t i = 0; i < chosen.size(0); ++i) {
    const int64_t anchor = chosen[i].item<int64_t>();
    const float big =
        Iou({0, 0, 40, 40},
            {decoded.boxes[0][anchor][0].item<float>(), decoded.boxes[0][anchor][1].item<float>(),
             decoded.boxes[0][anchor][2].item<float>(), decoded.boxes[0][anchor][3].item<float>()},
            false);
    EXPECT_GE(
        BoxIou(decoded.boxes[0][anchor], assignment.target_boxes[0][anchor], false).item<float>(),
        big - 1e-5F);
  }
}

TEST(DetectionLossTest, PicturesWithoutObjectsOnlyTrainTheScores) {
  const LossTerms terms =
      DetectionLoss(DecodeHeads(UniformHeads(64, 2, 2, -3.0F), 64), PadLabels({{}}));
  EXPECT_EQ(terms.box, 0.0);
  EXPECT_EQ(terms.distribution, 0.0);
  // 84 anchors, 2 classes, log(1 + e^-3) each.
  EXPECT_NEAR(terms.classes, 84 * 2 * std::log1p(std::exp(-3.0)), 1e-3);
}

TEST(DetectionLossTest, GradientDescentFindsTheObject) {
  HeadOutputs heads = UniformHeads(64, 2, 4, -2.0F);
  for (auto* maps : {&heads.boxes, &heads.classes}) {
    for (torch::Tensor& map : *maps) map = (map * 0.1).clone().requires_grad_(true);
  }
  const BatchLabels labels = PadLabels({{{1, 9, 12, 49, 55, false}}});
  double first = 0.0, last = 0.0;
  for (int step = 0; step < 150; ++step) {
    const LossTerms terms = DetectionLoss(DecodeHeads(heads, 64), labels);
    terms.total.backward();
    last = terms.total.item<double>();
    if (step == 0) first = last;
    for (auto* maps : {&heads.boxes, &heads.classes}) {
      for (torch::Tensor& map : *maps) {
        const at::NoGradGuard no_grad;
        map.add_(map.grad(), -1.0);
        map.mutable_grad().zero_();
      }
    }
  }
  EXPECT_LT(last, 0.5 * first);
  const DecodedHeads decoded = DecodeHeads(heads, 64);
  const int64_t best = decoded.class_logits[0].select(1, 1).argmax().item<int64_t>();
  EXPECT_GT(BoxIou(decoded.boxes[0][best], labels.boxes[0][0], false).item<float>(), 0.8F);
}

}  // namespace
}  // namespace msf
