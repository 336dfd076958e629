#include "training/head_decoding.h"

#include <torch/types.h>
#include <torch/utils.h>

namespace msf {

DecodedHeads DecodeHeads(const HeadOutputs& heads, int image_width) {
  std::vector<torch::Tensor> classes, sides, anchors, strides;
  for (size_t i = 0; i < heads.boxes.size(); ++i) {
    const int64_t batch = heads.boxes[i].size(0), height = heads.boxes[i].size(2),
                  width = heads.boxes[i].size(3);
    const double stride = static_cast<double>(image_width) / static_cast<double>(width);
    const auto flat = [&](const torch::Tensor& map) {
      return map.permute({0, 2, 3, 1}).reshape({batch, height * width, -1}).to(torch::kFloat);
    };
    classes.push_back(flat(heads.classes[i]));
    sides.push_back(flat(heads.boxes[i]));
    const torch::Tensor y = (torch::arange(height, torch::kFloat) + 0.5) * stride;
    const torch::Tensor x = (torch::arange(width, torch::kFloat) + 0.5) * stride;
    const auto grid = torch::meshgrid({y, x}, "ij");
    anchors.push_back(torch::stack({grid[1].flatten(), grid[0].flatten()}, 1));
    strides.push_back(torch::full({height * width}, stride, torch::kFloat));
  }
  DecodedHeads decoded;
  decoded.class_logits = torch::cat(classes, 1);
  decoded.anchors = torch::cat(anchors, 0);
  decoded.strides = torch::cat(strides, 0);
  const torch::Tensor flat_sides = torch::cat(sides, 1);
  decoded.side_logits = flat_sides.view({flat_sides.size(0), flat_sides.size(1), 4, kBoxBins});
  const torch::Tensor bins = torch::arange(kBoxBins, torch::kFloat);
  const torch::Tensor reach =
      torch::matmul(decoded.side_logits.softmax(-1), bins) * decoded.strides.view({1, -1, 1});
  decoded.boxes = torch::cat(
      {decoded.anchors - reach.narrow(-1, 0, 2), decoded.anchors + reach.narrow(-1, 2, 2)}, -1);
  return decoded;
}

}  // namespace msf
