#include "detection/head_decoder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace msf {
namespace {

constexpr int64_t kBins = 16;  // per side of a box
constexpr int64_t kSides = 4;

// Reads a column of an output: element k of position p.
struct Column {
  Column(const NetworkOutput& output, size_t position)
      : data(output.data + (output.channels_last ? position * Channels(output) : position)),
        step(output.channels_last ? 1 : Positions(output)) {}
  float operator[](size_t k) const { return data[k * step]; }

  static size_t Channels(const NetworkOutput& output) {
    return static_cast<size_t>(output.shape[1]);
  }
  static size_t Positions(const NetworkOutput& output) {
    return static_cast<size_t>(NumElements(output.shape)) / Channels(output);
  }

  const float* data;
  size_t step;
};

// The mean of a distribution given by logits.
float Expectation(const Column& logits, size_t first) {
  float highest = logits[first];
  for (size_t i = 1; i < kBins; ++i) highest = std::max(highest, logits[first + i]);
  float sum = 0, weighted = 0;
  for (size_t i = 0; i < kBins; ++i) {
    const float weight = std::exp(logits[first + i] - highest);
    sum += weight;
    weighted += weight * static_cast<float>(i);
  }
  return weighted / sum;
}

// Calls report(class, value) for each class from `first` on that reaches the threshold, or only for
// the best of them.
template <typename Report>
void ForEachClass(const Column& scores, size_t first, size_t count, float threshold,
                  bool every_class, const Report& report) {
  size_t best = count;
  float best_score = threshold;
  for (size_t k = 0; k < count; ++k) {
    const float score = scores[first + k];
    if (!(score >= threshold)) continue;
    if (every_class) {
      report(k, score);
    } else if (best == count || score > best_score) {
      best = k;
      best_score = score;
    }
  }
  if (best < count) report(best, best_score);
}

const NetworkOutput* Find(const std::vector<NetworkOutput>& outputs, const std::string& name) {
  const auto found =
      std::find_if(outputs.begin(), outputs.end(), [&](const auto& o) { return o.name == name; });
  return found == outputs.end() ? nullptr : &*found;
}

}  // namespace

StatusOr<HeadDecoder> HeadDecoder::Make(const std::vector<NetworkOutput>& outputs,
                                        const std::string& source) {
  HeadDecoder decoder;
  std::string shapes;
  for (const NetworkOutput& o : outputs)
    shapes += fmt::format(" {} {};", o.name, ToString(o.shape));
  const auto error = [&](const std::string& why) {
    return Status::Error(
        fmt::format("{}: {}; its outputs are:{} expected are box_8, class_8, ... or one output "
                    "1 x (4 + classes) x boxes",
                    source, why, shapes));
  };
  if (outputs.size() == 1 && outputs[0].shape.size() == 3) {
    const Shape& s = outputs[0].shape;
    if (s[0] != 1 || s[1] < 5 || s[1] > s[2]) return error("is no detector of a known form");
    decoder.num_classes_ = static_cast<int>(s[1]) - 4;
    return decoder;
  }
  for (const int stride : {8, 16, 32}) {
    const NetworkOutput* box = Find(outputs, fmt::format("box_{}", stride));
    const NetworkOutput* klass = Find(outputs, fmt::format("class_{}", stride));
    if (!box || !klass) return error("is no detector of a known form");
    const Shape &b = box->shape, &c = klass->shape;
    if (b.size() != 4 || c.size() != 4 || b[0] != 1 || c[0] != 1 || b[1] != kSides * kBins ||
        c[1] < 1 || b[2] != c[2] || b[3] != c[3] || (stride > 8 && c[1] != decoder.num_classes_)) {
      return error("has heads of shapes that do not belong together");
    }
    decoder.num_classes_ = static_cast<int>(c[1]);
    decoder.scales_.push_back({static_cast<size_t>(box - outputs.data()),
                               static_cast<size_t>(klass - outputs.data()),
                               static_cast<float>(stride)});
  }
  return decoder;
}

std::vector<Detection> HeadDecoder::Decode(const std::vector<NetworkOutput>& outputs,
                                           float confidence, bool every_class) const {
  std::vector<Detection> found;
  for (const RawScale& scale : scales_) DecodeScale(scale, outputs, confidence, every_class, found);
  if (scales_.empty()) DecodeSingle(outputs[0], confidence, every_class, found);
  return found;
}

std::vector<float> HeadDecoder::Scores(const std::vector<NetworkOutput>& outputs) const {
  std::vector<float> scores;
  const auto append = [&](const NetworkOutput& output, size_t first, auto&& score) {
    for (size_t i = 0; i < Column::Positions(output); ++i) {
      const Column column(output, i);
      for (size_t k = 0; k < static_cast<size_t>(num_classes_); ++k)
        scores.push_back(score(column[first + k]));
    }
  };
  for (const RawScale& scale : scales_)
    append(outputs[scale.klass], 0, [](float logit) { return 1 / (1 + std::exp(-logit)); });
  if (scales_.empty()) append(outputs[0], kSides, [](float score) { return score; });
  return scores;
}

void HeadDecoder::DecodeScale(const RawScale& scale, const std::vector<NetworkOutput>& outputs,
                              float confidence, bool every_class,
                              std::vector<Detection>& found) const {
  const NetworkOutput &boxes = outputs[scale.box], &classes = outputs[scale.klass];
  const size_t width = static_cast<size_t>(boxes.shape[3]),
               height = static_cast<size_t>(boxes.shape[2]);
  const float p = std::clamp(confidence, 1e-6f, 1 - 1e-6f);
  const float least_logit =
      std::log(p / (1 - p));  // most cells are background: no sigmoid for them
  for (size_t cell = 0; cell < width * height; ++cell) {
    ForEachClass(Column(classes, cell), 0, static_cast<size_t>(num_classes_), least_logit,
                 every_class, [&](size_t k, float logit) {
                   const Column sides(boxes, cell);
                   const auto column = cell % width, row = cell / width;
                   const float x = static_cast<float>(column) + 0.5f,
                               y = static_cast<float>(row) + 0.5f;
                   const ImageBox box{(x - Expectation(sides, 0)) * scale.stride,
                                      (y - Expectation(sides, kBins)) * scale.stride,
                                      (x + Expectation(sides, 2 * kBins)) * scale.stride,
                                      (y + Expectation(sides, 3 * kBins)) * scale.stride};
                   found.push_back({static_cast<int>(k), 1 / (1 + std::exp(-logit)), box});
                 });
  }
}

void HeadDecoder::DecodeSingle(const NetworkOutput& output, float confidence, bool every_class,
                               std::vector<Detection>& found) const {
  for (size_t i = 0; i < static_cast<size_t>(output.shape[2]); ++i) {
    const Column values(output, i);
    ForEachClass(values, kSides, static_cast<size_t>(num_classes_), confidence, every_class,
                 [&](size_t k, float score) {
                   const float half_width = values[2] / 2, half_height = values[3] / 2;
                   found.push_back({static_cast<int>(k),
                                    score,
                                    {values[0] - half_width, values[1] - half_height,
                                     values[0] + half_width, values[1] + half_height}});
                 });
  }
}

}  // namespace msf
