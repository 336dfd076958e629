// The detector that runs on oneDNN.
#pragma once

#include "detection/detector.h"
#include "detection/graph.h"
#include "detection/storage_plan.h"

namespace msf {

StatusOr<std::unique_ptr<Detector>> MakeOneDnnDetector(const DetectorOptions& options,
                                                       const std::filesystem::path& model);

// The same for a model at hand, in a precision that is already decided (quantisation calibrates
// with it).
StatusOr<std::unique_ptr<Detector>> MakeOneDnnDetector(const DetectorOptions& options,
                                                       const Graph& graph,
                                                       NetworkPrecision precision);

// What `name` (fp32, bf16, int8 or auto) means for a model on this processor. auto: int8 when the
// model is calibrated and the processor multiplies 8-bit numbers fast, else bf16 when it is fast,
// else fp32.
NetworkPrecision ChoosePrecision(const std::string& name, const Graph& graph);

// Class names for a model with `num_classes` classes: from the file in the options, from the
// metadata, or "class 0", ... A different number of names is an error.
StatusOr<std::vector<std::string>> ClassNamesFor(const DetectorOptions& options, const Graph& graph,
                                                 int num_classes);

// The input size to run a model at: of the options, the model's own, or the default 416x320.
StatusOr<cv::Size> InputSizeFor(const DetectorOptions& options, const Graph& graph);

// A sentence unless `image` is 8-bit with 1 or 3 channels.
Status CheckImage(const cv::Mat& image);

}  // namespace msf
