#include "io/png_decoder.h"

#include <gtest/gtest.h>
#include <libdeflate.h>

#include <opencv2/imgcodecs.hpp>
#include <random>
#include <string>

namespace msf {
namespace {

using Bytes = std::vector<uint8_t>;

void AppendBigEndian(Bytes& out, uint32_t v) {
  for (const int shift : {24, 16, 8, 0}) out.push_back(static_cast<uint8_t>(v >> shift));
}

void AppendChunk(Bytes& out, const std::string& type, const Bytes& data) {
  AppendBigEndian(out, static_cast<uint32_t>(data.size()));
  Bytes body(type.begin(), type.end());
  body.insert(body.end(), data.begin(), data.end());
  out.insert(out.end(), body.begin(), body.end());
  AppendBigEndian(out, libdeflate_crc32(0, body.data(), body.size()));
}

Bytes Compress(const Bytes& raw) {
  libdeflate_compressor* compressor = libdeflate_alloc_compressor(6);
  Bytes out(libdeflate_zlib_compress_bound(compressor, raw.size()));
  out.resize(libdeflate_zlib_compress(compressor, raw.data(), raw.size(), out.data(), out.size()));
  libdeflate_free_compressor(compressor);
  return out;
}

// Random filtered rows are a valid image whatever the filters are; libpng (in OpenCV) says which
// one.
Bytes RandomPng(int width, int height, int bit_depth, int color_type,
                const std::vector<int>& filters, int num_idat = 1) {
  std::mt19937 random(static_cast<unsigned>(width * 1000 + height * 10 + color_type));
  const int pixel_bytes = bit_depth / 8 * (color_type == 2 ? 3 : 1);
  Bytes raw;
  for (int y = 0; y < height; ++y) {
    raw.push_back(static_cast<uint8_t>(filters[static_cast<size_t>(y) % filters.size()]));
    for (int i = 0; i < width * pixel_bytes; ++i) raw.push_back(static_cast<uint8_t>(random()));
  }
  const Bytes compressed = Compress(raw);
  Bytes png = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  Bytes header;
  AppendBigEndian(header, static_cast<uint32_t>(width));
  AppendBigEndian(header, static_cast<uint32_t>(height));
  for (const int b : {bit_depth, color_type, 0, 0, 0}) header.push_back(static_cast<uint8_t>(b));
  AppendChunk(png, "IHDR", header);
  for (int i = 0; i < num_idat; ++i) {
    const auto begin = compressed.begin() + static_cast<long>(compressed.size()) * i / num_idat;
    const auto end = compressed.begin() + static_cast<long>(compressed.size()) * (i + 1) / num_idat;
    AppendChunk(png, "IDAT", Bytes(begin, end));
  }
  AppendChunk(png, "IEND", {});
  return png;
}

void ExpectLikeLibpng(const Bytes& png) {
  cv::Mat image;
  ASSERT_EQ(PngDecoder().Decode(png, image), PngDecoder::Outcome::kDecoded);
  const cv::Mat expected = cv::imdecode(png, cv::IMREAD_UNCHANGED);
  ASSERT_EQ(image.type(), expected.type());
  ASSERT_EQ(image.size(), expected.size());
  EXPECT_EQ(cv::norm(image, expected, cv::NORM_INF), 0);
}

class PngKinds : public testing::TestWithParam<std::pair<int, int>> {};

TEST_P(PngKinds, EveryFilterAndSizeDecodesLikeLibpng) {
  const auto [bit_depth, color_type] = GetParam();
  const std::vector<std::vector<int>> filters = {{0}, {1}, {2},
                                                 {3}, {4}, {4, 4, 4, 4, 4, 2, 4, 4, 1, 3, 0}};
  const std::vector<std::pair<int, int>> sizes = {{1, 1}, {1, 9},  {2, 8},  {3, 8},
                                                  {4, 5}, {5, 13}, {64, 23}};
  for (const auto& [width, height] : sizes) {
    for (const std::vector<int>& f : filters) {
      SCOPED_TRACE(std::to_string(width) + "x" + std::to_string(height) + " filter " +
                   std::to_string(f[0]));
      ExpectLikeLibpng(RandomPng(width, height, bit_depth, color_type, f));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, PngKinds,
                         testing::Values(std::pair{8, 0}, std::pair{8, 2}, std::pair{16, 0}));

TEST(PngDecoder, JoinsIdatChunks) { ExpectLikeLibpng(RandomPng(40, 30, 8, 2, {4}, 7)); }

TEST(PngDecoder, IsReusable) {
  PngDecoder decoder;
  cv::Mat large, small;
  ASSERT_EQ(decoder.Decode(RandomPng(50, 40, 8, 2, {4}), large), PngDecoder::Outcome::kDecoded);
  const Bytes png = RandomPng(20, 10, 16, 0, {4});
  ASSERT_EQ(decoder.Decode(png, small), PngDecoder::Outcome::kDecoded);
  EXPECT_EQ(cv::norm(small, cv::imdecode(png, cv::IMREAD_UNCHANGED), cv::NORM_INF), 0);
}

TEST(PngDecoder, EveryTruncationIsBroken) {
  const Bytes png = RandomPng(6, 5, 8, 2, {4});
  for (size_t size = 8; size < png.size(); ++size) {
    cv::Mat image;
    EXPECT_EQ(PngDecoder().Decode(std::span(png).first(size), image), PngDecoder::Outcome::kBroken)
        << size;
  }
}

TEST(PngDecoder, DamagedBytesAreBroken) {
  const Bytes good = RandomPng(6, 5, 8, 2, {4});
  for (size_t i = 8; i < good.size(); ++i) {
    Bytes bad = good;
    bad[i] ^= 0x10;
    cv::Mat image;
    EXPECT_NE(PngDecoder().Decode(bad, image), PngDecoder::Outcome::kDecoded) << i;
  }
}

TEST(PngDecoder, UnknownFilterAndWrongLengthAreBroken) {
  cv::Mat image;
  EXPECT_EQ(PngDecoder().Decode(RandomPng(6, 5, 8, 2, {5}), image), PngDecoder::Outcome::kBroken);
  // The header of a higher image with the data of a lower one.
  const Bytes low = RandomPng(6, 5, 8, 2, {0}), high = RandomPng(6, 6, 8, 2, {0});
  constexpr size_t kHeaderEnd = 8 + 25;
  Bytes mixed(high.begin(), high.begin() + kHeaderEnd);
  mixed.insert(mixed.end(), low.begin() + kHeaderEnd, low.end());
  EXPECT_EQ(PngDecoder().Decode(mixed, image), PngDecoder::Outcome::kBroken);
}

TEST(PngDecoder, LeavesOtherKindsToOthers) {
  cv::Mat image;
  EXPECT_EQ(PngDecoder().Decode(Bytes{0xff, 0xd8, 0xff}, image), PngDecoder::Outcome::kUnsupported);
  EXPECT_EQ(PngDecoder().Decode(RandomPng(6, 5, 8, 6, {0}), image),
            PngDecoder::Outcome::kUnsupported);
}

}  // namespace
}  // namespace msf
