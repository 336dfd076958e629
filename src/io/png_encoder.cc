#include "io/png_encoder.h"

#include <libdeflate.h>

#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "io/png_unfilter.h"
#include "util/check.h"

namespace msf {
namespace {

using Bytes = std::vector<uint8_t>;

void AppendBigEndian(std::string& out, uint32_t v) {
  for (const int shift : {24, 16, 8, 0}) out.push_back(static_cast<char>(v >> shift));
}

void AppendChunk(std::string& out, std::string_view type, std::string_view data) {
  AppendBigEndian(out, static_cast<uint32_t>(data.size()));
  const size_t body = out.size();
  out.append(type).append(data);
  AppendBigEndian(out, libdeflate_crc32(0, out.data() + body, out.size() - body));
}

std::string Header(const cv::Mat& image) {
  std::string header;
  AppendBigEndian(header, static_cast<uint32_t>(image.cols));
  AppendBigEndian(header, static_cast<uint32_t>(image.rows));
  const char bit_depth = image.depth() == CV_16U ? 16 : 8,
             color_type = image.channels() == 3 ? 2 : 0;
  return header.append({bit_depth, color_type, 0, 0, 0});
}

// A row in PNG's order of bytes: RGB, and big-endian.
void CopyRow(const cv::Mat& image, int y, Bytes& row) {
  const uint8_t* in = image.ptr(y);
  const auto pixel_bytes = image.elemSize();
  for (size_t x = 0; x < row.size(); x += pixel_bytes) {
    for (size_t c = 0; c < pixel_bytes; ++c) row[x + c] = in[x + pixel_bytes - 1 - c];
  }
}

// Appends the filter byte and the filtered row; `n` is the size of a pixel. Paeth suits
// photographs, Up the even areas of depth.
void AppendFiltered(const Bytes& row, const Bytes& up, size_t n, Bytes& out) {
  constexpr uint8_t kUp = 2, kPaeth = 4;
  const bool is_depth = n == 2;
  out.push_back(is_depth ? kUp : kPaeth);
  const size_t start = out.size();
  out.resize(start + row.size());
  uint8_t* filtered = out.data() + start;
  for (size_t i = 0; i < row.size(); ++i) filtered[i] = static_cast<uint8_t>(row[i] - up[i]);
  if (is_depth) return;
  for (size_t i = n; i < row.size(); ++i)
    filtered[i] = static_cast<uint8_t>(row[i] - PredictPaeth(row[i - n], up[i], up[i - n]));
}

}  // namespace

std::string EncodePng(const cv::Mat& image, int level) {
  MSF_CHECK(image.type() == CV_8UC1 || image.type() == CV_8UC3 || image.type() == CV_16UC1,
            "not a kind of image that PNG holds");
  const size_t row_bytes = static_cast<size_t>(image.cols) * image.elemSize();
  Bytes row(row_bytes), up(row_bytes, 0), filtered;
  filtered.reserve((row_bytes + 1) * static_cast<size_t>(image.rows));
  for (int y = 0; y < image.rows; ++y) {
    CopyRow(image, y, row);
    AppendFiltered(row, up, image.elemSize(), filtered);
    row.swap(up);
  }
  const std::unique_ptr<libdeflate_compressor, void (*)(libdeflate_compressor*)> compressor(
      libdeflate_alloc_compressor(level), libdeflate_free_compressor);
  std::string compressed(libdeflate_zlib_compress_bound(compressor.get(), filtered.size()), '\0');
  compressed.resize(libdeflate_zlib_compress(compressor.get(), filtered.data(), filtered.size(),
                                             compressed.data(), compressed.size()));

  std::string png = "\x89PNG\r\n\x1a\n";
  AppendChunk(png, "IHDR", Header(image));
  AppendChunk(png, "IDAT", compressed);
  AppendChunk(png, "IEND", "");
  return png;
}

}  // namespace msf
