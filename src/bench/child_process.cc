#include "bench/child_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fstream>
#include <system_error>

namespace msf {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kCannotRun = 127;  // the shell's code
constexpr double kTick_s = 5;

struct Child {
  size_t index = 0;
  pid_t pid = -1;
  int pid_fd = -1;  // readable when the process has ended
  Clock::time_point start;
  double time_limit_s = 0;
  bool timed_out = false;

  double Elapsed_s() const { return std::chrono::duration<double>(Clock::now() - start).count(); }
};

// In the child, between fork and exec: only what a signal handler may do, too.
[[noreturn]] void BecomeProgram(char* const* arguments, int log, pid_t parent) {
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(kCannotRun);  // it died before the line above
  dup2(log, STDOUT_FILENO);
  dup2(log, STDERR_FILENO);
  const int input = open("/dev/null", O_RDONLY | O_CLOEXEC);
  dup2(input, STDIN_FILENO);
  execvp(arguments[0], arguments);
  _exit(kCannotRun);
}

// 0, or errno.
int Start(const ProcessSpec& spec, Child& child) {
  const int log = open(spec.log_file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (log < 0) return errno;
  std::vector<std::string> words = spec.command;
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  child.start = Clock::now();
  child.time_limit_s = spec.time_limit_s;
  const pid_t parent = getpid();
  child.pid = fork();
  if (child.pid == 0) BecomeProgram(arguments.data(), log, parent);
  const int failure = errno;
  close(log);
  if (child.pid < 0) return failure;
  // Also here: whoever of the two comes first, the group is there before it may have to be killed.
  setpgid(child.pid, child.pid);
  child.pid_fd = static_cast<int>(syscall(SYS_pidfd_open, child.pid, 0));
  if (child.pid_fd >= 0) return 0;
  const int no_fd = errno;
  kill(-child.pid, SIGKILL);
  waitpid(child.pid, nullptr, 0);
  return no_fd;
}

ProcessEnd Reap(const Child& child) {
  int status = 0;
  waitpid(child.pid, &status, 0);
  close(child.pid_fd);
  kill(-child.pid, SIGKILL);  // what it may have left behind
  ProcessEnd end;
  end.wall_time_s = child.Elapsed_s();
  if (child.timed_out) {
    end.kind = ProcessEnd::Kind::kTimedOut;
  } else if (WIFSIGNALED(status)) {
    end.kind = ProcessEnd::Kind::kKilled;
    end.code = WTERMSIG(status);
  } else {
    end.code = WEXITSTATUS(status);
  }
  return end;
}

// Until a child ends, one's time is up or a tick has passed.
void Wait(const std::vector<Child>& children, std::vector<pollfd>& events) {
  events.clear();
  double wait_s = kTick_s;
  for (const Child& child : children) {
    events.push_back({child.pid_fd, POLLIN, 0});
    if (child.time_limit_s <= 0 || child.timed_out) continue;
    const double left_s = std::max(0.0, child.time_limit_s - child.Elapsed_s());
    wait_s = std::min(wait_s, left_s);
  }
  poll(events.data(), events.size(), static_cast<int>(wait_s * 1e3) + 1);
}

void KillLate(std::vector<Child>& children) {
  for (Child& child : children) {
    if (child.time_limit_s <= 0 || child.timed_out || child.Elapsed_s() < child.time_limit_s)
      continue;
    child.timed_out = true;
    kill(-child.pid, SIGKILL);
  }
}

}  // namespace

std::string ProcessEnd::ToString() const {
  switch (kind) {
    case Kind::kExited:
      return fmt::format("exit code {}", code);
    case Kind::kKilled:
      return fmt::format("killed by signal {} ({})", code, strsignal(code));
    case Kind::kTimedOut:
      return fmt::format("killed after {:.0f} s, its time limit", wall_time_s);
    case Kind::kNotStarted:
      return "could not be started: " + std::generic_category().message(code);
  }
  return "";
}

void RunProcesses(std::span<const ProcessSpec> specs, int jobs,
                  const std::function<void(size_t, const ProcessEnd&)>& on_end,
                  const std::function<void()>& on_tick) {
  std::vector<Child> running;
  std::vector<pollfd> events;
  size_t next = 0;
  while (next < specs.size() || !running.empty()) {
    if (next < specs.size() && running.size() < static_cast<size_t>(std::max(jobs, 1))) {
      Child child;
      child.index = next++;
      const int failure = Start(specs[child.index], child);
      if (failure == 0)
        running.push_back(child);
      else
        on_end(child.index, {ProcessEnd::Kind::kNotStarted, failure, 0});
      continue;
    }
    Wait(running, events);
    KillLate(running);
    if (on_tick) on_tick();
    for (size_t i = events.size(); i-- > 0;) {
      if (events[i].revents == 0) continue;
      const Child ended = running[i];
      running.erase(running.begin() + static_cast<std::ptrdiff_t>(i));
      on_end(ended.index, Reap(ended));
    }
  }
}

ProcessEnd RunProcess(const ProcessSpec& spec) {
  ProcessEnd result;
  RunProcesses({&spec, 1}, 1, [&result](size_t, const ProcessEnd& end) { result = end; });
  return result;
}

std::filesystem::path ThisProgram() {
  std::error_code error;
  return std::filesystem::read_symlink("/proc/self/exe", error);
}

std::string LastLine(const std::filesystem::path& log_file) {
  std::ifstream stream(log_file);
  std::string last;
  for (std::string line; std::getline(stream, line);) {
    if (line.find_first_not_of(" \t\r") != std::string::npos) last = line;
  }
  return last;
}

}  // namespace msf
