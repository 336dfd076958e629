// The detector that runs on OpenCV's DNN module: for networks that oneDNN's reader does not know,
// and as a cross-check.
#pragma once

#include "detection/detector.h"

namespace msf {

// float32 only. The model file may have open sizes; they are fixed before OpenCV reads it.
StatusOr<std::unique_ptr<Detector>> MakeOpenCvDetector(const DetectorOptions& options,
                                                       const std::filesystem::path& model);

}  // namespace msf
