// Builds small ONNX files in memory for tests.
#pragma once

#include <random>
#include <string>
#include <vector>

#include "detection/onnx_reader.h"
#include "detection/onnx_tensor.h"

namespace msf {

class OnnxBuilder {
 public:
  explicit OnnxBuilder(int64_t opset = 12, unsigned seed = 1) : random_(seed) {
    model_.set_ir_version(7);
    model_.add_opset_import()->set_version(opset);
  }

  // An input or output with sizes; -1 is symbolic.
  std::string Input(const std::string& name, const std::vector<int64_t>& dims) {
    Describe(*graph().add_input(), name, dims);
    return name;
  }
  void Output(const std::string& name, const std::vector<int64_t>& dims = {}) {
    Describe(*graph().add_output(), name, dims);
  }

  std::string Floats(const std::vector<int64_t>& shape, const std::vector<float>& values) {
    onnx::TensorProto& tensor = Initializer(shape, onnx::TensorProto::FLOAT);
    tensor.set_raw_data(values.data(), values.size() * sizeof(float));
    return tensor.name();
  }
  std::string Ints(const std::vector<int64_t>& values) {
    onnx::TensorProto& tensor =
        Initializer({static_cast<int64_t>(values.size())}, onnx::TensorProto::INT64);
    for (const int64_t value : values) tensor.add_int64_data(value);
    return tensor.name();
  }
  // Normally distributed numbers.
  std::string Random(const std::vector<int64_t>& shape, float sigma, float mean = 0) {
    std::normal_distribution<float> normal(mean, sigma);
    std::vector<float> values(static_cast<size_t>(NumElements(shape)));
    for (float& value : values) value = normal(random_);
    return Floats(shape, values);
  }

  // Adds a node with `outputs` results; attributes are set on the returned reference.
  onnx::NodeProto& Add(const std::string& op, const std::vector<std::string>& inputs,
                       int outputs = 1) {
    onnx::NodeProto& node = *graph().add_node();
    node.set_op_type(op);
    node.set_name(op + "_" + std::to_string(graph().node_size()));
    for (const std::string& input : inputs) node.add_input(input);
    for (int i = 0; i < outputs; ++i) node.add_output("t" + std::to_string(++names_));
    return node;
  }
  std::string Node(const std::string& op, const std::vector<std::string>& inputs) {
    return Add(op, inputs).output(0);
  }
  static void Set(onnx::NodeProto& node, const std::string& key, int64_t value) {
    onnx::AttributeProto& a = *node.add_attribute();
    a.set_name(key);
    a.set_type(onnx::AttributeProto::INT);
    a.set_i(value);
  }
  static void Set(onnx::NodeProto& node, const std::string& key,
                  const std::vector<int64_t>& values) {
    onnx::AttributeProto& a = *node.add_attribute();
    a.set_name(key);
    a.set_type(onnx::AttributeProto::INTS);
    for (const int64_t value : values) a.add_ints(value);
  }
  static void Set(onnx::NodeProto& node, const std::string& key, const std::string& value) {
    onnx::AttributeProto& a = *node.add_attribute();
    a.set_name(key);
    a.set_type(onnx::AttributeProto::STRING);
    a.set_s(value);
  }

  // A convolution with random weights that keeps the size of numbers; "same" padding.
  std::string Conv(const std::string& x, int64_t in, int64_t out, int64_t kernel,
                   int64_t stride = 1, int64_t group = 1) {
    const int64_t channels = in / group, fan_in = channels * kernel * kernel;
    const std::string weights =
        Random({out, channels, kernel, kernel}, 1.6f / std::sqrt(static_cast<float>(fan_in)));
    onnx::NodeProto& node = Add("Conv", {x, weights, Random({out}, 0.3f)});
    Set(node, "strides", std::vector<int64_t>{stride, stride});
    Set(node, "pads", std::vector<int64_t>(4, kernel / 2));
    Set(node, "kernel_shape", std::vector<int64_t>{kernel, kernel});
    Set(node, "group", group);
    return node.output(0);
  }
  std::string Silu(const std::string& x) { return Node("Mul", {x, Node("Sigmoid", {x})}); }
  std::string ConvSilu(const std::string& x, int64_t in, int64_t out, int64_t kernel,
                       int64_t stride = 1) {
    return Silu(Conv(x, in, out, kernel, stride));
  }
  std::string BatchNorm(const std::string& x, int64_t channels) {
    return Node("BatchNormalization", {x, Random({channels}, 0.2f, 1), Random({channels}, 0.2f),
                                       Random({channels}, 0.2f), Random({channels}, 0.05f, 1)});
  }
  std::string Concat(const std::vector<std::string>& pieces, int64_t axis = 1) {
    onnx::NodeProto& node = Add("Concat", pieces);
    Set(node, "axis", axis);
    return node.output(0);
  }
  std::string MaxPool(const std::string& x, int64_t kernel) {
    onnx::NodeProto& node = Add("MaxPool", {x});
    Set(node, "kernel_shape", std::vector<int64_t>{kernel, kernel});
    Set(node, "pads", std::vector<int64_t>(4, kernel / 2));
    Set(node, "strides", std::vector<int64_t>{1, 1});
    return node.output(0);
  }
  std::string Upsample2(const std::string& x) {
    onnx::NodeProto& node = Add("Resize", {x, "", Floats({4}, {1, 1, 2, 2})});
    Set(node, "mode", "nearest");
    Set(node, "coordinate_transformation_mode", "asymmetric");
    Set(node, "nearest_mode", "floor");
    return node.output(0);
  }
  // Two halves along the channels.
  std::pair<std::string, std::string> Halves(const std::string& x) {
    onnx::NodeProto& node = Add("Split", {x}, 2);
    Set(node, "axis", int64_t{1});
    return {node.output(0), node.output(1)};
  }
  std::string Reshape(const std::string& x, const std::vector<int64_t>& shape) {
    return Node("Reshape", {x, Ints(shape)});
  }
  std::string Transpose(const std::string& x, const std::vector<int64_t>& order) {
    onnx::NodeProto& node = Add("Transpose", {x});
    Set(node, "perm", order);
    return node.output(0);
  }
  std::string Softmax(const std::string& x, int64_t axis) {
    onnx::NodeProto& node = Add("Softmax", {x});
    Set(node, "axis", axis);
    return node.output(0);
  }
  // Gives a value the name under which the network hands it out.
  void NameOutput(const std::string& value, const std::string& name) {
    for (onnx::NodeProto& node : *graph().mutable_node()) {
      for (std::string& output : *node.mutable_output()) {
        if (output == value) output = name;
      }
      for (std::string& input : *node.mutable_input()) {
        if (input == value) input = name;
      }
    }
    Output(name);
  }

  void Metadata(const std::string& key, const std::string& value) {
    auto& entry = *model_.add_metadata_props();
    entry.set_key(key);
    entry.set_value(value);
  }

  onnx::GraphProto& graph() { return *model_.mutable_graph(); }
  std::string Bytes() const { return model_.SerializeAsString(); }
  StatusOr<Graph> Parse() const { return ParseOnnx(Bytes(), "test.onnx"); }

 private:
  static void Describe(onnx::ValueInfoProto& info, const std::string& name,
                       const std::vector<int64_t>& dims) {
    info.set_name(name);
    auto& type = *info.mutable_type()->mutable_tensor_type();
    type.set_elem_type(onnx::TensorProto::FLOAT);
    for (const int64_t dim : dims) {
      auto& d = *type.mutable_shape()->add_dim();
      if (dim >= 0) {
        d.set_dim_value(dim);
      } else {
        d.set_dim_param("d" + std::to_string(type.shape().dim_size()));
      }
    }
  }
  onnx::TensorProto& Initializer(const std::vector<int64_t>& shape, int type) {
    onnx::TensorProto& tensor = *graph().add_initializer();
    tensor.set_name("w" + std::to_string(++names_));
    tensor.set_data_type(type);
    for (const int64_t size : shape) tensor.add_dims(size);
    return tensor;
  }

  onnx::ModelProto model_;
  std::mt19937 random_;
  int names_ = 0;
};

}  // namespace msf
