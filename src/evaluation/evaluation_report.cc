#include "evaluation/evaluation_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>
#include <utility>

namespace msf {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

struct Measure {
  const char* title;
  const std::vector<double>& (*values)(const Evaluation&);
  double unit;
};

const std::vector<double>& Absolute(const Evaluation& e) { return e.absolute.translation_m.value; }
const std::vector<double>& FrameTranslation(const Evaluation& e) {
  return e.per_frame.translation_m.value;
}
const std::vector<double>& FrameRotation(const Evaluation& e) {
  return e.per_frame.rotation_rad.value;
}
const std::vector<double>& SecondTranslation(const Evaluation& e) {
  return e.per_second.translation_m.value;
}
const std::vector<double>& SecondRotation(const Evaluation& e) {
  return e.per_second.rotation_rad.value;
}

constexpr std::array kMeasures = {Measure{"ATE [m]", Absolute, 1},
                                  Measure{"RPE 1 frame [m]", FrameTranslation, 1},
                                  Measure{"RPE 1 frame [deg]", FrameRotation, kDegree},
                                  Measure{"RPE 1 s [m]", SecondTranslation, 1},
                                  Measure{"RPE 1 s [deg]", SecondRotation, kDegree}};

struct Column {
  const char* title;
  double Statistics::*value;
};

constexpr std::array kColumns = {
    Column{"rmse", &Statistics::rmse},     Column{"mean", &Statistics::mean},
    Column{"median", &Statistics::median}, Column{"std", &Statistics::std},
    Column{"min", &Statistics::min},       Column{"max", &Statistics::max}};

// A table row: a title and one cell per evaluation.
class Table {
 public:
  explicit Table(const std::vector<Evaluation>& evaluations) : evaluations_(evaluations) {
    for (const Evaluation& e : evaluations) width_ = std::max(width_, e.name.size() + 2);
  }

  template <typename Cell>
  void AddRow(const std::string& title, Cell cell) {
    text_ += fmt::format("{:<26}", title);
    for (const Evaluation& e : evaluations_) text_ += fmt::format("{:>{}}", cell(e), width_);
    text_ += '\n';
  }
  const std::string& text() const { return text_; }

 private:
  const std::vector<Evaluation>& evaluations_;
  size_t width_ = 12;
  std::string text_;
};

std::string FormatCoverage(const Evaluation& e) {
  const std::optional<double> coverage = e.Coverage();
  return coverage ? fmt::format("{:.1f} %", *coverage * 100) : "unknown";
}

std::string FormatStatistic(const Evaluation& e, const Measure& measure, const Column& column) {
  const std::vector<double>& values = measure.values(e);
  if (values.empty()) return "-";
  return fmt::format("{:.6f}", ComputeStatistics(values).*column.value / measure.unit);
}

}  // namespace

std::string FormatTable(const std::vector<Evaluation>& evaluations) {
  Table table(evaluations);
  table.AddRow("", [](const Evaluation& e) { return e.name; });
  table.AddRow("coverage", FormatCoverage);
  table.AddRow("poses", [](const Evaluation& e) { return std::to_string(e.num_poses); });
  table.AddRow("poses with ground truth",
               [](const Evaluation& e) { return std::to_string(e.pairs.size()); });
  const auto has_scale = [](const Evaluation& e) { return e.absolute.T_true_estimated.scale != 1; };
  if (std::any_of(evaluations.begin(), evaluations.end(), has_scale)) {
    table.AddRow("scale", [](const Evaluation& e) {
      return fmt::format("{:.6f}", e.absolute.T_true_estimated.scale);
    });
  }
  for (const Measure& measure : kMeasures) {
    for (const Column& column : kColumns) {
      const std::string title =
          fmt::format("{:<19}{}", &column == &kColumns[0] ? measure.title : "", column.title);
      table.AddRow(title, [&](const Evaluation& e) { return FormatStatistic(e, measure, column); });
    }
  }
  return table.text();
}

nlohmann::json StatisticsToJson(const std::vector<double>& values, double unit) {
  if (values.empty()) return nullptr;
  const Statistics statistics = ComputeStatistics(values);
  nlohmann::json json;
  for (const Column& column : kColumns) json[column.title] = statistics.*column.value / unit;
  return json;
}

nlohmann::json EvaluationToJson(const Evaluation& e) {
  const auto relative = [](const RelativeError& error) {
    return nlohmann::json{{"translation_m", StatisticsToJson(error.translation_m.value)},
                          {"rotation_deg", StatisticsToJson(error.rotation_rad.value, kDegree)}};
  };
  const std::optional<double> coverage = e.Coverage();
  return {
      {"name", e.name},
      {"poses", e.num_poses},
      {"associated", e.pairs.size()},
      {"input_frames", e.num_input_frames ? nlohmann::json(*e.num_input_frames) : nlohmann::json()},
      {"coverage", coverage ? nlohmann::json(*coverage) : nlohmann::json()},
      {"scale", e.absolute.T_true_estimated.scale},
      {"ate_m", StatisticsToJson(e.absolute.translation_m.value)},
      {"rpe_1_frame", relative(e.per_frame)},
      {"rpe_1_s", relative(e.per_second)}};
}

}  // namespace msf
