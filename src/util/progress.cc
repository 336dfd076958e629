#include "util/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

namespace msf {

using std::chrono::steady_clock;

Progress::Surroundings Progress::Surroundings::Stderr() {
  const auto write = [](const std::string& text) {
    std::fputs(text.c_str(), stderr);
    std::fflush(stderr);
  };
  return {write, [] { return steady_clock::now(); }, isatty(STDERR_FILENO) != 0};
}

Progress::Progress(std::string job, std::string unit, int total, Surroundings surroundings)
    : job_(std::move(job)),
      unit_(std::move(unit)),
      total_(total),
      surroundings_(std::move(surroundings)),
      start_(surroundings_.now()),
      last_(start_) {}

Progress::~Progress() {
  if (surroundings_.is_terminal && shown_width_ > 0) surroundings_.write("\n");
}

void Progress::Update(int done) {
  const steady_clock::time_point now = surroundings_.now();
  const auto interval = surroundings_.is_terminal ? std::chrono::milliseconds(200)
                                                  : std::chrono::milliseconds(10'000);
  if (now - last_ < interval && done != total_) return;
  last_ = now;
  const std::string line = Line(done, std::chrono::duration<double>(now - start_).count());
  // Blanks cover what a longer line before left behind.
  const size_t width = std::max(shown_width_, line.size());
  surroundings_.write(surroundings_.is_terminal ? fmt::format("\r{:<{}}", line, width)
                                                : line + "\n");
  shown_width_ = line.size();
}

std::string Progress::Line(int done, double elapsed_s) const {
  const double rate = elapsed_s > 0 ? done / elapsed_s : 0;
  if (total_ <= 0) return fmt::format("{}: {} {}, {:.1f}/s", job_, done, unit_, rate);
  const int left_s = rate > 0 ? static_cast<int>(std::lround((total_ - done) / rate)) : 0;
  return fmt::format("{}: {}/{} {}, {:.1f}/s, {}:{:02} left", job_, done, total_, unit_, rate,
                     left_s / 60, left_s % 60);
}

}  // namespace msf
