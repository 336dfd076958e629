#include "training/onnx_graph.h"

#include <algorithm>
#include <cctype>

namespace msf {

namespace {

// A dimension is a number or a symbol.
void FillType(onnx::ValueInfoProto& info, const std::string& name,
              const std::vector<std::string>& shape) {
  info.set_name(name);
  auto* tensor = info.mutable_type()->mutable_tensor_type();
  tensor->set_elem_type(onnx::TensorProto::FLOAT);
  for (const std::string& size : shape) {
    auto* dimension = tensor->mutable_shape()->add_dim();
    if (std::all_of(size.begin(), size.end(),
                    [](unsigned char c) { return std::isdigit(c) != 0; })) {
      dimension->set_dim_value(std::stoll(size));
    } else {
      dimension->set_dim_param(size);
    }
  }
}

onnx::AttributeProto& AddAttribute(onnx::NodeProto& node, const std::string& name,
                                   onnx::AttributeProto::AttributeType type) {
  onnx::AttributeProto* attribute = node.add_attribute();
  attribute->set_name(name);
  attribute->set_type(type);
  return *attribute;
}

}  // namespace

onnx::NodeProto& OnnxGraph::Node(const std::string& op, const std::vector<std::string>& inputs,
                                 const std::string& output) {
  onnx::NodeProto* node = graph_.add_node();
  node->set_op_type(op);
  node->set_name(op + "_" + output);
  for (const std::string& input : inputs) node->add_input(input);
  node->add_output(output);
  return *node;
}

void OnnxGraph::Set(onnx::NodeProto& node, const std::string& name, int64_t value) {
  AddAttribute(node, name, onnx::AttributeProto::INT).set_i(value);
}

void OnnxGraph::Set(onnx::NodeProto& node, const std::string& name,
                    const std::vector<int64_t>& values) {
  onnx::AttributeProto& attribute = AddAttribute(node, name, onnx::AttributeProto::INTS);
  for (int64_t value : values) attribute.add_ints(value);
}

void OnnxGraph::Set(onnx::NodeProto& node, const std::string& name, float value) {
  AddAttribute(node, name, onnx::AttributeProto::FLOAT).set_f(value);
}

void OnnxGraph::Set(onnx::NodeProto& node, const std::string& name, const std::string& value) {
  AddAttribute(node, name, onnx::AttributeProto::STRING).set_s(value);
}

std::string OnnxGraph::Constant(const std::string& name, const torch::Tensor& value, bool half) {
  const torch::Tensor stored = value.to(half ? torch::kHalf : torch::kFloat).contiguous();
  onnx::TensorProto* tensor = graph_.add_initializer();
  tensor->set_name(half ? name + "_half" : name);
  tensor->set_data_type(half ? onnx::TensorProto::FLOAT16 : onnx::TensorProto::FLOAT);
  for (int64_t size : stored.sizes()) tensor->add_dims(size);
  tensor->set_raw_data(stored.data_ptr(), static_cast<size_t>(stored.nbytes()));
  if (half)
    Set(Node("Cast", {name + "_half"}, name), "to", static_cast<int64_t>(onnx::TensorProto::FLOAT));
  return name;
}

std::string OnnxGraph::Constant(const std::string& name, const std::vector<int64_t>& values) {
  onnx::TensorProto* tensor = graph_.add_initializer();
  tensor->set_name(name);
  tensor->set_data_type(onnx::TensorProto::INT64);
  tensor->add_dims(static_cast<int64_t>(values.size()));
  tensor->set_raw_data(values.data(), values.size() * sizeof(int64_t));
  return name;
}

std::string OnnxGraph::Reshape(const std::string& input, const std::vector<int64_t>& shape,
                               const std::string& output) {
  Node("Reshape", {input, Constant(output + "_shape", shape)}, output);
  return output;
}

std::string OnnxGraph::Slice(const std::string& input, int64_t axis, int64_t begin, int64_t end,
                             const std::string& output) {
  const std::string starts = Constant(output + "_start", std::vector<int64_t>{begin});
  const std::string ends = Constant(output + "_end", std::vector<int64_t>{end});
  Node("Slice", {input, starts, ends, Constant(output + "_axis", std::vector<int64_t>{axis})},
       output);
  return output;
}

std::string OnnxGraph::Concat(const std::vector<std::string>& inputs, int64_t axis,
                              const std::string& output) {
  Set(Node("Concat", inputs, output), "axis", axis);
  return output;
}

void OnnxGraph::Input(const std::string& name, const std::vector<std::string>& shape) {
  FillType(*graph_.add_input(), name, shape);
}

void OnnxGraph::Output(const std::string& name, const std::vector<std::string>& shape) {
  FillType(*graph_.add_output(), name, shape);
}

}  // namespace msf
