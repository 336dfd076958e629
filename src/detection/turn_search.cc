#include "detection/turn_search.h"

#include <fmt/format.h>

#include <algorithm>

#include "detection/mirror_average.h"

namespace msf {
namespace {

constexpr double kTurns_deg[] = {30, -30, 60, -60, 90, -90};
// Then on both sides of the best of these views.
constexpr double kFineTurns_deg[] = {-15, 15};
// Weaker detections say nothing about which way is up.
constexpr float kLeastEvidence = 0.2f;
// What another view has to show beyond the upright one, since most pictures are upright: about one
// object more that is found with some certainty.
constexpr double kTurnedMargin = 0.4;

double EvidenceOf(const Detections& detections) {
  double sum = 0;
  for (const Detection& object : detections.objects) {
    if (object.score > kLeastEvidence) sum += object.score * object.score;
  }
  return sum;
}

}  // namespace

TurnSearch::TurnSearch(std::unique_ptr<Detector> detector, double confidence, bool mirrored)
    : Detector(detector->class_names(), detector->input_size(),
               fmt::format("{}, {} ways up{}", detector->description(),
                           std::size(kTurns_deg) + std::size(kFineTurns_deg) + 1,
                           mirrored ? ", also mirrored" : "")),
      detector_(std::move(detector)),
      mirrored_(mirrored) {
  TurnSearch::set_confidence(confidence);
}

void TurnSearch::set_confidence(double confidence) {
  confidence_ = confidence;
  // Weaker ones than are reported speak for a view and count in averages.
  detector_->set_confidence(
      std::min(confidence, mirrored_ ? kLeastAveragedScore : double{kLeastEvidence}));
}

StatusOr<Detections> TurnSearch::DetectInImage(const cv::Mat& image) {
  StatusOr<View> view = FindView(image);
  if (!view.ok()) return view.status();
  Detections found = std::move(view->detections);
  if (mirrored_) {
    StatusOr<Detections> in_mirror = detector_->DetectMirrored(image, view->turn_rad);
    if (!in_mirror.ok()) return in_mirror;
    found.objects = AverageDetections(found.objects, std::move(in_mirror->objects));
  }
  std::erase_if(found.objects, [this](const Detection& d) { return d.score < confidence_; });
  return found;
}

StatusOr<TurnSearch::View> TurnSearch::FindView(const cv::Mat& image) {
  StatusOr<Detections> upright = detector_->DetectInImage(image);
  if (!upright.ok()) return upright.status();
  View best{0, *std::move(upright)};
  double most = EvidenceOf(best.detections) + kTurnedMargin;
  const auto try_turn = [&](double turn_deg) -> Status {
    const double turn_rad = turn_deg * CV_PI / 180;
    StatusOr<Detections> turned = detector_->DetectTurned(image, turn_rad);
    if (!turned.ok()) return turned.status();
    const double evidence = EvidenceOf(*turned);
    if (evidence > most) {
      most = evidence;
      best = {turn_rad, *std::move(turned)};
    }
    return Status::Ok();
  };
  for (const double turn_deg : kTurns_deg) MSF_RETURN_IF_ERROR(try_turn(turn_deg));
  const double coarse_deg = best.turn_rad * 180 / CV_PI;
  for (const double fine_deg : kFineTurns_deg) MSF_RETURN_IF_ERROR(try_turn(coarse_deg + fine_deg));
  return best;
}

}  // namespace msf
