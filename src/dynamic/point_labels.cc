#include "dynamic/point_labels.h"

namespace msf {

const char* ToString(PointReason reason) {
  switch (reason) {
    case PointReason::kStatic:
      return "static";
    case PointReason::kBox:
      return "box";
    case PointReason::kObject:
      return "object";
    case PointReason::kFlow:
      return "flow";
    case PointReason::kDepth:
      return "depth";
    case PointReason::kSettled:
      return "settled";
    case PointReason::kReadmitted:
      return "readmitted";
    case PointReason::kKnown:
      return "known";
  }
  return "unknown";
}

std::array<int, kNumPointReasons> PointLabels::Counts() const {
  std::array<int, kNumPointReasons> counts{};
  for (const PointReason why : reason) ++counts[static_cast<std::size_t>(why)];
  return counts;
}

}  // namespace msf
