// A finished run read back from its folder, for the figures.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "bench/bench_run.h"
#include "evaluation/evaluation.h"
#include "util/status.h"

namespace msf {

// A row of frames.csv.
struct FrameRow {
  double time_s = 0;
  std::string state;
  std::optional<double> latency_ms;
  std::optional<double> static_share;  // of its points
};
StatusOr<std::vector<FrameRow>> ReadFramesCsv(const std::filesystem::path& file);

struct RunRecord {
  std::string variant;
  std::vector<FrameRow> frames;
  Trajectory truth;
  Evaluation evaluation;
};

// The runs of a sequence that its figures show: the baseline and ours, or, where the suite has
// neither, the first few variants; of several repeats the one with the median error. Runs without
// an evaluation are left out.
std::vector<RunRecord> LoadRuns(const std::filesystem::path& out, const BenchResults& results,
                                const SuiteSequence& sequence);

}  // namespace msf
