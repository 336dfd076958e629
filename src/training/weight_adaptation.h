// Starting weights for a model from a detector trained on other classes.
#pragma once

#include "training/network.h"

namespace msf {

// `source` re-arranged for `target`: the rows of the class heads follow the class names (20 VOC
// classes take the rows of their COCO counterparts), and where the class branch is narrower its
// most influential channels are kept. Everything else is copied by name. `source` must hold the 80
// COCO classes or as many as `target`; another count is an error.
StatusOr<NamedTensors> AdaptWeights(const NamedTensors& source, const ModelGraph& target);

// The mean of two sets of weights of one model, `share` of it `b`: between the weights before and
// after a fine-tuning lie ones that do better than either on what both can do (Wortsman et al.,
// Robust fine-tuning of zero-shot models, CVPR 2022).
StatusOr<NamedTensors> BlendWeights(const NamedTensors& a, const NamedTensors& b, double share);

}  // namespace msf
