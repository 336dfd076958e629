// Convolution, pooling, batch normalisation, resizing: plain implementations on [N, C, H, W].
#include <algorithm>
#include <cmath>
#include <limits>

#include "detection/operators.h"
#include "detection/window.h"

namespace msf {
namespace {

using Results = StatusOr<std::vector<ResultInfo>>;

Results Image(const Shape& x, int64_t channels, int64_t h, int64_t w) {
  return std::vector<ResultInfo>{{Shape{x[0], channels, h, w}, ElementType::kFloat}};
}

StatusOr<Window> ConvWindow(const Node& node, const Shape& x, const Shape& w) {
  if (w.size() != 4) return Status::Error("has weights of shape " + ToString(w));
  return ReadWindow(node, x, w[2], w[3]);
}

Results InferConv(const InferContext& c) {
  const Shape& w = c.shape(1);
  StatusOr<Window> window = ConvWindow(c.node, c.shape(0), w);
  if (!window.ok()) return window.status();
  const int64_t group = c.node.Int("group", 1);
  const int64_t channels = c.shape(0)[1];
  if (group < 1 || channels % group != 0 || w[0] % group != 0 || w[1] != channels / group) {
    return Status::Error("has weights " + ToString(w) + " that do not fit an input of " +
                         ToString(c.shape(0)));
  }
  if (c.Has(2) && (c.shape(2) != Shape{w[0]} || c.inputs[2].type != ElementType::kFloat)) {
    return Status::Error("has a bias that does not fit its weights");
  }
  if (c.inputs[0].type != ElementType::kFloat || c.inputs[1].type != ElementType::kFloat) {
    return Status::Error("needs floating point operands");
  }
  return Image(c.shape(0), w[0], window->output[0], window->output[1]);
}

float Activate(float x, const Epilogue& e) {
  switch (e.activation) {
    case Activation::kNone:
      return x;
    case Activation::kSilu:
      return x / (1 + std::exp(-x));
    case Activation::kRelu:
      return std::max(x, 0.0f);
    case Activation::kLeakyRelu:
      return x < 0 ? x * e.alpha : x;
    case Activation::kSigmoid:
      return 1 / (1 + std::exp(-x));
  }
  return x;
}

float Finish(float sum, const Epilogue& e, int64_t channel, float addend) {
  if (e.add_first) sum += addend;
  if (!e.scale.empty()) sum *= e.scale[static_cast<size_t>(channel)];
  if (!e.shift.empty()) sum += e.shift[static_cast<size_t>(channel)];
  sum = Activate(sum, e);
  return e.add_first ? sum : sum + addend;
}

// One output pixel: the window over one group of channels. Double, as this is what others are
// compared with.
double SumWindow(const InputView& x, const InputView& w, const Window& win, int64_t n, int64_t out,
                 int64_t first_channel, int64_t oy, int64_t ox) {
  const int64_t height = x.shape[2], width = x.shape[3];
  double sum = 0;
  for (int64_t c = 0; c < w.shape[1]; ++c) {
    const int64_t plane = (n * x.shape[1] + first_channel + c) * height;
    for (int64_t ky = 0; ky < win.kernel[0]; ++ky) {
      const int64_t y = oy * win.stride[0] - win.pad_begin[0] + ky * win.dilation[0];
      if (y < 0 || y >= height) continue;
      const int64_t weights = ((out * w.shape[1] + c) * win.kernel[0] + ky) * win.kernel[1];
      for (int64_t kx = 0; kx < win.kernel[1]; ++kx) {
        const int64_t col = ox * win.stride[1] - win.pad_begin[1] + kx * win.dilation[1];
        if (col < 0 || col >= width) continue;
        sum += static_cast<double>(x.floats[static_cast<size_t>((plane + y) * width + col)]) *
               w.floats[static_cast<size_t>(weights + kx)];
      }
    }
  }
  return sum;
}

// The epilogue's addend, if any, is the last input.
Status ComputeConv(const ComputeContext& c) {
  const InputView& x = c.inputs[0];
  const InputView& w = c.inputs[1];
  const OutputView& y = c.outputs[0];
  const Epilogue& epilogue = c.node.epilogue;
  const bool adds = epilogue.addend != kNoValue;
  StatusOr<Window> window = ConvWindow(c.node, x.shape, w.shape);
  if (!window.ok()) return window.status();
  const int64_t per_group = w.shape[0] / c.node.Int("group", 1);
  const bool biased = c.inputs.size() - (adds ? 1 : 0) > 2 && c.Has(2);
  size_t to = 0;
  for (int64_t n = 0; n < y.shape[0]; ++n) {
    for (int64_t out = 0; out < y.shape[1]; ++out) {
      const float bias = biased ? c.inputs[2].floats[static_cast<size_t>(out)] : 0;
      const int64_t first = out / per_group * w.shape[1];
      for (int64_t oy = 0; oy < y.shape[2]; ++oy) {
        for (int64_t ox = 0; ox < y.shape[3]; ++ox, ++to) {
          const double sum = SumWindow(x, w, *window, n, out, first, oy, ox) + bias;
          const float addend = adds ? c.inputs.back().floats[to] : 0;
          y.floats[to] = Finish(static_cast<float>(sum), epilogue, out, addend);
        }
      }
    }
  }
  return Status::Ok();
}

StatusOr<Window> PoolWindow(const Node& node, const Shape& x) {
  const std::vector<int64_t> kernel = node.Ints("kernel_shape");
  if (kernel.size() != 2) return Status::Error("needs a kernel_shape of two sizes");
  return ReadWindow(node, x, kernel[0], kernel[1]);
}

Results InferPool(const InferContext& c) {
  StatusOr<Window> window = PoolWindow(c.node, c.shape(0));
  if (!window.ok()) return window.status();
  for (int d = 0; d < 2; ++d) {
    if (window->pad_begin[d] >= window->kernel[d] || window->pad_end[d] >= window->kernel[d]) {
      return Status::Error("has padding as wide as its kernel");
    }
  }
  if (c.node.outputs.size() > 1)
    return Status::Error("is asked for indices, which is not supported");
  return Image(c.shape(0), c.shape(0)[1], window->output[0], window->output[1]);
}

template <bool kMax>
float PoolPixel(const Node& node, std::span<const float> plane, const Shape& x, const Window& w,
                int64_t oy, int64_t ox) {
  float best = -std::numeric_limits<float>::infinity();
  double sum = 0;
  int64_t inside = 0;
  for (int64_t ky = 0; ky < w.kernel[0]; ++ky) {
    const int64_t y = oy * w.stride[0] - w.pad_begin[0] + ky * w.dilation[0];
    if (y < 0 || y >= x[2]) continue;
    for (int64_t kx = 0; kx < w.kernel[1]; ++kx) {
      const int64_t col = ox * w.stride[1] - w.pad_begin[1] + kx * w.dilation[1];
      if (col < 0 || col >= x[3]) continue;
      const float value = plane[static_cast<size_t>(y * x[3] + col)];
      best = std::max(best, value);
      sum += value;
      ++inside;
    }
  }
  if (kMax) return best;
  const bool all = node.Int("count_include_pad", 0) != 0;
  const int64_t count = all ? w.kernel[0] * w.kernel[1] : std::max<int64_t>(inside, 1);
  return static_cast<float>(sum / static_cast<double>(count));
}

template <bool kMax>
Status ComputePool(const ComputeContext& c) {
  const InputView& x = c.inputs[0];
  const OutputView& y = c.outputs[0];
  StatusOr<Window> window = PoolWindow(c.node, x.shape);
  if (!window.ok()) return window.status();
  const int64_t plane = x.shape[2] * x.shape[3];
  size_t to = 0;
  for (int64_t p = 0; p < y.shape[0] * y.shape[1]; ++p) {
    const auto pixels =
        x.floats.subspan(static_cast<size_t>(p * plane), static_cast<size_t>(plane));
    for (int64_t oy = 0; oy < y.shape[2]; ++oy) {
      for (int64_t ox = 0; ox < y.shape[3]; ++ox) {
        y.floats[to++] = PoolPixel<kMax>(c.node, pixels, x.shape, *window, oy, ox);
      }
    }
  }
  return Status::Ok();
}

Results InferGlobalPool(const InferContext& c) {
  if (c.shape(0).size() != 4 || NumElements(c.shape(0)) == 0)
    return Status::Error("works on images only");
  return Image(c.shape(0), c.shape(0)[1], 1, 1);
}

Status ComputeGlobalPool(const ComputeContext& c) {
  const size_t plane = static_cast<size_t>(c.inputs[0].shape[2] * c.inputs[0].shape[3]);
  for (size_t i = 0; i < c.outputs[0].floats.size(); ++i) {
    double sum = 0;
    for (const float value : c.inputs[0].floats.subspan(i * plane, plane)) sum += value;
    c.outputs[0].floats[i] = static_cast<float>(sum / static_cast<double>(plane));
  }
  return Status::Ok();
}

Results InferPerChannel(const InferContext& c) {
  if (c.shape(0).size() < 2) return Status::Error("needs a channel dimension");
  for (size_t i = 1; i < c.inputs.size(); ++i) {
    if (!c.Has(i) || c.shape(i) != Shape{c.shape(0)[1]} ||
        c.inputs[i].type != ElementType::kFloat) {
      return Status::Error("has parameters that do not fit " + ToString(c.shape(0)));
    }
  }
  return std::vector<ResultInfo>{{c.shape(0), ElementType::kFloat}};
}

// y = x * scale(channel) + shift(channel)
template <typename Line>
void ApplyPerChannel(const ComputeContext& c, const Line& line) {
  const Shape& shape = c.inputs[0].shape;
  const size_t channels = static_cast<size_t>(shape[1]);
  const size_t inner = static_cast<size_t>(DenseStrides(shape)[1]);
  for (size_t i = 0; i < c.outputs[0].floats.size(); ++i) {
    c.outputs[0].floats[i] = line(c.inputs[0].floats[i], i / inner % channels);
  }
}

Status ComputeBatchNorm(const ComputeContext& c) {
  const float epsilon = c.node.Float("epsilon", 1e-5f);
  ApplyPerChannel(c, [&](float x, size_t k) {
    const float scale = c.inputs[1].floats[k] / std::sqrt(c.inputs[4].floats[k] + epsilon);
    return (x - c.inputs[3].floats[k]) * scale + c.inputs[2].floats[k];
  });
  return Status::Ok();
}

Status ComputeChannelAffine(const ComputeContext& c) {
  ApplyPerChannel(
      c, [&](float x, size_t k) { return x * c.inputs[1].floats[k] + c.inputs[2].floats[k]; });
  return Status::Ok();
}

// Sizes from the `sizes` input, or from `scales` (input 1 in opset 10, input 2 later).
StatusOr<Shape> ResizedShape(const InferContext& c) {
  const Shape& x = c.shape(0);
  if (c.Has(3) && NumElements(c.shape(3)) > 0) return c.ConstantInts(3);
  const size_t at = c.Has(2) ? 2 : 1;
  if (!c.Has(at) || !c.inputs[at].constant || c.inputs[at].type != ElementType::kFloat ||
      c.inputs[at].constant->floats.size() != x.size()) {
    return Status::Error("needs constant scales or sizes");
  }
  Shape shape;
  for (size_t i = 0; i < x.size(); ++i) {
    const double size = std::floor(static_cast<double>(x[i]) * c.inputs[at].constant->floats[i]);
    if (!(size >= 0 && size < static_cast<double>(kMaxElements)))
      return Status::Error("has a bad scale");
    shape.push_back(static_cast<int64_t>(size));
  }
  return shape;
}

// Whether pixel i of the result is pixel floor(i / factor) of the input, for a whole factor.
bool RepeatsPixels(const InferContext& c) {
  if (c.node.String("mode", "nearest") != "nearest") return false;
  if (c.node.op == "Upsample" || c.opset < 11) return true;
  const std::string where = c.node.String("coordinate_transformation_mode", "half_pixel");
  const std::string rounding = c.node.String("nearest_mode", "round_prefer_floor");
  if (where == "asymmetric") return rounding == "floor";
  const bool centred = where == "half_pixel" || where == "pytorch_half_pixel";
  return centred && (rounding == "round_prefer_floor" || rounding == "round_prefer_ceil");
}

Results InferResize(const InferContext& c) {
  const Shape& x = c.shape(0);
  StatusOr<Shape> shape = ResizedShape(c);
  if (!shape.ok()) return shape.status();
  const bool image =
      x.size() == 4 && shape->size() == 4 && (*shape)[0] == x[0] && (*shape)[1] == x[1];
  if (!image || c.inputs[0].type != ElementType::kFloat)
    return Status::Error("may resize height and width only");
  const bool whole = x[2] > 0 && x[3] > 0 && (*shape)[2] % x[2] == 0 && (*shape)[3] % x[3] == 0;
  if (!whole || !RepeatsPixels(c)) {
    return Status::Error("is supported for nearest neighbours and whole factors only");
  }
  return std::vector<ResultInfo>{{*shape, ElementType::kFloat}};
}

Status ComputeResize(const ComputeContext& c) {
  const Shape& x = c.inputs[0].shape;
  const Shape& y = c.outputs[0].shape;
  if (NumElements(y) == 0) return Status::Ok();
  const int64_t fy = y[2] / x[2], fx = y[3] / x[3];
  size_t to = 0;
  for (int64_t p = 0; p < y[0] * y[1]; ++p) {
    for (int64_t row = 0; row < y[2]; ++row) {
      for (int64_t col = 0; col < y[3]; ++col) {
        const int64_t from = (p * x[2] + row / fy) * x[3] + col / fx;
        c.outputs[0].floats[to++] = c.inputs[0].floats[static_cast<size_t>(from)];
      }
    }
  }
  return Status::Ok();
}

}  // namespace

std::vector<NamedOperator> WindowOperators() {
  return {
      {"Conv", {2, 3, InferConv, ComputeConv}},
      {"MaxPool", {1, 1, InferPool, ComputePool<true>}},
      {"AveragePool", {1, 1, InferPool, ComputePool<false>}},
      {"GlobalAveragePool", {1, 1, InferGlobalPool, ComputeGlobalPool}},
      {"BatchNormalization", {5, 5, InferPerChannel, ComputeBatchNorm}},
      {"ChannelAffine", {3, 3, InferPerChannel, ComputeChannelAffine}},
      {"Resize", {1, 4, InferResize, ComputeResize}},
      {"Upsample", {1, 2, InferResize, ComputeResize}},
  };
}

}  // namespace msf
