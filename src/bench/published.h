// Figures of the literature, which stand beside ours and are marked as theirs.
#pragma once

#include <string>
#include <vector>

#include "util/status.h"

namespace msf {

// Errors of a system on a sequence, m; 0: not published. Tables 5, 6 and 7.
struct PublishedError {
  std::string sequence, system;
  double rmse = 0, std = 0, mean = 0, median = 0;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("sequence", sequence, "");
    visit("system", system, "");
    visit("rmse", rmse, "m");
    visit("std", std, "m");
    visit("mean", mean, "m");
    visit("median", median, "m");
  }
};

// A row of table 1.
struct PublishedThreshold {
  double threshold_px = 0, ate_rmse_m = 0, static_kept = 0, dynamic_removed = 0;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("threshold_px", threshold_px, "L");
    visit("ate_rmse_m", ate_rmse_m, "m");
    visit("static_kept", static_kept, "share of the static points that is retained");
    visit("dynamic_removed", dynamic_removed, "share of the dynamic points that is removed");
  }
};

// A row of tables 3 and 4; 0: not published.
struct PublishedDetector {
  std::string model;
  double precision = 0, recall = 0, map50 = 0, map50_95 = 0, parameters_m = 0, gflops = 0, fps = 0;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("model", model, "");
    visit("precision", precision, "share");
    visit("recall", recall, "share");
    visit("map50", map50, "share");
    visit("map50_95", map50_95, "share");
    visit("parameters_m", parameters_m, "million");
    visit("gflops", gflops, "at 640 x 640");
    visit("fps", fps, "images per second");
  }
};

// A row of table 8; 0: not published.
struct PublishedRuntime {
  std::string system, machine, note;
  double fps = 0, latency_ms = 0, memory_mb = 0;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("system", system, "");
    visit("machine", machine, "");
    visit("note", note, "");
    visit("fps", fps, "");
    visit("latency_ms", latency_ms, "");
    visit("memory_mb", memory_mb, "main memory");
  }
};

struct PublishedFigures {
  std::string threshold_sequence;
  std::vector<PublishedThreshold> threshold;
  std::vector<PublishedDetector> detectors;
  std::vector<PublishedError> ate, rpe, compared, others;
  std::vector<PublishedRuntime> runtime;

  template <typename Visitor>
  void Visit(Visitor& visit) {
    visit("threshold_sequence", threshold_sequence, "of table 1");
    visit("threshold", threshold, "table 1");
    visit("detectors", detectors, "tables 3 and 4");
    visit("ate", ate, "table 5");
    visit("rpe", rpe, "table 6");
    visit("compared", compared, "table 7, ATE");
    visit("others", others, "ATE published elsewhere");
    visit("runtime", runtime, "table 8");
  }
};

// Those that ship, suites/published/figures.yaml.
StatusOr<PublishedFigures> LoadPublishedFigures();

}  // namespace msf
