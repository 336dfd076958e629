// All that a run over a sequence leaves behind.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "evaluation/dynamics_record.h"
#include "io/ply.h"
#include "io/trajectory.h"
#include "util/process_usage.h"
#include "util/stage_timer.h"

namespace msf {

// One input frame, whatever became of it.
struct FrameRecord {
  double time_s = 0;
  std::string state;  // the tracker's word, or "missing" (unreadable image), "dropped" (real time)
  std::optional<Rigid3d> T_wc;  // the final pose; empty for none
  int num_inliers = 0;
  int64_t keyframe_id = -1;  // the keyframe that this frame became; -1 for none
  StageTimings timings_ms;
  std::optional<DynamicsRecord> dynamics;  // empty in mode off and for frames that were not tracked
  std::string note;                        // why an image was missing, or empty
};

struct RunResults {
  std::string name;          // of the sequence
  std::string mode;          // "deterministic", "threaded", "real time"
  std::string dynamic_mode;  // "off", "boxes", "paper", "full"
  std::optional<DetectorRecord> detector;
  std::vector<FrameRecord> frames;  // one per input frame, in order of time
  Trajectory keyframes;             // final poses
  std::vector<PlyPoint> points;     // the sparse map
  size_t num_maps = 0;
  size_t num_loops = 0;
  size_t num_merges = 0;
  double wall_time_s = 0;           // of the whole run
  double time_to_first_pose_s = 0;  // from the start of the run
  ProcessUsage usage;
  bool interrupted = false;           // by the user; what is here is complete up to then
  std::string failure;                // of a stage that ended it early; empty: none
  std::vector<std::string> warnings;  // what was survived
  std::string config_yaml;            // the resolved options
  std::string camera_yaml;            // the camera
  std::optional<Trajectory> ground_truth;
  std::string ground_truth_problem;  // why there is none although there is a file
};

// The poses of all frames that have one.
Trajectory FrameTrajectory(const RunResults& results);

}  // namespace msf
