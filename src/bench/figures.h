// The figures of the report.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/bench_run.h"

namespace msf {

struct Figure {
  std::string id;       // file name
  std::string section;  // a sequence, or empty: with the tables
  std::string title;
  std::string note;
  std::string svg;
};

// Figure 4: what the detectors find, in pictures of some sequences.
std::vector<Figure> DetectionFigures(const std::filesystem::path& out, const BenchResults& results);
// Figures 5 (from above) and 6 (from the side): truth, estimate and the error between them, the
// baseline beside ours, one per sequence.
std::vector<Figure> TrajectoryFigures(const std::filesystem::path& out,
                                      const BenchResults& results);
// Per sequence: errors over time, states, timing, share of static points, worst frames.
std::vector<Figure> SequenceFigures(const std::filesystem::path& out, const BenchResults& results);

}  // namespace msf
