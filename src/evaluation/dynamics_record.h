// What the filter of dynamic points did, frame by frame and as a whole.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "dynamic/dynamic_filter.h"

namespace msf {

struct DynamicsRecord {
  std::array<int, kNumPointReasons> points{};  // features by PointReason
  double mask_share = 0;                       // of the image
  int detection_age =
      -1;               // frames since the one that the newest detections belong to; -1: none yet
  int num_objects = 0;  // followed, whether their points are removed or not
};

inline DynamicsRecord MakeDynamicsRecord(const DynamicResult& result) {
  return {result.labels.Counts(), result.mask_share, result.detection_age,
          static_cast<int>(result.objects.size())};
}

// How the detector did over a whole run.
struct DetectorRecord {
  std::string description;
  int64_t num_detected = 0;  // frames that went through it
  int64_t num_failed = 0;    // of them, those on which it failed
  std::string first_failure;
  double mean_ms = 0;  // per frame
};

}  // namespace msf
