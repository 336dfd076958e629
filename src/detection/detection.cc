#include "detection/detection.h"

#include <algorithm>
#include <cmath>

namespace msf {
namespace {

// More candidates than this come from a network that cannot tell objects from background.
constexpr size_t kMaxCandidates = 30000;

// Applies the rule to what is weaker than `better`.
void LowerOverlapped(std::vector<Detection>& weaker, const Detection& better,
                     const OverlapRule& rule) {
  constexpr float kDropped = -1;
  for (Detection& d : weaker) {
    if (d.class_id != better.class_id) continue;
    const float iou = IntersectionOverUnion(better.box, d.box);
    if (iou <= 0) continue;
    if (rule.decay > 0) d.score *= std::exp(-iou * iou / rule.decay);
    if (iou > rule.max_iou || d.score < rule.min_score) d.score = kDropped;
  }
  std::erase_if(weaker, [](const Detection& d) { return d.score == kDropped; });
}

}  // namespace

float IntersectionOverUnion(const ImageBox& a, const ImageBox& b) {
  const ImageBox common{std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1),
                        std::min(a.y1, b.y1)};
  const float both = a.area() + b.area() - common.area();
  return both > 0 ? common.area() / both : 0;
}

std::vector<Detection> SuppressOverlaps(std::vector<Detection> detections,
                                        const OverlapRule& rule) {
  const auto weaker = [](const Detection& a, const Detection& b) { return a.score < b.score; };
  if (detections.size() > kMaxCandidates) {
    std::stable_sort(detections.begin(), detections.end(),
                     [&](const Detection& a, const Detection& b) { return weaker(b, a); });
    detections.resize(kMaxCandidates);
  }
  std::vector<Detection> kept;
  while (!detections.empty() && kept.size() < rule.max_count) {
    const auto best = std::max_element(detections.begin(), detections.end(), weaker);
    kept.push_back(*best);
    detections.erase(best);
    LowerOverlapped(detections, kept.back(), rule);
  }
  return kept;
}

}  // namespace msf
