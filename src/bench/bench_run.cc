#include "bench/bench_run.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <set>

#include "bench/child_process.h"
#include "bench/task_run.h"
#include "evaluation/json_text.h"
#include "util/atomic_file.h"

namespace msf {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

std::string FormatDuration(double seconds) {
  const int64_t s = std::llround(seconds);
  if (s < 3600) return fmt::format("{}:{:02}", s / 60, s % 60);
  return fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
}

// A line per finished task, with the time that the others will take.
class TaskProgress {
 public:
  TaskProgress(size_t num_open, size_t num_all)
      : num_open_(num_open), num_done_before_(num_all - num_open), num_all_(num_all) {}

  void Finish(const TaskResult& result) {
    ++num_done_;
    const double elapsed_s = std::chrono::duration<double>(Clock::now() - start_).count();
    const double left_s =
        elapsed_s / static_cast<double>(num_done_) * static_cast<double>(num_open_ - num_done_);
    fmt::print(stderr, "bench: {}/{} {} ({:.0f} s; {} left)\n", num_done_before_ + num_done_,
               num_all_, Describe(result), result.timing.wall_time_s, FormatDuration(left_s));
    std::fflush(stderr);
  }

 private:
  const Clock::time_point start_ = Clock::now();
  const size_t num_open_, num_done_before_, num_all_;
  size_t num_done_ = 0;
};

std::string WithoutSlashes(std::string id) {
  std::replace(id.begin(), id.end(), '/', '.');
  return id;
}

TaskResult ResultOrLost(const fs::path& out, const Task& task) {
  if (std::optional<TaskResult> result = ReadTaskResult(TaskResultFile(out, task));
      result && result->fingerprint == task.fingerprint) {
    return *std::move(result);
  }
  TaskResult lost = EmptyResult(task);
  lost.reason = "its process ended without a result";
  return lost;
}

void RunBatch(const fs::path& out, const std::vector<Task>& tasks, int jobs,
              TaskProgress& progress) {
  std::vector<ProcessSpec> specs;
  specs.reserve(tasks.size());
  for (const Task& task : tasks) {
    specs.push_back({{ThisProgram().string(), "bench", "--task", task.id, "--out", out.string()},
                     out / "logs" / (WithoutSlashes(task.id) + ".txt"),
                     0});
  }
  RunProcesses(specs, jobs, [&](size_t i, const ProcessEnd& end) {
    TaskResult result = ResultOrLost(out, tasks[i]);
    if (result.status == "lost")
      result.reason += fmt::format(" ({}; {})", end.ToString(), LastLine(specs[i].log_file));
    progress.Finish(result);
  });
}

nlohmann::json MissingToJson(const Plan& plan) {
  nlohmann::json list = nlohmann::json::array();
  for (const MissingSequence& missing : plan.missing) {
    list.push_back({{"name", missing.name},
                    {"folder", missing.folder},
                    {"address", missing.address},
                    {"reason", missing.reason}});
  }
  return list;
}

}  // namespace

std::vector<const TaskResult*> BenchResults::Of(const std::string& sequence,
                                                const std::string& variant) const {
  std::vector<const TaskResult*> found;
  for (const TaskResult& result : results) {
    if (result.sequence == sequence && result.variant == variant) found.push_back(&result);
  }
  return found;
}

Status PrepareBenchFolder(const fs::path& out, bool resume) {
  std::error_code error, ignored;
  if (!resume && fs::exists(out / "tasks", ignored)) {
    return Status::Error(out.string() +
                         ": holds results already; go on with them with --resume, or name another "
                         "folder");
  }
  for (const char* folder : {"tasks", "logs"}) {
    fs::create_directories(out / folder, error);
    if (error) break;
  }
  if (!error && access(out.c_str(), W_OK | X_OK) != 0) error = {errno, std::generic_category()};
  if (!error) return Status::Ok();
  return Status::Error(
      fmt::format("{}: the results cannot be written there ({})", out.string(), error.message()));
}

void RenderSequences(const fs::path& out, int jobs, Plan& plan) {
  std::vector<ProcessSpec> specs;
  std::vector<Rendering> open;
  std::set<std::string> folders;
  std::error_code ignored;
  for (const Rendering& rendering : plan.renderings) {
    if (fs::exists(fs::path(rendering.folder) / "groundtruth.txt", ignored)) continue;
    if (!folders.insert(rendering.folder).second) continue;
    fs::create_directories(fs::path(rendering.folder).parent_path(), ignored);
    std::vector<std::string> command = {ThisProgram().string(), "simulate"};
    command.insert(command.end(), rendering.arguments.begin(), rendering.arguments.end());
    command.insert(command.end(), {"--out", rendering.folder});
    specs.push_back({command, out / "logs" / ("simulate." + rendering.sequence + ".txt"), 0});
    open.push_back(rendering);
  }
  size_t done = 0;
  RunProcesses(specs, jobs, [&](size_t i, const ProcessEnd& end) {
    fmt::print(stderr, "bench: {}/{} sequences rendered: {}{}\n", ++done, specs.size(),
               open[i].sequence, end.ok() ? "" : " FAILED");
  });
  for (const Rendering& rendering : std::vector<Rendering>(plan.renderings)) {
    if (fs::exists(fs::path(rendering.folder) / "groundtruth.txt", ignored)) continue;
    plan.Drop(rendering.sequence,
              "could not be rendered: " +
                  LastLine(out / "logs" / ("simulate." + rendering.sequence + ".txt")));
  }
}

std::vector<Task> OpenTasks(const fs::path& out, const Plan& plan, bool retry_failed) {
  std::vector<Task> open;
  for (const Task& task : plan.tasks) {
    const TaskResult result = ResultOrLost(out, task);
    if (result.status == "lost" || (retry_failed && !result.ok())) open.push_back(task);
  }
  return open;
}

void ForgetResults(const fs::path& out, const std::vector<Task>& tasks) {
  std::error_code ignored;
  for (const Task& task : tasks) fs::remove(TaskResultFile(out, task), ignored);
}

void RunTasks(const fs::path& out, const std::vector<Task>& tasks, int jobs, size_t num_all) {
  TaskProgress progress(tasks.size(), num_all);
  std::vector<Task> together, alone;
  for (const Task& task : tasks) (task.alone ? alone : together).push_back(task);
  RunBatch(out, together, jobs, progress);
  RunBatch(out, alone, 1, progress);
}

std::vector<TaskResult> CollectResults(const fs::path& out, const Plan& plan) {
  std::vector<TaskResult> results;
  results.reserve(plan.tasks.size());
  for (const Task& task : plan.tasks) results.push_back(ResultOrLost(out, task));
  return results;
}

Status WriteResults(const fs::path& out, const BenchResults& results) {
  nlohmann::json tasks = nlohmann::json::array(), timings = nlohmann::json::object();
  for (const TaskResult& result : results.results) {
    tasks.push_back(ResultToJson(result));
    timings[result.id] = TimingToJson(result.timing);
  }
  const BuildInfo& build = results.build;
  const nlohmann::json figures = {{"format", 1},
                                  {"suite", results.suite.name},
                                  {"description", results.suite.description},
                                  {"build",
                                   {{"version", build.version},
                                    {"commit", build.commit},
                                    {"compiler", build.compiler},
                                    {"flags", build.flags}}},
                                  {"missing", MissingToJson(results.plan)},
                                  {"tasks", std::move(tasks)}};
  MSF_RETURN_IF_ERROR(WriteFileAtomically(out / "results.json", JsonText(figures)));
  const Machine& machine = results.machine;
  const nlohmann::json timing = {{"format", 1},
                                 {"machine",
                                  {{"processor", machine.processor},
                                   {"processors", machine.num_processors},
                                   {"memory_gb", machine.memory_gb},
                                   {"system", machine.system}}},
                                 {"tasks", std::move(timings)}};
  return WriteFileAtomically(out / "timing.json", JsonText(timing));
}

std::string Describe(const TaskResult& result) {
  std::string text = fmt::format("{}: {}", result.id, result.status);
  if (!result.ok()) return text + ": " + result.reason;
  if (result.ate_m) text += fmt::format(", ATE {:.4f} m", result.ate_m->rmse);
  if (result.coverage) text += fmt::format(", coverage {:.1f} %", 100 * *result.coverage);
  if (result.detector) text += fmt::format(", mAP50 {:.3f}", result.detector->map50);
  return text;
}

}  // namespace msf
