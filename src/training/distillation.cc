#include "training/distillation.h"

#include <torch/types.h>
#include <torch/utils.h>

#include <algorithm>

#include "training/mixed_precision.h"
#include "training/turning.h"
#include "util/check.h"

namespace msf {

namespace {

torch::Tensor RelativeError(const torch::Tensor& given, const torch::Tensor& wanted) {
  const torch::Tensor target = wanted.to(torch::kFloat);
  // Per channel, so that quiet channels count as much as loud ones.
  const torch::Tensor spread = target.var({0, 2, 3}, false, true) + 1e-3;
  return ((given.to(torch::kFloat) - target).square() / spread).mean();
}

// The same for class logits, weighted by the teacher's scores: almost all cells are background, the
// few others are what matters.
// `counted`: [batch, 1, h, w], 1 for cells that count, else 0.
torch::Tensor ScoreWeightedError(const torch::Tensor& given, const torch::Tensor& wanted,
                                 const torch::Tensor& counted) {
  constexpr double kBackgroundWeight = 0.02;
  const torch::Tensor target = wanted.to(torch::kFloat);
  const torch::Tensor weight = (target.sigmoid() + kBackgroundWeight) * counted;
  const torch::Tensor error = (given.to(torch::kFloat) - target).square() * weight;
  // Small maps may have no cell that counts.
  return error.sum() / ((weight.sum() + 1e-6) * (target.var() + 1e-3));
}

// A value of the student's node `index`, if it is the output of a layer, is the teacher's output of
// that layer.
int TeacherNode(const ModelGraph& student, const ModelGraph& teacher, int index) {
  if (index == 0) return 0;
  for (size_t layer = 0; layer < student.layers.size() && layer < teacher.layers.size(); ++layer) {
    if (student.LayerOutput(static_cast<int>(layer)) == index)
      return teacher.LayerOutput(static_cast<int>(layer));
  }
  MSF_CHECK(false, "layers may only use outputs of layers");
}

// A square part of a layer's output; the input is `step` times as large. Early layers have far more
// pixels than their few weights need.
struct Window {
  int64_t top = 0, left = 0, size = 0, step = 1;
};
constexpr int64_t kLargestWindow = 40;
constexpr int64_t kWindowMargin = 4;

Window DrawWindow(const torch::Tensor& input, const torch::Tensor& output) {
  const int64_t side = std::min(output.size(2), output.size(3));
  Window window{.size = std::min(side, kLargestWindow), .step = input.size(2) / output.size(2)};
  window.top = torch::randint(output.size(2) - window.size + 1, {1}, torch::kLong).item<int64_t>();
  window.left = torch::randint(output.size(3) - window.size + 1, {1}, torch::kLong).item<int64_t>();
  return window;
}

torch::Tensor Cut(const torch::Tensor& map, int64_t top, int64_t left, int64_t size) {
  return map.narrow(2, top, size).narrow(3, left, size);
}

bool SameKind(const std::string& a, const std::string& b) {
  const auto kind = [](const std::string& type) {
    return type == "MSFConv" ? std::string("Conv") : type;
  };
  return kind(a) == kind(b);
}

}  // namespace

LayerDistillation::LayerDistillation(const Network& student, const Network& teacher,
                                     const std::vector<std::string>& new_tensors)
    : student_(student), teacher_(teacher) {
  const ModelGraph& own = student.graph();
  const ModelGraph& other = teacher.graph();
  for (int i = 0; i < static_cast<int>(std::min(own.layers.size(), other.layers.size())); ++i) {
    if (!SameKind(own.layers[i].type, other.layers[i].type)) break;
    const std::string prefix = "model." + std::to_string(i) + ".";
    const bool is_new =
        std::any_of(new_tensors.begin(), new_tensors.end(),
                    [&](const std::string& name) { return name.starts_with(prefix); });
    if (is_new) layers_.push_back(i);
  }
}

torch::Tensor LayerDistillation::LayerError(
    int layer, std::vector<torch::Tensor>& values,
    const std::vector<torch::Tensor>& teacher_values) const {
  const ModelGraph& own = student_.graph();
  const ModelGraph& other = teacher_.graph();
  const GraphLayer& nodes = own.layers[layer];
  for (int i = nodes.begin; i < nodes.end; ++i) {
    for (int input : own.nodes[i].inputs) {
      if (input < nodes.begin) values[input] = teacher_values[TeacherNode(own, other, input)];
    }
  }
  if (own.layers[layer].type == "Detect") {
    student_.RunNodes(nodes.begin, nodes.end, values);
    const HeadOutputs heads = student_.HeadsOf(values);
    return ClassDistance(heads, teacher_.HeadsOf(teacher_values),
                         torch::zeros({heads.classes[0].size(0)}));
  }
  const torch::Tensor& wanted = teacher_values[other.LayerOutput(layer)];
  torch::Tensor& input = values[own.nodes[nodes.begin].inputs[0]];
  const Window window = DrawWindow(input, wanted);
  const torch::Tensor full = input;
  input = Cut(full, window.top * window.step, window.left * window.step, window.size * window.step);
  student_.RunNodes(nodes.begin, nodes.end, values);
  input = full;
  // Near the window's edge the student does not see what the teacher saw.
  const int64_t margin = window.size < wanted.size(2) ? kWindowMargin : 0,
                inner = window.size - 2 * margin;
  return RelativeError(Cut(values[own.LayerOutput(layer)], margin, margin, inner),
                       Cut(wanted, window.top + margin, window.left + margin, inner));
}

std::vector<torch::Tensor> LayerDistillation::LayerErrors(const torch::Tensor& images,
                                                          bool bfloat16) const {
  const MixedPrecision mixed(bfloat16);
  std::vector<torch::Tensor> teacher_values(teacher_.graph().nodes.size());
  teacher_values[0] = images.contiguous(torch::MemoryFormat::ChannelsLast);
  {
    const torch::NoGradGuard no_grad;
    teacher_.RunNodes(1, static_cast<int>(teacher_values.size()), teacher_values);
  }
  std::vector<torch::Tensor> values(student_.graph().nodes.size());
  std::vector<torch::Tensor> errors;
  for (int layer : layers_) errors.push_back(LayerError(layer, values, teacher_values));
  return errors;
}

torch::Tensor LayerDistillation::Loss(const torch::Tensor& images, bool bfloat16) const {
  return torch::stack(LayerErrors(images, bfloat16)).mean();
}

std::vector<double> LayerDistillation::Errors(const torch::Tensor& images, bool bfloat16) const {
  const torch::NoGradGuard no_grad;
  std::vector<double> errors;
  for (const torch::Tensor& error : LayerErrors(images, bfloat16))
    errors.push_back(error.item<double>());
  return errors;
}

torch::Tensor FeatureDistance(const ModelGraph& student,
                              const std::vector<torch::Tensor>& student_values,
                              const ModelGraph& teacher,
                              const std::vector<torch::Tensor>& teacher_values,
                              const torch::Tensor& pictures) {
  constexpr int kLeastScale = 8;  // earlier layers have most of the pixels and little to say
  if (pictures.numel() == 0) return torch::zeros({});
  std::vector<torch::Tensor> errors;
  const size_t count = std::min(student.layers.size(), teacher.layers.size());
  for (size_t i = 0; i < count && SameKind(student.layers[i].type, teacher.layers[i].type); ++i) {
    const std::string& type = student.layers[i].type;
    const int own = student.LayerOutput(static_cast<int>(i)),
              other = teacher.LayerOutput(static_cast<int>(i));
    const bool only_passes_on = type == "Upsample" || type == "Concat" || type == "Detect";
    const bool same_width = student.nodes[own].channels == teacher.nodes[other].channels;
    if (only_passes_on || !same_width || student.nodes[own].scale < kLeastScale) continue;
    errors.push_back(RelativeError(student_values[own].index_select(0, pictures),
                                   teacher_values[other].index_select(0, pictures)));
  }
  return errors.empty() ? torch::zeros({}) : torch::stack(errors).mean();
}

void AverageClassesWithMirror(const Network& network, std::vector<torch::Tensor>& values) {
  constexpr int64_t kColumns = 3;
  std::vector<torch::Tensor> mirrored(values.size());
  mirrored[0] = values[0].flip(kColumns).contiguous(torch::MemoryFormat::ChannelsLast);
  network.RunNodes(1, static_cast<int>(mirrored.size()), mirrored);
  for (const int head : network.graph().class_heads)
    values[head] = (values[head] + mirrored[head].flip(kColumns)) / 2;
}

torch::Tensor ClassDistance(const HeadOutputs& student, const HeadOutputs& teacher,
                            const torch::Tensor& angles) {
  constexpr double kNothing = -10.0;
  torch::Tensor sum = torch::zeros({});
  for (size_t i = 0; i < student.classes.size(); ++i) {
    const torch::Tensor wanted = TurnMaps(teacher.classes[i], -angles, kNothing);
    sum =
        sum + ScoreWeightedError(student.classes[i], wanted, TurnedInside(wanted.size(2), -angles));
  }
  return sum / static_cast<double>(student.classes.size());
}

}  // namespace msf
