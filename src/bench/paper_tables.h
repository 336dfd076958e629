// The tables of the paper (Duan et al. 2025) in its layout, its figures beside ours.
#pragma once

#include <vector>

#include "bench/bench_run.h"
#include "bench/published.h"
#include "bench/table.h"

namespace msf {

// All variants of all sequences, one row each: what the other tables choose from.
Table OverviewTable(const BenchResults& results);

// What each variant is: its mode, options and purpose.
Table VariantTable(const BenchResults& results);

// Table 1, once per sequence that was run with several thresholds.
std::vector<Table> ThresholdTables(const BenchResults& results, const PublishedFigures& published);
// Tables 3 and 4; none when no detector was scored.
std::vector<Table> DetectorTables(const BenchResults& results, const PublishedFigures& published);
// Tables 5 and 6: the baseline beside ours.
Table AbsoluteErrorTable(const BenchResults& results, const PublishedFigures& published);
Table RelativeErrorTable(const BenchResults& results, const PublishedFigures& published);
// Table 7: other systems, published and measured (peers), and more of them than the paper has.
std::vector<Table> ComparisonTables(const BenchResults& results, const PublishedFigures& published);
// Table 8.
Table RuntimeTable(const BenchResults& results, const PublishedFigures& published);

// Those of the above that the suite has figures for, in the paper's order.
std::vector<Table> PaperTables(const BenchResults& results, const PublishedFigures& published);

}  // namespace msf
