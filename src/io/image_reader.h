// Image files of RGB-D sequences, with errors that name the file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "io/png_decoder.h"
#include "util/status.h"

namespace msf {

// Reads PNG and JPEG files. Keeps its buffers from image to
// image; used by one thread at a time.
class ImageReader {
 public:
  // 8-bit, grey (1 channel) or BGR (3 channels); transparency is dropped, palettes are resolved.
  StatusOr<cv::Mat> ReadColor(const std::filesystem::path& file);
  // 16-bit, 1 channel.
  StatusOr<cv::Mat> ReadDepth(const std::filesystem::path& file);

 private:
  // As stored in the file.
  StatusOr<cv::Mat> Read(const std::filesystem::path& file);

  PngDecoder png_;
  std::vector<uint8_t> bytes_;
};

// "8-bit, 3 channels": for messages.
std::string DescribePixels(const cv::Mat& image);

}  // namespace msf
