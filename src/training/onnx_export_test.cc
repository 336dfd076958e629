#include "training/onnx_export.h"

#include <gtest/gtest.h>
#include <torch/types.h>
#include <torch/utils.h>

#include "detection/compiled_network.h"
#include "detection/onnx_reader.h"
#include "training/head_decoding.h"
#include "training/model_config.h"
#include "training/onnx_import.h"

namespace msf {
namespace {

constexpr int kWidth = 96, kHeight = 64;

// A network with uneven norms, so that a mistake in folding them shows.
Network MakeNetwork(const std::string& name) {
  Network network(BuildModelGraph(*LoadModelConfig(name)), 0);
  const torch::NoGradGuard no_grad;
  torch::manual_seed(5);
  for (const NamedTensors* tensors : {&network.parameters(), &network.buffers()}) {
    for (const auto& [key, tensor] : *tensors) {
      torch::Tensor target = tensor;
      if (key.find("bn.") == std::string::npos && key.find("norm.") == std::string::npos) continue;
      if (key.ends_with(".weight") || key.ends_with(".running_var")) target.uniform_(0.7, 1.5);
      if (key.ends_with(".bias") || key.ends_with(".running_mean")) target.uniform_(-0.3, 0.3);
    }
  }
  return network;
}

std::unique_ptr<CompiledNetwork> Compile(const std::filesystem::path& file) {
  StatusOr<Graph> graph = ReadOnnx(file);
  EXPECT_TRUE(graph.ok()) << graph.message();
  CompileOptions options;
  options.width = kWidth;
  options.height = kHeight;
  options.float_input = true;
  StatusOr<std::unique_ptr<CompiledNetwork>> compiled = CompiledNetwork::Compile(*graph, options);
  EXPECT_TRUE(compiled.ok()) << compiled.message();
  return compiled.ok() ? *std::move(compiled) : nullptr;
}

torch::Tensor ToTensor(const NetworkOutput& output) {
  std::vector<int64_t> shape(output.shape.begin(), output.shape.end());
  if (!output.channels_last)
    return torch::from_blob(const_cast<float*>(output.data), shape).clone();
  const std::vector<int64_t> stored = {shape[0], shape[2], shape[3], shape[1]};
  return torch::from_blob(const_cast<float*>(output.data), stored).permute({0, 3, 1, 2}).clone();
}

double RelativeError(const torch::Tensor& a, const torch::Tensor& b) {
  return ((a - b).abs().max() / b.abs().max()).item<double>();
}

class OnnxExportTest : public testing::TestWithParam<const char*> {};

TEST_P(OnnxExportTest, OneDnnAgreesWithLibtorch) {
  const Network network = MakeNetwork(GetParam());
  const std::filesystem::path file =
      std::filesystem::path(testing::TempDir()) / (std::string(GetParam()) + ".onnx");
  OnnxOptions options;
  options.half = false;
  ASSERT_TRUE(ExportOnnx(network.graph(), network.State(), options, file).ok());
  const std::unique_ptr<CompiledNetwork> compiled = Compile(file);
  ASSERT_NE(compiled, nullptr);
  const torch::NoGradGuard no_grad;
  const torch::Tensor image = torch::rand({1, 3, kHeight, kWidth});
  std::copy_n(image.data_ptr<float>(), image.numel(), compiled->float_input());
  ASSERT_TRUE(compiled->Run().ok());
  const HeadOutputs heads = network.Forward(image);
  for (const NetworkOutput& output : compiled->outputs()) {
    const bool box = output.name.starts_with("box_");
    const int stride = std::stoi(output.name.substr(output.name.find('_') + 1));
    const int index = stride == 8 ? 0 : stride == 16 ? 1 : 2;
    EXPECT_LT(RelativeError(ToTensor(output), box ? heads.boxes[index] : heads.classes[index]),
              1e-4)
        << output.name;
  }
  EXPECT_EQ(compiled->outputs().size(), 6U);
}

TEST_P(OnnxExportTest, WeightsComeBack) {
  const Network network = MakeNetwork(GetParam());
  const std::filesystem::path file =
      std::filesystem::path(testing::TempDir()) / (std::string(GetParam()) + "_back.onnx");
  OnnxOptions options;
  options.half = false;
  ASSERT_TRUE(ExportOnnx(network.graph(), network.State(), options, file).ok());
  const StatusOr<NamedTensors> weights = LoadTensors(file);
  ASSERT_TRUE(weights.ok()) << weights.message();
  Network again(network.graph(), 1);
  const Status loaded = again.Load(*weights);
  ASSERT_TRUE(loaded.ok()) << loaded.message();
  const torch::NoGradGuard no_grad;
  const torch::Tensor image = torch::rand({1, 3, kHeight, kWidth});
  const HeadOutputs a = network.Forward(image), b = again.Forward(image);
  for (size_t i = 0; i < a.boxes.size(); ++i) {
    EXPECT_LT(RelativeError(b.boxes[i], a.boxes[i]), 1e-4);
    EXPECT_LT(RelativeError(b.classes[i], a.classes[i]), 1e-4);
  }
}

INSTANTIATE_TEST_SUITE_P(Models, OnnxExportTest,
                         testing::Values("yolov8n", "yolov8n_msf", "yolov8n_msf_wide",
                                         "yolov8n_msf_full", "yolov8n_fpn", "yolov8n_hrnet"));

TEST(OnnxExportTest, SingleOutputHoldsDecodedBoxes) {
  const Network network = MakeNetwork("yolov8n");
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "single.onnx";
  OnnxOptions options{OnnxForm::kSingleOutput, kWidth, kHeight, false};
  ASSERT_TRUE(ExportOnnx(network.graph(), network.State(), options, file).ok());
  const std::unique_ptr<CompiledNetwork> compiled = Compile(file);
  ASSERT_NE(compiled, nullptr);
  const torch::NoGradGuard no_grad;
  const torch::Tensor image = torch::rand({1, 3, kHeight, kWidth});
  std::copy_n(image.data_ptr<float>(), image.numel(), compiled->float_input());
  ASSERT_TRUE(compiled->Run().ok());
  const DecodedHeads decoded = DecodeHeads(network.Forward(image), kWidth);
  const torch::Tensor output = ToTensor(compiled->outputs()[0]).transpose(1, 2);
  ASSERT_EQ(output.size(2), 24);
  const torch::Tensor minimum = decoded.boxes.narrow(-1, 0, 2),
                      maximum = decoded.boxes.narrow(-1, 2, 2);
  EXPECT_LT(RelativeError(output.narrow(-1, 0, 2), (minimum + maximum) / 2), 1e-4);
  EXPECT_LT(RelativeError(output.narrow(-1, 2, 2), maximum - minimum), 1e-4);
  EXPECT_LT(RelativeError(output.narrow(-1, 4, 20), decoded.class_logits.sigmoid()), 1e-4);
}

TEST(OnnxExportTest, HalfPrecisionHalvesTheFile) {
  const Network network = MakeNetwork("yolov8n_msf");
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "half.onnx";
  ASSERT_TRUE(ExportOnnx(network.graph(), network.State(), {}, file).ok());
  EXPECT_LT(std::filesystem::file_size(file), 7U << 20);
  EXPECT_TRUE(ReadOnnx(file).ok());
}

TEST(OnnxExportTest, WhatIsNoModelGivesNoWeights) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "none.onnx";
  EXPECT_NE(LoadTensors(file).status().message().find("none.onnx"), std::string::npos);
}

TEST(OnnxExportTest, OddSizesAreRefused) {
  const Network network = MakeNetwork("yolov8n");
  OnnxOptions options;
  options.form = OnnxForm::kSingleOutput;
  options.width = 100;
  EXPECT_FALSE(ExportOnnx(network.graph(), network.State(), options, "never.onnx").ok());
}

}  // namespace
}  // namespace msf
