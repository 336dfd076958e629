#include "bench/thumbnail.h"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "bench/base64.h"

namespace msf {

std::string ThumbnailAddress(const cv::Mat& picture, int width_px) {
  cv::Mat small;
  cv::resize(picture, small, {width_px, picture.rows * width_px / picture.cols}, 0, 0,
             cv::INTER_AREA);
  std::vector<uchar> jpeg;
  cv::imencode(".jpg", small, jpeg, {cv::IMWRITE_JPEG_QUALITY, 80});
  return "data:image/jpeg;base64," +
         EncodeBase64({reinterpret_cast<const char*>(jpeg.data()), jpeg.size()});
}

}  // namespace msf
