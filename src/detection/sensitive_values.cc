#include "detection/sensitive_values.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "detection/compiled_network.h"
#include "detection/head_decoder.h"
#include "detection/letterbox.h"
#include "detection/onednn_detector.h"

namespace msf {
namespace {

constexpr float kLeastScore = 0.05f;  // below it nobody looks at a detection
// Only what helps most when it is left out alone is tried together with others.
constexpr size_t kCandidatesPerValue = 2;

using Scores = std::vector<std::vector<float>>;  // per image

double ScoreError(const Scores& reference, const Scores& scores) {
  double sum = 0, count = 0;
  for (size_t i = 0; i < reference.size(); ++i) {
    for (size_t k = 0; k < reference[i].size(); ++k) {
      if (std::max(reference[i][k], scores[i][k]) < kLeastScore) continue;
      const double difference = scores[i][k] - reference[i][k];
      sum += difference * difference;
      count += 1;
    }
  }
  return count > 0 ? std::sqrt(sum / count) : 0;
}

class Search {
 public:
  Search(const Graph& graph, const ActivationRanges& ranges, cv::Size size,
         const SensitivityOptions& options, std::vector<cv::Mat> images,
         const std::function<void(int, int)>& progress)
      : graph_(graph),
        ranges_(ranges),
        size_(size),
        options_(options),
        images_(std::move(images)),
        progress_(progress),
        max_trials_(static_cast<int>(1 + ranges.size() + MaxValues() * MaxCandidates())) {}

  StatusOr<SensitiveValues> Run() {
    StatusOr<Scored> reference = Score(graph_, NetworkPrecision::kFloat32);
    if (!reference.ok()) return reference.status();
    reference_ = std::move(reference->scores);
    StatusOr<Trial> all = Try(ranges_);
    if (!all.ok()) return all.status();
    SensitiveValues result{{}, all->error, all->error};
    if (MaxValues() == 0) return result;
    StatusOr<std::vector<std::string>> candidates = FindCandidates();
    if (!candidates.ok()) return candidates.status();
    while (result.names.size() < MaxValues()) {
      StatusOr<bool> added = AddBest(*candidates, result);
      if (!added.ok()) return added.status();
      if (!*added) break;
    }
    progress_(max_trials_, max_trials_);
    return result;
  }

 private:
  struct Scored {
    Scores scores;
    double int8_share = 0;
  };
  struct Trial {
    double error = 0;
    double share_left = 0;  // of the multiply-adds that could be done in 8 bits and are not
  };

  size_t MaxValues() const {
    return std::min(static_cast<size_t>(std::max(options_.max_values, 0)), ranges_.size());
  }
  size_t MaxCandidates() const {
    return std::min(MaxValues() * kCandidatesPerValue, ranges_.size());
  }

  StatusOr<Scored> Score(const Graph& graph, NetworkPrecision precision) const {
    CompileOptions compile;
    compile.width = size_.width;
    compile.height = size_.height;
    compile.precision = precision;
    auto network = CompiledNetwork::Compile(graph, compile);
    if (!network.ok()) return network.status();
    StatusOr<HeadDecoder> decoder = HeadDecoder::Make((*network)->outputs(), graph.source);
    if (!decoder.ok()) return decoder.status();
    Scored result;
    for (const cv::Mat& image : images_) {
      Letterbox(image.size(), size_).Fill(image, (*network)->pixels());
      MSF_RETURN_IF_ERROR((*network)->Run());
      result.scores.push_back(decoder->Scores((*network)->outputs()));
    }
    result.int8_share = (*network)->int8_share();
    return result;
  }

  StatusOr<Trial> Try(const ActivationRanges& ranges) {
    Graph graph = graph_;
    graph.metadata[kActivationRangesKey] = FormatActivationRanges(ranges);
    StatusOr<Scored> scored = Score(graph, NetworkPrecision::kInt8);
    if (!scored.ok()) return scored.status();
    progress_(++num_trials_, max_trials_);
    most_int8_ = std::max(most_int8_, scored->int8_share);  // the first trial's: all ranges
    return Trial{ScoreError(reference_, scored->scores), most_int8_ - scored->int8_share};
  }

  // Those that gain most alone, of the values whose range matters at all and that do not cost too
  // much.
  StatusOr<std::vector<std::string>> FindCandidates() {
    std::vector<std::pair<double, std::string>> ranked;
    for (const auto& [name, range] : ranges_) {
      ActivationRanges others = ranges_;
      others.erase(name);
      StatusOr<Trial> trial = Try(others);
      if (!trial.ok()) return trial.status();
      if (trial->share_left > 0 && trial->share_left <= options_.max_share)
        ranked.emplace_back(trial->error, name);
    }
    std::sort(ranked.begin(), ranked.end());
    std::vector<std::string> candidates;
    for (size_t i = 0; i < std::min(ranked.size(), MaxCandidates()); ++i)
      candidates.push_back(ranked[i].second);
    return candidates;
  }

  // False when no candidate gains enough.
  StatusOr<bool> AddBest(const std::vector<std::string>& candidates, SensitiveValues& result) {
    ActivationRanges without = ranges_;
    for (const std::string& name : result.names) without.erase(name);
    std::string best;
    double least = result.error_without * (1 - options_.min_gain), share = 0;
    for (const std::string& name : candidates) {
      ActivationRanges fewer = without;
      if (fewer.erase(name) == 0) continue;
      StatusOr<Trial> trial = Try(fewer);
      if (!trial.ok()) return trial.status();
      if (trial->error >= least || trial->share_left > options_.max_share) continue;
      least = trial->error;
      share = trial->share_left;
      best = name;
    }
    if (best.empty()) return false;
    result.names.push_back(best);
    result.error_without = least;
    result.share = share;
    return true;
  }

  const Graph& graph_;
  const ActivationRanges& ranges_;
  const cv::Size size_;
  const SensitivityOptions options_;
  const std::vector<cv::Mat> images_;
  const std::function<void(int, int)>& progress_;
  const int max_trials_;
  Scores reference_;
  double most_int8_ = 0;
  int num_trials_ = 0;
};

}  // namespace

StatusOr<SensitiveValues> FindSensitiveValues(const Graph& graph, const ActivationRanges& ranges,
                                              const CalibrationOptions& size,
                                              const SensitivityOptions& options,
                                              const CalibrationImages& images,
                                              const std::function<void(int, int)>& progress) {
  DetectorOptions detector;
  detector.width = size.width;
  detector.height = size.height;
  StatusOr<cv::Size> input = InputSizeFor(detector, graph);
  if (!input.ok()) return input.status();
  const int wanted = std::min(images.count, options.max_images);
  std::vector<cv::Mat> pictures;
  for (int i = 0; i < wanted; ++i) {
    StatusOr<cv::Mat> picture = images.read(i * images.count / wanted);
    if (!picture.ok()) return picture.status();
    MSF_RETURN_IF_ERROR(CheckImage(*picture));
    pictures.push_back(*std::move(picture));
  }
  return Search(graph, ranges, *input, options, std::move(pictures), progress).Run();
}

}  // namespace msf
