// What the tests of DynamicFilter share: a filter, a thing before a wall, and what is said about
// it.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "dynamic/dynamic_filter.h"
#include "dynamic/test_scene.h"

namespace msf {

inline const cv::Rect kThing_px(240, 120, 128, 240);
inline constexpr int kPerson = 0, kChair = 1, kLamp = 2;

inline std::unique_ptr<DynamicFilter> MakeFilter(const DynamicOptions& options) {
  StatusOr<std::unique_ptr<DynamicFilter>> filter =
      DynamicFilter::Create(options, *TestCamera(), TestLevels(), {"person", "chair", "lamp"}, 1);
  EXPECT_TRUE(filter.ok());
  return *std::move(filter);
}

inline DynamicOptions Mode(const std::string& mode) {
  DynamicOptions options;
  options.mode = mode;
  return options;
}

inline cv::Rect Shifted(const cv::Rect& rect, int x_px) { return rect + cv::Point(x_px, 0); }

inline ImageBox BoxOf(const cv::Rect& rect, float margin_px = 0) {
  return {static_cast<float>(rect.x) - margin_px, static_cast<float>(rect.y) - margin_px,
          static_cast<float>(rect.br().x) + margin_px, static_cast<float>(rect.br().y) + margin_px};
}

inline Detections Found(int frame, const std::vector<Detection>& objects) {
  Detections found;
  found.frame = FrameId(frame);
  found.objects = objects;
  return found;
}

struct Seen {
  FrameFeatures features;
  DynamicResult result;
  const PointLabels& labels() const { return result.labels; }

  // Share of the points of reason `why` among those inside `box` (outside when `inside` is false).
  double ShareOf(PointReason why, const ImageBox& box, bool inside = true) const {
    int count = 0, all = 0;
    for (int i = 0; i < features.size(); ++i) {
      const Eigen::Vector2f& px = features.image_px[i];
      if (box.Contains(px.x(), px.y()) != inside) continue;
      ++all;
      count += result.labels.reason[i] == why;
    }
    return static_cast<double>(count) / all;
  }
};

inline Seen Classify(DynamicFilter& filter, const RgbdFrame& frame,
                     const Detections* detections = nullptr, const Rigid3d& T_last_now = {}) {
  Seen seen;
  seen.features = GridFeatures(frame);
  seen.result = filter.Classify(frame, seen.features, T_last_now, detections);
  filter.TakePose(Rigid3d(), true, {});
  return seen;
}

inline const DynamicObject* FindPerson(const DynamicResult& result) {
  for (const DynamicObject& object : result.objects) {
    if (object.name == "person") return &object;
  }
  return nullptr;
}

}  // namespace msf
