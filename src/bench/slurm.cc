#include "bench/slurm.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <sstream>

#include "bench/child_process.h"
#include "bench/task_run.h"
#include "util/atomic_file.h"

namespace msf {
namespace {

namespace fs = std::filesystem;

// Slurm's own default, MaxArraySize, is 1001.
constexpr size_t kLargestArray = 1000;

// Tells the arrays of one folder from all others in the queue.
std::string JobName(const fs::path& out) {
  return fmt::format("msf-bench-{:08x}",
                     std::hash<std::string>{}(fs::absolute(out).string()) & 0xffffffff);
}

std::string Quoted(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::string ReadText(const fs::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

// What an earlier call left in the queue would write into the same folders.
Status CheckQueue(const fs::path& out) {
  const fs::path answer = out / "slurm" / "squeue.txt";
  const ProcessEnd end =
      RunProcess({{"squeue", "--noheader", "--name=" + JobName(out)}, answer, 0});
  if (!end.ok()) {
    const std::string said = LastLine(answer);
    return Status::Error("Slurm cannot be asked (squeue: " + end.ToString() +
                         (said.empty() ? "" : "; " + said) +
                         "); --slurm needs a machine that may submit jobs");
  }
  if (ReadText(answer).find_first_not_of(" \n") == std::string::npos) return Status::Ok();
  return Status::Error(
      fmt::format("an earlier array of {} is still in Slurm's queue; wait for it, or take it out "
                  "with scancel --name={}",
                  out.string(), JobName(out)));
}

Status SubmitAndWait(const fs::path& out, const std::vector<Task>& tasks, size_t number,
                     const SlurmOptions& options) {
  const fs::path script = out / "slurm" / fmt::format("array{}.sh", number),
                 answer = out / "slurm" / fmt::format("array{}.txt", number);
  MSF_RETURN_IF_ERROR(WriteFileAtomically(script, SlurmScript(out, tasks, options)));
  std::vector<std::string> command = {"sbatch", "--wait"};
  std::istringstream words(options.sbatch_options);
  for (std::string word; words >> word;) command.push_back(word);
  command.push_back(script.string());
  size_t shown = 0;
  const auto tick = [&] {
    const auto done =
        static_cast<size_t>(std::count_if(tasks.begin(), tasks.end(), [&](const Task& task) {
          const auto result = ReadTaskResult(TaskResultFile(out, task));
          return result && result->fingerprint == task.fingerprint;
        }));
    if (done != shown) fmt::print(stderr, "bench: {}/{} tasks of the array\n", done, tasks.size());
    shown = done;
  };
  ProcessEnd end;
  const ProcessSpec spec{command, answer, 0};
  RunProcesses(
      {&spec, 1}, 1, [&end](size_t, const ProcessEnd& e) { end = e; }, tick);
  tick();
  // --wait passes on the exit code of the worst element; only an answer without a job is a refusal.
  if (ReadText(answer).find("Submitted batch job") != std::string::npos) return Status::Ok();
  return Status::Error("Slurm did not take the jobs: " + end.ToString() + "; " + LastLine(answer));
}

}  // namespace

std::string SlurmScript(const fs::path& out, const std::vector<Task>& tasks,
                        const SlurmOptions& options) {
  // The tasks have limits of their own; Slurm's is the net below: minutes, and some for the rest.
  double limit_s = 0;
  bool threaded = false, alone = false;
  for (const Task& task : tasks) {
    limit_s = std::max(limit_s, task.time_limit_s);
    alone = alone || task.alone;
    const auto& words = task.arguments;
    threaded = threaded || std::find(words.begin(), words.end(), "--deterministic") == words.end();
  }
  std::string script = "#!/bin/bash\n";
  script += fmt::format("#SBATCH --job-name={}\n", JobName(out));
  script += fmt::format("#SBATCH --array=0-{}{}\n", tasks.size() - 1,
                        options.jobs > 0 ? fmt::format("%{}", options.jobs) : "");
  script += fmt::format("#SBATCH --cpus-per-task={}\n", threaded ? 2 : 1);
  script += fmt::format("#SBATCH --time={}\n", static_cast<int>(std::ceil(limit_s / 60)) + 10);
  if (alone) script += "#SBATCH --exclusive\n";
  script += "#SBATCH --output=/dev/null\n";
  script += fmt::format("#SBATCH --chdir={}\n", fs::absolute(out).string());
  script += "tasks=(\n";
  for (const Task& task : tasks) script += "  " + Quoted(task.id) + "\n";
  script += ")\n";
  script += fmt::format("exec {} bench --out {} --task \"${{tasks[$SLURM_ARRAY_TASK_ID]}}\"\n",
                        Quoted(ThisProgram().string()), Quoted(fs::absolute(out).string()));
  return script;
}

Status RunTasksOnSlurm(const fs::path& out, const std::vector<Task>& tasks,
                       const SlurmOptions& options) {
  if (tasks.empty()) return Status::Ok();
  std::error_code error;
  fs::create_directories(out / "slurm", error);
  if (error) return Status::Error((out / "slurm").string() + ": " + error.message());
  MSF_RETURN_IF_ERROR(CheckQueue(out));
  size_t number = 0;
  for (const bool alone : {false, true}) {
    std::vector<Task> batch;
    for (const Task& task : tasks) {
      if (task.alone == alone) batch.push_back(task);
    }
    for (size_t first = 0; first < batch.size(); first += kLargestArray) {
      const size_t last = std::min(first + kLargestArray, batch.size());
      MSF_RETURN_IF_ERROR(
          SubmitAndWait(out,
                        std::vector<Task>(batch.begin() + static_cast<std::ptrdiff_t>(first),
                                          batch.begin() + static_cast<std::ptrdiff_t>(last)),
                        number++, options));
    }
  }
  return Status::Ok();
}

}  // namespace msf
