// Weights out of an ONNX file that ExportOnnx wrote: a model that ships is a start for a training.
#pragma once

#include <filesystem>

#include "training/network.h"

namespace msf {

// The tensors by their names in a training. The norms that the export folded into convolutions come
// back as norms that change nothing but add the bias. An error when the file is no readable model,
// or has no weights of that naming.
StatusOr<NamedTensors> ReadOnnxWeights(const std::filesystem::path& file);

}  // namespace msf
