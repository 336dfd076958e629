#include "training/onnx_import.h"

#include <torch/types.h>
#include <torch/utils.h>

#include "detection/onnx_reader.h"

namespace msf {

namespace {

torch::Tensor ToTorch(const Tensor& tensor) {
  return torch::tensor(tensor.floats).reshape(tensor.shape);
}

// The convolution and the norm that the file's convolution stands for.
void AddUnfolded(const std::string& prefix, const torch::Tensor& weight, const torch::Tensor& bias,
                 NamedTensors& tensors) {
  tensors[prefix + ".conv.weight"] = weight;
  tensors[prefix + ".bn.weight"] = torch::ones_like(bias);
  tensors[prefix + ".bn.bias"] = bias;
  tensors[prefix + ".bn.running_mean"] = torch::zeros_like(bias);
  tensors[prefix + ".bn.running_var"] = torch::full_like(bias, 1.0 - kNormEpsilon);
}

}  // namespace

StatusOr<NamedTensors> ReadOnnxWeights(const std::filesystem::path& file) {
  const StatusOr<Graph> graph = ReadOnnx(file);
  if (!graph.ok()) return graph.status();
  constexpr std::string_view kHalf = "_half", kWeight = ".weight";
  NamedTensors tensors;
  for (const Value& value : graph->values) {
    if (!value.constant || value.constant->type != ElementType::kFloat ||
        !value.name.starts_with("model."))
      continue;
    std::string name = value.name;
    if (name.ends_with(kHalf)) name.resize(name.size() - kHalf.size());
    tensors[name] = ToTorch(*value.constant);
  }
  if (tensors.empty()) {
    return Status::Error(file.string() +
                         ": has no weights named as in a training here (model.0.conv.weight, ...)");
  }
  // The file does not say which convolutions have a norm of their own: both readings are given, and
  // the model takes the one that it knows.
  const NamedTensors as_stored = tensors;
  for (const auto& [name, tensor] : as_stored) {
    if (!name.ends_with(kWeight) || tensor.dim() != 4) continue;
    const std::string prefix = name.substr(0, name.size() - kWeight.size());
    const auto bias = as_stored.find(prefix + ".bias");
    if (bias != as_stored.end()) AddUnfolded(prefix, tensor, bias->second, tensors);
  }
  return tensors;
}

}  // namespace msf
