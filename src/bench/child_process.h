// Runs programs beside this one, each in a process group of its own, with a limit on their time.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace msf {

struct ProcessSpec {
  std::vector<std::string> command;  // the program, then its arguments
  std::filesystem::path log_file;    // takes stdout and stderr; replaced
  double time_limit_s = 0;           // 0: none
};

struct ProcessEnd {
  enum class Kind {
    kExited,     // code: its exit code
    kKilled,     // code: the signal that ended it
    kTimedOut,   // the limit was reached, and it and all that it had started were killed
    kNotStarted  // code: errno
  };
  Kind kind = Kind::kExited;
  int code = 0;
  double wall_time_s = 0;

  bool ok() const { return kind == Kind::kExited && code == 0; }
  // "exit code 3", "killed by signal 11 (Segmentation fault)", ...
  std::string ToString() const;
};

// Runs all of them, in order, at most `jobs` at a time, and calls `on_end` with the index of each
// that ended, and `on_tick`, if there is one, every few seconds. They die with this program. A
// program that cannot be run exits with 127.
void RunProcesses(std::span<const ProcessSpec> specs, int jobs,
                  const std::function<void(size_t, const ProcessEnd&)>& on_end,
                  const std::function<void()>& on_tick = nullptr);

ProcessEnd RunProcess(const ProcessSpec& spec);

// The file that this program was started from.
std::filesystem::path ThisProgram();

// The last line of a log that says something; empty when there is none.
std::string LastLine(const std::filesystem::path& log_file);

}  // namespace msf
