#include "evaluation/run_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <utility>

#include "evaluation/evaluation_report.h"
#include "evaluation/statistics.h"

namespace msf {
namespace {

constexpr double kMebibyte = 1024.0 * 1024.0;

std::vector<StateSpan> FindSpans(const std::vector<FrameRecord>& frames) {
  std::vector<StateSpan> spans;
  for (size_t i = 0; i < frames.size(); ++i) {
    if (spans.empty() || spans.back().state != frames[i].state)
      spans.push_back({frames[i].state, i, i, frames[i].time_s, frames[i].time_s});
    spans.back().last_frame = i;
    spans.back().end_s = frames[i].time_s;
  }
  return spans;
}

std::map<std::string, TimingSummary> SummarizeTimings(const std::vector<FrameRecord>& frames) {
  std::map<std::string, std::vector<double>> values;
  for (const FrameRecord& frame : frames) {
    for (const auto& [stage, ms] : frame.timings_ms) values[stage].push_back(ms);
  }
  std::map<std::string, TimingSummary> timings;
  for (const auto& [stage, ms] : values) {
    const Statistics statistics = ComputeStatistics(ms);
    timings[stage] = {ms.size(),
                      statistics.mean,
                      statistics.median,
                      Percentile(ms, 0.95),
                      Percentile(ms, 0.99),
                      statistics.max};
  }
  return timings;
}

void AddEvaluation(const RunResults& results, RunReport& report) {
  report.evaluation_problem = results.ground_truth_problem;
  if (!results.ground_truth) return;
  if (report.num_poses == 0) {
    report.evaluation_problem = "no frame has a pose";
    return;
  }
  StatusOr<Evaluation> evaluation =
      EvaluateTrajectory(results.name, *results.ground_truth, FrameTrajectory(results),
                         {.num_input_frames = results.frames.size()});
  if (evaluation.ok())
    report.evaluation = std::move(*evaluation);
  else
    report.evaluation_problem = evaluation.message();
}

// What could not be used of the input, with the first reason; nothing when all could.
std::optional<std::string> DescribeMissing(const std::vector<FrameRecord>& frames) {
  const auto missing = [](const FrameRecord& frame) { return frame.state == "missing"; };
  const auto first = std::find_if(frames.begin(), frames.end(), missing);
  if (first == frames.end()) return std::nullopt;
  return fmt::format("{} of {} frames could not be used; the first is frame {}: {}",
                     std::count_if(first, frames.end(), missing), frames.size(),
                     first - frames.begin(), first->note);
}

// "-" where a trajectory is too short for the error to exist.
std::string FormatRmse(const ErrorSeries& series, double unit, const char* format) {
  if (series.value.empty()) return "-";
  return fmt::format(fmt::runtime(format), ComputeStatistics(series.value).rmse / unit);
}

std::string FormatErrors(const Evaluation& evaluation) {
  constexpr double kDegree = std::numbers::pi / 180;
  std::string text = fmt::format("ATE          {} RMSE\n",
                                 FormatRmse(evaluation.absolute.translation_m, 1, "{:.4f} m"));
  const auto add = [&text](const char* name, const RelativeError& errors) {
    text += fmt::format("{}{}, {} RMSE\n", name, FormatRmse(errors.translation_m, 1, "{:.4f} m"),
                        FormatRmse(errors.rotation_rad, kDegree, "{:.3f} deg"));
  };
  add("RPE 1 frame  ", evaluation.per_frame);
  add("RPE 1 s      ", evaluation.per_second);
  return text;
}

}  // namespace

Trajectory FrameTrajectory(const RunResults& results) {
  Trajectory trajectory;
  for (const FrameRecord& frame : results.frames) {
    if (frame.T_wc) trajectory.push_back({frame.time_s, *frame.T_wc});
  }
  return trajectory;
}

RunReport MakeRunReport(const RunResults& results) {
  RunReport report;
  report.name = results.name;
  report.mode = results.mode;
  report.num_frames = results.frames.size();
  for (const FrameRecord& frame : results.frames) {
    report.num_poses += frame.T_wc.has_value();
    ++report.frames_per_state[frame.state];
  }
  report.spans = FindSpans(results.frames);
  report.num_keyframes = results.keyframes.size();
  report.num_points = results.points.size();
  report.num_maps = results.num_maps;
  report.num_loops = results.num_loops;
  report.num_merges = results.num_merges;
  report.timings = SummarizeTimings(results.frames);
  report.wall_time_s = results.wall_time_s;
  report.time_to_first_pose_s = results.time_to_first_pose_s;
  report.usage = results.usage;
  report.interrupted = results.interrupted;
  report.warnings = results.warnings;
  if (std::optional<std::string> missing = DescribeMissing(results.frames))
    report.warnings.push_back(*std::move(missing));
  report.dynamics = SummarizeDynamics(results);
  if (report.dynamics) {
    for (std::string& warning : report.dynamics->Warnings())
      report.warnings.push_back(std::move(warning));
  }
  AddEvaluation(results, report);
  return report;
}

nlohmann::json RunReportToJson(const RunReport& report) {
  nlohmann::json spans = nlohmann::json::array(), timings = nlohmann::json::object();
  for (const StateSpan& span : report.spans) {
    spans.push_back({{"state", span.state},
                     {"first_frame", span.first_frame},
                     {"last_frame", span.last_frame},
                     {"start_s", span.start_s},
                     {"end_s", span.end_s}});
  }
  for (const auto& [stage, timing] : report.timings) {
    timings[stage] = {{"frames", timing.num_frames}, {"mean", timing.mean_ms},
                      {"p50", timing.p50_ms},        {"p95", timing.p95_ms},
                      {"p99", timing.p99_ms},        {"max", timing.max_ms}};
  }
  nlohmann::json json = {
      {"name", report.name},
      {"mode", report.mode},
      {"interrupted", report.interrupted},
      {"frames",
       {{"input", report.num_frames},
        {"with_pose", report.num_poses},
        {"by_state", report.frames_per_state}}},
      {"coverage", report.Coverage()},
      {"spans", std::move(spans)},
      {"keyframes", report.num_keyframes},
      {"points", report.num_points},
      {"maps", report.num_maps},
      {"loops", report.num_loops},
      {"merges", report.num_merges},
      {"dynamic", report.dynamics ? DynamicsToJson(*report.dynamics) : nlohmann::json()},
      {"timing_ms", std::move(timings)},
      {"wall_time_s", report.wall_time_s},
      {"cpu_time_s", report.usage.cpu_time_s},
      {"time_to_first_pose_s", report.time_to_first_pose_s},
      {"peak_memory_mb", static_cast<double>(report.usage.peak_memory_bytes) / kMebibyte},
      {"warnings", report.warnings},
      {"evaluation", report.evaluation ? EvaluationToJson(*report.evaluation) : nlohmann::json()}};
  if (!report.evaluation_problem.empty()) json["evaluation_problem"] = report.evaluation_problem;
  return json;
}

std::string FormatRunReport(const RunReport& report) {
  std::string text = fmt::format("{} ({}){}\n", report.name, report.mode,
                                 report.interrupted ? ", interrupted" : "");
  text += fmt::format("coverage     {:.1f} % ({} of {} frames have a pose)\n",
                      100 * report.Coverage(), report.num_poses, report.num_frames);
  for (const std::string& warning : report.warnings) text += "warning      " + warning + "\n";
  if (report.evaluation) {
    text += FormatErrors(*report.evaluation);
  } else if (!report.evaluation_problem.empty()) {
    text += "no ATE/RPE   " + report.evaluation_problem + "\n";
  }
  text += fmt::format("map          {} keyframes, {} points, {} loops closed, {} maps, {} merged\n",
                      report.num_keyframes, report.num_points, report.num_loops, report.num_maps,
                      report.num_merges);
  if (report.dynamics) text += FormatDynamics(*report.dynamics);
  const double rate =
      report.wall_time_s > 0 ? static_cast<double>(report.num_frames) / report.wall_time_s : 0;
  text += fmt::format(
      "time         {:.1f} s for {} frames ({:.1f}/s), {:.1f} s of CPU, first pose after {:.2f} s, "
      "peak memory {:.0f} MB\n",
      report.wall_time_s, report.num_frames, rate, report.usage.cpu_time_s,
      report.time_to_first_pose_s, static_cast<double>(report.usage.peak_memory_bytes) / kMebibyte);
  text += fmt::format("{:<24}{:>9}{:>9}{:>9}{:>9}\n", "ms per frame", "p50", "p95", "p99", "max");
  for (const auto& [stage, timing] : report.timings) {
    text += fmt::format("  {:<22}{:>9.2f}{:>9.2f}{:>9.2f}{:>9.2f}\n", stage, timing.p50_ms,
                        timing.p95_ms, timing.p99_ms, timing.max_ms);
  }
  return text;
}

}  // namespace msf
