#include "bench/task_run.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>

#include "bench/child_process.h"
#include "bench/energy_counter.h"
#include "detection/detector.h"
#include "detection/model_summary.h"
#include "detection/onnx_reader.h"
#include "evaluation/mask_score.h"

namespace msf {
namespace {

namespace fs = std::filesystem;

constexpr int kSummarySize_px = 640;  // tables 3 and 4 count operations at this size

std::string ProgramOf(const Task& task) {
  return task.program.empty() ? ThisProgram().string() : task.program;
}

bool HasMasks(const Task& task) {
  std::error_code ignored;
  return task.score_masks && fs::is_directory(fs::path(task.dataset) / "mask", ignored);
}

std::vector<std::string> CommandOf(const Task& task, const fs::path& folder) {
  std::vector<std::string> command = {ProgramOf(task)};
  if (task.is_detector) {
    for (const char* word : {"detector", "evaluate", "--data"}) command.emplace_back(word);
    command.push_back(task.dataset);
  } else {
    command.insert(command.end(), {"run", task.dataset});
  }
  command.insert(command.end(), task.arguments.begin(), task.arguments.end());
  if (task.is_detector) {
    command.insert(command.end(), {"--json", (folder / "metrics.json").string()});
  } else {
    command.insert(command.end(), {"--out", folder.string()});
    if (HasMasks(task)) command.emplace_back("--labels");
  }
  return command;
}

// What the filter said about each point, against the masks. Takes the labels away afterwards: they
// are larger than all other results together.
Status ScoreMasks(const Task& task, const fs::path& folder, TaskResult& result) {
  const StatusOr<MaskScore> score =
      ScoreAgainstMasks(task.id, folder / "labels.csv", fs::path(task.dataset));
  std::error_code ignored;
  for (const char* name : {"labels.csv", "objects.csv"}) fs::remove(folder / name, ignored);
  if (!score.ok()) return score.status();
  if (score->on_static.Total() > 0) result.static_kept = score->on_static.KeptShare();
  if (score->on_movers.Total() > 0) result.dynamic_removed = score->Recall();
  return Status::Ok();
}

Status AddDetectorFigures(const Task& task, const fs::path& folder, TaskResult& result) {
  DetectorFigures figures;
  try {
    std::ifstream stream(folder / "metrics.json");
    const nlohmann::json metrics = nlohmann::json::parse(stream);
    metrics.at("precision").get_to(figures.precision);
    metrics.at("recall").get_to(figures.recall);
    metrics.at("map50").get_to(figures.map50);
    metrics.at("map50_95").get_to(figures.map50_95);
  } catch (const nlohmann::json::exception& error) {
    return Status::Error(fmt::format("metrics.json is not readable: {}", error.what()));
  }
  const StatusOr<fs::path> model = FindModel(task.arguments.at(1));
  if (!model.ok()) return model.status();
  const StatusOr<Graph> graph = ReadOnnx(*model);
  if (!graph.ok()) return graph.status();
  const StatusOr<ModelSummary> summary = Summarize(*graph, kSummarySize_px, kSummarySize_px);
  if (!summary.ok()) return summary.status();
  figures.parameters_m = 1e-6 * static_cast<double>(summary->parameters);
  figures.gflops = 1e-9 * static_cast<double>(summary->flops);
  result.detector = figures;
  return Status::Ok();
}

Status AddDetectorTime(const Task& task, const fs::path& folder, TaskResult& result) {
  const fs::path file = folder / "time.json";
  const ProcessEnd end =
      RunProcess({{ProgramOf(task), "detector", "time", "--model", task.arguments.at(1), "--size",
                   task.arguments.at(3), "--json", file.string()},
                  folder / "time.txt",
                  task.time_limit_s});
  if (!end.ok()) return Status::Error("detector time: " + end.ToString());
  try {
    std::ifstream stream(file);
    result.timing.detector_ms = nlohmann::json::parse(stream).at("cpu_ms_median");
  } catch (const nlohmann::json::exception& error) {
    return Status::Error(fmt::format("time.json is not readable: {}", error.what()));
  }
  return Status::Ok();
}

Status AddFigures(const Task& task, const fs::path& folder, TaskResult& result) {
  if (task.is_detector) {
    MSF_RETURN_IF_ERROR(AddDetectorFigures(task, folder, result));
    return AddDetectorTime(task, folder, result);
  }
  MSF_RETURN_IF_ERROR(AddRunReport(folder / "report.json", result));
  return HasMasks(task) ? ScoreMasks(task, folder, result) : Status::Ok();
}

void Judge(const ProcessEnd& end, const fs::path& log, TaskResult& result) {
  const std::string last_words = LastLine(log);
  switch (end.kind) {
    case ProcessEnd::Kind::kTimedOut:
      result.status = "timed_out";
      result.reason = end.ToString();
      return;
    case ProcessEnd::Kind::kKilled:
      result.status = "crashed";
      result.reason = end.ToString();
      return;
    default:
      result.status = end.ok() ? "ok" : "failed";
      if (end.ok()) return;
      result.reason =
          last_words.empty() ? end.ToString() : fmt::format("{}: {}", end.ToString(), last_words);
  }
}

}  // namespace

fs::path TaskFolder(const fs::path& out, const Task& task) { return out / "tasks" / task.id; }

fs::path TaskResultFile(const fs::path& out, const Task& task) {
  return TaskFolder(out, task) / "result.json";
}

Status RunTask(const fs::path& out, const Task& task) {
  const fs::path folder = TaskFolder(out, task), log = folder / "log.txt";
  std::error_code error;
  fs::remove_all(folder, error);
  fs::create_directories(folder, error);
  if (error) return Status::Error(folder.string() + ": cannot be made: " + error.message());
  TaskResult result = EmptyResult(task);
  result.timing.started = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
  const EnergyCounter energy;
  const ProcessEnd end = RunProcess({CommandOf(task, folder), log, task.time_limit_s});
  // Beside other tasks nobody can tell whose energy it was.
  if (task.alone) result.timing.energy_j = energy.Joules();
  Judge(end, log, result);
  const Status figures = AddFigures(task, folder, result);
  if (result.ok() && !figures.ok()) {
    result.status = "failed";
    result.reason = figures.message();
  }
  if (result.timing.wall_time_s == 0) result.timing.wall_time_s = end.wall_time_s;
  return WriteTaskResult(TaskResultFile(out, task), result);
}

}  // namespace msf
