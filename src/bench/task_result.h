// What came out of one task: one JSON file.
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "bench/plan.h"
#include "util/status.h"

namespace msf {

// Of a set of errors; see Statistics.
struct ErrorFigures {
  double rmse = 0, std = 0, mean = 0, median = 0, max = 0;
};

// What depends on the machine and on what else it did.
struct TaskTiming {
  std::string started;                            // UTC, ISO 8601
  double wall_time_s = 0;                         // of the run, with reading its images
  double cpu_time_s = 0;                          // of all its threads
  double peak_memory_mb = 0;                      // largest resident size
  double p50_ms = 0, p95_ms = 0, p99_ms = 0;      // from a frame's arrival to its pose
  double detector_ms = 0;                         // per detection
  double detections = 0;                          // frames that went through the detector
  double age_p50_frames = 0, age_p95_frames = 0;  // of the detections that a frame had
  std::optional<double> energy_j;                 // of the processor, while nothing else ran
};

struct DetectorFigures {
  double precision = 0, recall = 0, map50 = 0, map50_95 = 0;  // shares
  double parameters_m = 0, gflops = 0;                        // at 640 x 640
};

struct TaskResult {
  std::string id, sequence, variant;
  int repeat = 0;
  std::string fingerprint;
  // ok; failed: a sentence of the program; crashed; timed_out; lost: nobody knows
  std::string status = "lost";
  std::string reason;  // why it is not ok
  // What a deterministic run repeats to the last bit.
  size_t num_frames = 0;
  std::optional<double> coverage;  // share of the frames that have a pose
  std::map<std::string, size_t> states;
  std::optional<ErrorFigures> ate_m, rpe_frame_m, rpe_frame_deg, rpe_second_m;
  std::optional<double> static_share;                  // of the points, by the filter
  std::optional<double> static_kept, dynamic_removed;  // shares, against true masks
  std::optional<DetectorFigures> detector;
  TaskTiming timing;

  bool ok() const { return status == "ok"; }
};

// A result that says no more than whose it is.
TaskResult EmptyResult(const Task& task);

// Fills in what report.json of a run says.
Status AddRunReport(const std::filesystem::path& report_file, TaskResult& result);

// Without, or only, what depends on the machine.
nlohmann::json ResultToJson(const TaskResult& result);
nlohmann::json TimingToJson(const TaskTiming& timing);
// Throws nlohmann::json::exception where a key is missing or of another type.
TaskResult ResultFromJson(const nlohmann::json& json);
TaskTiming TimingFromJson(const nlohmann::json& json);

Status WriteTaskResult(const std::filesystem::path& file, const TaskResult& result);
// Nothing when there is none, or it is no result.
std::optional<TaskResult> ReadTaskResult(const std::filesystem::path& file);

}  // namespace msf
