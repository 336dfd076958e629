#include "evaluation/dynamics_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>

#include "evaluation/statistics.h"

namespace msf {
namespace {

constexpr int kNumOtherColumns = 3;  // mask_share, detection_age, objects

void SummarizeAges(const std::vector<double>& ages, DynamicsSummary& summary) {
  if (!ages.empty()) {
    summary.age_p50 = Percentile(ages, 0.5);
    summary.age_p95 = Percentile(ages, 0.95);
    summary.age_max = Percentile(ages, 1);
  }
  if (!summary.detector) return;
  const auto fresh = std::count_if(ages.begin(), ages.end(),
                                   [](double age) { return age <= DynamicsSummary::kStaleFrames; });
  summary.stale_share = 1 - static_cast<double>(fresh) / static_cast<double>(summary.num_frames);
}

}  // namespace

double DynamicsSummary::PointShare(PointReason reason) const {
  const int64_t all = std::accumulate(points.begin(), points.end(), int64_t{0});
  return all == 0
             ? 0
             : static_cast<double>(points[static_cast<size_t>(reason)]) / static_cast<double>(all);
}

std::vector<std::string> DynamicsSummary::Warnings() const {
  constexpr double kWorthSaying = 0.05;
  std::vector<std::string> warnings;
  if (!detector) return warnings;
  if (detector->num_failed > 0) {
    warnings.push_back(fmt::format("the detector failed on {} of {} frames; the first: {}",
                                   detector->num_failed, detector->num_detected,
                                   detector->first_failure));
  }
  if (stale_share > kWorthSaying) {
    warnings.push_back(fmt::format(
        "the detector fell behind: {:.0f} % of the frames had detections older than {} frames or "
        "none yet ({:.0f} ms per detection)",
        100 * stale_share, kStaleFrames, detector->mean_ms));
  }
  return warnings;
}

std::optional<DynamicsSummary> SummarizeDynamics(const RunResults& results) {
  DynamicsSummary summary;
  summary.mode = results.dynamic_mode;
  summary.detector = results.detector;
  std::vector<double> ages;
  for (const FrameRecord& frame : results.frames) {
    if (!frame.dynamics) continue;
    const DynamicsRecord& record = *frame.dynamics;
    ++summary.num_frames;
    for (int i = 0; i < kNumPointReasons; ++i) summary.points[i] += record.points[i];
    summary.mean_mask_share += record.mask_share;
    summary.max_mask_share = std::max(summary.max_mask_share, record.mask_share);
    summary.mean_objects += record.num_objects;
    if (record.detection_age >= 0) ages.push_back(record.detection_age);
  }
  if (summary.num_frames == 0) return std::nullopt;
  summary.mean_mask_share /= static_cast<double>(summary.num_frames);
  summary.mean_objects /= static_cast<double>(summary.num_frames);
  SummarizeAges(ages, summary);
  return summary;
}

nlohmann::json DynamicsToJson(const DynamicsSummary& summary) {
  nlohmann::json counts = nlohmann::json::object(), shares = nlohmann::json::object();
  for (int i = 0; i < kNumPointReasons; ++i) {
    const auto reason = static_cast<PointReason>(i);
    counts[ToString(reason)] = summary.points[i];
    shares[ToString(reason)] = summary.PointShare(reason);
  }
  nlohmann::json json = {
      {"mode", summary.mode},
      {"frames", summary.num_frames},
      {"points", std::move(counts)},
      {"point_share", std::move(shares)},
      {"mask_share", {{"mean", summary.mean_mask_share}, {"max", summary.max_mask_share}}},
      {"objects_per_frame", summary.mean_objects},
      {"detector", nlohmann::json()}};
  if (summary.detector) {
    const DetectorRecord& detector = *summary.detector;
    json["detector"] = {
        {"description", detector.description},
        {"frames_detected", detector.num_detected},
        {"frames_failed", detector.num_failed},
        {"first_failure", detector.first_failure},
        {"mean_ms", detector.mean_ms},
        {"age_frames",
         {{"p50", summary.age_p50}, {"p95", summary.age_p95}, {"max", summary.age_max}}},
        {"stale_share", summary.stale_share}};
  }
  return json;
}

std::string FormatDynamics(const DynamicsSummary& summary) {
  std::string text = fmt::format("dynamic      {}: ", summary.mode);
  const char* separator = "";
  for (int i = 0; i < kNumPointReasons; ++i) {
    const auto reason = static_cast<PointReason>(i);
    if (summary.points[i] == 0 && reason != PointReason::kStatic) continue;
    text +=
        fmt::format("{}{:.1f} % {}", separator, 100 * summary.PointShare(reason), ToString(reason));
    separator = ", ";
  }
  text += fmt::format(
      " points; masks cover {:.1f} % (at most {:.0f} %), {:.1f} objects per frame\n",
      100 * summary.mean_mask_share, 100 * summary.max_mask_share, summary.mean_objects);
  if (!summary.detector) return text + "detector     none\n";
  return text + fmt::format(
                    "detector     {}: {} frames, {:.1f} ms each, detections {:.0f} frames old (p95 "
                    "{:.0f}, max {:.0f})\n",
                    summary.detector->description, summary.detector->num_detected,
                    summary.detector->mean_ms, summary.age_p50, summary.age_p95, summary.age_max);
}

std::string DynamicsCsvHeader() {
  std::string header;
  for (int i = 0; i < kNumPointReasons; ++i)
    header += fmt::format(",points_{}", ToString(static_cast<PointReason>(i)));
  return header + ",mask_share,detection_age,objects";
}

std::string DynamicsCsvCells(const DynamicsRecord* record) {
  if (record == nullptr) return std::string(kNumPointReasons + kNumOtherColumns, ',');
  std::string cells;
  for (const int count : record->points) cells += fmt::format(",{}", count);
  cells += fmt::format(",{:.4f},", record->mask_share);
  if (record->detection_age >= 0) cells += std::to_string(record->detection_age);
  return cells + fmt::format(",{}", record->num_objects);
}

}  // namespace msf
