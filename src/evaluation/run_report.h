// The figures of a run.
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "evaluation/dynamics_summary.h"
#include "evaluation/evaluation.h"
#include "evaluation/run_results.h"

namespace msf {

// Successive frames in the same state.
struct StateSpan {
  std::string state;
  size_t first_frame = 0;
  size_t last_frame = 0;
  double start_s = 0;
  double end_s = 0;
};

struct TimingSummary {
  size_t num_frames = 0;  // that had this stage
  double mean_ms = 0, p50_ms = 0, p95_ms = 0, p99_ms = 0, max_ms = 0;
};

struct RunReport {
  std::string name;
  std::string mode;
  size_t num_frames = 0;
  size_t num_poses = 0;
  std::map<std::string, size_t> frames_per_state;
  std::vector<StateSpan> spans;
  size_t num_keyframes = 0, num_points = 0, num_maps = 0, num_loops = 0, num_merges = 0;
  std::map<std::string, TimingSummary> timings;  // by stage
  double wall_time_s = 0, time_to_first_pose_s = 0;
  ProcessUsage usage;
  bool interrupted = false;
  std::vector<std::string> warnings;
  std::optional<DynamicsSummary> dynamics;  // empty in mode off
  std::optional<Evaluation> evaluation;
  std::string evaluation_problem;  // why there is none although there should be

  double Coverage() const {
    return num_frames == 0 ? 0 : static_cast<double>(num_poses) / static_cast<double>(num_frames);
  }
};

RunReport MakeRunReport(const RunResults& results);

// The content of report.json.
nlohmann::json RunReportToJson(const RunReport& report);

// A screenful for the user: coverage, errors, map, times.
std::string FormatRunReport(const RunReport& report);

}  // namespace msf
