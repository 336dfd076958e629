#include "detection/compiled_network.h"

#include <gtest/gtest.h>

#include "detection/dnnl_steps.h"
#include "detection/fusion.h"
#include "detection/test_networks.h"

namespace msf {
namespace {

// A result in the order of the model file.
std::vector<float> Dense(const NetworkOutput& output) {
  std::vector<float> values(static_cast<size_t>(NumElements(output.shape)));
  Convert(output.shape, output.data, {NumberFormat::kFloat32, output.channels_last}, values.data(),
          {});
  return values;
}

// Largest difference over the largest magnitude.
float RelativeError(const std::vector<float>& a, const std::vector<float>& b) {
  float difference = 0, magnitude = 0;
  EXPECT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) {
    difference = std::max(difference, std::abs(a[i] - b[i]));
    magnitude = std::max(magnitude, std::abs(b[i]));
  }
  EXPECT_GT(magnitude, 0);
  return difference / magnitude;
}

std::unique_ptr<CompiledNetwork> Compile(const Graph& graph, const CompileOptions& options) {
  auto network = CompiledNetwork::Compile(graph, options);
  EXPECT_TRUE(network.ok()) << network.message();
  return network.ok() ? *std::move(network) : nullptr;
}

// Largest relative error over all outputs against the interpreter on the unfused graph.
float ErrorAgainstInterpreter(const Graph& graph, CompileOptions options) {
  const Tensor image = TestImage(options.height, options.width);
  StatusOr<Graph> fixed = Specialize(graph, options.height, options.width);
  EXPECT_TRUE(fixed.ok()) << fixed.message();
  const auto expected = Interpret(*fixed, image);
  options.float_input = true;
  const auto network = Compile(graph, options);
  if (!network) return 1;
  std::copy(image.floats.begin(), image.floats.end(), network->float_input());
  const Status status = network->Run();
  EXPECT_TRUE(status.ok()) << status.message();
  float worst = 0;
  for (const NetworkOutput& output : network->outputs()) {
    worst = std::max(worst, RelativeError(Dense(output), expected.at(output.name).floats));
  }
  return worst;
}

Graph Parse(const TestNetworkOptions& options) {
  TestNetwork network(options);
  StatusOr<Graph> graph = network.builder().Parse();
  EXPECT_TRUE(graph.ok()) << graph.message();
  return *graph;
}

TEST(CompiledNetwork, AgreesWithThePlainImplementationInFloat) {
  EXPECT_LT(ErrorAgainstInterpreter(Parse({}), {64, 96}), 1e-5f);
}

TEST(CompiledNetwork, AgreesForMsfConv) {
  TestNetworkOptions options;
  options.msf = true;
  EXPECT_LT(ErrorAgainstInterpreter(Parse(options), {96, 64}), 1e-5f);
}

TEST(CompiledNetwork, MergedBranchesComputeTheSame) {
  TestNetworkOptions options;
  options.msf = true;
  CompileOptions merged{96, 64};
  merged.merging = CompileOptions::Merging::kAlways;
  EXPECT_LT(ErrorAgainstInterpreter(Parse(options), merged), 1e-5f);
  const auto with = Compile(Parse(options), merged);
  merged.merging = CompileOptions::Merging::kNever;
  const auto without = Compile(Parse(options), merged);
  EXPECT_EQ(without->num_convolutions() - with->num_convolutions(), 7 * 4);
}

TEST(CompiledNetwork, AgreesForAttentionAndTheDecodedForm) {
  TestNetworkOptions options;
  options.attention = true;
  options.single_output = true;
  options.height = 64;
  options.width = 64;
  EXPECT_LT(ErrorAgainstInterpreter(Parse(options), {64, 64}), 1e-5f);
}

TEST(CompiledNetwork, AgreesLooselyInBfloat16) {
  if (!HasFastBfloat16()) GTEST_SKIP() << "this processor has no bfloat16";
  TestNetworkOptions options;
  options.msf = true;
  const float error =
      ErrorAgainstInterpreter(Parse(options), {64, 96, NetworkPrecision::kBfloat16});
  EXPECT_LT(error, 0.05f);
  EXPECT_GT(error, 1e-6f);  // otherwise it did not run in bfloat16
}

// The graph with ranges from its own values on the test image.
Graph Calibrated(Graph graph, CompileOptions options) {
  const Tensor image = TestImage(options.height, options.width);
  options.precision = NetworkPrecision::kFloat32;
  options.keep_values = true;
  options.float_input = true;
  const auto network = Compile(graph, options);
  std::copy(image.floats.begin(), image.floats.end(), network->float_input());
  EXPECT_TRUE(network->Run().ok());
  ActivationRanges ranges;
  for (const NetworkOutput& value : network->inner_values()) {
    const std::span<const float> numbers = value.numbers();
    ranges[value.name] = {*std::min_element(numbers.begin(), numbers.end()),
                          *std::max_element(numbers.begin(), numbers.end()),
                          {}};
  }
  graph.metadata[kActivationRangesKey] = FormatActivationRanges(ranges);
  return graph;
}

// A network around one feature: 3x3 convolution with SiLU, `middle`, 3x3 convolution with SiLU,
// head.
Graph AroundMiddle(const std::function<std::string(OnnxBuilder&, const std::string&)>& middle) {
  OnnxBuilder n(12);
  const std::string x = n.ConvSilu(n.Input("images", {1, 3, -1, -1}), 3, 16, 3, 2);
  const std::string y = n.ConvSilu(middle(n, n.ConvSilu(x, 16, 16, 3)), 16, 32, 3);
  n.NameOutput(n.Conv(y, 32, 8, 1), "out");
  StatusOr<Graph> graph = n.Parse();
  EXPECT_TRUE(graph.ok()) << graph.message();
  return *graph;
}

void ExpectInt8Agrees(const Graph& graph, int int8_convolutions) {
  const CompileOptions options{64, 96, NetworkPrecision::kInt8};
  const Graph calibrated = Calibrated(graph, options);
  EXPECT_LT(ErrorAgainstInterpreter(calibrated, options), 0.06f);
  EXPECT_EQ(Compile(calibrated, options)->num_int8_convolutions(), int8_convolutions);
}

TEST(CompiledNetworkInt8, PlainConvolutions) {
  ExpectInt8Agrees(AroundMiddle([](OnnxBuilder&, const std::string& x) { return x; }), 3);
}

TEST(CompiledNetworkInt8, CountsTheMultiplyAdds) {
  CompileOptions options{64, 96, NetworkPrecision::kInt8};
  const Graph graph = AroundMiddle([](OnnxBuilder&, const std::string& x) { return x; });
  // Per pixel 3*16*9, 16*16*9 and 16*32*9 in 8 bits, 32*8 in the head.
  EXPECT_NEAR(Compile(Calibrated(graph, options), options)->int8_share(), 7344 / 7600.0, 1e-9);
  options.precision = NetworkPrecision::kFloat32;
  EXPECT_EQ(Compile(graph, options)->int8_share(), 0);
}

TEST(CompiledNetworkInt8, OneByOneConvolution) {
  ExpectInt8Agrees(
      AroundMiddle([](OnnxBuilder& n, const std::string& x) { return n.ConvSilu(x, 16, 16, 1); }),
      4);
}

TEST(CompiledNetworkInt8, ShortcutBehindTheActivation) {
  ExpectInt8Agrees(AroundMiddle([](OnnxBuilder& n, const std::string& x) {
                     return n.Node("Add", {x, n.ConvSilu(x, 16, 16, 3)});
                   }),
                   4);
}

TEST(CompiledNetworkInt8, AdditionBeforeTheActivation) {
  ExpectInt8Agrees(AroundMiddle([](OnnxBuilder& n, const std::string& x) {
                     return n.Silu(n.BatchNorm(n.Node("Add", {n.Conv(x, 16, 16, 3), x}), 16));
                   }),
                   4);
}

TEST(CompiledNetworkInt8, PoolsUpsamplingAndConcatenation) {
  ExpectInt8Agrees(
      AroundMiddle([](OnnxBuilder& n, const std::string& x) {
        const auto [a, b] = n.Halves(x);
        return n.ConvSilu(n.Concat({n.Upsample2(n.MaxPool(b, 5)), n.Upsample2(a)}), 16, 16, 1);
      }),
      4);
}

TEST(CompiledNetworkInt8, DepthwiseConvolution) {
  ExpectInt8Agrees(AroundMiddle([](OnnxBuilder& n, const std::string& x) {
                     return n.Silu(n.Conv(n.Silu(n.Conv(x, 16, 16, 5, 1, 16)), 16, 16, 1));
                   }),
                   5);
}

TEST(CompiledNetworkInt8, WholeDetector) {
  TestNetworkOptions options;
  options.msf = true;
  const CompileOptions compile{64, 96, NetworkPrecision::kInt8};
  EXPECT_LT(ErrorAgainstInterpreter(Calibrated(Parse(options), compile), compile),
            0.3f);  // random weights forgive nothing
}

TEST(CompiledNetworkInt8, NeedsCalibration) {
  const auto network = CompiledNetwork::Compile(Parse({}), {64, 96, NetworkPrecision::kInt8});
  ASSERT_FALSE(network.ok());
  EXPECT_NE(network.message().find("detector quantize"), std::string::npos);
}

}  // namespace
}  // namespace msf
