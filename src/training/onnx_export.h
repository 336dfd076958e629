// Detectors as ONNX files (opset 13), batch norms folded into convolutions.
#pragma once

#include <filesystem>

#include "training/network.h"
#include "util/status.h"

namespace msf {

enum class OnnxForm {
  // Outputs box_8, class_8, box_16, ... as the network gives them; any input size that is a
  // multiple of 32.
  kRawHeads,
  // One output [1, 4 + classes, anchors]: x, y, width, height of the box in input pixels, then
  // sigmoid scores; one input size.
  kSingleOutput
};

struct OnnxOptions {
  OnnxForm form = OnnxForm::kRawHeads;
  int width = 640;  // kSingleOutput: the input size
  int height = 640;
  bool half = true;  // convolution weights stored as float16 (half the file), cast to float when
                     // the file is loaded
};

// Writes `graph` with the weights `state` (see Network::State). The input is `images` [1, 3,
// height, width], RGB in [0, 1]. Class names are in the file's metadata under "names", as a JSON
// list.
Status ExportOnnx(const ModelGraph& graph, const NamedTensors& state, const OnnxOptions& options,
                  const std::filesystem::path& file);

}  // namespace msf
