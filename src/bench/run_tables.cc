// The tables that are about all runs: overview, variants, run time (table 8).
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>

#include "bench/paper_tables.h"
#include "bench/table_cells.h"

namespace msf {
namespace {

// The repeats that have a time.
std::optional<Spread> TimeOf(const Runs& runs,
                             const std::function<std::optional<double>(const TaskTiming&)>& time) {
  return SpreadOf(runs, [&](const TaskResult& r) -> std::optional<double> {
    if (!r.ok() || r.timing.wall_time_s <= 0 || r.num_frames == 0) return std::nullopt;
    return time(r.timing);
  });
}

std::optional<Spread> TimeOf(const Runs& runs, double TaskTiming::*time) {
  return TimeOf(runs, [time](const TaskTiming& t) -> std::optional<double> {
    return t.*time > 0 ? std::optional(t.*time) : std::nullopt;
  });
}

// ATE over that of the baseline where nobody moves.
std::string OverCalm(const BenchResults& results, const SuiteSequence& sequence, const Runs& runs) {
  if (sequence.calm.empty()) return "";
  const auto calm = SpreadOf(results.Of(sequence.calm, results.suite.baseline), AteOf());
  const auto own = SpreadOf(runs, AteOf());
  return calm && own ? fmt::format("{:.2f}", own->median / calm->median) : "";
}

std::vector<Cell> OverviewRow(const BenchResults& results, const SuiteSequence& sequence,
                              const std::string& variant, const std::string& mode) {
  const Runs runs = results.Of(sequence.name, variant);
  const auto error = [&](std::optional<ErrorFigures> TaskResult::*e) {
    return FormatMedian(SpreadOf(runs, FigureOf(e, &ErrorFigures::rmse)), 4);
  };
  return {sequence.name,
          variant,
          mode,
          FormatRuns(runs),
          FormatMedian(SpreadOf(runs, AteOf()), 4),
          FormatRange(SpreadOf(runs, AteOf()), 4),
          OverCalm(results, sequence, runs),
          error(&TaskResult::rpe_frame_m),
          error(&TaskResult::rpe_second_m),
          FormatCoverage(runs),
          FormatMedian(SpreadOf(runs, KeptOf), 1, kPercent),
          FormatMedian(SpreadOf(runs, RemovedOf), 1, kPercent)};
}

std::vector<Cell> RuntimeRow(const std::string& sequence, const SuiteVariant& variant,
                             const std::string& mode, const Runs& runs) {
  const auto frames = SpreadOf(runs, [](const TaskResult& r) -> std::optional<double> {
    return r.ok() && r.timing.wall_time_s > 0
               ? std::optional(static_cast<double>(r.num_frames) / r.timing.wall_time_s)
               : std::nullopt;
  });
  const auto cores = TimeOf(runs, [](const TaskTiming& t) -> std::optional<double> {
    return 100 * t.cpu_time_s / t.wall_time_s;
  });
  const auto rate = TimeOf(runs, [](const TaskTiming& t) -> std::optional<double> {
    return t.detections > 0 ? std::optional(t.detections / t.wall_time_s) : std::nullopt;
  });
  const auto age = TimeOf(runs, [](const TaskTiming& t) -> std::optional<double> {
    return t.detections > 0 ? std::optional(t.age_p50_frames) : std::nullopt;
  });
  const auto energy = TimeOf(runs, [](const TaskTiming& t) { return t.energy_j; });
  return {sequence,
          "measured",
          variant.name,
          mode,
          FormatMedian(TimeOf(runs, &TaskTiming::p50_ms), 1),
          FormatMedian(TimeOf(runs, &TaskTiming::p95_ms), 1),
          FormatMedian(TimeOf(runs, &TaskTiming::p99_ms), 1),
          FormatMedian(frames, 1),
          FormatMedian(cores, 0),
          FormatMedian(TimeOf(runs, &TaskTiming::peak_memory_mb), 0),
          FormatMedian(rate, 1),
          FormatMedian(TimeOf(runs, &TaskTiming::detector_ms), 1),
          FormatMedian(age, 0),
          energy ? FormatMedian(energy, 0) : (mode == "realtime" ? "not available" : ""),
          FormatCoverage(runs)};
}

}  // namespace

Table OverviewTable(const BenchResults& results) {
  Table table{
      "overview",
      "All variants",
      fmt::format(
          "RMSE, medians over the runs that gave a trajectory; coverage: the lowest. / calm: "
          "ATE over that of {} on the same path without people. Kept and removed: of the "
          "points on what stands still and on what moves, against true masks.",
          results.suite.baseline),
      {},
      {"Sequence", "Variant", "Mode", "Runs", "ATE [m]", "min-max", "/ calm", "RPE 1 frame [m]",
       "RPE 1 s [m]", "Coverage", "kept %", "removed %"},
      {},
      4};
  for (const SuiteSequence& sequence : results.suite.sequences) {
    for (const SuiteVariant& variant : results.suite.variants) {
      if (!results.Of(sequence.name, variant.name).empty())
        table.rows.push_back(
            OverviewRow(results, sequence, variant.name, ModeOf(results.suite, variant)));
    }
    for (const std::string& peer : results.peers) {
      if (!results.Of(sequence.name, peer).empty())
        table.rows.push_back(OverviewRow(results, sequence, peer, "peer"));
    }
  }
  return table;
}

Table VariantTable(const BenchResults& results) {
  Table table{
      "variants",
      "Variants",
      "Options as given to msf-slam run; all others have their defaults. config.yaml beside "
      "each run has every option.",
      {},
      {"Variant", "Options", "About"},
      {},
      3};
  for (const SuiteVariant& variant : results.suite.variants) {
    const auto& tasks = results.plan.tasks;
    const auto task = std::find_if(tasks.begin(), tasks.end(), [&](const Task& t) {
      return t.variant == variant.name && !t.is_detector;
    });
    if (task == tasks.end()) continue;
    std::string options = fmt::format("{}", fmt::join(task->arguments, " "));
    if (!variant.program.empty()) options = fmt::format("{}: {}", variant.program, options);
    table.rows.push_back({variant.name, options, variant.about});
  }
  return table;
}

Table RuntimeTable(const BenchResults& results, const PublishedFigures& published) {
  Table table{
      "table8",
      "Table 8: run time",
      "Latency: from a frame's arrival in the system to its pose, all stages, without "
      "reading the images. fps: frames over the time of the whole run (at most the camera's "
      "rate in real time). CPU: 100 % is one processor. Energy: of the processor over the "
      "whole run (RAPL), only for runs in real time, which have the machine for themselves. "
      "The published figures of the laptop equal those of the detector alone.",
      {},
      {"Sequence", "Source", "System", "Mode", "median [ms]", "p95", "p99", "fps", "CPU %",
       "memory [MB]", "detections/s", "ms each", "age [frames]", "energy [J]", "Coverage"},
      {},
      4};
  for (const PublishedRuntime& p : published.runtime) {
    table.rows.push_back({{"", true},
                          {"published", true},
                          {p.system, true},
                          {p.machine, true},
                          PublishedNumber(p.latency_ms, 1),
                          "",
                          "",
                          PublishedNumber(p.fps, 1),
                          "",
                          PublishedNumber(p.memory_mb, 0),
                          "",
                          "",
                          "",
                          "",
                          ""});
  }
  for (const SuiteSequence& sequence : results.suite.sequences) {
    for (const SuiteVariant& variant : results.suite.variants) {
      const Runs runs = results.Of(sequence.name, variant.name);
      if (!runs.empty())
        table.rows.push_back(
            RuntimeRow(sequence.name, variant, ModeOf(results.suite, variant), runs));
    }
  }
  return table;
}

}  // namespace msf
