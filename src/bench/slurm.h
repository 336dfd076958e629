// Runs the tasks as job arrays of Slurm.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/plan.h"
#include "util/status.h"

namespace msf {

struct SlurmOptions {
  std::string sbatch_options;  // further words for sbatch, e.g. "--partition=cpu --mem=2G"
  int jobs = 0;                // tasks of an array that run at a time; 0: as many as fit
};

// The script of an array whose element i does task number i of `tasks`.
std::string SlurmScript(const std::filesystem::path& out, const std::vector<Task>& tasks,
                        const SlurmOptions& options);

// Submits the tasks and waits until they are through; tasks that have to be alone get a node for
// themselves. `out` must be seen by all nodes under the same path. An error when Slurm is not
// there, refuses, or still works on an earlier array of this folder; tasks that fail are no error.
Status RunTasksOnSlurm(const std::filesystem::path& out, const std::vector<Task>& tasks,
                       const SlurmOptions& options);

}  // namespace msf
