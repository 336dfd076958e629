// The tables that are about more than trajectories: overview, thresholds, detectors, run time.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>

#include "bench/paper_tables.h"
#include "bench/repeats.h"

namespace msf {
namespace {

using Runs = std::vector<const TaskResult*>;

Cell PublishedNumber(double value, int decimals, double unit = 1) {
  return {value == 0 ? "" : fmt::format("{:.{}f}", value / unit, decimals), true};
}

constexpr double kPercent = 0.01;

std::optional<double> KeptOf(const TaskResult& r) { return r.static_kept; }
std::optional<double> RemovedOf(const TaskResult& r) { return r.dynamic_removed; }

auto Ate() { return FigureOf(&TaskResult::ate_m, &ErrorFigures::rmse); }

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
  const auto calm = SpreadOf(results.Of(sequence.calm, results.suite.baseline), Ate());
  const auto own = SpreadOf(runs, Ate());
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
          FormatMedian(SpreadOf(runs, Ate()), 4),
          FormatRange(SpreadOf(runs, Ate()), 4),
          OverCalm(results, sequence, runs),
          error(&TaskResult::rpe_frame_m),
          error(&TaskResult::rpe_second_m),
          FormatCoverage(runs),
          FormatMedian(SpreadOf(runs, KeptOf), 1, kPercent),
          FormatMedian(SpreadOf(runs, RemovedOf), 1, kPercent)};
}

// The variants of one mode that differ in L, by L.
std::vector<std::pair<double, std::string>> Thresholds(const Suite& suite,
                                                       const std::string& dynamic) {
  std::vector<std::pair<double, std::string>> thresholds;
  for (const SuiteVariant& variant : suite.variants) {
    if (variant.threshold_px > 0 && variant.dynamic == dynamic)
      thresholds.emplace_back(variant.threshold_px, variant.name);
  }
  std::sort(thresholds.begin(), thresholds.end());
  return thresholds;
}

void AddThresholdCells(const BenchResults& results, const std::string& sequence, double threshold,
                       const std::string& dynamic, std::vector<Cell>& row) {
  Runs runs;
  for (const auto& [value, variant] : Thresholds(results.suite, dynamic)) {
    if (value == threshold) runs = results.Of(sequence, variant);
  }
  row.emplace_back(FormatMedian(SpreadOf(runs, Ate()), 4));
  row.emplace_back(FormatMedian(SpreadOf(runs, KeptOf), 1, kPercent));
  row.emplace_back(FormatMedian(SpreadOf(runs, RemovedOf), 1, kPercent));
  row.emplace_back(FormatCoverage(runs));
}

Table ThresholdTable(const BenchResults& results, const PublishedFigures& published,
                     const SuiteSequence& sequence) {
  Table table{
      "table1_" + sequence.name,
      "Table 1: sensitivity to the motion threshold L, " + sequence.name,
      "In italics: as published, on the real " + published.threshold_sequence +
          ". Kept and removed: shares of the points on what stands still and on what moves, "
          "against true masks where the sequence has them. Mode paper tests the raw flow, "
          "mode full the flow that the camera's motion does not explain.",
      {{"", 1}, {"published", 3}, {"measured, mode paper", 4}, {"measured, mode full", 4}},
      {"L [px]", "ATE RMSE", "static kept %", "dynamic removed %"},
      {}};
  for (int i = 0; i < 2; ++i) {
    for (const char* column : {"ATE RMSE", "static kept %", "dynamic removed %", "Coverage"})
      table.columns.emplace_back(column);
  }
  std::vector<double> values;
  for (const PublishedThreshold& row : published.threshold) values.push_back(row.threshold_px);
  for (const char* dynamic : {"paper", "full"}) {
    for (const auto& [value, variant] : Thresholds(results.suite, dynamic)) values.push_back(value);
  }
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  for (const double value : values) {
    std::vector<Cell> row = {fmt::format("{:g}", value)};
    PublishedThreshold theirs;
    for (const PublishedThreshold& p : published.threshold) {
      if (p.threshold_px == value) theirs = p;
    }
    row.push_back(PublishedNumber(theirs.ate_rmse_m, 4));
    row.push_back(PublishedNumber(theirs.static_kept, 1, kPercent));
    row.push_back(PublishedNumber(theirs.dynamic_removed, 1, kPercent));
    for (const char* dynamic : {"paper", "full"})
      AddThresholdCells(results, sequence.name, value, dynamic, row);
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::vector<Cell> DetectorRow(const TaskResult& result) {
  if (!result.detector) return {result.variant, "measured", result.status, "", "", "", "", "", ""};
  const DetectorFigures& d = *result.detector;
  const auto percent = [](double share) { return fmt::format("{:.1f}", share / kPercent); };
  return {
      result.variant,
      "measured",
      percent(d.precision),
      percent(d.recall),
      percent(d.map50),
      percent(d.map50_95),
      fmt::format("{:.2f}", d.parameters_m),
      fmt::format("{:.1f}", d.gflops),
      result.timing.detector_ms > 0 ? fmt::format("{:.1f}", 1000 / result.timing.detector_ms) : ""};
}

std::vector<Cell> PublishedDetectorRow(const PublishedDetector& d) {
  return {{d.model, true},
          {"published", true},
          PublishedNumber(d.precision, 1, kPercent),
          PublishedNumber(d.recall, 1, kPercent),
          PublishedNumber(d.map50, 1, kPercent),
          PublishedNumber(d.map50_95, 1, kPercent),
          PublishedNumber(d.parameters_m, 2),
          PublishedNumber(d.gflops, 1),
          PublishedNumber(d.fps, 1)};
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
      "RMSE, medians over the runs that gave a trajectory; coverage: the lowest. / calm: ATE "
      "over that of " +
          results.suite.baseline +
          " on the same path without people. Kept and removed: of the points on what stands "
          "still and on what moves, against true masks.",
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
    if (!variant.program.empty()) options = variant.program + ": " + options;
    table.rows.push_back({variant.name, options, variant.about});
  }
  return table;
}

std::vector<Table> ThresholdTables(const BenchResults& results, const PublishedFigures& published) {
  std::vector<Table> tables;
  for (const SuiteSequence& sequence : results.suite.sequences) {
    const auto has_threshold = [&](const SuiteVariant& variant) {
      return variant.threshold_px > 0 && !results.Of(sequence.name, variant.name).empty();
    };
    const auto& variants = results.suite.variants;
    if (std::any_of(variants.begin(), variants.end(), has_threshold))
      tables.push_back(ThresholdTable(results, published, sequence));
  }
  return tables;
}

std::vector<Table> DetectorTables(const BenchResults& results, const PublishedFigures& published) {
  std::vector<std::vector<Cell>> measured;
  for (const TaskResult& result : results.results) {
    if (result.id.starts_with("detectors/")) measured.push_back(DetectorRow(result));
  }
  if (measured.empty()) return {};
  const DetectorData& data = results.suite.detector_data;
  const std::string note = fmt::format(
      "In italics: as published, on all of VOC2007 at 640x640 and on a GPU. Measured: {}{} at {}, "
      "on "
      "one thread of this CPU; parameters and GFLOPs (2 per multiply-add) at 640x640.",
      data.limit > 0 ? fmt::format("the first {} test images of ", data.limit) : "", data.folder,
      data.size);
  const std::vector<std::string> columns = {"Model",      "Source",     "P %",    "R %", "mAP50 %",
                                            "mAP50-95 %", "params [M]", "GFLOPs", "FPS"};
  Table three{"table3", "Table 3: the detector with and without MSFConv", note, {}, columns, {}, 2};
  Table four{"table4", "Table 4: the detector against other necks", note, {}, columns, {}, 2};
  for (size_t i = 0; i < published.detectors.size(); ++i) {
    const std::vector<Cell> row = PublishedDetectorRow(published.detectors[i]);
    if (i < 2) three.rows.push_back(row);
    four.rows.push_back(row);
  }
  for (Table* table : {&three, &four})
    table->rows.insert(table->rows.end(), measured.begin(), measured.end());
  return {three, four};
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
