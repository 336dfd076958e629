// Image kinds that are rarer than those of PngDecoder. OpenCV's own reader is avoided: it drags in
// a hundred libraries, which cost every start of the program 65 ms and 30 MB.
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <span>

namespace msf {

// A JPEG as CV_8UC1 or CV_8UC3 (BGR); nothing when it is none, or truncated or damaged, or has a
// side of more than kMaxImageSide_px.
std::optional<cv::Mat> DecodeJpeg(std::span<const uint8_t> file);

// A PNG of any kind as CV_8UC3 (BGR), without transparency; nothing under the same conditions.
std::optional<cv::Mat> DecodeAnyPng(std::span<const uint8_t> file);

}  // namespace msf
