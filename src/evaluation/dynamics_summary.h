// The figures of a run's filter of dynamic points.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "evaluation/run_results.h"

namespace msf {

struct DynamicsSummary {
  std::string mode;  // of the filter
  size_t num_frames = 0;
  std::array<int64_t, kNumPointReasons> points{};  // of all frames, by PointReason
  double mean_mask_share = 0, max_mask_share = 0;
  double mean_objects = 0;  // per frame
  // Age of the detections in frames, over the frames that had any; all 0 when none had.
  double age_p50 = 0, age_p95 = 0, age_max = 0;
  double stale_share =
      0;  // frames whose detections were older than kStaleFrames, or that had none yet
  std::optional<DetectorRecord> detector;

  // Detections that old may have been outrun by what they describe.
  static constexpr int kStaleFrames = 5;
  // Of all points; 0 without points.
  double PointShare(PointReason reason) const;
  // What the user should know about the detector, one sentence each.
  std::vector<std::string> Warnings() const;
};

// Nothing when no frame has a DynamicsRecord (mode off).
std::optional<DynamicsSummary> SummarizeDynamics(const RunResults& results);

nlohmann::json DynamicsToJson(const DynamicsSummary& summary);
// A few lines for the user.
std::string FormatDynamics(const DynamicsSummary& summary);

// Columns of frames.csv: names, and cells of one frame (empty cells for null), each with a leading
// comma.
std::string DynamicsCsvHeader();
std::string DynamicsCsvCells(const DynamicsRecord* record);

}  // namespace msf
