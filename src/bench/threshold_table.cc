// Table 1.
#include <fmt/format.h>

#include <algorithm>

#include "bench/paper_tables.h"
#include "bench/table_cells.h"

namespace msf {
namespace {

// The variants of one mode that differ in L, by L.
std::vector<std::pair<double, std::string>> Thresholds(const Suite& suite,
                                                       const std::string& dynamic) {
  std::vector<std::pair<double, std::string>> thresholds;
  for (const SuiteVariant& variant : suite.variants) {
    if (variant.threshold_px > 0 && variant.dynamic == dynamic)
      thresholds.emplace_back(variant.threshold_px, variant.name);
  }
  std::sort(thresholds.begin(), thresholds.end());
  return thresholds;
}

void AddThresholdCells(const BenchResults& results, const std::string& sequence, double threshold,
                       const std::string& dynamic, std::vector<Cell>& row) {
  Runs runs;
  for (const auto& [value, variant] : Thresholds(results.suite, dynamic)) {
    if (value == threshold) runs = results.Of(sequence, variant);
  }
  row.emplace_back(FormatMedian(SpreadOf(runs, AteOf()), 4));
  row.emplace_back(FormatMedian(SpreadOf(runs, KeptOf), 1, kPercent));
  row.emplace_back(FormatMedian(SpreadOf(runs, RemovedOf), 1, kPercent));
  row.emplace_back(FormatCoverage(runs));
}

Table ThresholdTable(const BenchResults& results, const PublishedFigures& published,
                     const SuiteSequence& sequence) {
  Table table{
      "table1_" + sequence.name,
      "Table 1: sensitivity to the motion threshold L, " + sequence.name,
      "In italics: as published, on the real " + published.threshold_sequence +
          ". Kept and removed: shares of the points on what stands still and on what moves, "
          "against true masks where the sequence has them. Mode paper tests the raw flow, "
          "mode full the flow that the camera's motion does not explain.",
      {{"", 1}, {"published", 3}, {"measured, mode paper", 4}, {"measured, mode full", 4}},
      {"L [px]", "ATE RMSE", "static kept %", "dynamic removed %"},
      {}};
  for (int i = 0; i < 2; ++i) {
    for (const char* column : {"ATE RMSE", "static kept %", "dynamic removed %", "Coverage"})
      table.columns.emplace_back(column);
  }
  std::vector<double> values;
  for (const PublishedThreshold& row : published.threshold) values.push_back(row.threshold_px);
  for (const char* dynamic : {"paper", "full"}) {
    for (const auto& [value, variant] : Thresholds(results.suite, dynamic)) values.push_back(value);
  }
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  for (const double value : values) {
    std::vector<Cell> row = {fmt::format("{:g}", value)};
    PublishedThreshold theirs;
    for (const PublishedThreshold& p : published.threshold) {
      if (p.threshold_px == value) theirs = p;
    }
    row.push_back(PublishedNumber(theirs.ate_rmse_m, 4));
    row.push_back(PublishedNumber(theirs.static_kept, 1, kPercent));
    row.push_back(PublishedNumber(theirs.dynamic_removed, 1, kPercent));
    for (const char* dynamic : {"paper", "full"})
      AddThresholdCells(results, sequence.name, value, dynamic, row);
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

std::vector<Table> ThresholdTables(const BenchResults& results, const PublishedFigures& published) {
  std::vector<Table> tables;
  for (const SuiteSequence& sequence : results.suite.sequences) {
    const auto has_threshold = [&](const SuiteVariant& variant) {
      return variant.threshold_px > 0 && !results.Of(sequence.name, variant.name).empty();
    };
    const auto& variants = results.suite.variants;
    if (std::any_of(variants.begin(), variants.end(), has_threshold))
      tables.push_back(ThresholdTable(results, published, sequence));
  }
  return tables;
}

}  // namespace msf
