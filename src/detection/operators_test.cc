#include "detection/operators.h"

#include <gtest/gtest.h>

#include "detection/memory_plan.h"
#include "detection/storage.h"
#include "detection/test_networks.h"

namespace msf {
namespace {

// Runs one operator on constants.
StatusOr<std::vector<Tensor>> Apply(const Node& node, const std::vector<Tensor>& inputs,
                                    int64_t opset = 13) {
  InferContext infer{node, opset, {}};
  ComputeContext compute{node, opset, {}, {}};
  for (const Tensor& input : inputs) {
    infer.inputs.push_back({true, input.shape, input.type, &input});
    compute.inputs.emplace_back(input);
  }
  StatusOr<std::vector<ResultInfo>> results = InferShapes(infer);
  if (!results.ok()) return results.status();
  std::vector<Tensor> outputs;
  for (const ResultInfo& result : *results)
    outputs.push_back(Tensor::Zeros(result.type, result.shape));
  for (Tensor& output : outputs) compute.outputs.emplace_back(output);
  const Status status = FindOperator(node.op)->compute(compute);
  if (!status.ok()) return status;
  return outputs;
}

Node Make(const std::string& op, std::map<std::string, Attribute> attributes = {},
          size_t outputs = 1) {
  Node node;
  node.op = op;
  node.name = "n";
  node.attributes = std::move(attributes);
  node.outputs.assign(outputs, 0);
  return node;
}

Tensor Counting(const Shape& shape) {
  Tensor t = Tensor::Zeros(ElementType::kFloat, shape);
  for (size_t i = 0; i < t.floats.size(); ++i) t.floats[i] = static_cast<float>(i);
  return t;
}

using Floats = std::vector<float>;
using Numbers = std::vector<int64_t>;

TEST(Operators, BroadcastingArithmetic) {
  const auto sum =
      Apply(Make("Add"), {Counting({2, 3}), Tensor::Floats({2, 1}, {10, 20})}).value()[0];
  EXPECT_EQ(sum.floats, (Floats{10, 11, 12, 23, 24, 25}));
  EXPECT_FALSE(Apply(Make("Add"), {Counting({2, 3}), Counting({2})}).ok());
  EXPECT_EQ(Apply(Make("Div"), {Tensor::Ints({2}, {7, 1}), Tensor::Ints({1}, {0})}).value()[0].ints,
            (Numbers{0, 0}));
}

TEST(Operators, ReshapeInfersTheOpenSize) {
  EXPECT_EQ(
      Apply(Make("Reshape"), {Counting({2, 6}), Tensor::Ints({3}, {0, -1, 2})}).value()[0].shape,
      (Shape{2, 3, 2}));
  EXPECT_FALSE(Apply(Make("Reshape"), {Counting({2, 6}), Tensor::Ints({2}, {5, -1})}).ok());
  EXPECT_FALSE(Apply(Make("Reshape"), {Counting({2, 6}), Tensor::Ints({2}, {-1, -1})}).ok());
}

TEST(Operators, MovingElements) {
  EXPECT_EQ(
      Apply(Make("Transpose", {{"perm", Numbers{1, 0}}}), {Counting({2, 3})}).value()[0].floats,
      (Floats{0, 3, 1, 4, 2, 5}));
  const Node concat = Make("Concat", {{"axis", int64_t{-1}}});
  EXPECT_EQ(Apply(concat, {Counting({2, 1}), Counting({2, 2})}).value()[0].floats,
            (Floats{0, 0, 1, 1, 2, 3}));
  const auto split =
      Apply(Make("Split", {{"axis", int64_t{1}}}, 2), {Counting({2, 3}), Tensor::Ints({2}, {1, 2})})
          .value();
  EXPECT_EQ(split[0].floats, (Floats{0, 3}));
  EXPECT_EQ(split[1].floats, (Floats{1, 2, 4, 5}));
  EXPECT_FALSE(
      Apply(Make("Split", {{"axis", int64_t{1}}}, 2), {Counting({2, 3}), Tensor::Ints({2}, {1, 1})})
          .ok());
  EXPECT_EQ(Apply(Make("Expand"), {Counting({2, 1}), Tensor::Ints({2}, {1, 3})}).value()[0].floats,
            (Floats{0, 0, 0, 1, 1, 1}));
}

TEST(Operators, SlicesForwardsAndBackwards) {
  const auto slice = [](int64_t from, int64_t to, int64_t step) {
    return Apply(Make("Slice"), {Counting({6}), Tensor::Ints({1}, {from}), Tensor::Ints({1}, {to}),
                                 Tensor::Ints({1}, {0}), Tensor::Ints({1}, {step})});
  };
  EXPECT_EQ(slice(1, 5, 2).value()[0].floats, (Floats{1, 3}));
  EXPECT_EQ(slice(-2, 1000, 1).value()[0].floats, (Floats{4, 5}));
  EXPECT_EQ(slice(-1, -1000, -2).value()[0].floats, (Floats{5, 3, 1}));
  EXPECT_TRUE(slice(4, 2, 1).value()[0].floats.empty());
  EXPECT_FALSE(slice(0, 1, 0).ok());
}

TEST(Operators, ShapeArithmetic) {
  EXPECT_EQ(Apply(Make("Shape"), {Counting({2, 3, 4})}).value()[0].ints, (Numbers{2, 3, 4}));
  EXPECT_EQ(Apply(Make("Gather"), {Counting({4}), Tensor::Ints({2}, {-1, 1})}).value()[0].floats,
            (Floats{3, 1}));
  EXPECT_FALSE(Apply(Make("Gather"), {Counting({4}), Tensor::Ints({1}, {4})}).ok());
  EXPECT_EQ(
      Apply(Make("Range"), {Tensor::Ints({}, {1}), Tensor::Ints({}, {8}), Tensor::Ints({}, {3})})
          .value()[0]
          .ints,
      (Numbers{1, 4, 7}));
  EXPECT_FALSE(
      Apply(Make("Range"), {Tensor::Ints({}, {0}), Tensor::Ints({}, {1}), Tensor::Ints({}, {0})})
          .ok());
  EXPECT_FALSE(
      Apply(Make("ConstantOfShape"), {Tensor::Ints({2}, {1 << 20, 1 << 20})}).ok());  // too large
}

TEST(Operators, ConvolutionByHand) {
  // 1x1x3x3 counting image, a 3x3 kernel of ones, padding 1, stride 2.
  const Node conv = Make("Conv", {{"pads", Numbers{1, 1, 1, 1}}, {"strides", Numbers{2, 2}}});
  const auto y = Apply(conv, {Counting({1, 1, 3, 3}), Tensor::Floats({1, 1, 3, 3}, Floats(9, 1)),
                              Tensor::Floats({1}, {100})});
  EXPECT_EQ(y.value()[0].floats, (Floats{108, 112, 120, 124}));
}

TEST(Operators, PoolsKnowTheirPadding) {
  const std::map<std::string, Attribute> window{
      {"kernel_shape", Numbers{3, 3}}, {"pads", Numbers{1, 1, 1, 1}}, {"strides", Numbers{2, 2}}};
  EXPECT_EQ(Apply(Make("MaxPool", window), {Counting({1, 1, 3, 3})}).value()[0].floats,
            (Floats{4, 5, 7, 8}));
  EXPECT_EQ(Apply(Make("AveragePool", window), {Counting({1, 1, 3, 3})}).value()[0].floats,
            (Floats{2, 3, 5, 6}));
}

TEST(Operators, SoftmaxAndProducts) {
  const Tensor y = Apply(Make("Softmax", {{"axis", int64_t{0}}}),
                         {Tensor::Floats({2, 2}, {0, 1000, 0, 1000 + std::log(3.0f)})})
                       .value()[0];
  EXPECT_NEAR(y.floats[0], 0.5, 1e-6);
  EXPECT_NEAR(y.floats[3], 0.75, 1e-4);
  EXPECT_EQ(Apply(Make("MatMul"), {Counting({2, 2}), Counting({2, 2})}).value()[0].floats,
            (Floats{2, 3, 6, 11}));
  EXPECT_EQ(Apply(Make("ReduceMean", {{"axes", Numbers{1}}, {"keepdims", int64_t{0}}}),
                  {Counting({2, 3})})
                .value()[0]
                .floats,
            (Floats{1, 4}));
}

TEST(MemoryPlan, NeverOverlapsWhatLivesTogether) {
  std::mt19937 random(3);
  std::vector<BufferLife> buffers;
  size_t sum = 0;
  for (int i = 0; i < 80; ++i) {
    const int first = static_cast<int>(random() % 60);
    buffers.push_back({1 + random() % 5000, first, first + static_cast<int>(random() % 10)});
    sum += buffers.back().bytes;
  }
  const MemoryPlan plan = PlanMemory(buffers);
  for (size_t i = 0; i < buffers.size(); ++i) {
    EXPECT_EQ(plan.offsets[i] % 64, 0u);
    EXPECT_LE(plan.offsets[i] + buffers[i].bytes, plan.total_bytes);
    for (size_t j = 0; j < i; ++j) {
      if (buffers[i].first > buffers[j].last || buffers[j].first > buffers[i].last) continue;
      EXPECT_TRUE(plan.offsets[i] + buffers[i].bytes <= plan.offsets[j] ||
                  plan.offsets[j] + buffers[j].bytes <= plan.offsets[i]);
    }
  }
  EXPECT_LT(plan.total_bytes, sum / 2);
}

TEST(Storage, ConvertsFormatsAndOrders) {
  const Shape shape{1, 3, 2, 5};
  const Tensor x = Counting(shape);
  const Storage plain{}, last{NumberFormat::kFloat32, true}, half{NumberFormat::kBfloat16, true};
  const Storage bytes{NumberFormat::kUint8, true, 0.25f, 7};
  Floats a(30), back(30);
  std::vector<uint16_t> b(30);
  std::vector<uint8_t> c(30);
  Convert(shape, x.floats.data(), plain, a.data(), last);
  EXPECT_EQ(a[1], 10);  // second channel of the first pixel
  Convert(shape, a.data(), last, b.data(), half);
  Convert(shape, b.data(), half, back.data(), plain);
  EXPECT_EQ(back, x.floats);  // small integers are exact in bfloat16
  Convert(shape, x.floats.data(), plain, c.data(), bytes);
  EXPECT_EQ(c[2], 20 * 4 + 7);
  Convert(shape, c.data(), bytes, back.data(), plain);
  EXPECT_EQ(back, x.floats);
  const Floats extreme{-100, 1e9f};
  Convert({2}, extreme.data(), plain, c.data(), {NumberFormat::kUint8, false, 0.25f, 7});
  EXPECT_EQ(c[0], 0);
  EXPECT_EQ(c[1], 255);
}

}  // namespace
}  // namespace msf
