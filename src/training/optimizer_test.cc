#include "training/optimizer.h"

#include <gtest/gtest.h>
#include <torch/types.h>

#include <cmath>

namespace msf {
namespace {

NamedTensors OneParameter(float value) {
  return {{"model.0.bias", torch::full({1}, value).requires_grad_(true)}};
}

void SetGradient(const NamedTensors& parameters, float gradient) {
  parameters.at("model.0.bias").mutable_grad() = torch::full({1}, gradient);
}

TEST(OptimizerTest, FirstAdamWStepHasTheLengthOfTheRate) {
  const NamedTensors parameters = OneParameter(1.0F);
  Optimizer optimizer(parameters, {});
  SetGradient(parameters, 0.03F);
  optimizer.Step(0.01);
  EXPECT_NEAR(parameters.at("model.0.bias").item<float>(), 0.99F, 1e-5);
  EXPECT_FALSE(parameters.at("model.0.bias").grad().defined());
}

TEST(OptimizerTest, SgdAccumulatesMomentum) {
  OptimizerOptions options;
  options.method = "sgd";
  options.momentum = 0.5;
  const NamedTensors parameters = OneParameter(0.0F);
  Optimizer optimizer(parameters, options);
  SetGradient(parameters, 1.0F);
  optimizer.Step(0.1);  // velocity 1, Nesterov step 1 + 0.5
  EXPECT_NEAR(parameters.at("model.0.bias").item<float>(), -0.15F, 1e-6);
  SetGradient(parameters, 1.0F);
  optimizer.Step(0.1);  // velocity 1.5, step 1 + 0.75
  EXPECT_NEAR(parameters.at("model.0.bias").item<float>(), -0.325F, 1e-6);
}

TEST(OptimizerTest, GradientsAreClippedAndRatesScaled) {
  OptimizerOptions options;
  options.method = "sgd";
  options.momentum = 0.0;
  options.clip_norm = 2.0;
  const NamedTensors parameters = OneParameter(0.0F);
  Optimizer optimizer(parameters, options);
  optimizer.ScaleRate({"model.0.bias"}, 3.0);
  SetGradient(parameters, 100.0F);
  optimizer.Step(0.1);
  EXPECT_NEAR(parameters.at("model.0.bias").item<float>(), -0.6F, 1e-4);
}

TEST(OptimizerTest, OnlyListedParametersMove) {
  const NamedTensors parameters = {{"a", torch::zeros({1}).requires_grad_(true)},
                                   {"b", torch::zeros({1}).requires_grad_(true)}};
  Optimizer optimizer(parameters, {}, {"b"});
  for (const auto& [name, tensor] : parameters) tensor.mutable_grad() = torch::ones({1});
  optimizer.Step(0.1);
  EXPECT_EQ(parameters.at("a").item<float>(), 0.0F);
  EXPECT_LT(parameters.at("b").item<float>(), 0.0F);
}

TEST(LearningRateTest, RisesThenFalls) {
  OptimizerOptions options;
  options.learning_rate = 1.0;
  options.final_fraction = 0.1;
  options.warmup_epochs = 1.0;
  options.decay = "linear";
  EXPECT_NEAR(LearningRateAt(options, 0.0, 10.0), 0.0, 1e-9);
  EXPECT_NEAR(LearningRateAt(options, 5.0, 10.0), 0.55, 1e-9);
  EXPECT_NEAR(LearningRateAt(options, 10.0, 10.0), 0.1, 1e-9);
  options.decay = "cosine";
  EXPECT_NEAR(LearningRateAt(options, 5.0, 10.0), 0.55, 1e-9);
  EXPECT_GT(LearningRateAt(options, 2.5, 10.0), 0.8);
}

TEST(OptimizerOptionsTest, NonsenseIsRefused) {
  OptimizerOptions options;
  EXPECT_TRUE(options.Check().ok());
  options.method = "adam";
  EXPECT_FALSE(options.Check().ok());
}

}  // namespace
}  // namespace msf
