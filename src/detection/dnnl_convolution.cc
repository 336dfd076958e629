#include <algorithm>
#include <cmath>
#include <dnnl.hpp>
#include <unordered_map>

#include "detection/column_folding.h"
#include "detection/dnnl_steps.h"
#include "detection/dnnl_types.h"
#include "detection/weight_rounding.h"
#include "util/check.h"

namespace msf {
namespace {

using dnnl::memory;

// Builds oneDNN's list of operations behind the sum; successive linear maps are joined into one.
class PostOps {
 public:
  void Linear(float scale, float shift) {
    scale_ *= scale;
    shift_ = shift_ * scale + shift;
  }

  void Activate(const Epilogue& e) {
    if (e.activation == Activation::kNone) return;
    Flush();
    switch (e.activation) {
      case Activation::kSilu:
        return Append(dnnl::algorithm::eltwise_swish, 1);
      case Activation::kSigmoid:
        return Append(dnnl::algorithm::eltwise_logistic, 0);
      default:
        return Append(dnnl::algorithm::eltwise_relu, e.alpha);
    }
  }

  // The argument index is the place in the list; `index()` is where the memory has to be passed.
  void Binary(dnnl::algorithm algorithm, const memory& operand) {
    Flush();
    ops_.append_binary(algorithm, operand.get_desc());
    operands_.emplace_back(ops_.len() - 1, operand);
  }

  const dnnl::post_ops& Finish() {
    Flush();
    return ops_;
  }
  const std::vector<std::pair<int, memory>>& operands() const { return operands_; }

 private:
  void Append(dnnl::algorithm algorithm, float alpha) {
    ops_.append_eltwise(1, algorithm, alpha, 0);
  }
  void Flush() {
    if (scale_ != 1 || shift_ != 0)
      ops_.append_eltwise(1, dnnl::algorithm::eltwise_linear, scale_, shift_);
    scale_ = 1;
    shift_ = 0;
  }

  float scale_ = 1, shift_ = 0;
  dnnl::post_ops ops_;
  std::vector<std::pair<int, memory>> operands_;
};

class ConvolutionStep : public Step {
 public:
  ConvolutionStep(const ConvolutionSpec& spec, const StepMemory& buffers)
      : spec_(spec), stream_(CpuEngine()) {
    const dnnl::engine& engine = CpuEngine();
    const bool int8 = spec.compute == NumberFormat::kUint8;
    const memory::desc source = ImageDesc(spec.input_shape, spec.input.format);
    const memory::desc target = ImageDesc(spec.output_shape, spec.output.format);
    RoundedWeights rounded;
    if (int8) rounded = RoundWeights(*spec.weights, LargestInt8Weight());

    dnnl::primitive_attr attributes;
    attributes.set_scratchpad_mode(dnnl::scratchpad_mode::user);
    PostOps post_ops;
    AddEpilogue(buffers, post_ops);
    attributes.set_post_ops(post_ops.Finish());
    if (int8) SetScales(rounded, attributes);

    const Window& w = spec.window;
    const auto type = int8 ? memory::data_type::s8 : DataType(spec.compute);
    const memory::desc weights(WeightDims(), type, memory::format_tag::any);
    const memory::desc bias({spec.output_shape[1]}, memory::data_type::f32, memory::format_tag::a);
    const dnnl::convolution_forward::desc desc(
        dnnl::prop_kind::forward_inference, dnnl::algorithm::convolution_direct, source, weights,
        bias, target, {w.stride[0], w.stride[1]}, {w.dilation[0] - 1, w.dilation[1] - 1},
        {w.pad_begin[0], w.pad_begin[1]}, PadEnd(w, spec.input_shape));
    const dnnl::convolution_forward::primitive_desc chosen(desc, attributes, engine);
    primitive_ = dnnl::convolution_forward(chosen);
    scratch_ = memory(chosen.scratchpad_desc(), engine, nullptr);

    arguments_ = {{DNNL_ARG_SRC, memory(source, engine, buffers.input)},
                  {DNNL_ARG_DST, memory(target, engine, buffers.output)},
                  {DNNL_ARG_WEIGHTS, OrderWeights(rounded, chosen.weights_desc())},
                  {DNNL_ARG_BIAS, MakeBias(rounded)},
                  {DNNL_ARG_SCRATCHPAD, scratch_}};
    for (const auto& [index, operand] : post_ops.operands()) {
      arguments_[DNNL_ARG_ATTR_MULTIPLE_POST_OP(index) | DNNL_ARG_SRC_1] = operand;
    }
    spec_.weights = spec_.bias = nullptr;  // oneDNN holds its own copies now
  }

  Status Run() override {
    primitive_.execute(stream_, arguments_);
    return Status::Ok();
  }
  size_t ScratchBytes() const override { return scratch_.get_desc().get_size(); }
  void SetScratch(void* scratch) override {
    arguments_.at(DNNL_ARG_SCRATCHPAD).set_data_handle(scratch);
  }

 private:
  bool Padded() const {
    const Window& w = spec_.window;
    return w.pad_begin[0] + w.pad_begin[1] + w.pad_end[0] + w.pad_end[1] > 0;
  }

  memory::dims WeightDims() const {
    const Shape& s = spec_.weights->shape;
    if (spec_.group == 1) return s;
    return {spec_.group, s[0] / spec_.group, s[1], s[2], s[3]};
  }

  // A vector with one number per output channel.
  memory ChannelVector(const std::vector<float>& values) const {
    memory vector({{1, static_cast<int64_t>(values.size()), 1, 1},
                   memory::data_type::f32,
                   memory::format_tag::nchw},
                  CpuEngine());
    std::copy(values.begin(), values.end(), static_cast<float*>(vector.get_data_handle()));
    return vector;
  }

  void AddEpilogue(const StepMemory& buffers, PostOps& ops) const {
    const Epilogue& e = spec_.epilogue;
    memory addend;
    if (e.addend != kNoValue) {
      addend =
          memory(ImageDesc(spec_.output_shape, spec_.addend.format), CpuEngine(), buffers.addend);
    }
    if (addend && e.add_first) ops.Binary(dnnl::algorithm::binary_add, addend);
    if (!e.scale.empty()) ops.Binary(dnnl::algorithm::binary_mul, ChannelVector(e.scale));
    if (!e.shift.empty()) ops.Binary(dnnl::algorithm::binary_add, ChannelVector(e.shift));
    ops.Activate(e);
    if (addend && !e.add_first) ops.Binary(dnnl::algorithm::binary_add, addend);
    if (spec_.output.format == NumberFormat::kUint8) {
      ops.Linear(1 / spec_.output.scale, static_cast<float>(spec_.output.zero_point));
    }
  }

  void SetScales(const RoundedWeights& rounded, dnnl::primitive_attr& attributes) const {
    std::vector<float> scales;
    for (const float scale : rounded.scales) scales.push_back(scale * spec_.input.scale);
    attributes.set_output_scales(1 << 1, scales);
    // Where nothing is padded the zero point is a constant that the bias takes up, which leaves
    // oneDNN more implementations.
    if (Padded() && spec_.input.zero_point != 0) {
      attributes.set_zero_points(DNNL_ARG_SRC, 0, {spec_.input.zero_point});
    }
  }

  memory OrderWeights(const RoundedWeights& rounded, const memory::desc& wanted) {
    const dnnl::engine& engine = CpuEngine();
    const bool int8 = !rounded.values.empty();
    const auto tag = spec_.group == 1 ? memory::format_tag::oihw : memory::format_tag::goihw;
    const memory::desc plain(WeightDims(), int8 ? memory::data_type::s8 : memory::data_type::f32,
                             tag);
    const void* values =
        int8 ? static_cast<const void*>(rounded.values.data()) : spec_.weights->floats.data();
    memory from(plain, engine, const_cast<void*>(values));  // read only
    memory ordered(wanted, engine);
    dnnl::reorder(from, ordered).execute(stream_, from, ordered);
    stream_.wait();
    return ordered;
  }

  // With 8-bit weights oneDNN adds the bias before it applies the scales.
  memory MakeBias(const RoundedWeights& rounded) const {
    std::vector<float> bias(static_cast<size_t>(spec_.output_shape[1]), 0.0f);
    if (spec_.bias) bias = spec_.bias->floats;
    for (size_t c = 0; c < rounded.scales.size(); ++c) {
      bias[c] /= rounded.scales[c] * spec_.input.scale;
      if (!Padded()) bias[c] -= static_cast<float>(spec_.input.zero_point) * rounded.sums[c];
    }
    memory result({{spec_.output_shape[1]}, memory::data_type::f32, memory::format_tag::a},
                  CpuEngine());
    std::copy(bias.begin(), bias.end(), static_cast<float*>(result.get_data_handle()));
    return result;
  }

  ConvolutionSpec spec_;
  dnnl::stream stream_;
  dnnl::convolution_forward primitive_;
  memory scratch_;
  std::unordered_map<int, memory> arguments_;
};

}  // namespace

std::unique_ptr<Step> MakeConvolutionStep(const ConvolutionSpec& spec, const StepMemory& memory) {
  const int factor = FoldingFactor(spec);
  if (factor == 1) return std::make_unique<ConvolutionStep>(spec, memory);
  Tensor weights, bias;  // the step keeps copies of its own
  return std::make_unique<ConvolutionStep>(FoldColumns(spec, factor, weights, bias), memory);
}

bool CanWrite(NumberFormat compute, NumberFormat output) {
  switch (compute) {
    case NumberFormat::kFloat32:
      return output == NumberFormat::kFloat32;
    case NumberFormat::kBfloat16:
      return output != NumberFormat::kUint8;
    case NumberFormat::kUint8:
      return output != NumberFormat::kBfloat16 || HasFastBfloat16();
  }
  return false;
}

}  // namespace msf
