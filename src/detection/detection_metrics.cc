#include "detection/detection_metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "util/check.h"

namespace msf {
namespace {

constexpr size_t kNumThresholds = 10;  // IoU 0.50, 0.55, ..., 0.95
constexpr size_t kGrid = 1000;         // confidences at which precision and recall are looked at

double Threshold(size_t i) { return 0.5 + 0.05 * static_cast<double>(i); }

// A detection of one class with the verdict at each IoU threshold.
struct Verdict {
  float score = 0;
  std::array<bool, kNumThresholds> right{};
};

// Verdicts on the detections of one class in one image. Every detection stands for the object that
// it overlaps most; of those that stand for the same object well enough the strongest is right.
void Judge(const ScoredImage& image, int class_id, std::vector<Verdict>& all) {
  std::vector<const Detection*> ranked;
  for (const Detection& found : image.found) {
    if (found.class_id == class_id) ranked.push_back(&found);
  }
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const auto* a, const auto* b) { return a->score > b->score; });
  std::vector<std::array<bool, kNumThresholds>> taken(image.truth.size());
  for (const Detection* found : ranked) {
    Verdict verdict{found->score, {}};
    bool ignored = false;
    double best = 0;
    size_t object = 0;
    for (size_t t = 0; t < image.truth.size(); ++t) {
      if (image.truth[t].class_id != class_id) continue;
      const double iou = IntersectionOverUnion(image.truth[t].box, found->box);
      if (image.truth[t].ignored) {
        ignored = ignored || iou >= Threshold(0);
      } else if (iou > best) {
        best = iou;
        object = t;
      }
    }
    for (size_t level = 0; level < kNumThresholds && best >= Threshold(level); ++level) {
      verdict.right[level] = !taken[object][level];
      taken[object][level] = true;
    }
    if (!ignored || verdict.right[0]) all.push_back(verdict);
  }
}

std::vector<OperatingPoint> Curve(const std::vector<Verdict>& verdicts, size_t level,
                                  int num_objects) {
  std::vector<OperatingPoint> curve;
  int right = 0;
  for (size_t i = 0; i < verdicts.size(); ++i) {
    right += verdicts[i].right[level];
    curve.push_back({verdicts[i].score,
                     num_objects > 0 ? static_cast<double>(right) / num_objects : 0,
                     static_cast<double>(right) / static_cast<double>(i + 1)});
  }
  return curve;
}

// Precision and recall if only scores above `confidence` counted, linear between neighbouring
// detections.
std::pair<double, double> AtConfidence(const std::vector<OperatingPoint>& curve,
                                       double confidence) {
  if (curve.empty() || confidence > curve.front().score) return {1.0, 0.0};
  if (confidence <= curve.back().score) return {curve.back().precision, curve.back().recall};
  const auto after = std::partition_point(
      curve.begin(), curve.end(), [&](const OperatingPoint& p) { return p.score >= confidence; });
  const OperatingPoint &a = *(after - 1), &b = *after;
  const double t = (a.score - confidence) / (a.score - b.score);
  return {a.precision + t * (b.precision - a.precision), a.recall + t * (b.recall - a.recall)};
}

// Moving average; beyond the ends the first and last numbers are repeated.
std::vector<double> Smooth(const std::vector<double>& values, int width) {
  const int n = static_cast<int>(values.size()), half = width / 2;
  std::vector<double> smooth(values.size());
  for (int i = 0; i < n; ++i) {
    double sum = 0;
    for (int k = -half; k <= half; ++k)
      sum += values[static_cast<size_t>(std::clamp(i + k, 0, n - 1))];
    smooth[static_cast<size_t>(i)] = sum / (2 * half + 1);
  }
  return smooth;
}

// The confidence with the best mean F1 score over classes with objects.
double BestConfidence(const std::vector<ClassMetrics>& classes, int min_objects) {
  std::vector<double> f1(kGrid, 0.0);
  for (const ClassMetrics& c : classes) {
    if (c.num_objects < min_objects) continue;
    for (size_t i = 0; i < kGrid; ++i) {
      const auto [p, r] = AtConfidence(c.curve, static_cast<double>(i) / (kGrid - 1));
      f1[i] += p + r > 0 ? 2 * p * r / (p + r) : 0;
    }
  }
  const std::vector<double> smooth = Smooth(f1, static_cast<int>(kGrid) / 10);
  const auto best = std::max_element(smooth.begin(), smooth.end());
  return static_cast<double>(best - smooth.begin()) / (kGrid - 1);
}

ClassMetrics ScoreClass(const std::vector<ScoredImage>& images, int class_id) {
  ClassMetrics metrics;
  std::vector<Verdict> verdicts;
  for (const ScoredImage& image : images) {
    metrics.num_objects +=
        static_cast<int>(std::count_if(image.truth.begin(), image.truth.end(), [&](const auto& t) {
          return t.class_id == class_id && !t.ignored;
        }));
    Judge(image, class_id, verdicts);
  }
  std::stable_sort(verdicts.begin(), verdicts.end(),
                   [](const auto& a, const auto& b) { return a.score > b.score; });
  for (size_t level = 0; level < kNumThresholds; ++level) {
    std::vector<OperatingPoint> curve = Curve(verdicts, level, metrics.num_objects);
    const double ap = AveragePrecision101(curve);
    metrics.ap50_95 += ap / kNumThresholds;
    if (level > 0) continue;
    metrics.ap50 = ap;
    metrics.curve = std::move(curve);
  }
  return metrics;
}

}  // namespace

double AveragePrecision101(const std::vector<OperatingPoint>& curve) {
  if (curve.empty() || curve.back().recall <= 0) return 0;
  // Recall 0 with precision 1 before the first detection, recall 1 with precision 0 after the last.
  std::vector<double> recall{0}, precision{1};
  for (const OperatingPoint& point : curve) {
    recall.push_back(point.recall);
    precision.push_back(point.precision);
  }
  recall.push_back(1);
  precision.push_back(0);
  for (size_t i = precision.size() - 1; i-- > 0;)
    precision[i] = std::max(precision[i], precision[i + 1]);
  double area = 0, before = 1;
  for (int i = 0; i <= 100; ++i) {
    const double at = i / 100.0;
    const size_t after =
        static_cast<size_t>(std::upper_bound(recall.begin(), recall.end(), at) - recall.begin());
    double value = precision.back();
    if (after < recall.size()) {
      const double t = (at - recall[after - 1]) / (recall[after] - recall[after - 1]);
      value = precision[after - 1] + t * (precision[after] - precision[after - 1]);
    }
    if (i == 0) {
      before = value;
      continue;
    }
    area += 0.01 * (before + value) / 2;
    before = value;
  }
  return area;
}

DetectionMetrics ComputeMetrics(const std::vector<ScoredImage>& images, int num_classes,
                                int min_objects) {
  MSF_CHECK(min_objects >= 1, "classes without objects have no recall");
  DetectionMetrics metrics;
  for (int c = 0; c < num_classes; ++c) metrics.per_class.push_back(ScoreClass(images, c));
  metrics.confidence = BestConfidence(metrics.per_class, min_objects);
  for (ClassMetrics& c : metrics.per_class) {
    std::tie(c.precision, c.recall) = AtConfidence(c.curve, metrics.confidence);
    if (c.num_objects < min_objects) continue;
    ++metrics.num_classes;
    metrics.precision += c.precision;
    metrics.recall += c.recall;
    metrics.map50 += c.ap50;
    metrics.map50_95 += c.ap50_95;
  }
  if (metrics.num_classes == 0) return metrics;
  for (double* mean : {&metrics.precision, &metrics.recall, &metrics.map50, &metrics.map50_95}) {
    *mean /= metrics.num_classes;
  }
  return metrics;
}

RecallAtFalseRate ComputeRecallAtFalseRate(const std::vector<ScoredImage>& images, int class_id,
                                           double false_per_image) {
  struct Found {
    float score;
    size_t image;
    const Detection* detection;
  };
  RecallAtFalseRate result;
  std::vector<Found> all;
  std::vector<std::vector<bool>> used;
  for (size_t i = 0; i < images.size(); ++i) {
    used.emplace_back(images[i].truth.size(), false);
    for (const LabeledBox& t : images[i].truth)
      result.num_objects += t.class_id == class_id && !t.ignored;
    for (const Detection& d : images[i].found) {
      if (d.class_id == class_id) all.push_back({d.score, i, &d});
    }
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const Found& a, const Found& b) { return a.score > b.score; });
  const int allowed =
      static_cast<int>(std::floor(false_per_image * static_cast<double>(images.size()) + 1e-9));
  int right = 0, wrong = 0;
  for (const Found& found : all) {
    const std::vector<LabeledBox>& truth = images[found.image].truth;
    double best = 0.5;
    size_t match = truth.size();
    bool ignored = false;
    for (size_t t = 0; t < truth.size(); ++t) {
      if (truth[t].class_id != class_id || used[found.image][t]) continue;
      const double iou = IntersectionOverUnion(truth[t].box, found.detection->box);
      if (truth[t].ignored) {
        ignored = ignored || iou >= 0.5;
      } else if (iou >= best) {
        best = iou;
        match = t;
      }
    }
    if (match == truth.size()) {
      if (ignored) continue;
      if (++wrong > allowed) break;
    } else {
      used[found.image][match] = true;
      ++right;
    }
    result.score = found.score;
    result.num_found = right;
    result.num_false = wrong;
  }
  result.recall =
      result.num_objects > 0 ? static_cast<double>(result.num_found) / result.num_objects : 0;
  return result;
}

std::string FormatMetrics(const DetectionMetrics& metrics,
                          const std::vector<std::string>& class_names) {
  std::string text = fmt::format("{:<16}{:>9}{:>8}{:>8}{:>8}{:>10}\n", "class", "objects", "P", "R",
                                 "mAP50", "mAP50-95");
  const auto row = [&](const std::string& name, int objects, double p, double r, double ap50,
                       double ap) {
    text += fmt::format("{:<16}{:>9}{:>8.3f}{:>8.3f}{:>8.3f}{:>10.3f}\n", name, objects, p, r, ap50,
                        ap);
  };
  int objects = 0;
  for (const ClassMetrics& c : metrics.per_class) objects += c.num_objects;
  row(fmt::format("mean of {}", metrics.num_classes), objects, metrics.precision, metrics.recall,
      metrics.map50, metrics.map50_95);
  for (size_t i = 0; i < metrics.per_class.size(); ++i) {
    const ClassMetrics& c = metrics.per_class[i];
    if (c.num_objects > 0)
      row(class_names[i], c.num_objects, c.precision, c.recall, c.ap50, c.ap50_95);
  }
  return text;
}

}  // namespace msf
