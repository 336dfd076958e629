// For tests: a small suite, and results for it without running anything.
#pragma once

#include <string>

#include "bench/bench_run.h"

namespace msf {

// Two simulated sequences (one with a published namesake, and its calm twin) and one recorded that
// is not there; off and full, full also in real time; two repeats.
inline Suite TestSuite() {
  Suite suite;
  suite.name = "test";
  suite.repeats = 2;
  SuiteSequence walking, calm, recorded;
  walking.name = "walking";
  walking.scenario = "walking_xyz";
  walking.published_as = "walking_xyz";
  walking.calm = "calm";
  walking.frames = 12;
  calm = walking;
  calm.name = "calm";
  calm.calm = calm.published_as = "";
  calm.without_actors = true;
  recorded.name = "recorded";
  recorded.folder = "not_here";
  recorded.camera = "tum_fr3";
  recorded.address = "https://example.org/not_here.tgz";
  suite.sequences = {walking, calm, recorded};
  SuiteVariant off, full, live;
  off.name = off.dynamic = "off";
  full.name = full.dynamic = "full";
  live = full;
  live.name = "live";
  live.mode = "realtime";
  live.sequences = {"walking"};
  suite.variants = {off, full, live};
  return suite;
}

// Every task succeeded; repeat r of `off` has an ATE of 0.2 + 0.01 r, the others 0.01 + 0.001 r.
inline BenchResults TestResults() {
  BenchResults results;
  results.suite = TestSuite();
  results.plan = MakePlan(results.suite, {{}, "sequences", "build", 0});
  results.build = {"1", "abc", "gcc", "Release"};
  results.machine = {"cpu", 2, 4, "linux"};
  for (const Task& task : results.plan.tasks) {
    TaskResult result = EmptyResult(task);
    const double ate =
        task.variant == "off" ? 0.2 + 0.01 * task.repeat : 0.01 + 0.001 * task.repeat;
    result.status = "ok";
    result.num_frames = 12;
    result.coverage = task.repeat == 0 ? 1 : 0.5;
    result.states = {{"tracking", 12}};
    result.ate_m = ErrorFigures{ate, ate / 2, ate / 3, ate / 4, ate * 2};
    result.rpe_frame_m = result.rpe_frame_deg = result.rpe_second_m = result.ate_m;
    result.timing.started = "2000-01-01T00:00:00Z";
    result.timing.wall_time_s = 4;
    result.timing.cpu_time_s = 6;
    result.timing.p50_ms = 10 + task.repeat;
    results.results.push_back(result);
  }
  return results;
}

}  // namespace msf
