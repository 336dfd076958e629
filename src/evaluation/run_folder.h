// The results folder of a run.
#pragma once

#include <filesystem>
#include <string>

#include "evaluation/run_report.h"
#include "evaluation/run_results.h"
#include "util/status.h"

namespace msf {

// Makes the folder, so that a place that cannot be written to is found before the run, not after
// it.
Status PrepareRunFolder(const std::filesystem::path& folder);

// Makes the folder and writes trajectory.txt, keyframes.txt (TUM text), frames.csv, map.ply,
// config.yaml, camera.yaml, report.json and, when the run was evaluated, trajectory.svg and
// error.svg (those of an earlier run go when it was not). Each file is complete or absent; when one
// cannot be written the others still are, and the error names all that are missing.
Status WriteRunFolder(const std::filesystem::path& folder, const RunResults& results,
                      const RunReport& report);

// The text of frames.csv: a header, then one row per input frame with
// frame,time_s,state,pose,inliers,keyframe_id,<dynamics>...,<stage>_ms...,note. What a frame did
// not have is an empty cell; the columns about dynamic points are there when any frame has them.
std::string FormatFramesCsv(const std::vector<FrameRecord>& frames);

}  // namespace msf
