#include "io/other_images.h"

#include <spng.h>
#include <turbojpeg.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "io/png_decoder.h"

namespace msf {

std::optional<cv::Mat> DecodeJpeg(std::span<const uint8_t> file) {
  const std::unique_ptr<void, int (*)(tjhandle)> decompressor(tjInitDecompress(), tjDestroy);
  int width = 0, height = 0, subsampling = 0, colour_space = 0;
  if (tjDecompressHeader3(decompressor.get(), file.data(), file.size(), &width, &height,
                          &subsampling, &colour_space) != 0 ||
      std::max(width, height) > static_cast<int>(kMaxImageSide_px)) {
    return std::nullopt;
  }
  const bool is_grey = colour_space == TJCS_GRAY;
  cv::Mat image(height, width, is_grey ? CV_8UC1 : CV_8UC3);
  const int failed =
      tjDecompress2(decompressor.get(), file.data(), file.size(), image.data, width,
                    static_cast<int>(image.step[0]), height, is_grey ? TJPF_GRAY : TJPF_BGR, 0);
  return failed != 0 ? std::nullopt : std::optional(image);
}

std::optional<cv::Mat> DecodeAnyPng(std::span<const uint8_t> file) {
  const std::unique_ptr<spng_ctx, void (*)(spng_ctx*)> context(spng_ctx_new(0), spng_ctx_free);
  spng_ihdr header{};
  size_t num_bytes = 0;
  if (spng_set_image_limits(context.get(), kMaxImageSide_px, kMaxImageSide_px) != 0 ||
      spng_set_png_buffer(context.get(), file.data(), file.size()) != 0 ||
      spng_get_ihdr(context.get(), &header) != 0 ||
      spng_decoded_image_size(context.get(), SPNG_FMT_RGB8, &num_bytes) != 0) {
    return std::nullopt;
  }
  cv::Mat image(static_cast<int>(header.height), static_cast<int>(header.width), CV_8UC3);
  if (spng_decode_image(context.get(), image.data, num_bytes, SPNG_FMT_RGB8, 0) != 0)
    return std::nullopt;
  for (uint8_t* pixel = image.data; pixel != image.dataend; pixel += 3)
    std::swap(pixel[0], pixel[2]);
  return image;
}

}  // namespace msf
