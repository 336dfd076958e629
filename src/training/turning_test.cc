#include "training/turning.h"

#include <gtest/gtest.h>
#include <torch/utils.h>

#include <numbers>

#include "training/distillation.h"

namespace msf {
namespace {

constexpr double kQuarter = std::numbers::pi / 2.0;

torch::Tensor Ramp() { return torch::arange(36, torch::kFloat).reshape({1, 1, 6, 6}); }

TEST(Turning, AQuarterTurnMovesCellsOntoCells) {
  const torch::Tensor turned = TurnMaps(Ramp(), torch::full({1}, kQuarter), 0.0);
  // R(90 degrees) x for x = right is down: the right end of the middle row shows the lower end.
  EXPECT_NEAR(turned[0][0][2][5].item<double>(), Ramp()[0][0][5][3].item<double>(), 1e-3);
  EXPECT_TRUE(torch::allclose(turned, Ramp().rot90(1, {2, 3}), 1e-4, 1e-3));
}

TEST(Turning, ThereAndBackIsTheSame) {
  const torch::Tensor angle = torch::full({1}, 0.4);
  const torch::Tensor back = TurnMaps(TurnMaps(Ramp(), angle, 0.0), -angle, 0.0);
  EXPECT_NEAR(back[0][0][3][3].item<double>(), Ramp()[0][0][3][3].item<double>(), 1e-3);
}

TEST(Turning, EachPictureHasItsAngle) {
  const torch::Tensor maps = torch::cat({Ramp(), Ramp()});
  const torch::Tensor turned = TurnMaps(maps, torch::tensor({0.0, kQuarter}), 0.0);
  EXPECT_TRUE(torch::allclose(turned[0], Ramp()[0], 1e-4, 1e-3));
  EXPECT_FALSE(torch::allclose(turned[1], Ramp()[0], 1e-4, 1e-3));
}

TEST(Turning, CornersComeFromOutside) {
  const torch::Tensor angle = torch::full({1}, kQuarter / 2.0);
  const torch::Tensor inside = TurnedInside(8, angle);
  EXPECT_EQ(inside[0][0][0][0].item<double>(), 0.0);
  EXPECT_EQ(inside[0][0][4][4].item<double>(), 1.0);
  EXPECT_NEAR(TurnMaps(torch::zeros({1, 1, 8, 8}), angle, 0.5)[0][0][0][0].item<double>(), 0.5,
              1e-4);
  EXPECT_EQ(TurnedInside(8, torch::zeros({1})).sum().item<double>(), 64.0);
}

// What a teacher says of the upright picture, turned, is what a turned picture should give.
TEST(Turning, ClassLogitsOfATurnedPictureAreComparedWithTurnedOnes) {
  const torch::Tensor angle = torch::full({1}, kQuarter);
  const HeadOutputs upright{{}, {Ramp()}}, turned{{}, {TurnMaps(Ramp(), -angle, 0.0)}};
  EXPECT_NEAR(ClassDistance(turned, upright, angle).item<double>(), 0.0, 1e-6);
  EXPECT_GT(ClassDistance(upright, upright, angle).item<double>(), 0.1);
  EXPECT_NEAR(ClassDistance(upright, upright, torch::zeros({1})).item<double>(), 0.0, 1e-6);
}

}  // namespace
}  // namespace msf
