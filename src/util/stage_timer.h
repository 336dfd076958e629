// Where a frame's time goes: named stages with wall milliseconds, one table per frame.
#pragma once

#include <chrono>
#include <map>
#include <string>

namespace msf {

// Milliseconds per stage name, ordered by name.
using StageTimings = std::map<std::string, double>;

// Adds the time from construction to destruction to `timings[stage]`.
class StageTimer {
 public:
  StageTimer(StageTimings& timings, std::string stage)
      : timings_(timings), stage_(std::move(stage)), start_(std::chrono::steady_clock::now()) {}
  ~StageTimer() {
    const std::chrono::duration<double, std::milli> elapsed =
        std::chrono::steady_clock::now() - start_;
    timings_[stage_] += elapsed.count();
  }
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;

 private:
  StageTimings& timings_;
  std::string stage_;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace msf
