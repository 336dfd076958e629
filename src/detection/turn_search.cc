#include "detection/turn_search.h"

#include <fmt/format.h>

#include <algorithm>

namespace msf {
namespace {

constexpr double kTurns_deg[] = {30, -30, 60, -60, 90, -90};
// Weaker detections say nothing about which way is up.
constexpr float kLeastEvidence = 0.2f;
// What another view has to show beyond the upright one, since most pictures are upright: about one
// object more that is found with some certainty.
constexpr double kTurnedMargin = 0.4;

// Of the detections that are reported and those that speak for a view.
double LeastWanted(double confidence) { return std::min<double>(confidence, kLeastEvidence); }

double EvidenceOf(const Detections& detections) {
  double sum = 0;
  for (const Detection& object : detections.objects) {
    if (object.score > kLeastEvidence) sum += object.score * object.score;
  }
  return sum;
}

}  // namespace

TurnSearch::TurnSearch(std::unique_ptr<Detector> detector, double confidence)
    : Detector(detector->class_names(), detector->input_size(),
               fmt::format("{}, {} ways up", detector->description(), std::size(kTurns_deg) + 1)),
      detector_(std::move(detector)),
      confidence_(confidence) {
  detector_->set_confidence(LeastWanted(confidence));
}

void TurnSearch::set_confidence(double confidence) {
  confidence_ = confidence;
  detector_->set_confidence(LeastWanted(confidence));
}

StatusOr<Detections> TurnSearch::DetectInImage(const cv::Mat& image) {
  StatusOr<Detections> best = detector_->DetectInImage(image);
  if (!best.ok()) return best;
  double most = EvidenceOf(*best) + kTurnedMargin;
  for (const double turn_deg : kTurns_deg) {
    StatusOr<Detections> turned = detector_->DetectTurned(image, turn_deg * CV_PI / 180);
    if (!turned.ok()) return turned;
    const double evidence = EvidenceOf(*turned);
    if (evidence <= most) continue;
    most = evidence;
    best = std::move(turned);
  }
  std::erase_if(best->objects, [this](const Detection& d) { return d.score < confidence_; });
  return best;
}

}  // namespace msf
