#include "viewer/dynamics_drawing.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <opencv2/imgproc.hpp>

namespace msf {
namespace {

constexpr double kTextSize = 0.42;
constexpr int kLine_px = 18;
constexpr int kLegendLines = 3;

// BGR.
cv::Scalar ColorOf(PointReason reason) {
  switch (reason) {
    case PointReason::kStatic:
      return {90, 220, 60};
    case PointReason::kBox:
      return {0, 140, 255};
    case PointReason::kObject:
      return {60, 60, 240};
    case PointReason::kFlow:
      return {240, 60, 240};
    case PointReason::kDepth:
      return {0, 230, 255};
    case PointReason::kSettled:
      return {240, 180, 40};
    case PointReason::kReadmitted:
      return {255, 255, 255};
    case PointReason::kKnown:
      return {160, 200, 40};
  }
  return {};
}

cv::Scalar ColorOf(MotionState state) {
  switch (state) {
    case MotionState::kMoving:
      return {60, 60, 240};
    case MotionState::kUncertain:
      return {0, 170, 255};
    case MotionState::kStatic:
      return {240, 180, 40};
  }
  return {};
}

void Write(cv::Mat& canvas, const std::string& text, cv::Point at, const cv::Scalar& color) {
  cv::putText(canvas, text, at, cv::FONT_HERSHEY_SIMPLEX, kTextSize, color, 1, cv::LINE_AA);
}

int WidthOf(const std::string& text) {
  return cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, kTextSize, 1, nullptr).width;
}

void TintMask(const cv::Mat1b& cells, cv::Mat& image) {
  if (cells.empty()) return;
  cv::Mat1b mask;
  cv::resize(cells, mask, image.size(), 0, 0, cv::INTER_NEAREST);
  cv::Mat tinted(image.size(), image.type(), ColorOf(PointReason::kObject));
  cv::addWeighted(image, 0.65, tinted, 0.35, 0, tinted);
  tinted.copyTo(image, mask);
}

void DrawPoints(const DynamicsView& view, cv::Mat& image) {
  const PointLabels& labels = view.result.labels;
  for (int i = 0; i < std::min(labels.size(), static_cast<int>(view.points_px.size())); ++i) {
    const cv::Point at(cvRound(view.points_px[i].x()), cvRound(view.points_px[i].y()));
    cv::circle(image, at, labels.reason[i] == PointReason::kStatic ? 1 : 2,
               ColorOf(labels.reason[i]), cv::FILLED);
  }
}

// Thin lines: followed without a detection. Grey: its points are used.
void DrawObject(const DynamicObject& object, cv::Mat& image) {
  const cv::Scalar color = object.removed || object.state == MotionState::kStatic
                               ? ColorOf(object.state)
                               : cv::Scalar::all(150);
  const cv::Rect2f box(object.box.x0, object.box.y0, object.box.width() - 1,
                       object.box.height() - 1);
  cv::rectangle(image, cv::Rect(box), color, object.bridged ? 1 : 2);
  if (!object.removed && object.kind == ObjectKind::kUnknown)
    return;  // many, and most of them chance
  std::string label = fmt::format("{} {} {}", object.id, object.name, ToString(object.state));
  if (object.kind != ObjectKind::kUnknown) label += fmt::format(" {:.2f}", object.score);
  if (object.bridged) label += " followed";
  const int top = std::clamp(cvRound(box.y), kLine_px, image.rows);
  const int left = std::clamp(cvRound(box.x), 0, std::max(0, image.cols - WidthOf(label) - 4));
  cv::rectangle(image, {left, top - kLine_px + 2}, {left + WidthOf(label) + 4, top}, color,
                cv::FILLED);
  Write(image, label, {left + 2, top - 4}, cv::Scalar::all(0));
}

void DrawLegend(const DynamicsView& view, cv::Mat legend) {
  const cv::Scalar grey = cv::Scalar::all(220);
  const DynamicResult& result = view.result;
  const std::string age = result.detection_age < 0
                              ? "no detections yet"
                              : fmt::format("detections {} frames old", result.detection_age);
  Write(legend,
        fmt::format("frame {}   {}   {}   masks {:.0f} %", view.frame, view.tracking, age,
                    100 * result.mask_share),
        {6, kLine_px - 4}, grey);
  const std::array<int, kNumPointReasons> counts = result.labels.Counts();
  int x = 6;
  for (int i = 0; i < kNumPointReasons; ++i) {
    const auto reason = static_cast<PointReason>(i);
    const std::string name = fmt::format("{} {}", ToString(reason), counts[i]);
    cv::circle(legend, {x + 4, 2 * kLine_px - 9}, 4, ColorOf(reason), cv::FILLED);
    Write(legend, name, {x + 12, 2 * kLine_px - 4}, grey);
    x += WidthOf(name) + 20;
  }
  x = 6;
  for (const MotionState state :
       {MotionState::kMoving, MotionState::kUncertain, MotionState::kStatic}) {
    const std::string name = std::string("object ") + ToString(state);
    cv::rectangle(legend, {x, 3 * kLine_px - 14}, {x + 10, 3 * kLine_px - 4}, ColorOf(state), 2);
    Write(legend, name, {x + 16, 3 * kLine_px - 4}, grey);
    x += WidthOf(name) + 30;
  }
}

}  // namespace

cv::Mat DrawDynamics(const DynamicsView& view) {
  const int width = view.color.cols + view.color.cols % 2,
            height = view.color.rows + kLegendLines * kLine_px + 4;
  cv::Mat canvas(height + height % 2, width, CV_8UC3, cv::Scalar::all(24));
  cv::Mat image = canvas(cv::Rect(0, 0, view.color.cols, view.color.rows));
  if (view.color.channels() == 1) {
    cv::cvtColor(view.color, image, cv::COLOR_GRAY2BGR);
  } else {
    view.color.copyTo(image);
  }
  TintMask(view.result.mask, image);
  DrawPoints(view, image);
  for (const DynamicObject& object : view.result.objects) DrawObject(object, image);
  DrawLegend(view, canvas.rowRange(view.color.rows, canvas.rows));
  return canvas;
}

}  // namespace msf
