#include "training/weight_adaptation.h"

#include <gtest/gtest.h>
#include <torch/types.h>
#include <torch/utils.h>

namespace msf {
namespace {

TEST(BlendWeights, GoesFromOneSetToTheOther) {
  const NamedTensors a = {{"conv.weight", torch::tensor({{1.0F, -2.0F}})},
                          {"conv.bias", torch::tensor({4.0F})}};
  const NamedTensors b = {{"conv.weight", torch::tensor({{5.0F, 2.0F}})},
                          {"conv.bias", torch::tensor({-4.0F})}};
  const StatusOr<NamedTensors> quarter = BlendWeights(a, b, 0.25);
  ASSERT_TRUE(quarter.ok());
  EXPECT_EQ(quarter->size(), 2u);
  EXPECT_TRUE(torch::allclose(quarter->at("conv.weight"), torch::tensor({{2.0F, -1.0F}})));
  EXPECT_TRUE(torch::allclose(quarter->at("conv.bias"), torch::tensor({2.0F})));
  EXPECT_TRUE(torch::equal(BlendWeights(a, b, 0)->at("conv.weight"), a.at("conv.weight")));
  EXPECT_TRUE(torch::equal(BlendWeights(a, b, 1)->at("conv.weight"), b.at("conv.weight")));
  EXPECT_EQ(a.at("conv.bias").item<float>(), 4.0F) << "the sources stay as they are";
}

TEST(BlendWeights, HalfPrecisionBecomesSingle) {
  const NamedTensors a = {{"w", torch::tensor({1.0F}).to(torch::kHalf)}};
  const NamedTensors b = {{"w", torch::tensor({2.0F})}};
  const StatusOr<NamedTensors> blended = BlendWeights(a, b, 0.5);
  ASSERT_TRUE(blended.ok());
  EXPECT_EQ(blended->at("w").scalar_type(), torch::kFloat);
  EXPECT_FLOAT_EQ(blended->at("w").item<float>(), 1.5F);
}

TEST(BlendWeights, DifferentModelsAreAnError) {
  const NamedTensors a = {{"w", torch::zeros({2, 3})}};
  for (const NamedTensors& other :
       {NamedTensors{{"w", torch::zeros({3, 2})}}, NamedTensors{{"v", torch::zeros({2, 3})}}}) {
    const StatusOr<NamedTensors> blended = BlendWeights(a, other, 0.5);
    ASSERT_FALSE(blended.ok());
    EXPECT_NE(blended.message().find("tensor w"), std::string::npos) << blended.message();
  }
}

}  // namespace
}  // namespace msf
