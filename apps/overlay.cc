#include "apps/overlay.h"

#include <fmt/format.h>

#include <opencv2/imgproc.hpp>

namespace msf {
namespace {

// Colours that are told apart easily, by class.
cv::Scalar ColorOf(int class_id) {
  const int hue = class_id * 67 % 180;
  cv::Mat3b color(1, 1, cv::Vec3b(static_cast<uchar>(hue), 220, 255));
  cv::cvtColor(color, color, cv::COLOR_HSV2BGR);
  return cv::Scalar(color(0, 0)[0], color(0, 0)[1], color(0, 0)[2]);
}

}  // namespace

cv::Mat DrawDetections(const cv::Mat& image, const std::vector<Detection>& detections,
                       const std::vector<std::string>& class_names) {
  cv::Mat drawn;
  if (image.channels() == 1) {
    cv::cvtColor(image, drawn, cv::COLOR_GRAY2BGR);
  } else {
    drawn = image.clone();
  }
  for (auto d = detections.rbegin(); d != detections.rend(); ++d) {  // the best one on top
    const cv::Scalar color = ColorOf(d->class_id);
    const cv::Point corner(cvRound(d->box.x0), cvRound(d->box.y0));
    cv::rectangle(drawn, corner, cv::Point(cvRound(d->box.x1) - 1, cvRound(d->box.y1) - 1), color,
                  2);
    const std::string label =
        fmt::format("{} {:.2f}", class_names[static_cast<size_t>(d->class_id)], d->score);
    const cv::Size text = cv::getTextSize(label, cv::FONT_HERSHEY_SIMPLEX, 0.45, 1, nullptr);
    const int top = std::max(corner.y, text.height + 4);
    cv::rectangle(drawn, {corner.x, top - text.height - 4}, {corner.x + text.width + 2, top}, color,
                  cv::FILLED);
    cv::putText(drawn, label, {corner.x + 1, top - 3}, cv::FONT_HERSHEY_SIMPLEX, 0.45,
                cv::Scalar::all(0), 1, cv::LINE_AA);
  }
  return drawn;
}

}  // namespace msf
