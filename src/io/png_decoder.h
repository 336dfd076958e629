// Decodes the PNG images of RGB-D sequences about three times as fast as libpng: they are most of
// what reading a frame costs.
#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <span>
#include <vector>

struct libdeflate_decompressor;

namespace msf {

// A header that says more is damaged rather than that of a camera's image.
inline constexpr unsigned kMaxImageSide_px = 16384;

// Inflation is libdeflate's; chunks and row filters follow the PNG specification (ISO/IEC 15948).
// Used by one thread at a time.
class PngDecoder {
 public:
  enum class Outcome {
    kDecoded,
    kUnsupported,  // not a PNG, or a kind that this decoder leaves to others (palette, alpha,
                   // interlaced, ...)
    kBroken,       // truncated or damaged
  };

  PngDecoder();
  ~PngDecoder();
  PngDecoder(PngDecoder&&) noexcept;
  PngDecoder& operator=(PngDecoder&&) noexcept;

  // Decodes 8-bit grey (CV_8UC1), 8-bit colour (CV_8UC3, BGR) and 16-bit grey (CV_16UC1) without
  // interlacing into `image`, which is only meaningful with kDecoded.
  Outcome Decode(std::span<const uint8_t> file, cv::Mat& image);

 private:
  struct Deleter {
    void operator()(libdeflate_decompressor* decompressor) const;
  };

  Outcome Inflate(std::span<const uint8_t> file, size_t num_bytes);

  std::unique_ptr<libdeflate_decompressor, Deleter> decompressor_;
  std::vector<uint8_t> compressed_;  // the joined IDAT chunks
  std::vector<uint8_t>
      filtered_;  // rows as PNG stores them: a filter byte, then the filtered bytes
};

}  // namespace msf
