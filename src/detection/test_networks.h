// Networks of the shape of real detectors with random weights, and a plain interpreter to compare
// with.
#pragma once

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "detection/operators.h"
#include "detection/specialize.h"
#include "detection/test_onnx_builder.h"

namespace msf {

struct TestNetworkOptions {
  int64_t base = 4;  // channels of the first layer; YOLOv8n has 16
  int64_t classes = 3;
  bool msf = false;            // MSFConv blocks in the place of the stride-2 convolutions
  bool attention = false;      // the attention block of YOLO11 behind the pyramid pooling
  bool single_output = false;  // decoded boxes and scores [1, 4 + classes, anchors], else raw heads
  int64_t height = -1;         // -1: symbolic
  int64_t width = -1;
};

// Writes YOLOv8-like layers with an OnnxBuilder.
class TestNetwork {
 public:
  explicit TestNetwork(const TestNetworkOptions& options) : o_(options) {
    const int64_t b = o_.base;
    std::string x = n_.Input("images", {1, 3, o_.height, o_.width});
    x = C2f(Down(Down(x, 3, b), b, 2 * b), 2 * b, 2 * b, 1, true);
    const std::string p3 = C2f(Down(x, 2 * b, 4 * b), 4 * b, 4 * b, 2, true);
    const std::string p4 = C2f(Down(p3, 4 * b, 8 * b), 8 * b, 8 * b, 2, true);
    std::string p5 = Sppf(C2f(Down(p4, 8 * b, 16 * b), 16 * b, 16 * b, 1, true), 16 * b);
    if (o_.attention) p5 = Attention(p5, 16 * b);
    const std::string n4 = C2f(n_.Concat({n_.Upsample2(p5), p4}), 24 * b, 8 * b, 1, false);
    const std::string o3 = C2f(n_.Concat({n_.Upsample2(n4), p3}), 12 * b, 4 * b, 1, false);
    const std::string o4 = C2f(n_.Concat({Down(o3, 4 * b, 4 * b), n4}), 12 * b, 8 * b, 1, false);
    const std::string o5 = C2f(n_.Concat({Down(o4, 8 * b, 8 * b), p5}), 24 * b, 16 * b, 1, false);
    Heads({{o3, 4 * b, 8}, {o4, 8 * b, 16}, {o5, 16 * b, 32}});
  }

  OnnxBuilder& builder() { return n_; }

 private:
  struct Scale {
    std::string map;
    int64_t channels;
    int64_t stride;
  };

  std::string Down(const std::string& x, int64_t in, int64_t out) {
    return o_.msf ? Msf(x, in, out) : n_.ConvSilu(x, in, out, 3, 2);
  }

  // The MSFConv block as specified: three branches, the pooled input added where the widths agree,
  // norm, SiLU, 1x1.
  std::string Msf(const std::string& x, int64_t in, int64_t out) {
    const int64_t h = out / 2;
    const std::string y = n_.ConvSilu(x, in, h, 3, 2);
    std::vector<std::string> branches = {n_.Conv(n_.Conv(y, h, h, 3, 1, h), h, h, 1),
                                         n_.Conv(y, h, h, 3),
                                         n_.Conv(n_.Conv(y, h, h, 5, 1, h), h, h, 1)};
    if (in == h) {
      onnx::NodeProto& pool = n_.Add("AveragePool", {x});
      OnnxBuilder::Set(pool, "kernel_shape", std::vector<int64_t>{2, 2});
      OnnxBuilder::Set(pool, "strides", std::vector<int64_t>{2, 2});
      const std::string pooled = pool.output(0);
      for (std::string& branch : branches)
        branch = n_.Node("Add", {n_.BatchNorm(branch, h), pooled});
    }
    return n_.Conv(n_.Silu(n_.BatchNorm(n_.Concat(branches), 3 * h)), 3 * h, out, 1);
  }

  std::string C2f(const std::string& x, int64_t in, int64_t out, int n, bool shortcut) {
    const int64_t h = out / 2;
    auto [first, last] = n_.Halves(n_.ConvSilu(x, in, out, 1));
    std::vector<std::string> pieces = {first, last};
    for (int i = 0; i < n; ++i) {
      const std::string y = n_.ConvSilu(n_.ConvSilu(last, h, h, 3), h, h, 3);
      last = shortcut ? n_.Node("Add", {last, y}) : y;
      pieces.push_back(last);
    }
    return n_.ConvSilu(n_.Concat(pieces), (2 + n) * h, out, 1);
  }

  std::string Sppf(const std::string& x, int64_t channels) {
    std::vector<std::string> pieces = {n_.ConvSilu(x, channels, channels / 2, 1)};
    for (int i = 0; i < 3; ++i) pieces.push_back(n_.MaxPool(pieces.back(), 5));
    return n_.ConvSilu(n_.Concat(pieces), channels * 2, channels, 1);
  }

  // Self-attention with two heads and a depthwise convolution for the position, as in YOLO11.
  std::string Attention(const std::string& x, int64_t channels) {
    const int64_t h = channels / 2, heads = 2, value = h / heads, key = value / 2;
    auto [a, b] = n_.Halves(n_.ConvSilu(x, channels, channels, 1));
    const std::string shape = n_.Node("Shape", {b});
    const auto size = [&](int64_t axis) { return n_.Node("Gather", {shape, n_.Ints({axis})}); };
    const std::string qkv = n_.Conv(b, h, h + 2 * key * heads, 1);
    onnx::NodeProto& split = n_.Add("Split", {n_.Reshape(qkv, {1, heads, 2 * key + value, -1})}, 3);
    OnnxBuilder::Set(split, "axis", int64_t{2});
    OnnxBuilder::Set(split, "split", std::vector<int64_t>{key, key, value});
    const std::string q = split.output(0), k = split.output(1), v = split.output(2);
    const std::string scores =
        n_.Node("Mul", {n_.Node("MatMul", {n_.Transpose(q, {0, 1, 3, 2}), k}),
                        n_.Floats({1}, {1 / std::sqrt(static_cast<float>(key))})});
    const std::string weights = n_.Transpose(Softmax(scores), {0, 1, 3, 2});
    const std::string image = n_.Concat({n_.Ints({1}), n_.Ints({h}), size(2), size(3)}, 0);
    const std::string mixed = n_.Node("Reshape", {n_.Node("MatMul", {v, weights}), image});
    const std::string position = n_.Conv(n_.Node("Reshape", {v, image}), h, h, 3, 1, h);
    b = n_.Node("Add", {b, n_.Conv(n_.Node("Add", {mixed, position}), h, h, 1)});
    b = n_.Node("Add", {b, n_.Conv(n_.ConvSilu(b, h, 2 * h, 1), 2 * h, h, 1)});
    return n_.ConvSilu(n_.Concat({a, b}), channels, channels, 1);
  }

  std::string Softmax(const std::string& x) { return n_.Softmax(x, 3); }

  void Heads(const std::vector<Scale>& scales) {
    std::vector<std::string> flat;
    for (const Scale& s : scales) {
      const int64_t c3 = std::max<int64_t>(o_.base * 4, std::min<int64_t>(o_.classes, 100));
      const int64_t c2 = o_.base * 4;
      const std::string box =
          n_.Conv(n_.ConvSilu(n_.ConvSilu(s.map, s.channels, c2, 3), c2, c2, 3), c2, 64, 1);
      const std::string cls =
          n_.Conv(n_.ConvSilu(n_.ConvSilu(s.map, s.channels, c3, 3), c3, c3, 3), c3, o_.classes, 1);
      if (!o_.single_output) {
        n_.NameOutput(box, "box_" + std::to_string(s.stride));
        n_.NameOutput(cls, "class_" + std::to_string(s.stride));
        continue;
      }
      flat.push_back(n_.Reshape(n_.Concat({box, cls}), {1, 64 + o_.classes, -1}));
    }
    if (o_.single_output) Decode(n_.Concat(flat, 2));
  }

  // Distribution focal loss, anchors, sigmoid: what common exports append. Needs a fixed size.
  void Decode(const std::string& all) {
    onnx::NodeProto& split = n_.Add("Split", {all}, 2);
    OnnxBuilder::Set(split, "axis", int64_t{1});
    OnnxBuilder::Set(split, "split", std::vector<int64_t>{64, o_.classes});
    const std::string boxes = split.output(0), scores = split.output(1);
    std::vector<float> bins(16), x, y, strides;
    for (size_t i = 0; i < 16; ++i) bins[i] = static_cast<float>(i);
    for (const int64_t stride : {8, 16, 32}) {
      for (int64_t row = 0; row < o_.height / stride; ++row) {
        for (int64_t col = 0; col < o_.width / stride; ++col) {
          x.push_back(static_cast<float>(col) + 0.5f);
          y.push_back(static_cast<float>(row) + 0.5f);
          strides.push_back(static_cast<float>(stride));
        }
      }
    }
    const int64_t anchors = static_cast<int64_t>(x.size());
    x.insert(x.end(), y.begin(), y.end());
    const std::string bin_first =
        n_.Transpose(n_.Reshape(boxes, {1, 4, 16, anchors}), {0, 2, 1, 3});
    const std::string sides =
        n_.Reshape(n_.Node("Conv", {n_.Softmax(bin_first, 1), n_.Floats({1, 16, 1, 1}, bins)}),
                   {1, 4, anchors});
    const std::string centres = n_.Floats({1, 2, anchors}, x);
    const auto half = [&](int64_t from) {
      return n_.Node("Slice", {sides, n_.Ints({from}), n_.Ints({from + 2}), n_.Ints({1})});
    };
    const std::string low = n_.Node("Sub", {centres, half(0)}),
                      high = n_.Node("Add", {centres, half(2)});
    const std::string centre = n_.Node("Div", {n_.Node("Add", {low, high}), n_.Floats({1}, {2})});
    const std::string box = n_.Node("Mul", {n_.Concat({centre, n_.Node("Sub", {high, low})}),
                                            n_.Floats({1, 1, anchors}, strides)});
    n_.NameOutput(n_.Concat({box, n_.Node("Sigmoid", {scores})}), "output0");
  }

  TestNetworkOptions o_;
  OnnxBuilder n_{13};
};

// Runs a specialised graph node by node with the plain implementations. Values by name.
inline std::map<std::string, Tensor> Interpret(const Graph& graph, const Tensor& image) {
  std::map<ValueId, Tensor> values = {{graph.inputs[0], image}};
  std::map<std::string, Tensor> named;
  for (const Node& node : graph.nodes) {
    ComputeContext context{node, graph.opset, {}, {}};
    std::vector<ValueId> reads = node.inputs;
    if (node.epilogue.addend != kNoValue) reads.push_back(node.epilogue.addend);
    for (const ValueId id : reads) {
      context.inputs.emplace_back();
      if (id == kNoValue) continue;
      context.inputs.back() =
          InputView(graph.IsConstant(id) ? *graph.value(id).constant : values.at(id));
    }
    std::vector<Tensor> results;
    for (const ValueId id : node.outputs)
      results.push_back(Tensor::Zeros(graph.value(id).type, graph.value(id).shape));
    for (Tensor& result : results) context.outputs.emplace_back(result);
    const Status status = FindOperator(node.op)->compute(context);
    MSF_CHECK(status.ok(), status.message());
    for (size_t i = 0; i < results.size(); ++i) {
      named[graph.value(node.outputs[i]).name] = results[i];
      values[node.outputs[i]] = std::move(results[i]);
    }
  }
  return named;
}

// Smooth colours with some texture, in 0..1.
inline Tensor TestImage(int64_t height, int64_t width) {
  Tensor image = Tensor::Zeros(ElementType::kFloat, {1, 3, height, width});
  for (size_t i = 0; i < image.floats.size(); ++i) {
    const float t = static_cast<float>(i);
    image.floats[i] =
        0.5f + 0.3f * std::sin(t * 0.05f) + 0.19f * std::sin(t * 1.7f + std::floor(t / 97.0f));
    image.floats[i] = std::round(image.floats[i] * 255.0f) / 255.0f;
  }
  return image;
}

}  // namespace msf
