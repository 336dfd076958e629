#include "detection/mirror_average.h"

#include <algorithm>

namespace msf {
namespace {

// Two boxes that overlap less are of two objects.
constexpr float kLeastIou = 0.5F;

ImageBox Blend(const ImageBox& a, const ImageBox& b, float share_of_b) {
  const auto blend = [share_of_b](float x, float y) { return x + share_of_b * (y - x); };
  return {blend(a.x0, b.x0), blend(a.y0, b.y0), blend(a.x1, b.x1), blend(a.y1, b.y1)};
}

Detection Average(const Detection& a, const Detection& b) {
  const float sum = a.score + b.score;
  return {a.class_id, sum / 2, Blend(a.box, b.box, sum > 0 ? b.score / sum : 0.5F)};
}

Detection SeenOnce(Detection d) {
  d.score /= 2;
  return d;
}

// The best one (they are sorted) of the same class in the same place, or the end. Not the one that
// overlaps most: that may be a weak second box of the same object.
std::vector<Detection>::iterator FindSame(std::vector<Detection>& others, const Detection& d) {
  return std::find_if(others.begin(), others.end(), [&d](const Detection& other) {
    return other.class_id == d.class_id && IntersectionOverUnion(other.box, d.box) >= kLeastIou;
  });
}

}  // namespace

std::vector<Detection> AverageDetections(const std::vector<Detection>& first,
                                         std::vector<Detection> second) {
  std::vector<Detection> averaged;
  for (const Detection& d : first) {
    const auto same = FindSame(second, d);
    if (same == second.end()) {
      averaged.push_back(SeenOnce(d));
      continue;
    }
    averaged.push_back(Average(d, *same));
    second.erase(same);
  }
  for (const Detection& d : second) averaged.push_back(SeenOnce(d));
  std::stable_sort(averaged.begin(), averaged.end(),
                   [](const Detection& a, const Detection& b) { return a.score > b.score; });
  return averaged;
}

MirrorAverage::MirrorAverage(std::unique_ptr<Detector> detector, double confidence)
    : Detector(detector->class_names(), detector->input_size(),
               detector->description() + ", also mirrored"),
      detector_(std::move(detector)) {
  MirrorAverage::set_confidence(confidence);
}

void MirrorAverage::set_confidence(double confidence) {
  confidence_ = confidence;
  detector_->set_confidence(std::min(confidence, kLeastAveragedScore));
}

StatusOr<Detections> MirrorAverage::DetectInImage(const cv::Mat& image) {
  StatusOr<Detections> found = detector_->DetectInImage(image);
  if (!found.ok()) return found;
  StatusOr<Detections> in_mirror = detector_->DetectMirrored(image, 0);
  if (!in_mirror.ok()) return in_mirror;
  found->objects = AverageDetections(found->objects, std::move(in_mirror->objects));
  std::erase_if(found->objects, [this](const Detection& d) { return d.score < confidence_; });
  return found;
}

}  // namespace msf
