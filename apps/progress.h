// A line on stderr that says how far a long job is and how long it will take.
#pragma once

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <string>

namespace msf {

// "simulate: 120/750 frames, 31.2/s, 0:20 left": rewritten in place on a terminal, else a new line
// every ten seconds.
class Progress {
 public:
  Progress(std::string job, std::string unit, int total)
      : job_(std::move(job)),
        unit_(std::move(unit)),
        total_(total),
        start_(Clock::now()),
        last_(start_) {}
  ~Progress() {
    if (is_terminal_ && shown_) std::fputc('\n', stderr);
  }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // `done` of the total is finished.
  void Update(int done) {
    const auto now = Clock::now();
    const bool is_last = done >= total_;
    if (!is_last &&
        now - last_ < (is_terminal_ ? std::chrono::milliseconds(200) : std::chrono::seconds(10)))
      return;
    last_ = now;
    shown_ = true;
    const double elapsed_s = std::chrono::duration<double>(now - start_).count();
    const double rate = elapsed_s > 0 ? done / elapsed_s : 0;
    const int left_s = rate > 0 ? static_cast<int>((total_ - done) / rate + 0.5) : 0;
    fmt::print(stderr, "{}{}: {}/{} {}, {:.1f}/s, {}:{:02} left{}", is_terminal_ ? "\r" : "", job_,
               done, total_, unit_, rate, left_s / 60, left_s % 60, is_terminal_ ? "  " : "\n");
    std::fflush(stderr);
  }

 private:
  using Clock = std::chrono::steady_clock;
  const std::string job_;
  const std::string unit_;
  const int total_;
  const bool is_terminal_ = isatty(STDERR_FILENO) != 0;
  const Clock::time_point start_;
  Clock::time_point last_;
  bool shown_ = false;
};

}  // namespace msf
