// Changes to model files that leave the network as it is.
#pragma once

#include <map>
#include <string>

#include "util/status.h"

namespace msf {

// Replaces or adds entries of the metadata. `bytes` is a model file.
StatusOr<std::string> SetOnnxMetadata(const std::string& bytes,
                                      const std::map<std::string, std::string>& entries);

// Stores large float32 weights in half precision, each followed by a cast, which halves the file.
StatusOr<std::string> HalveOnnxWeights(const std::string& bytes);

// A copy for readers that know less than ours: the input has a fixed size, weights in half
// precision become float32 and the casts behind them disappear.
StatusOr<std::string> SimplifyOnnx(const std::string& bytes, int height, int width);

}  // namespace msf
