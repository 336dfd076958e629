#include "io/other_images.h"

#include <gtest/gtest.h>
#include <libdeflate.h>

#include <algorithm>
#include <array>
#include <opencv2/imgcodecs.hpp>
#include <utility>
#include <vector>

#include "io/png_decoder.h"
#include "io/png_encoder.h"

namespace msf {
namespace {

// A smooth picture with some noise.
cv::Mat Picture(int width, int height, int type) {
  cv::Mat picture(height, width, type);
  cv::RNG random(1);
  const int channels = picture.channels();
  for (int y = 0; y < height; ++y) {
    for (int i = 0; i < width * channels; ++i) {
      const int value = 3 * y + i / channels + 40 * (i % channels) + random.uniform(0, 8);
      if (picture.depth() == CV_8U)
        picture.ptr<uint8_t>(y)[i] = static_cast<uint8_t>(value);
      else
        picture.ptr<uint16_t>(y)[i] = static_cast<uint16_t>(100 * value);
    }
  }
  return picture;
}

std::vector<uint8_t> Encode(const std::string& format, const cv::Mat& image,
                            const std::vector<int>& options = {}) {
  std::vector<uint8_t> file;
  cv::imencode(format, image, file, options);
  return file;
}

TEST(DecodeJpeg, EqualsOpenCv) {
  for (const int type : {CV_8UC1, CV_8UC3}) {
    const std::vector<uint8_t> file = Encode(".jpg", Picture(37, 21, type));
    const std::optional<cv::Mat> image = DecodeJpeg(file);
    ASSERT_TRUE(image);
    ASSERT_EQ(image->type(), type);
    EXPECT_LE(cv::norm(*image, cv::imdecode(file, cv::IMREAD_UNCHANGED), cv::NORM_INF), 3);
  }
}

TEST(DecodeJpeg, WhatIsBrokenIsNothing) {
  const std::vector<uint8_t> file = Encode(".jpg", Picture(64, 48, CV_8UC3));
  EXPECT_FALSE(DecodeJpeg(std::span(file).first(file.size() / 2)));
  EXPECT_FALSE(DecodeJpeg(std::span(file).first(20)));
  EXPECT_FALSE(DecodeJpeg(Encode(".png", Picture(5, 5, CV_8UC3))));
}

TEST(DecodeJpeg, AbsurdSizesAreNotTriedOut) {
  std::vector<uint8_t> file = Encode(".jpg", Picture(64, 48, CV_8UC3));
  const std::array<uint8_t, 2> kFrameHeader = {0xff, 0xc0};
  const auto header =
      std::search(file.begin(), file.end(), kFrameHeader.begin(), kFrameHeader.end());
  ASSERT_NE(header, file.end());
  for (const int side : {5, 7}) {  // height, width
    std::vector<uint8_t> absurd = file;
    absurd[header - file.begin() + side] = 0xff;
    EXPECT_FALSE(DecodeJpeg(absurd));
  }
}

TEST(DecodeAnyPng, DropsTransparencyAndHalvesDepth) {
  const cv::Mat bgr = Picture(9, 7, CV_8UC3);
  std::vector<cv::Mat> planes;
  cv::split(bgr, planes);
  planes.push_back(cv::Mat(7, 9, CV_8UC1, cv::Scalar(99)));
  cv::Mat bgra;
  cv::merge(planes, bgra);
  const std::optional<cv::Mat> image = DecodeAnyPng(Encode(".png", bgra));
  ASSERT_TRUE(image);
  EXPECT_EQ(cv::norm(*image, bgr, cv::NORM_INF), 0);

  cv::Mat deep;
  bgr.convertTo(deep, CV_16U, 257);
  EXPECT_EQ(cv::norm(*DecodeAnyPng(Encode(".png", deep)), bgr, cv::NORM_INF), 0);
}

TEST(DecodeAnyPng, WhatIsBrokenIsNothing) {
  const std::vector<uint8_t> file = Encode(".png", Picture(64, 48, CV_8UC3));
  EXPECT_FALSE(DecodeAnyPng(std::span(file).first(file.size() / 2)));
  EXPECT_FALSE(DecodeAnyPng(Encode(".jpg", Picture(5, 5, CV_8UC3))));
}

// The PNG file of a small picture whose header says that it is larger.
std::vector<uint8_t> PngThatClaims(uint32_t width, uint32_t height) {
  constexpr size_t kHeader = 12, kWidth = 16, kHeight = 20, kChecksum = 29;  // places of IHDR
  std::vector<uint8_t> file = Encode(".png", Picture(64, 48, CV_8UC3));
  const auto put = [&file](size_t at, uint32_t number) {
    for (size_t i = 0; i < 4; ++i) file[at + i] = static_cast<uint8_t>(number >> (24 - 8 * i));
  };
  put(kWidth, width);
  put(kHeight, height);
  put(kChecksum, libdeflate_crc32(0, &file[kHeader], kChecksum - kHeader));
  return file;
}

TEST(DecodeAnyPng, AbsurdSizesAreNotTriedOut) {
  EXPECT_TRUE(DecodeAnyPng(PngThatClaims(64, 48)));
  for (const auto& [width, height] :
       {std::pair(200'000u, 200'000u), {16'385u, 1u}, {1u, 16'385u}}) {
    const std::vector<uint8_t> file = PngThatClaims(width, height);
    cv::Mat image;
    EXPECT_EQ(PngDecoder().Decode(file, image), PngDecoder::Outcome::kUnsupported);
    EXPECT_FALSE(DecodeAnyPng(file));
  }
  cv::Mat image;
  EXPECT_EQ(PngDecoder().Decode(PngThatClaims(16'384, 16'384), image),
            PngDecoder::Outcome::kBroken);
}

TEST(EncodePng, IsReadBackByUsAndByLibpng) {
  for (const int type : {CV_8UC1, CV_8UC3, CV_16UC1}) {
    const cv::Mat picture = Picture(61, 17, type);
    const std::string png = EncodePng(picture);
    const std::vector<uint8_t> file(png.begin(), png.end());
    const cv::Mat by_libpng = cv::imdecode(file, cv::IMREAD_UNCHANGED);
    ASSERT_EQ(by_libpng.type(), type);
    EXPECT_EQ(cv::norm(by_libpng, picture, cv::NORM_INF), 0);
    cv::Mat by_us;
    ASSERT_EQ(PngDecoder().Decode(file, by_us), PngDecoder::Outcome::kDecoded);
    EXPECT_EQ(cv::norm(by_us, picture, cv::NORM_INF), 0);
  }
}

TEST(EncodePng, TakesPartsOfLargerImages) {
  const cv::Mat part = Picture(61, 17, CV_8UC3)(cv::Rect(3, 2, 20, 10));
  const std::string png = EncodePng(part);
  EXPECT_EQ(
      cv::norm(cv::imdecode(std::vector<uint8_t>(png.begin(), png.end()), cv::IMREAD_UNCHANGED),
               part, cv::NORM_INF),
      0);
}

}  // namespace
}  // namespace msf
