#include "bench/task_result.h"

#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>

#include "evaluation/json_text.h"
#include "util/atomic_file.h"

namespace msf {
namespace {

using Json = nlohmann::json;

template <typename T, typename Convert>
Json OptionalToJson(const std::optional<T>& value, Convert convert) {
  return value ? Json(convert(*value)) : Json();
}

Json NumberToJson(const std::optional<double>& value) { return value ? Json(*value) : Json(); }

std::optional<double> NumberFromJson(const Json& json) {
  if (json.is_null()) return std::nullopt;
  return json.get<double>();
}

Json FiguresToJson(const ErrorFigures& f) {
  return {{"rmse", f.rmse}, {"std", f.std}, {"mean", f.mean}, {"median", f.median}, {"max", f.max}};
}

std::optional<ErrorFigures> FiguresFromJson(const Json& json) {
  if (json.is_null()) return std::nullopt;
  return ErrorFigures{json.at("rmse"), json.at("std"), json.at("mean"), json.at("median"),
                      json.at("max")};
}

Json DetectorToJson(const DetectorFigures& d) {
  return {{"precision", d.precision}, {"recall", d.recall}, {"map50", d.map50},
          {"map50_95", d.map50_95},   {"gflops", d.gflops}, {"parameters_m", d.parameters_m}};
}

std::optional<DetectorFigures> DetectorFromJson(const Json& json) {
  if (json.is_null()) return std::nullopt;
  return DetectorFigures{json.at("precision"), json.at("recall"),       json.at("map50"),
                         json.at("map50_95"),  json.at("parameters_m"), json.at("gflops")};
}

void AddTiming(const Json& report, TaskTiming& timing) {
  timing.wall_time_s = report.at("wall_time_s");
  timing.cpu_time_s = report.at("cpu_time_s");
  timing.peak_memory_mb = report.at("peak_memory_mb");
  const Json& stages = report.at("timing_ms");
  if (stages.contains("total")) {
    timing.p50_ms = stages["total"].at("p50");
    timing.p95_ms = stages["total"].at("p95");
    timing.p99_ms = stages["total"].at("p99");
  }
  const Json& dynamic = report.at("dynamic");
  if (dynamic.is_null() || dynamic.at("detector").is_null()) return;
  const Json& detector = dynamic.at("detector");
  timing.detector_ms = detector.at("mean_ms");
  timing.detections = detector.at("frames_detected");
  timing.age_p50_frames = detector.at("age_frames").at("p50");
  timing.age_p95_frames = detector.at("age_frames").at("p95");
}

void AddFigures(const Json& report, TaskResult& result) {
  result.num_frames = report.at("frames").at("input");
  result.coverage = report.at("coverage").get<double>();
  result.states = report.at("frames").at("by_state");
  if (const Json& dynamic = report.at("dynamic"); !dynamic.is_null())
    result.static_share = dynamic.at("point_share").at("static").get<double>();
  const Json& evaluation = report.at("evaluation");
  if (evaluation.is_null()) return;
  result.ate_m = FiguresFromJson(evaluation.at("ate_m"));
  result.rpe_frame_m = FiguresFromJson(evaluation.at("rpe_1_frame").at("translation_m"));
  result.rpe_frame_deg = FiguresFromJson(evaluation.at("rpe_1_frame").at("rotation_deg"));
  result.rpe_second_m = FiguresFromJson(evaluation.at("rpe_1_s").at("translation_m"));
}

}  // namespace

TaskResult EmptyResult(const Task& task) {
  TaskResult result;
  result.id = task.id;
  result.sequence = task.sequence;
  result.variant = task.variant;
  result.repeat = task.repeat;
  result.fingerprint = task.fingerprint;
  return result;
}

Status AddRunReport(const std::filesystem::path& report_file, TaskResult& result) {
  std::error_code ignored;
  try {
    std::ifstream stream(report_file);
    if (!stream || std::filesystem::is_directory(report_file, ignored))
      return Status::Error(report_file.string() + ": the run left no report");
    const Json report = Json::parse(stream);
    AddFigures(report, result);
    AddTiming(report, result.timing);
  } catch (const Json::exception& error) {
    return Status::Error(report_file.string() + ": is no report of a run: " + error.what());
  }
  return Status::Ok();
}

Json ResultToJson(const TaskResult& r) {
  return {{"id", r.id},
          {"sequence", r.sequence},
          {"variant", r.variant},
          {"repeat", r.repeat},
          {"fingerprint", r.fingerprint},
          {"status", r.status},
          {"reason", r.reason},
          {"frames", r.num_frames},
          {"coverage", NumberToJson(r.coverage)},
          {"states", r.states},
          {"ate_m", OptionalToJson(r.ate_m, FiguresToJson)},
          {"rpe_1_frame_m", OptionalToJson(r.rpe_frame_m, FiguresToJson)},
          {"rpe_1_frame_deg", OptionalToJson(r.rpe_frame_deg, FiguresToJson)},
          {"rpe_1_s_m", OptionalToJson(r.rpe_second_m, FiguresToJson)},
          {"static_share", NumberToJson(r.static_share)},
          {"static_kept", NumberToJson(r.static_kept)},
          {"dynamic_removed", NumberToJson(r.dynamic_removed)},
          {"detector", OptionalToJson(r.detector, DetectorToJson)}};
}

Json TimingToJson(const TaskTiming& t) {
  return {{"started", t.started},
          {"wall_time_s", t.wall_time_s},
          {"cpu_time_s", t.cpu_time_s},
          {"peak_memory_mb", t.peak_memory_mb},
          {"p50_ms", t.p50_ms},
          {"p95_ms", t.p95_ms},
          {"p99_ms", t.p99_ms},
          {"detector_ms", t.detector_ms},
          {"detections", t.detections},
          {"age_p50_frames", t.age_p50_frames},
          {"age_p95_frames", t.age_p95_frames},
          {"energy_j", NumberToJson(t.energy_j)}};
}

TaskResult ResultFromJson(const Json& json) {
  TaskResult r;
  json.at("id").get_to(r.id);
  json.at("sequence").get_to(r.sequence);
  json.at("variant").get_to(r.variant);
  json.at("repeat").get_to(r.repeat);
  json.at("fingerprint").get_to(r.fingerprint);
  json.at("status").get_to(r.status);
  json.at("reason").get_to(r.reason);
  json.at("frames").get_to(r.num_frames);
  r.coverage = NumberFromJson(json.at("coverage"));
  json.at("states").get_to(r.states);
  r.ate_m = FiguresFromJson(json.at("ate_m"));
  r.rpe_frame_m = FiguresFromJson(json.at("rpe_1_frame_m"));
  r.rpe_frame_deg = FiguresFromJson(json.at("rpe_1_frame_deg"));
  r.rpe_second_m = FiguresFromJson(json.at("rpe_1_s_m"));
  r.static_share = NumberFromJson(json.at("static_share"));
  r.static_kept = NumberFromJson(json.at("static_kept"));
  r.dynamic_removed = NumberFromJson(json.at("dynamic_removed"));
  r.detector = DetectorFromJson(json.at("detector"));
  return r;
}

TaskTiming TimingFromJson(const Json& json) {
  TaskTiming t;
  json.at("started").get_to(t.started);
  json.at("wall_time_s").get_to(t.wall_time_s);
  json.at("cpu_time_s").get_to(t.cpu_time_s);
  json.at("peak_memory_mb").get_to(t.peak_memory_mb);
  json.at("p50_ms").get_to(t.p50_ms);
  json.at("p95_ms").get_to(t.p95_ms);
  json.at("p99_ms").get_to(t.p99_ms);
  json.at("detector_ms").get_to(t.detector_ms);
  json.at("detections").get_to(t.detections);
  json.at("age_p50_frames").get_to(t.age_p50_frames);
  json.at("age_p95_frames").get_to(t.age_p95_frames);
  t.energy_j = NumberFromJson(json.at("energy_j"));
  return t;
}

Status WriteTaskResult(const std::filesystem::path& file, const TaskResult& result) {
  Json json = ResultToJson(result);
  json["timing"] = TimingToJson(result.timing);
  return WriteFileAtomically(file, JsonText(json));
}

std::optional<TaskResult> ReadTaskResult(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::error_code ignored;
  if (!stream || std::filesystem::is_directory(file, ignored)) return std::nullopt;
  try {
    const Json json = Json::parse(stream);
    TaskResult result = ResultFromJson(json);
    result.timing = TimingFromJson(json.at("timing"));
    return result;
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

}  // namespace msf
