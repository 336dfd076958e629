// Puts nodes and constants into an ONNX graph.
#pragma once

#include <onnx/onnx_pb.h>
#include <torch/types.h>

#include <string>
#include <vector>

namespace msf {

class OnnxGraph {
 public:
  explicit OnnxGraph(onnx::GraphProto& graph) : graph_(graph) {}

  // Appends a node with one output and returns it for attributes.
  onnx::NodeProto& Node(const std::string& op, const std::vector<std::string>& inputs,
                        const std::string& output);
  static void Set(onnx::NodeProto& node, const std::string& name, int64_t value);
  static void Set(onnx::NodeProto& node, const std::string& name,
                  const std::vector<int64_t>& values);
  static void Set(onnx::NodeProto& node, const std::string& name, float value);
  static void Set(onnx::NodeProto& node, const std::string& name, const std::string& value);

  // Constants; each returns its name. `half`: stored as float16 and followed by a Cast to float.
  std::string Constant(const std::string& name, const torch::Tensor& value, bool half = false);
  std::string Constant(const std::string& name, const std::vector<int64_t>& values);

  // Reshape to a constant shape.
  std::string Reshape(const std::string& input, const std::vector<int64_t>& shape,
                      const std::string& output);
  // Elements [begin, end) along an axis.
  std::string Slice(const std::string& input, int64_t axis, int64_t begin, int64_t end,
                    const std::string& output);
  std::string Concat(const std::vector<std::string>& inputs, int64_t axis,
                     const std::string& output);

  void Input(const std::string& name, const std::vector<std::string>& shape);
  void Output(const std::string& name, const std::vector<std::string>& shape);

 private:
  onnx::GraphProto& graph_;
};

}  // namespace msf
