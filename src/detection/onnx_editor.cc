#include "detection/onnx_editor.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "detection/onnx_tensor.h"

namespace msf {
namespace {

StatusOr<onnx::ModelProto> Parse(const std::string& bytes) {
  onnx::ModelProto model;
  if (!model.ParseFromString(bytes)) return Status::Error("not a complete ONNX model");
  return model;
}

// Writes the numbers of a half-precision tensor as float32.
Status WidenTensor(onnx::TensorProto& proto) {
  StatusOr<Tensor> tensor = DecodeTensor(proto);
  if (!tensor.ok()) return Status::Error("tensor '" + proto.name() + "' " + tensor.message());
  proto.set_data_type(onnx::TensorProto::FLOAT);
  proto.clear_int32_data();
  proto.set_raw_data(tensor->floats.data(), tensor->floats.size() * sizeof(float));
  return Status::Ok();
}

// Casts to float of what is float already hand their input on.
void RemoveCasts(onnx::GraphProto& graph, const std::set<std::string>& floats) {
  std::map<std::string, std::string> renamed;
  google::protobuf::RepeatedPtrField<onnx::NodeProto> kept;
  for (onnx::NodeProto& node : *graph.mutable_node()) {
    for (std::string& input : *node.mutable_input()) {
      if (const auto found = renamed.find(input); found != renamed.end()) input = found->second;
    }
    if (node.op_type() == "Cast" && node.input_size() == 1 && node.output_size() == 1 &&
        floats.count(node.input(0))) {
      renamed[node.output(0)] = node.input(0);
    } else {
      *kept.Add() = std::move(node);
    }
  }
  *graph.mutable_node() = std::move(kept);
}

// Smaller tensors (biases, anchors) stay exact: they hardly add to the file.
constexpr int64_t kLeastHalvedElements = 256;

bool FitsHalf(const Tensor& tensor) {
  return tensor.type == ElementType::kFloat && tensor.size() >= kLeastHalvedElements &&
         std::all_of(tensor.floats.begin(), tensor.floats.end(),
                     [](float x) { return std::abs(x) < 65504.0f; });
}

// Turns an initializer into half precision under another name, and returns the node that casts it
// back.
onnx::NodeProto HalveTensor(onnx::TensorProto& proto, const Tensor& tensor) {
  onnx::NodeProto cast;
  cast.set_op_type("Cast");
  cast.set_name(proto.name() + "_cast");
  cast.add_input(proto.name() + "_half");
  cast.add_output(proto.name());
  onnx::AttributeProto& to = *cast.add_attribute();
  to.set_name("to");
  to.set_type(onnx::AttributeProto::INT);
  to.set_i(onnx::TensorProto::FLOAT);
  std::vector<uint16_t> halves;
  for (const float x : tensor.floats) halves.push_back(FloatToHalf(x));
  proto.set_name(proto.name() + "_half");
  proto.set_data_type(onnx::TensorProto::FLOAT16);
  proto.clear_float_data();
  proto.set_raw_data(halves.data(), halves.size() * sizeof(uint16_t));
  return cast;
}

}  // namespace

StatusOr<std::string> HalveOnnxWeights(const std::string& bytes) {
  StatusOr<onnx::ModelProto> model = Parse(bytes);
  if (!model.ok()) return model.status();
  onnx::GraphProto& graph = *model->mutable_graph();
  google::protobuf::RepeatedPtrField<onnx::NodeProto> nodes;
  for (auto& proto : *graph.mutable_initializer()) {
    if (proto.data_type() != onnx::TensorProto::FLOAT) continue;
    StatusOr<Tensor> tensor = DecodeTensor(proto);
    if (!tensor.ok()) return Status::Error("tensor '" + proto.name() + "' " + tensor.message());
    if (FitsHalf(*tensor)) *nodes.Add() = HalveTensor(proto, *tensor);
  }
  for (auto& node : *graph.mutable_node()) *nodes.Add() = std::move(node);
  *graph.mutable_node() = std::move(nodes);
  return model->SerializeAsString();
}

StatusOr<std::string> SetOnnxMetadata(const std::string& bytes,
                                      const std::map<std::string, std::string>& entries) {
  StatusOr<onnx::ModelProto> model = Parse(bytes);
  if (!model.ok()) return model.status();
  for (const auto& [key, value] : entries) {
    onnx::StringStringEntryProto* target = nullptr;
    for (auto& entry : *model->mutable_metadata_props()) {
      if (entry.key() == key) target = &entry;
    }
    if (!target) target = model->add_metadata_props();
    target->set_key(key);
    target->set_value(value);
  }
  return model->SerializeAsString();
}

StatusOr<std::string> SimplifyOnnx(const std::string& bytes, int height, int width) {
  StatusOr<onnx::ModelProto> model = Parse(bytes);
  if (!model.ok()) return model.status();
  onnx::GraphProto& graph = *model->mutable_graph();
  std::set<std::string> floats;
  for (auto& tensor : *graph.mutable_initializer()) {
    if (tensor.data_type() != onnx::TensorProto::FLOAT16) continue;
    MSF_RETURN_IF_ERROR(WidenTensor(tensor));
    floats.insert(tensor.name());
  }
  RemoveCasts(graph, floats);
  for (auto& input : *graph.mutable_input()) {
    auto& shape = *input.mutable_type()->mutable_tensor_type()->mutable_shape();
    if (shape.dim_size() != 4) continue;
    const int sizes[] = {1, 3, height, width};
    for (int i = 0; i < 4; ++i) shape.mutable_dim(i)->set_dim_value(sizes[i]);
  }
  // OpenCV insists on a shape of the outputs, though not on its sizes.
  for (auto& output : *graph.mutable_output())
    output.mutable_type()->mutable_tensor_type()->mutable_shape();
  return model->SerializeAsString();
}

}  // namespace msf
