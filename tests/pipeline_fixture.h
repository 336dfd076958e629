// Runs the whole system in memory and compares what it says with the truth.
#pragma once

#include <functional>
#include <opencv2/core/utility.hpp>
#include <string>

#include "evaluation/evaluation.h"
#include "evaluation/statistics.h"
#include "io/tum_dataset.h"
#include "simulation/scenario.h"
#include "simulation/simulator.h"
#include "system/system.h"

namespace msf {

// As `msf-slam run` has it. The thread sanitizer would take what the pool's threads, which it
// cannot see into, hand over for races.
inline const bool kOpenCvHasOneThread = [] {
  cv::setNumThreads(1);
  return true;
}();

struct PipelineRun {
  Reconstruction reconstruction;
  Trajectory estimate;  // frames of the main map
  std::vector<TrackingResult> results;
};

inline SystemOptions PipelineOptions(bool deterministic) {
  SystemOptions options;
  options.deterministic = deterministic;
  options.wait_for_mapping = true;
  options.vocabulary = std::string(MSF_SOURCE_DIR) + "/models/vocabulary.msfvoc";
  return options;
}

// Gives frames 0 .. count - 1 of `frame_at` to a new system.
inline PipelineRun RunPipeline(const SystemOptions& options, const Camera& camera, int count,
                               const std::function<RgbdFramePtr(int)>& frame_at) {
  PipelineRun run;
  StatusOr<std::unique_ptr<System>> system = System::Create(options, camera);
  MSF_CHECK(system.ok(), system.message());
  for (int i = 0; i < count; ++i) {
    StatusOr<TrackingResult> result = (*system)->Track(frame_at(i));
    MSF_CHECK(result.ok(), result.message());
    run.results.push_back(*std::move(result));
  }
  run.reconstruction = (*system)->Finish();
  for (const ResolvedFrame& frame : run.reconstruction.frames) {
    if (frame.T_wc && frame.map_id == run.reconstruction.main_map) {
      run.estimate.push_back({frame.time_s, *frame.T_wc});
    }
  }
  return run;
}

inline double AbsoluteErrorOf(const Trajectory& truth, const Trajectory& estimate) {
  const StatusOr<Evaluation> evaluation = EvaluateTrajectory("test", truth, estimate);
  MSF_CHECK(evaluation.ok(), evaluation.message());
  return ComputeStatistics(evaluation->absolute.translation_m.value).rmse;
}

inline double FrameErrorOf(const Trajectory& truth, const Trajectory& estimate) {
  const StatusOr<Evaluation> evaluation = EvaluateTrajectory("test", truth, estimate);
  MSF_CHECK(evaluation.ok(), evaluation.message());
  return ComputeStatistics(evaluation->per_frame.translation_m.value).rmse;
}

}  // namespace msf
