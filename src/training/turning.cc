#include "training/turning.h"

#include <torch/nn/functional/vision.h>

namespace msf {

torch::Tensor TurnMaps(const torch::Tensor& maps, const torch::Tensor& angles, double fill) {
  namespace F = torch::nn::functional;
  const torch::Tensor a = angles.to(torch::kFloat), zero = torch::zeros_like(a);
  const torch::Tensor rows = torch::stack(
      {torch::stack({a.cos(), -a.sin(), zero}, 1), torch::stack({a.sin(), a.cos(), zero}, 1)}, 1);
  const torch::Tensor grid = F::affine_grid(rows, maps.sizes(), false);
  const auto options = F::GridSampleFuncOptions()
                           .mode(torch::kBilinear)
                           .padding_mode(torch::kZeros)
                           .align_corners(false);
  return F::grid_sample(maps.to(torch::kFloat) - fill, grid, options) + fill;
}

torch::Tensor TurnedInside(int64_t side, const torch::Tensor& angles) {
  constexpr double kWhole = 0.99;
  const torch::Tensor ones = torch::ones({angles.size(0), 1, side, side});
  return (TurnMaps(ones, angles, 0.0) > kWhole).to(torch::kFloat);
}

}  // namespace msf
