// Gets a plan done: renders what is simulated, runs what is open, collects what came out.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/machine.h"
#include "bench/plan.h"
#include "bench/task_result.h"
#include "util/status.h"

namespace msf {

// Everything that the report is made of.
struct BenchResults {
  Suite suite;
  Plan plan;
  BuildInfo build;
  Machine machine;
  std::vector<TaskResult> results;      // one per task, then those of the peers
  std::vector<std::string> peers;       // names of other systems
  std::vector<std::string> peer_notes;  // what of theirs could not be used

  // In order of the repeats.
  std::vector<const TaskResult*> Of(const std::string& sequence, const std::string& variant) const;
};

// Makes the folder, or goes on with it. Errors: it cannot be written to; it holds results and
// nobody said `resume`.
Status PrepareBenchFolder(const std::filesystem::path& out, bool resume);

// Renders the simulated sequences that are not there yet, `jobs` at a time. Those that cannot be
// rendered leave the plan.
void RenderSequences(const std::filesystem::path& out, int jobs, Plan& plan);

// The tasks without a result that fits; with `retry_failed` also those that were not ok.
std::vector<Task> OpenTasks(const std::filesystem::path& out, const Plan& plan, bool retry_failed);

// Takes away what earlier runs of these tasks left, so that nothing old can pass for new.
void ForgetResults(const std::filesystem::path& out, const std::vector<Task>& tasks);

// Runs them on this machine, `jobs` at a time; tasks that have to be alone come last, one by one.
// `num_all`: tasks of the suite, for the progress on stderr.
void RunTasks(const std::filesystem::path& out, const std::vector<Task>& tasks, int jobs,
              size_t num_all);

// What every task came to; those that left no result are "lost".
std::vector<TaskResult> CollectResults(const std::filesystem::path& out, const Plan& plan);

// Writes results.json (what runs found; of deterministic runs equal to the byte) and timing.json
// (what they cost).
Status WriteResults(const std::filesystem::path& out, const BenchResults& results);

// "walking_xyz/full/0: ok, ATE 0.0123 m, coverage 100.0 %"
std::string Describe(const TaskResult& result);

}  // namespace msf
