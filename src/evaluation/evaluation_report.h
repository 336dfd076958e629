// Evaluations as text and as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "evaluation/evaluation.h"
#include "evaluation/statistics.h"

namespace msf {

// One column per estimate; ATE and RPE with all statistics, and the coverage next to them.
std::string FormatTable(const std::vector<Evaluation>& evaluations);

// {"rmse": ..., "mean": ..., "median": ..., "std": ..., "min": ..., "max": ...}; null for no
// values.
nlohmann::json StatisticsToJson(const std::vector<double>& values, double unit = 1);

// name, poses, associated, input_frames, coverage, scale, ate_m, rpe_1_frame and rpe_1_s with
// translation_m and rotation_deg.
nlohmann::json EvaluationToJson(const Evaluation& evaluation);

}  // namespace msf
