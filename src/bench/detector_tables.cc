// Tables 3 and 4.
#include <fmt/format.h>

#include <string>

#include "bench/paper_tables.h"
#include "bench/table_cells.h"

namespace msf {
namespace {

std::vector<Cell> DetectorRow(const TaskResult& result) {
  if (!result.detector) return {result.variant, "measured", result.status, "", "", "", "", "", ""};
  const DetectorFigures& d = *result.detector;
  const auto percent = [](double share) { return fmt::format("{:.1f}", share / kPercent); };
  return {
      result.variant,
      "measured",
      percent(d.precision),
      percent(d.recall),
      percent(d.map50),
      percent(d.map50_95),
      fmt::format("{:.2f}", d.parameters_m),
      fmt::format("{:.1f}", d.gflops),
      result.timing.detector_ms > 0 ? fmt::format("{:.1f}", 1000 / result.timing.detector_ms) : ""};
}

std::vector<Cell> PublishedDetectorRow(const PublishedDetector& d) {
  return {{d.model, true},
          {"published", true},
          PublishedNumber(d.precision, 1, kPercent),
          PublishedNumber(d.recall, 1, kPercent),
          PublishedNumber(d.map50, 1, kPercent),
          PublishedNumber(d.map50_95, 1, kPercent),
          PublishedNumber(d.parameters_m, 2),
          PublishedNumber(d.gflops, 1),
          PublishedNumber(d.fps, 1)};
}

}  // namespace

std::vector<Table> DetectorTables(const BenchResults& results, const PublishedFigures& published) {
  std::vector<std::vector<Cell>> measured;
  for (const TaskResult& result : results.results) {
    if (result.id.starts_with("detectors/")) measured.push_back(DetectorRow(result));
  }
  if (measured.empty()) return {};
  const DetectorData& data = results.suite.detector_data;
  const std::string note = fmt::format(
      "In italics: as published, on all of VOC2007 at 640x640 and on a GPU. Measured: {}{} at {}, "
      "on "
      "one thread of this CPU; parameters and GFLOPs (2 per multiply-add) at 640x640.",
      data.limit > 0 ? fmt::format("the first {} test images of ", data.limit) : "", data.folder,
      data.size);
  const std::vector<std::string> columns = {"Model",      "Source",     "P %",    "R %", "mAP50 %",
                                            "mAP50-95 %", "params [M]", "GFLOPs", "FPS"};
  Table three{"table3", "Table 3: the detector with and without MSFConv", note, {}, columns, {}, 2};
  Table four{"table4", "Table 4: the detector against other necks", note, {}, columns, {}, 2};
  for (size_t i = 0; i < published.detectors.size(); ++i) {
    const std::vector<Cell> row = PublishedDetectorRow(published.detectors[i]);
    if (i < 2) three.rows.push_back(row);
    four.rows.push_back(row);
  }
  for (Table* table : {&three, &four})
    table->rows.insert(table->rows.end(), measured.begin(), measured.end());
  return {three, four};
}

}  // namespace msf
