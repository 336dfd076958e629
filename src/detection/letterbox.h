// Fitting an image of any size into the network's input.
#pragma once

#include <opencv2/core/mat.hpp>

#include "detection/detection.h"

namespace msf {

// Scales an image by one factor so that it just fits, centred, with a grey border (value 114): the
// way YOLO networks are trained.
class Letterbox {
 public:
  // All sizes in pixels.
  Letterbox(cv::Size image, cv::Size network);

  // Writes the network's input, RGB [height][width][3]. `image` is 8-bit BGR or grey, of the size
  // given above.
  void Fill(const cv::Mat& image, uint8_t* rgb) const;

  // From network pixels to pixels of the image, cut at its border.
  ImageBox ToImage(const ImageBox& box) const;
  // From pixels of the image to network pixels.
  ImageBox ToNetwork(const ImageBox& box) const;

 private:
  cv::Size image_, network_;
  cv::Rect inside_;  // where the scaled image lies in the network's input
  float scale_;      // network pixels per image pixel
};

}  // namespace msf
