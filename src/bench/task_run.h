// Does one task of a plan and writes down what came out of it.
#pragma once

#include <filesystem>

#include "bench/plan.h"
#include "bench/task_result.h"
#include "util/status.h"

namespace msf {

// The folder of a task, and the file that says that it is done.
std::filesystem::path TaskFolder(const std::filesystem::path& out, const Task& task);
std::filesystem::path TaskResultFile(const std::filesystem::path& out, const Task& task);

// Runs the task as a process of its own. Whatever becomes of that process, its folder below
// out/tasks gets a result.json in the end; an error means that not even this could be written.
Status RunTask(const std::filesystem::path& out, const Task& task);

}  // namespace msf
