// What happened in a sequence: errors, states, static points and times, and the worst moments.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "bench/figures.h"
#include "bench/run_record.h"
#include "bench/thumbnail.h"
#include "evaluation/chart.h"
#include "evaluation/color_scale.h"
#include "evaluation/statistics.h"
#include "evaluation/trajectory_plot.h"
#include "io/image_reader.h"
#include "io/tum_dataset.h"

namespace msf {
namespace {

constexpr double kWidth = 960, kLeft = 130, kRight = 24, kPanel = 170;
constexpr double kStrip = 22, kStripGap = 8;
constexpr int kBins = 60;

Color StateColor(const std::string& state) {
  static const std::map<std::string, Color> colors = {
      {"tracking", {0x4c, 0xaf, 0x6a}},      {"initialising", {0xb0, 0xb0, 0xb0}},
      {"recently_lost", {0xf0, 0xa0, 0x30}}, {"lost", {0xd6, 0x2b, 0x2b}},
      {"dropped", {0x7a, 0x4f, 0xb0}},       {"missing", {0x30, 0x30, 0x30}}};
  const auto found = colors.find(state);
  return found == colors.end() ? Color{0x80, 0x80, 0x80} : found->second;
}

Range TimeOf(const std::vector<RunRecord>& runs) {
  Range time_s = Range::Empty();
  for (const RunRecord& run : runs) {
    time_s.Include(run.frames.front().time_s);
    time_s.Include(run.frames.back().time_s);
  }
  return time_s;
}

// One bar per run, coloured by the state of its frames; returns where the next panel may start.
double DrawStates(SvgCanvas& canvas, double top, const std::vector<RunRecord>& runs,
                  const Range& time_s) {
  const double width = kWidth - kLeft - kRight;
  const auto x_of = [&](double t) {
    return kLeft + (t - time_s.min) / std::max(time_s.length(), 1e-9) * width;
  };
  canvas.Text({kLeft + width / 2, top}, "states of the tracker",
              {.size = 13, .anchor = "middle", .bold = true});
  std::map<std::string, Color> seen;
  double y = top + 10;
  for (const RunRecord& run : runs) {
    canvas.Text({kLeft - 8, y + 16}, run.variant, {.anchor = "end"});
    for (size_t i = 0; i < run.frames.size();) {
      size_t end = i;
      while (end < run.frames.size() && run.frames[end].state == run.frames[i].state) ++end;
      const double to = end < run.frames.size() ? run.frames[end].time_s : time_s.max;
      seen[run.frames[i].state] = StateColor(run.frames[i].state);
      canvas.FillBox({x_of(run.frames[i].time_s), y,
                      std::max(1.0, x_of(to) - x_of(run.frames[i].time_s)), kStrip},
                     StateColor(run.frames[i].state));
      i = end;
    }
    y += kStrip + kStripGap;
  }
  std::vector<LegendEntry> legend;
  legend.reserve(seen.size());
  for (const auto& [state, color] : seen) legend.push_back({state, {color, 10}});
  DrawLegend(canvas, {kLeft, y}, legend);
  return y + 60;
}

double DrawStaticShares(SvgCanvas& canvas, double top, const std::vector<RunRecord>& runs,
                        const Range& time_s) {
  const auto has_share = [](const FrameRow& frame) { return frame.static_share.has_value(); };
  const auto any = [&](const RunRecord& run) {
    return std::any_of(run.frames.begin(), run.frames.end(), has_share);
  };
  if (std::none_of(runs.begin(), runs.end(), any)) return top;
  Chart chart(canvas, {{kLeft, top, kWidth - kLeft - kRight, kPanel},
                       "share of static points",
                       "time [s]",
                       "%",
                       {0, std::max(time_s.length(), 1e-3)},
                       {0, 102}});
  for (size_t i = 0; i < runs.size(); ++i) {
    std::vector<Eigen::Vector2d> points;
    for (const FrameRow& frame : runs[i].frames) {
      if (frame.static_share)
        points.emplace_back(frame.time_s - time_s.min, 100 * *frame.static_share);
    }
    chart.Curve(points, {LineColor(i), 1.3});
  }
  return top + kPanel + 84;
}

// Shares of the frames per bin of latency, as steps.
std::vector<Eigen::Vector2d> Histogram(const RunRecord& run, double bin_ms) {
  std::vector<double> counts(kBins, 0);
  double all = 0;
  for (const FrameRow& frame : run.frames) {
    if (!frame.latency_ms) continue;
    ++counts[std::min(kBins - 1, static_cast<int>(*frame.latency_ms / bin_ms))];
    ++all;
  }
  std::vector<Eigen::Vector2d> steps = {{0, 0}};
  for (int i = 0; i < kBins; ++i) {
    const double share = all == 0 ? 0 : 100 * counts[i] / all;
    steps.emplace_back(i * bin_ms, share);
    steps.emplace_back((i + 1) * bin_ms, share);
  }
  return steps;
}

double DrawLatencies(SvgCanvas& canvas, double top, const std::vector<RunRecord>& runs) {
  std::vector<double> latencies;
  for (const RunRecord& run : runs) {
    for (const FrameRow& frame : run.frames) {
      if (frame.latency_ms) latencies.push_back(*frame.latency_ms);
    }
  }
  if (latencies.empty()) return top;
  // A few stragglers must not squeeze all others into one bin; they are in the last one.
  const double bin_ms = std::max(1e-3, 1.1 * Percentile(latencies, 0.99) / kBins);
  Range share = {0, 1};
  for (const RunRecord& run : runs) {
    for (const Eigen::Vector2d& p : Histogram(run, bin_ms)) share.Include(1.08 * p.y());
  }
  Chart chart(canvas, {{kLeft, top, kWidth - kLeft - kRight, kPanel},
                       "time from a frame to its pose (longer ones are in the last bin)",
                       "ms",
                       "% of frames",
                       {0, kBins * bin_ms},
                       share});
  for (size_t i = 0; i < runs.size(); ++i)
    chart.Curve(Histogram(runs[i], bin_ms), {LineColor(i), 1.6});
  return top + kPanel + 60;
}

Figure CourseFigure(const SuiteSequence& sequence, const std::vector<RunRecord>& runs) {
  const double height =
      96 + static_cast<double>(runs.size()) * (kStrip + kStripGap) + 2 * (kPanel + 96) + 70;
  SvgCanvas canvas(kWidth, height);
  const std::string title = sequence.name + ": course of the runs";
  canvas.Text({kLeft, 26}, title, {.size = 15, .bold = true});
  std::vector<LegendEntry> legend;
  legend.reserve(runs.size());
  for (size_t i = 0; i < runs.size(); ++i) legend.push_back({runs[i].variant, {LineColor(i), 2.4}});
  DrawLegend(canvas, {kLeft, 36}, legend);
  const Range time_s = TimeOf(runs);
  double top = DrawStates(canvas, 78, runs, time_s);
  top = DrawStaticShares(canvas, top, runs, time_s);
  DrawLatencies(canvas, top, runs);
  return {"course_" + sequence.name, sequence.name, title, "", canvas.ToString()};
}

Figure ErrorFigure(const SuiteSequence& sequence, const std::vector<RunRecord>& runs) {
  std::vector<Evaluation> evaluations;
  evaluations.reserve(runs.size());
  for (const RunRecord& run : runs) evaluations.push_back(run.evaluation);
  return {"errors_" + sequence.name, sequence.name, sequence.name + ": errors over time", "",
          PlotErrors(evaluations)};
}

struct WorstFrame {
  double time_s = 0, error_m = 0;
};

// The largest errors, at least a second apart.
std::vector<WorstFrame> FindWorst(const Evaluation& evaluation, size_t count) {
  const ErrorSeries& errors = evaluation.absolute.translation_m;
  std::vector<WorstFrame> all, worst;
  for (size_t i = 0; i < errors.value.size(); ++i)
    all.push_back({errors.time_s[i], errors.value[i]});
  std::stable_sort(all.begin(), all.end(),
                   [](const WorstFrame& a, const WorstFrame& b) { return a.error_m > b.error_m; });
  for (const WorstFrame& frame : all) {
    const auto near = [&](const WorstFrame& w) { return std::abs(w.time_s - frame.time_s) < 1; };
    if (worst.size() < count && std::none_of(worst.begin(), worst.end(), near))
      worst.push_back(frame);
  }
  return worst;
}

std::optional<Figure> WorstFramesFigure(const SuiteSequence& sequence, const std::string& folder,
                                        const RunRecord& run) {
  constexpr int kThumbnail_px = 232;
  constexpr double kGap = 8, kTop = 44, kHeight = 174;
  const StatusOr<TumDataset> dataset = TumDataset::Open(folder, "tum_fr3");
  if (!dataset.ok()) return std::nullopt;
  SvgCanvas canvas(4 * (kThumbnail_px + kGap) + kGap, kTop + kHeight + 34);
  const std::string title =
      fmt::format("{}: the largest absolute errors of {}", sequence.name, run.variant);
  canvas.Text({kGap, 28}, title, {.size = 15, .bold = true});
  ImageReader reader;
  double left = kGap;
  for (const WorstFrame& worst : FindWorst(run.evaluation, 4)) {
    size_t index = 0;
    const auto distance_s = [&](size_t i) { return std::abs(dataset->time_s(i) - worst.time_s); };
    for (size_t i = 0; i < dataset->size(); ++i)
      index = distance_s(i) < distance_s(index) ? i : index;
    const StatusOr<cv::Mat> picture = reader.ReadColor(dataset->files(index).color);
    if (!picture.ok()) continue;
    canvas.Image({left, kTop, kThumbnail_px, kHeight}, ThumbnailAddress(*picture, kThumbnail_px));
    canvas.Text({left, kTop + kHeight + 18},
                fmt::format("frame {}, {:.2f} s: {:.4f} m", index,
                            worst.time_s - dataset->time_s(0), worst.error_m));
    left += kThumbnail_px + kGap;
  }
  return Figure{"worst_" + sequence.name, sequence.name, title, "", canvas.ToString()};
}

}  // namespace

std::vector<Figure> SequenceFigures(const std::filesystem::path& out, const BenchResults& results) {
  std::vector<Figure> figures;
  for (const SuiteSequence& sequence : results.suite.sequences) {
    const std::vector<RunRecord> runs = LoadRuns(out, results, sequence);
    if (runs.empty()) continue;
    figures.push_back(ErrorFigure(sequence, runs));
    figures.push_back(CourseFigure(sequence, runs));
    // Ours comes last where the suite has it.
    if (std::optional<Figure> worst =
            WorstFramesFigure(sequence, results.plan.FolderOf(sequence.name), runs.back()))
      figures.push_back(*std::move(worst));
  }
  return figures;
}

}  // namespace msf
