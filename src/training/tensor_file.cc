#include <torch/csrc/api/include/torch/serialize.h>

#include <fstream>
#include <sstream>

#include "training/network.h"
#include "training/onnx_import.h"
#include "util/atomic_file.h"

namespace msf {

StatusOr<NamedTensors> LoadTensors(const std::filesystem::path& file) {
  if (file.extension() == ".onnx") return ReadOnnxWeights(file);
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return Status::Error(file.string() + ": cannot be opened; give a file of weights");
  const std::vector<char> bytes((std::istreambuf_iterator<char>(stream)),
                                std::istreambuf_iterator<char>());
  NamedTensors tensors;
  try {
    for (const auto& entry : torch::pickle_load(bytes).toGenericDict()) {
      if (entry.value().isTensor())
        tensors[entry.key().toStringRef()] = entry.value().toTensor().to(torch::kFloat);
    }
  } catch (const std::exception&) {
    return Status::Error(file.string() +
                         ": is not a dict of tensors as torch.save or a training here writes it");
  }
  return tensors;
}

Status SaveTensors(const std::filesystem::path& file, const NamedTensors& tensors) {
  c10::Dict<std::string, torch::Tensor> dict;
  for (const auto& [name, tensor] : tensors) dict.insert(name, tensor);
  const std::vector<char> bytes = torch::pickle_save(dict);
  return WriteFileAtomically(file, std::string_view(bytes.data(), bytes.size()));
}

}  // namespace msf
