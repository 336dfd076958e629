// Precision-recall curves as pictures.
#pragma once

#include <string>
#include <vector>

#include "detection/detection_metrics.h"

namespace msf {

// An SVG with one curve (IoU 0.5) per class that has at least `min_objects` objects, and the mean
// average precision.
std::string PlotPrecisionRecall(const DetectionMetrics& metrics,
                                const std::vector<std::string>& class_names, int min_objects);

}  // namespace msf
