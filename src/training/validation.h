// Mean average precision of a network on labelled images, to watch a training.
#pragma once

#include <vector>

#include "detection/detection_metrics.h"
#include "training/augmentation.h"
#include "training/network.h"

namespace msf {

// Detections of one image with a score above `min_score`, after non-maximum suppression per class
// (IoU 0.7), best first, at most 300. `scores`: [A, classes] in [0, 1]; `boxes`: [A, 4] in pixels.
// One box may be reported for several classes.
std::vector<Detection> SelectDetections(const torch::Tensor& scores, const torch::Tensor& boxes,
                                        float min_score);

// Runs the network in batches over images letterboxed to `side` pixels and scores what it finds.
// Means are over the classes with at least `min_objects` objects. Leaves the network in evaluation
// mode.
DetectionMetrics Validate(Network& network, const std::vector<LabeledImage>& images, int side,
                          int min_objects, bool bfloat16);

}  // namespace msf
