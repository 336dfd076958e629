#include "detection/onnx_reader.h"

#include <fmt/format.h>

#include <fstream>
#include <unordered_map>

#include "detection/onnx_tensor.h"
#include "detection/operators.h"

namespace msf {
namespace {

constexpr int kMaxNodes = 100000;

// Turns one onnx::GraphProto into a Graph.
class Reader {
 public:
  explicit Reader(const std::string& source) { graph_.source = source; }

  StatusOr<Graph> Read(const onnx::ModelProto& model) {
    const onnx::GraphProto& proto = model.graph();
    if (proto.node_size() == 0) return Error("holds no network");
    if (proto.node_size() > kMaxNodes) return Error("holds too many nodes");
    for (const auto& import : model.opset_import()) {
      if (import.domain().empty() || import.domain() == "ai.onnx") graph_.opset = import.version();
    }
    for (const auto& entry : model.metadata_props()) graph_.metadata[entry.key()] = entry.value();
    MSF_RETURN_IF_ERROR(ReadInitializers(proto));
    MSF_RETURN_IF_ERROR(ReadInputs(proto));
    for (const auto& node : proto.node()) MSF_RETURN_IF_ERROR(ReadNode(node));
    MSF_RETURN_IF_ERROR(ReadOutputs(proto));
    return std::move(graph_);
  }

 private:
  Status Error(const std::string& what) const { return Status::Error(graph_.source + ": " + what); }

  Status ReadInitializers(const onnx::GraphProto& proto) {
    for (const auto& initializer : proto.initializer()) {
      StatusOr<Tensor> tensor = DecodeTensor(initializer);
      const std::string& name = initializer.name();
      if (!tensor.ok()) return Error(fmt::format("tensor '{}' {}", name, tensor.message()));
      const ValueId id = graph_.AddConstant(name, *std::move(tensor));
      if (!ids_.emplace(name, id).second)
        return Error(fmt::format("tensor '{}' appears twice", name));
    }
    if (proto.sparse_initializer_size() > 0) return Error("has sparse weights, not supported");
    return Status::Ok();
  }

  Status ReadInputs(const onnx::GraphProto& proto) {
    for (const auto& input : proto.input()) {
      if (ids_.count(input.name())) continue;  // a weight that is also listed as an input
      const ValueId id = graph_.AddValue(input.name());
      ids_.emplace(input.name(), id);
      graph_.inputs.push_back(id);
      for (const auto& dim : input.type().tensor_type().shape().dim()) {
        graph_.value(id).shape.push_back(
            dim.has_dim_value() && dim.dim_value() > 0 ? dim.dim_value() : -1);
      }
    }
    if (graph_.inputs.size() != 1) {
      return Error(fmt::format("has {} inputs, a detector has one image", graph_.inputs.size()));
    }
    return Status::Ok();
  }

  Status ReadOutputs(const onnx::GraphProto& proto) {
    for (const auto& output : proto.output()) {
      const auto found = ids_.find(output.name());
      if (found == ids_.end())
        return Error(fmt::format("no node makes the output '{}'", output.name()));
      graph_.outputs.push_back(found->second);
    }
    return graph_.outputs.empty() ? Error("has no output") : Status::Ok();
  }

  Status ReadNode(const onnx::NodeProto& proto) {
    Node node;
    node.op = proto.op_type();
    node.name = proto.name().empty() && proto.output_size() > 0 ? proto.output(0) : proto.name();
    const auto error = [&](const std::string& what) { return Error(Describe(node) + " " + what); };
    if (!proto.domain().empty() && proto.domain() != "ai.onnx") {
      return error(
          fmt::format("comes from the operator set '{}', which is not supported", proto.domain()));
    }
    if (node.op != "Constant" && !FindOperator(node.op)) {
      return error(
          "is an operator that is not supported; export without post-processing, or use backend: "
          "opencv");
    }
    for (const auto& attribute : proto.attribute()) {
      if (Status status = ReadAttribute(attribute, node); !status.ok()) {
        return error(fmt::format("has attribute '{}' that {}", attribute.name(), status.message()));
      }
    }
    if (node.op == "Constant") return ReadConstant(proto, node);
    for (const std::string& name : proto.input()) {
      const auto found = ids_.find(name);
      if (!name.empty() && found == ids_.end())
        return error(fmt::format("reads '{}', which nothing before it makes", name));
      node.inputs.push_back(name.empty() ? kNoValue : found->second);
    }
    while (!node.inputs.empty() && node.inputs.back() == kNoValue) node.inputs.pop_back();
    for (const std::string& name : proto.output()) {
      node.outputs.push_back(graph_.AddValue(name));
      if (!name.empty() && !ids_.emplace(name, node.outputs.back()).second) {
        return error(fmt::format("makes '{}' a second time", name));
      }
    }
    if (node.outputs.empty()) return error("has no output");
    graph_.nodes.push_back(std::move(node));
    return Status::Ok();
  }

  static Status ReadAttribute(const onnx::AttributeProto& proto, Node& node) {
    using A = onnx::AttributeProto;
    Attribute& target = node.attributes[proto.name()];
    switch (proto.type()) {
      case A::INT:
        target = static_cast<int64_t>(proto.i());
        break;
      case A::FLOAT:
        target = proto.f();
        break;
      case A::STRING:
        target = proto.s();
        break;
      case A::INTS:
        target = std::vector<int64_t>(proto.ints().begin(), proto.ints().end());
        break;
      case A::FLOATS:
        target = std::vector<float>(proto.floats().begin(), proto.floats().end());
        break;
      case A::TENSOR: {
        StatusOr<Tensor> tensor = DecodeTensor(proto.t());
        if (!tensor.ok()) return tensor.status();
        target = *std::move(tensor);
        break;
      }
      default:
        return Status::Error("is of a kind that is not supported");
    }
    return Status::Ok();
  }

  Status ReadConstant(const onnx::NodeProto& proto, const Node& node) {
    const auto& attributes = node.attributes;
    Tensor tensor;
    if (attributes.size() == 1) {
      const Attribute& value = attributes.begin()->second;
      if (const auto* t = std::get_if<Tensor>(&value)) tensor = *t;
      if (const auto* i = std::get_if<int64_t>(&value)) tensor = Tensor::Ints({}, {*i});
      if (const auto* f = std::get_if<float>(&value)) tensor = Tensor::Floats({}, {*f});
      if (const auto* v = std::get_if<std::vector<int64_t>>(&value)) {
        tensor = Tensor::Ints({static_cast<int64_t>(v->size())}, *v);
      }
      if (const auto* v = std::get_if<std::vector<float>>(&value)) {
        tensor = Tensor::Floats({static_cast<int64_t>(v->size())}, *v);
      }
    }
    const bool filled = !tensor.floats.empty() || !tensor.ints.empty() || !tensor.shape.empty();
    if (proto.output_size() != 1 || !filled) return Error(Describe(node) + " holds no numbers");
    const ValueId id = graph_.AddConstant(proto.output(0), std::move(tensor));
    if (!ids_.emplace(proto.output(0), id).second) {
      return Error(fmt::format("'{}' is made twice", proto.output(0)));
    }
    return Status::Ok();
  }

  Graph graph_;
  std::unordered_map<std::string, ValueId> ids_;
};

}  // namespace

StatusOr<std::string> ReadModelBytes(const std::filesystem::path& file) {
  std::error_code failure;
  const auto size = std::filesystem::file_size(file, failure);
  if (failure) return Status::Error(file.string() + ": the model cannot be read; check the path");
  if (size == 0) return Status::Error(file.string() + ": the model file is empty");
  if (size > kMaxModelBytes) return Status::Error(file.string() + ": too large for a model file");
  std::string bytes(size, '\0');
  std::ifstream stream(file, std::ios::binary);
  if (!stream.read(bytes.data(), static_cast<std::streamsize>(size))) {
    return Status::Error(file.string() + ": the model cannot be read; check its permissions");
  }
  return bytes;
}

StatusOr<Graph> ParseOnnx(std::string_view bytes, const std::string& source) {
  onnx::ModelProto model;
  if (bytes.size() > kMaxModelBytes ||
      !model.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) {
    return Status::Error(
        source + ": not a complete ONNX model; the file is damaged, truncated or of another kind");
  }
  return Reader(source).Read(model);
}

StatusOr<Graph> ReadOnnx(const std::filesystem::path& file) {
  StatusOr<std::string> bytes = ReadModelBytes(file);
  if (!bytes.ok()) return bytes.status();
  return ParseOnnx(*bytes, file.string());
}

}  // namespace msf
