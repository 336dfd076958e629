// A sequence of pictures as a video or as a folder, which appears only when it is complete.
#pragma once

#include <filesystem>
#include <memory>
#include <opencv2/core/mat.hpp>

#include "util/status.h"

namespace msf {

class PictureWriter {
 public:
  // `target`: FILE.mp4 (H.264 where the machine has an encoder, else MPEG-4), or a folder for
  // 000000.jpg, 000001.jpg ... An existing folder is replaced when it is empty, or was made here (a
  // hidden file tells) and holds nothing but such pictures; else this is an error, as is a target
  // that cannot be written.
  static StatusOr<std::unique_ptr<PictureWriter>> Create(const std::filesystem::path& target,
                                                         double fps);
  // Removes what was written when Finish() did not succeed.
  virtual ~PictureWriter() = default;

  // All pictures have the same even size, 8-bit BGR.
  virtual Status Add(const cv::Mat& picture) = 0;
  // Puts the file or folder in its place; an error when not all of it could be written.
  virtual Status Finish() = 0;
};

}  // namespace msf
