#include "feature/image_pyramid.h"

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace msf {

cv::Mat ToGrey(const cv::Mat& color, cv::Mat& converted) {
  if (color.channels() == 1) return color;
  cv::cvtColor(color, converted, cv::COLOR_BGR2GRAY);
  return converted;
}

void BuildPyramid(const cv::Mat& grey, const ScaleLevels& scales, std::vector<cv::Mat>& levels) {
  levels.resize(scales.size());
  levels[0] = grey;
  for (int l = 1; l < scales.size(); ++l) {
    const cv::Size size(static_cast<int>(std::lround(grey.cols / scales.scale(l))),
                        static_cast<int>(std::lround(grey.rows / scales.scale(l))));
    if (size.width < 1 || size.height < 1) {
      levels.resize(l);
      return;
    }
    cv::resize(levels[l - 1], levels[l], size, 0, 0, cv::INTER_LINEAR);
  }
}

}  // namespace msf
