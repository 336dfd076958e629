#include "detection/detection.h"

#include <algorithm>

namespace msf {
namespace {

// More candidates than this come from a network that cannot tell objects from background.
constexpr size_t kMaxCandidates = 30000;

}  // namespace

float IntersectionOverUnion(const ImageBox& a, const ImageBox& b) {
  const ImageBox common{std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1),
                        std::min(a.y1, b.y1)};
  const float both = a.area() + b.area() - common.area();
  return both > 0 ? common.area() / both : 0;
}

std::vector<Detection> SuppressOverlaps(std::vector<Detection> detections, float max_iou,
                                        size_t max_count) {
  std::stable_sort(detections.begin(), detections.end(),
                   [](const Detection& a, const Detection& b) { return a.score > b.score; });
  if (detections.size() > kMaxCandidates) detections.resize(kMaxCandidates);
  std::vector<Detection> kept;
  for (const Detection& candidate : detections) {
    if (kept.size() == max_count) break;
    const bool covered = std::any_of(kept.begin(), kept.end(), [&](const Detection& better) {
      return better.class_id == candidate.class_id &&
             IntersectionOverUnion(better.box, candidate.box) > max_iou;
    });
    if (!covered) kept.push_back(candidate);
  }
  return kept;
}

}  // namespace msf
