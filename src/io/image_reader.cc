#include "io/image_reader.h"

#include <cerrno>
#include <cstring>
#include <fstream>

#include "io/other_images.h"
#include "io/presence.h"

namespace msf {
namespace {

Status ReadBytes(const std::filesystem::path& file, std::vector<uint8_t>& bytes) {
  errno = 0;
  std::ifstream stream(file, std::ios::binary | std::ios::ate);
  const std::streamoff size = stream ? static_cast<std::streamoff>(stream.tellg()) : -1;
  if (size < 0 || IsFolder(file)) {
    return Status::Error(file.string() + ": cannot be opened" +
                         (errno != 0 ? std::string(" (") + std::strerror(errno) + ")" : ""));
  }
  bytes.resize(static_cast<size_t>(size));
  stream.seekg(0);
  if (!stream.read(reinterpret_cast<char*>(bytes.data()), size))
    return Status::Error(file.string() + ": cannot be read");
  return bytes.empty() ? Status::Error(file.string() + ": the file is empty") : Status::Ok();
}

}  // namespace

std::string DescribePixels(const cv::Mat& image) {
  return std::to_string(image.elemSize1() * 8) + "-bit, " + std::to_string(image.channels()) +
         (image.channels() == 1 ? " channel" : " channels");
}

StatusOr<cv::Mat> ImageReader::Read(const std::filesystem::path& file) {
  MSF_RETURN_IF_ERROR(ReadBytes(file, bytes_));
  const Status broken = Status::Error(file.string() + ": is no image or a damaged one");
  cv::Mat image;
  switch (png_.Decode(bytes_, image)) {
    case PngDecoder::Outcome::kDecoded:
      return image;
    case PngDecoder::Outcome::kBroken:
      return broken;
    case PngDecoder::Outcome::kUnsupported:
      break;
  }
  std::optional<cv::Mat> other = DecodeJpeg(bytes_);
  if (!other) other = DecodeAnyPng(bytes_);
  return other ? StatusOr<cv::Mat>(*other) : broken;
}

StatusOr<cv::Mat> ImageReader::ReadColor(const std::filesystem::path& file) {
  StatusOr<cv::Mat> image = Read(file);
  if (image.ok() && image->depth() != CV_8U) {
    return Status::Error(file.string() + ": a colour image has 8 bits per channel, this one is " +
                         DescribePixels(*image));
  }
  return image;
}

StatusOr<cv::Mat> ImageReader::ReadDepth(const std::filesystem::path& file) {
  StatusOr<cv::Mat> image = Read(file);
  if (image.ok() && image->type() != CV_16UC1) {
    return Status::Error(file.string() + ": a depth image is 16-bit, 1 channel, this one is " +
                         DescribePixels(*image));
  }
  return image;
}

}  // namespace msf
