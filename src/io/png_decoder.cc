#include "io/png_decoder.h"

#include <libdeflate.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>

#include "io/png_unfilter.h"

namespace msf {
namespace {

constexpr std::array<uint8_t, 8> kSignature = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
constexpr size_t kHeaderBytes = 13;
constexpr size_t kChunkOverhead = 12;   // length, type, checksum
constexpr size_t kMaxInflation = 1032;  // how many bytes deflate can make of one

uint32_t ReadBigEndian(const uint8_t* p) {
  return uint32_t{p[0]} << 24 | uint32_t{p[1]} << 16 | uint32_t{p[2]} << 8 | uint32_t{p[3]};
}

struct Chunk {
  std::span<const uint8_t> type;
  std::span<const uint8_t> data;
  bool Is(const char* name) const { return std::memcmp(type.data(), name, 4) == 0; }
};

// Takes the chunk at the front of `rest`; nothing when it is cut off or its checksum does not hold.
std::optional<Chunk> TakeChunk(std::span<const uint8_t>& rest) {
  if (rest.size() < kChunkOverhead) return std::nullopt;
  const size_t length = ReadBigEndian(rest.data());
  if (length > rest.size() - kChunkOverhead) return std::nullopt;
  const Chunk chunk{rest.subspan(4, 4), rest.subspan(8, length)};
  const uint32_t checksum = libdeflate_crc32(0, chunk.type.data(), 4 + length);
  if (checksum != ReadBigEndian(rest.data() + 8 + length)) return std::nullopt;
  rest = rest.subspan(kChunkOverhead + length);
  return chunk;
}

struct Header {
  int width = 0;
  int height = 0;
  int pixel_bytes = 0;
  int mat_type = 0;
};

std::optional<Header> ParseHeader(std::span<const uint8_t> ihdr) {
  const uint32_t width = ReadBigEndian(ihdr.data());
  const uint32_t height = ReadBigEndian(ihdr.data() + 4);
  const int depth = ihdr[8];
  const int color = ihdr[9];
  const bool plain =
      ihdr[10] == 0 && ihdr[11] == 0 && ihdr[12] == 0;  // deflate, five filters, no interlacing
  if (!plain || width == 0 || height == 0 || width > kMaxImageSide_px || height > kMaxImageSide_px)
    return std::nullopt;
  Header header{static_cast<int>(width), static_cast<int>(height)};
  if (color == 0 && depth == 8)
    header.pixel_bytes = 1, header.mat_type = CV_8UC1;
  else if (color == 0 && depth == 16)
    header.pixel_bytes = 2, header.mat_type = CV_16UC1;
  else if (color == 2 && depth == 8)
    header.pixel_bytes = 3, header.mat_type = CV_8UC3;
  else
    return std::nullopt;
  return header;
}

}  // namespace

void PngDecoder::Deleter::operator()(libdeflate_decompressor* decompressor) const {
  libdeflate_free_decompressor(decompressor);
}

PngDecoder::PngDecoder() : decompressor_(libdeflate_alloc_decompressor()) {}
PngDecoder::~PngDecoder() = default;
PngDecoder::PngDecoder(PngDecoder&&) noexcept = default;
PngDecoder& PngDecoder::operator=(PngDecoder&&) noexcept = default;

PngDecoder::Outcome PngDecoder::Decode(std::span<const uint8_t> file, cv::Mat& image) {
  if (file.size() < kSignature.size() ||
      !std::equal(kSignature.begin(), kSignature.end(), file.begin())) {
    return Outcome::kUnsupported;
  }
  std::span<const uint8_t> rest = file.subspan(kSignature.size());
  const std::optional<Chunk> ihdr = TakeChunk(rest);
  if (!ihdr || !ihdr->Is("IHDR") || ihdr->data.size() != kHeaderBytes) return Outcome::kBroken;
  const std::optional<Header> header = ParseHeader(ihdr->data);
  if (!header) return Outcome::kUnsupported;

  const size_t row_bytes = 1 + static_cast<size_t>(header->width) * header->pixel_bytes;
  if (const Outcome outcome = Inflate(rest, row_bytes * header->height);
      outcome != Outcome::kDecoded) {
    return outcome;
  }
  image.create(header->height, header->width, header->mat_type);
  const auto unfilter = header->pixel_bytes == 1   ? UnfilterPng<1>
                        : header->pixel_bytes == 2 ? UnfilterPng<2>
                                                   : UnfilterPng<3>;
  const bool known_filters =
      unfilter(filtered_.data(), header->width, header->height, image.data, image.step[0]);
  return known_filters ? Outcome::kDecoded : Outcome::kBroken;
}

// Joins and inflates the IDAT chunks of `rest` (all chunks after the header) to exactly `num_bytes`
// bytes in filtered_.
PngDecoder::Outcome PngDecoder::Inflate(std::span<const uint8_t> rest, size_t num_bytes) {
  compressed_.clear();
  while (true) {
    const std::optional<Chunk> chunk = TakeChunk(rest);
    if (!chunk) return Outcome::kBroken;
    if (chunk->Is("IEND")) break;
    if (chunk->Is("IDAT"))
      compressed_.insert(compressed_.end(), chunk->data.begin(), chunk->data.end());
  }
  // Found before the memory is taken: a few bytes may claim to be a picture of a gigabyte.
  if (num_bytes > kMaxInflation * compressed_.size()) return Outcome::kBroken;
  filtered_.resize(num_bytes + kUnfilterPadding);
  size_t inflated = 0;
  const libdeflate_result result =
      libdeflate_zlib_decompress(decompressor_.get(), compressed_.data(), compressed_.size(),
                                 filtered_.data(), num_bytes, &inflated);
  return result == LIBDEFLATE_SUCCESS && inflated == num_bytes ? Outcome::kDecoded
                                                               : Outcome::kBroken;
}

}  // namespace msf
