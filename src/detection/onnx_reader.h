// Reads ONNX model files (IR version 3 and later, operator sets 7 to 19) into our graph.
#pragma once

#include <filesystem>
#include <string_view>

#include "detection/graph.h"
#include "util/status.h"

namespace msf {

// Largest file the reader accepts, in bytes.
inline constexpr size_t kMaxModelBytes = size_t{512} << 20;

// Reads a model. Every operator is one we know, every value is written once and before it is read;
// all else (a truncated file, an unknown operator, weights whose size contradicts their shape, ...)
// is an error that names file and node.
StatusOr<Graph> ReadOnnx(const std::filesystem::path& file);

// The same from memory; `source` names it in messages.
StatusOr<Graph> ParseOnnx(std::string_view bytes, const std::string& source);

// The whole file as bytes, or why it cannot be a model: not there, empty, too large.
StatusOr<std::string> ReadModelBytes(const std::filesystem::path& file);

}  // namespace msf
