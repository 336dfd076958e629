#include "bench/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>
#include <utility>

#include "bench/repeats.h"
#include "bench/task_result.h"

namespace msf {
namespace {

namespace fs = std::filesystem;

// By sequence and variant.
using Runs = std::map<std::pair<std::string, std::string>, std::vector<TaskResult>>;

StatusOr<Runs> ReadResults(const fs::path& file, bool with_times) {
  Runs runs;
  const fs::path timing = file.parent_path() / "timing.json";
  std::error_code ignored;
  if (fs::is_directory(file, ignored))
    return Status::Error(file.string() + ": is a folder; name the results.json in it");
  try {
    std::ifstream stream(file);
    if (!stream) return Status::Error(file.string() + ": there is no such file");
    nlohmann::json times;
    if (with_times) {
      std::ifstream beside(timing);
      if (!beside || fs::is_directory(timing, ignored))
        return Status::Error(timing.string() + ": is not there, so times cannot be compared");
      times = nlohmann::json::parse(beside).at("tasks");
    }
    const nlohmann::json json = nlohmann::json::parse(stream);
    for (const nlohmann::json& task : json.at("tasks")) {
      TaskResult result = ResultFromJson(task);
      if (with_times) result.timing = TimingFromJson(times.at(result.id));
      runs[{result.sequence, result.variant}].push_back(std::move(result));
    }
  } catch (const nlohmann::json::exception& error) {
    return Status::Error(file.string() + ": holds no results of a bench: " + error.what());
  }
  return runs;
}

struct Measure {
  const char* name;
  std::function<std::optional<double>(const TaskResult&)> value;
  bool larger_is_better = false;
};

std::vector<Measure> MeasuresOf(const ComparisonOptions& options) {
  std::vector<Measure> measures = {
      {"ATE RMSE [m]", FigureOf(&TaskResult::ate_m, &ErrorFigures::rmse)},
      {"RPE 1 frame RMSE [m]", FigureOf(&TaskResult::rpe_frame_m, &ErrorFigures::rmse)},
      {"coverage", CoverageOf, true},
      {"mAP50",
       [](const TaskResult& r) {
         return r.detector ? std::optional(r.detector->map50) : std::nullopt;
       },
       true}};
  if (options.time_tolerance > 0) {
    measures.push_back({"latency [ms]", [](const TaskResult& r) {
                          return r.timing.p50_ms > 0 ? std::optional(r.timing.p50_ms)
                                                     : std::nullopt;
                        }});
  }
  return measures;
}

double AllowedChange(const Measure& measure, double before, const ComparisonOptions& options) {
  if (measure.larger_is_better) return options.coverage_tolerance;
  if (std::string(measure.name).starts_with("latency")) return options.time_tolerance * before;
  return std::max(options.tolerance * before, options.slack_m);
}

std::vector<const TaskResult*> Pointers(const std::vector<TaskResult>& results) {
  std::vector<const TaskResult*> pointers;
  pointers.reserve(results.size());
  for (const TaskResult& result : results) pointers.push_back(&result);
  return pointers;
}

size_t NumOk(const std::vector<TaskResult>& results) {
  return static_cast<size_t>(
      std::count_if(results.begin(), results.end(), [](const TaskResult& r) { return r.ok(); }));
}

void CompareOne(const std::vector<TaskResult>& before, const std::vector<TaskResult>& after,
                const ComparisonOptions& options, Comparison& comparison) {
  const std::string& sequence = before.front().sequence;
  const std::string& variant = before.front().variant;
  if (NumOk(after) * before.size() < NumOk(before) * after.size()) {
    comparison.rows.push_back({sequence, variant, "runs that succeed",
                               static_cast<double>(NumOk(before)),
                               static_cast<double>(NumOk(after)), "fails", true});
  }
  for (const Measure& measure : MeasuresOf(options)) {
    const auto old_value = SpreadOf(Pointers(before), measure.value);
    const auto new_value = SpreadOf(Pointers(after), measure.value);
    if (!old_value) continue;
    ComparisonRow row{sequence, variant, measure.name, old_value->median, 0, "gone", true};
    if (new_value) {
      row.after = new_value->median;
      const double sign = measure.larger_is_better ? -1 : 1;
      const double worse_by = sign * (row.after - row.before);
      const double allowed = AllowedChange(measure, row.before, options);
      row.is_regression = worse_by > allowed;
      row.verdict = row.is_regression ? "worse" : (worse_by < -allowed ? "better" : "same");
    }
    comparison.rows.push_back(std::move(row));
  }
}

}  // namespace

size_t Comparison::NumRegressions() const {
  return static_cast<size_t>(std::count_if(
      rows.begin(), rows.end(), [](const ComparisonRow& row) { return row.is_regression; }));
}

StatusOr<Comparison> CompareResults(const fs::path& before, const fs::path& after,
                                    const ComparisonOptions& options) {
  const bool with_times = options.time_tolerance > 0;
  const StatusOr<Runs> old_runs = ReadResults(before, with_times);
  if (!old_runs.ok()) return old_runs.status();
  const StatusOr<Runs> new_runs = ReadResults(after, with_times);
  if (!new_runs.ok()) return new_runs.status();
  Comparison comparison;
  for (const auto& [key, runs] : *old_runs) {
    const auto found = new_runs->find(key);
    if (found == new_runs->end()) {
      comparison.rows.push_back(
          {key.first, key.second, "runs", static_cast<double>(runs.size()), 0, "gone", true});
    } else {
      CompareOne(runs, found->second, options, comparison);
    }
  }
  return comparison;
}

std::string FormatComparison(const Comparison& comparison) {
  std::string text = fmt::format("{:<26}{:<20}{:<22}{:>11}{:>11}{:>9}  verdict\n", "sequence",
                                 "variant", "median of", "before", "after", "ratio");
  for (const ComparisonRow& row : comparison.rows) {
    text += fmt::format("{:<26}{:<20}{:<22}{:>11.5f}{:>11.5f}{:>9.3f}  {}\n", row.sequence,
                        row.variant, row.measure, row.before, row.after,
                        row.before == 0 ? 0 : row.after / row.before,
                        row.is_regression ? "WORSE: " + row.verdict : row.verdict);
  }
  return text + fmt::format("{} of {} figures are worse than tolerated\n",
                            comparison.NumRegressions(), comparison.rows.size());
}

}  // namespace msf
