#include "detection/onnx_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "detection/model_summary.h"
#include "detection/onnx_editor.h"
#include "detection/test_networks.h"

namespace msf {
namespace {

using testing::HasSubstr;

TEST(OnnxReader, NumbersOfHalfPrecision) {
  for (const float x :
       {0.0f, 1.0f, -2.5f, 65504.0f, 6.103515625e-5f, 5.9604645e-8f, 0.333251953125f}) {
    EXPECT_EQ(HalfToFloat(FloatToHalf(x)), x);
  }
  EXPECT_EQ(FloatToHalf(1e6f), 0x7c00);
  EXPECT_EQ(FloatToHalf(1.0f + 1.0f / 2048), 0x3c00);  // half way: to even
  EXPECT_EQ(FloatToHalf(1.0f + 3.0f / 2048), 0x3c02);
  EXPECT_TRUE(std::isinf(HalfToFloat(0xfc00)));
  EXPECT_TRUE(std::isnan(HalfToFloat(0x7e01)));
  // Every finite number survives the way there and back.
  for (uint32_t bits = 0; bits < 0x7c00; ++bits)
    ASSERT_EQ(FloatToHalf(HalfToFloat(static_cast<uint16_t>(bits))), bits);
}

TEST(OnnxReader, TellsWhyAFileIsNone) {
  EXPECT_THAT(ReadOnnx("/nowhere/model.onnx").message(), HasSubstr("/nowhere/model.onnx"));
  const std::string whole = TestNetwork({}).builder().Bytes();
  EXPECT_THAT(ParseOnnx(whole.substr(0, whole.size() / 2), "half.onnx").message(),
              HasSubstr("truncated"));
  EXPECT_THAT(ParseOnnx("not a model at all", "text.onnx").message(), HasSubstr("text.onnx"));
  EXPECT_THAT(ParseOnnx("", "empty.onnx").message(), HasSubstr("holds no network"));
}

TEST(OnnxReader, NamesTheUnsupportedOperatorAndItsNode) {
  OnnxBuilder n;
  const std::string x = n.Input("images", {1, 3, -1, -1});
  onnx::NodeProto& node = n.Add("NonMaxSuppression", {x});
  node.set_name("model.22/nms");
  n.Output(node.output(0));
  EXPECT_THAT(n.Parse().message(),
              testing::AllOf(HasSubstr("NonMaxSuppression"), HasSubstr("model.22/nms")));
}

TEST(OnnxReader, RefusesDamagedNetworks) {
  OnnxBuilder missing;
  missing.Input("images", {1, 3, -1, -1});
  missing.Output(missing.Node("Relu", {"nothing"}));
  EXPECT_THAT(missing.Parse().message(), HasSubstr("'nothing'"));

  OnnxBuilder wrong_size;
  const std::string x = wrong_size.Input("images", {1, 3, -1, -1});
  const std::string w = wrong_size.Floats({4, 3, 3, 3}, std::vector<float>(10));
  wrong_size.Output(wrong_size.Node("Conv", {x, w}));
  EXPECT_THAT(wrong_size.Parse().message(), HasSubstr("do not fill"));

  OnnxBuilder no_output;
  no_output.Node("Relu", {no_output.Input("images", {1, 3, -1, -1})});
  EXPECT_THAT(no_output.Parse().message(), HasSubstr("no output"));
}

TEST(OnnxReader, ContradictionsAreFoundWhenTheSizeIsFixed) {
  OnnxBuilder n;
  const std::string x = n.Input("images", {1, 3, -1, -1});
  n.NameOutput(n.Conv(x, 5, 4, 3), "out");  // weights for 5 channels
  EXPECT_THAT(Specialize(n.Parse().value(), 32, 32).message(),
              testing::AllOf(HasSubstr("Conv"), HasSubstr("do not fit")));
}

TEST(OnnxEditor, HalvedWeightsAndMetadata) {
  TestNetworkOptions options;
  options.base = 8;
  const std::string bytes = TestNetwork(options).builder().Bytes();
  const std::string halved = HalveOnnxWeights(bytes).value();
  EXPECT_LT(static_cast<double>(halved.size()), 0.65 * static_cast<double>(bytes.size()));
  const std::string named = SetOnnxMetadata(halved, {{"names", "[\"a\"]"}}).value();
  const Graph graph =
      ParseOnnx(SetOnnxMetadata(named, {{"names", "[\"b\"]"}}).value(), "halved").value();
  EXPECT_EQ(graph.metadata.at("names"), "[\"b\"]");
  // The network computes nearly the same.
  const Tensor image = TestImage(32, 32);
  const auto before =
      Interpret(Specialize(ParseOnnx(bytes, "whole").value(), 32, 32).value(), image);
  const auto after = Interpret(Specialize(graph, 32, 32).value(), image);
  for (size_t i = 0; i < before.at("class_8").floats.size(); ++i) {
    EXPECT_NEAR(before.at("class_8").floats[i], after.at("class_8").floats[i], 0.05);
  }
  // And back: no half precision and no cast is left, the size is fixed.
  const Graph simple = ParseOnnx(SimplifyOnnx(halved, 64, 96).value(), "simple").value();
  for (const Node& node : simple.nodes) EXPECT_NE(node.op, "Cast");
  EXPECT_EQ(DeclaredInputSize(simple).value().width, 96);
}

TEST(ModelSummary, CountsByHand) {
  OnnxBuilder n;
  const std::string x = n.ConvSilu(n.Input("images", {1, 3, -1, -1}), 3, 8, 3, 2);
  n.NameOutput(n.Conv(x, 8, 8, 5, 1, 8), "out");
  const ModelSummary summary = Summarize(n.Parse().value(), 32, 64).value();
  EXPECT_EQ(summary.parameters, (3 * 9 + 1) * 8 + (25 + 1) * 8);
  EXPECT_EQ(summary.flops, 2 * (16 * 32 * 8 * 27 + 16 * 32 * 8 * 25));
  EXPECT_THAT(FormatSummary(summary),
              testing::AllOf(HasSubstr("Conv 3x3/2"), HasSubstr("Depthwise 5x5")));
}

TEST(ModelSummary, YoloV8nHasItsKnownSize) {
  TestNetworkOptions options;
  options.base = 16;
  options.classes = 20;
  const ModelSummary summary =
      Summarize(TestNetwork(options).builder().Parse().value(), 640, 640).value();
  EXPECT_NEAR(static_cast<double>(summary.parameters), 3.01e6, 0.01 * 3.01e6);
  EXPECT_NEAR(static_cast<double>(summary.flops), 8.1e9, 0.01 * 8.1e9);
}

}  // namespace
}  // namespace msf
