// A line on stderr that says how far a long job is, how fast it goes and how long it will take.
#pragma once

#include <chrono>
#include <functional>
#include <string>

namespace msf {

// "run: 120/792 frames, 31.2/s, 0:22 left". On a terminal one line is rewritten in place; elsewhere
// (a log file) there is a new line every ten seconds and at the end.
class Progress {
 public:
  // Where lines go, and the time; tests bring their own.
  struct Surroundings {
    std::function<void(const std::string&)> write;
    std::function<std::chrono::steady_clock::time_point()> now;
    bool is_terminal = false;
    static Surroundings Stderr();
  };

  // `total` <= 0: it is not known how much there is to do.
  Progress(std::string job, std::string unit, int total,
           Surroundings surroundings = Surroundings::Stderr());
  // Leaves a terminal's cursor on a fresh line.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // `done` of the total is finished. Cheap enough to be called for every frame.
  void Update(int done);

 private:
  std::string Line(int done, double elapsed_s) const;

  const std::string job_;
  const std::string unit_;
  const int total_;
  const Surroundings surroundings_;
  const std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point last_;
  size_t shown_width_ = 0;
};

}  // namespace msf
