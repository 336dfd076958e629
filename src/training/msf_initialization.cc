#include "training/msf_initialization.h"

#include <torch/types.h>
#include <torch/utils.h>

#include <algorithm>
#include <cmath>

#include "training/least_squares.h"

namespace msf {

namespace {

constexpr double kShift = 4.0;         // where SiLU is nearly linear
constexpr double kResidualPart = 6.0;  // branches speak this many times as loud as the residual
constexpr int64_t kSamples = 20000;

// Finds weights for one block.
class BlockInitializer {
 public:
  BlockInitializer(Network& student, const Network& teacher, int layer)
      : graph_(student.graph()),
        tensors_(AllTensors(student)),
        name_("model." + std::to_string(layer)) {
    const NamedTensors all = AllTensors(teacher);
    const torch::Tensor scale =
        all.at(name_ + ".bn.weight") / (all.at(name_ + ".bn.running_var") + kNormEpsilon).sqrt();
    teacher_weight_ = all.at(name_ + ".conv.weight") * scale.view({-1, 1, 1, 1});
    teacher_bias_ = all.at(name_ + ".bn.bias") - all.at(name_ + ".bn.running_mean") * scale;
    for (int i = graph_.layers[layer].begin; i < graph_.layers[layer].end; ++i) {
      const GraphNode& node = graph_.nodes[i];
      if (node.op != GraphOp::kConv) continue;
      if (node.name == name_ + ".cv1") stem_ = &node;
      if (node.name == name_ + ".std" || IsDepthwise(&node)) branches_.push_back(&node);
    }
    // In the order of the concatenation, where the standard branch, made last, is the second.
    if (branches_.size() > 2)
      std::rotate(branches_.begin() + 1, branches_.end() - 1, branches_.end());
  }

  // `x`: what the student's block gets; `teacher_x`: what the teacher's convolution gets. Returns
  // the relative error.
  double Initialize(const torch::Tensor& x, const torch::Tensor& teacher_x) {
    wanted_ = at::conv2d(teacher_x, teacher_weight_, teacher_bias_, 2, 1);
    if (CanTakeOver(x)) return TakeOver(x);
    const torch::Tensor code = InitializeStem(x);
    residual_ = x.size(1) == stem_->channels ? at::avg_pool2d(x, 2, 2) : torch::Tensor();
    const torch::Tensor order = ByDifficulty(code);
    std::vector<torch::Tensor> sums, loudness;
    int64_t next = 0;
    for (const GraphNode* branch : OrderedBranches()) {
      InitializeBranch(*branch, code, order, next, sums, loudness);
      next += branch->channels;
    }
    return InitializeOutput(InBlockOrder(sums), InBlockOrder(loudness));
  }

 private:
  static NamedTensors AllTensors(const Network& network) {
    NamedTensors all = network.parameters();
    all.insert(network.buffers().begin(), network.buffers().end());
    return all;
  }

  void Assign(const std::string& name, const torch::Tensor& value) {
    torch::Tensor target = tensors_.at(name);
    target.copy_(value.reshape(target.sizes()));
  }

  // A norm whose running statistics are those of `map` and whose effect is map * gain + shift.
  void AssignNorm(const std::string& prefix, const torch::Tensor& map, const torch::Tensor& gain,
                  const torch::Tensor& shift) {
    const torch::Tensor mean = map.mean({0, 2, 3}), variance = map.var({0, 2, 3}, false);
    Assign(prefix + ".running_mean", mean);
    Assign(prefix + ".running_var", variance);
    Assign(prefix + ".weight", gain * (variance + kNormEpsilon).sqrt());
    Assign(prefix + ".bias", gain * mean + shift);
  }

  // Two depthwise branches as wide as the output, and no residual in the way.
  bool CanTakeOver(const torch::Tensor& x) const {
    const auto depthwise = std::count_if(branches_.begin(), branches_.end(), IsDepthwise);
    return stem_->channels == wanted_.size(1) && stem_->channels != x.size(1) && depthwise >= 2;
  }

  // The stem becomes the teacher's convolution. One branch hands its output y on, another one -y,
  // and the last 1x1 puts them together: SiLU(y) - SiLU(-y) = y. The other branches keep their
  // random weights and have no part in the output yet.
  double TakeOver(const torch::Tensor& x) {
    const torch::Tensor map = at::conv2d(x, teacher_weight_, {}, 2, 1);
    Assign(stem_->name + ".conv.weight", teacher_weight_);
    AssignNorm(stem_->name + ".bn", map, torch::ones_like(teacher_bias_), teacher_bias_);
    const torch::Tensor y = at::silu(map + teacher_bias_.view({1, -1, 1, 1}));
    std::vector<torch::Tensor> outputs, shares;
    double sign = 1.0;  // of the next branch that hands on: 1, -1, then none
    for (const GraphNode* branch : branches_) {
      const bool hands_on = IsDepthwise(branch) && sign != 0.0;
      outputs.push_back(hands_on ? HandOn(*branch, y, sign) : Idle(*branch, y));
      shares.push_back(torch::eye(stem_->channels) * (hands_on ? sign : 0.0));
      if (hands_on) sign = sign > 0.0 ? -1.0 : 0.0;
    }
    const torch::Tensor joined = torch::cat(outputs, 1);
    const torch::Tensor ones = torch::ones({joined.size(1)});
    AssignNorm(name_ + ".norm", joined, ones, torch::zeros_like(ones));
    const torch::Tensor last = torch::cat(shares, 1);
    Assign(name_ + ".cv2.weight", last);
    return RelativeError(PixelRows(at::silu(joined), kSamples).mm(last.t()),
                         PixelRows(at::silu(wanted_), kSamples));
  }

  // The branch becomes `sign` times the identity.
  torch::Tensor HandOn(const GraphNode& branch, const torch::Tensor& y, double sign) {
    PassThrough(DepthwiseOf(branch));
    Assign(branch.name + ".conv.weight", torch::eye(branch.channels) * sign);
    const torch::Tensor output = y * sign, ones = torch::ones({branch.channels});
    AssignNorm(branch.name + ".bn", output, ones, torch::zeros_like(ones));
    return output;
  }

  // The branch gives what its weights happen to give, at mean 0 and variance 1.
  torch::Tensor Idle(const GraphNode& branch, const torch::Tensor& y) {
    if (IsDepthwise(&branch)) PassThrough(DepthwiseOf(branch));
    const torch::Tensor output =
        at::conv2d(y, tensors_.at(branch.name + ".conv.weight"), {}, 1, branch.kernel / 2);
    const torch::Tensor mean = output.mean({0, 2, 3});
    const torch::Tensor gain = 1.0 / (output.std({0, 2, 3}, false, false) + 1e-6);
    AssignNorm(branch.name + ".bn", output, gain, -mean * gain);
    return (output - mean.view({1, -1, 1, 1})) * gain.view({1, -1, 1, 1});
  }

  // Principal components of the pre-activations; returns the activated code.
  torch::Tensor InitializeStem(const torch::Tensor& x) {
    const torch::Tensor rows = PixelRows(wanted_, kSamples);
    const torch::Tensor sigmoid = rows.sigmoid();
    const torch::Tensor slope = sigmoid * (1.0 + rows * (1.0 - sigmoid));
    importance_ = slope.square().mean(0).sqrt() / ((rows * sigmoid).std(0) + 1e-3);
    const torch::Tensor scaled = (rows - rows.mean(0)) * importance_;
    const torch::Tensor basis = LeadingEigenvectors(scaled.t().mm(scaled), stem_->channels);
    const torch::Tensor projection = basis.t() * importance_;  // [h, c_out]
    torch::Tensor weight = projection.mm(teacher_weight_.flatten(1)).view({-1, x.size(1), 3, 3});
    torch::Tensor code = at::conv2d(x, weight, {}, 2, 1);
    const torch::Tensor spread = code.std({0, 2, 3}, false, false) + 1e-6;
    weight = weight / spread.view({-1, 1, 1, 1});
    code = code / spread.view({1, -1, 1, 1});
    Assign(stem_->name + ".conv.weight", weight);
    const torch::Tensor shift = kShift - code.mean({0, 2, 3});
    AssignNorm(stem_->name + ".bn", code, torch::ones_like(shift), shift);
    return at::silu(code + shift.view({1, -1, 1, 1}));
  }

  // Output channels, those first that a 1x1 convolution of the code restores worst.
  torch::Tensor ByDifficulty(const torch::Tensor& code) const {
    const torch::Tensor rows = PixelRows(code, kSamples), targets = PixelRows(wanted_, kSamples);
    const torch::Tensor features = torch::cat({rows, torch::ones({rows.size(0), 1})}, 1);
    const torch::Tensor error = features.mm(SolveLeastSquares(features, targets)) - targets;
    return (error.square().mean(0).sqrt() * importance_).argsort(0, true);
  }

  // The standard branch, which sees most, first.
  std::vector<const GraphNode*> OrderedBranches() const {
    std::vector<const GraphNode*> ordered = branches_;
    std::stable_partition(ordered.begin(), ordered.end(),
                          [](const GraphNode* node) { return node->name.ends_with(".std"); });
    return ordered;
  }

  std::vector<torch::Tensor> InBlockOrder(const std::vector<torch::Tensor>& values) const {
    const std::vector<const GraphNode*> ordered = OrderedBranches();
    std::vector<torch::Tensor> result;
    for (const GraphNode* branch : branches_) {
      result.push_back(values[std::find(ordered.begin(), ordered.end(), branch) - ordered.begin()]);
    }
    return result;
  }

  // The branch restores the channels order[next], ...; once all are taken, their negatives.
  void InitializeBranch(const GraphNode& branch, const torch::Tensor& code,
                        const torch::Tensor& order, int64_t next, std::vector<torch::Tensor>& sums,
                        std::vector<torch::Tensor>& loudness) {
    const int64_t channels = wanted_.size(1);
    const torch::Tensor turn = torch::arange(next, next + branch.channels);
    const torch::Tensor chosen = order.index_select(0, turn.remainder(channels));
    const torch::Tensor sign = 1.0 - 2.0 * turn.ge(channels).to(torch::kFloat);
    torch::Tensor target = wanted_.index_select(1, chosen) * sign.view({1, -1, 1, 1});
    torch::Tensor gain = torch::ones({branch.channels});
    if (residual_.defined()) {
      gain = (kResidualPart * residual_.std({0, 2, 3}, false, false) /
              target.std({0, 2, 3}, false, false))
                 .clamp(1.0, 100.0);
      target = target * gain.view({1, -1, 1, 1}) - residual_;
    }
    const int kernel = branch.kernel;
    const torch::Tensor columns =
        at::im2col(code, {kernel, kernel}, {1, 1}, {kernel / 2, kernel / 2}, {1, 1});
    const torch::Tensor unfolded =
        columns.view({code.size(0), columns.size(1), code.size(2), code.size(3)});
    const torch::Tensor rows = PixelRows(unfolded, kSamples);
    const torch::Tensor features = torch::cat({rows, torch::ones({rows.size(0), 1})}, 1);
    const torch::Tensor solution = SolveLeastSquares(features, PixelRows(target, kSamples));
    const torch::Tensor weight = solution.narrow(0, 0, rows.size(1))
                                     .t()
                                     .contiguous()
                                     .view({branch.channels, -1, kernel, kernel});
    const torch::Tensor shift = solution[rows.size(1)];
    Assign(branch.name + ".conv.weight", weight);
    if (IsDepthwise(&branch)) PassThrough(DepthwiseOf(branch));
    const torch::Tensor output = at::conv2d(code, weight, {}, 1, kernel / 2);
    AssignNorm(branch.name + ".bn", output, torch::ones({branch.channels}), shift);
    torch::Tensor sum = output + shift.view({1, -1, 1, 1});
    if (residual_.defined()) sum = sum + residual_;
    sums.push_back(sum);
    loudness.push_back(gain);
  }

  static bool IsDepthwise(const GraphNode* branch) { return branch->name.ends_with(".pw"); }
  static std::string DepthwiseOf(const GraphNode& branch) {
    return branch.name.substr(0, branch.name.size() - 3) + ".dw.weight";
  }

  // A depthwise kernel that hands its input on.
  void PassThrough(const std::string& name) {
    torch::Tensor weight = tensors_.at(name);
    weight.zero_();
    weight.select(2, weight.size(2) / 2).select(2, weight.size(3) / 2).fill_(1.0);
  }

  double InitializeOutput(const std::vector<torch::Tensor>& sums,
                          const std::vector<torch::Tensor>& loudness) {
    const torch::Tensor joined = torch::cat(sums, 1);
    const torch::Tensor gain = 1.0 / torch::cat(loudness, 0);
    AssignNorm(name_ + ".norm", joined, gain, torch::zeros_like(gain));
    const torch::Tensor activated = at::silu(joined * gain.view({1, -1, 1, 1}));
    const torch::Tensor features = PixelRows(activated, kSamples),
                        targets = PixelRows(at::silu(wanted_), kSamples);
    const torch::Tensor solution = SolveLeastSquares(features, targets);
    Assign(name_ + ".cv2.weight", solution.t().contiguous());
    return RelativeError(features.mm(solution), targets);
  }

  static double RelativeError(const torch::Tensor& given, const torch::Tensor& wanted) {
    const torch::Tensor error = (given - wanted).square().mean(0) / (wanted.var(0) + 1e-3);
    return error.mean().item<double>();
  }

  const ModelGraph& graph_;
  NamedTensors tensors_;
  std::string name_;
  const GraphNode* stem_ = nullptr;
  std::vector<const GraphNode*> branches_;
  torch::Tensor teacher_weight_, teacher_bias_;
  torch::Tensor wanted_;      // the teacher's pre-activations
  torch::Tensor importance_;  // of its channels
  torch::Tensor residual_;    // undefined where widths differ
};

}  // namespace

std::map<int, double> InitializeMsfLayers(Network& student, const Network& teacher,
                                          const torch::Tensor& images) {
  const torch::NoGradGuard no_grad;
  student.set_training(false);
  const ModelGraph& own = student.graph();
  const ModelGraph& other = teacher.graph();
  std::vector<torch::Tensor> values(own.nodes.size()), teacher_values(other.nodes.size());
  values[0] = teacher_values[0] = images.contiguous(torch::MemoryFormat::ChannelsLast);
  teacher.RunNodes(1, static_cast<int>(other.nodes.size()), teacher_values);
  std::map<int, double> errors;
  for (int layer = 0; layer < static_cast<int>(own.layers.size()); ++layer) {
    const GraphLayer& nodes = own.layers[layer];
    const int begin = std::max(1, nodes.begin);
    if (nodes.type == "MSFConv") {
      const torch::Tensor& teacher_x =
          teacher_values[other.nodes[std::max(1, other.layers[layer].begin)].inputs[0]];
      errors[layer] = BlockInitializer(student, teacher, layer)
                          .Initialize(values[own.nodes[begin].inputs[0]], teacher_x);
    }
    student.RunNodes(begin, nodes.end, values);
  }
  return errors;
}

}  // namespace msf
