// A picture turned so that a network trained on upright ones recognises what a rolled camera saw.
#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/core/matx.hpp>

#include "detection/detection.h"

namespace msf {

// The turn by `turn_rad`, clockwise as one looks at it, that brings the middle of an image of size
// `from` to the middle of one of size `to`. Of box coordinates, where pixel 0 spans 0 to 1.
cv::Matx23d TurnAboutCentre(cv::Size from, double turn_rad, cv::Size to);

// The image under such a map, on grey (value 114).
cv::Mat WarpOntoGrey(const cv::Mat& image, const cv::Matx23d& map, cv::Size size);

class TurnedPicture {
 public:
  // `image` (8-bit, 1 or 3 channels), turned by `turn_rad` (clockwise as one looks at it) about its
  // centre and scaled to `size`, in the middle of grey. The ellipse in the image just fits; corners
  // that leave are cut off, since what all of the image would cost of the scale matters more.
  TurnedPicture(const cv::Mat& image, double turn_rad, cv::Size size);

  const cv::Mat& pixels() const { return pixels_; }
  // The upright box, in pixels of the image and cut at its border, around an object that was found
  // in the turned one.
  ImageBox ToImage(const ImageBox& box) const;

 private:
  cv::Mat pixels_;
  cv::Size image_size_;
  cv::Matx23d to_image_;
};

}  // namespace msf
