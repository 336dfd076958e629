#include "training/fast_silu.h"

#include <torch/csrc/autograd/custom_function.h>

#include "training/silu_kernels.h"
#include "util/check.h"

namespace msf {

namespace {

uint16_t* Bits(const torch::Tensor& tensor) { return static_cast<uint16_t*>(tensor.data_ptr()); }

// The elements in one block of memory without gaps.
torch::Tensor Dense(const torch::Tensor& x) {
  return x.is_non_overlapping_and_dense() ? x : x.contiguous(x.suggest_memory_format());
}

class SiluFunction : public torch::autograd::Function<SiluFunction> {
 public:
  static torch::Tensor forward(torch::autograd::AutogradContext* context,
                               const torch::Tensor& input) {
    const torch::Tensor x = Dense(input);
    context->save_for_backward({x});
    torch::Tensor y = at::empty_like(x);
    const auto count = static_cast<size_t>(x.numel());
    if (x.scalar_type() == torch::kBFloat16) {
      SiluForward(Bits(x), Bits(y), count);
    } else {
      MSF_CHECK(x.scalar_type() == torch::kFloat, "SiLU is for float and bfloat16");
      SiluForward(x.data_ptr<float>(), y.data_ptr<float>(), count);
    }
    return y;
  }

  static torch::autograd::variable_list backward(torch::autograd::AutogradContext* context,
                                                 torch::autograd::variable_list gradients) {
    const torch::Tensor x = context->get_saved_variables()[0];
    // The same order of elements in memory as x.
    torch::Tensor gradient = gradients[0].to(x.scalar_type());
    if (gradient.strides() != x.strides()) gradient = at::empty_like(x).copy_(gradient);
    torch::Tensor result = at::empty_like(x);
    const auto count = static_cast<size_t>(x.numel());
    if (x.scalar_type() == torch::kBFloat16) {
      SiluBackward(Bits(x), Bits(gradient), Bits(result), count);
    } else {
      SiluBackward(x.data_ptr<float>(), gradient.data_ptr<float>(), result.data_ptr<float>(),
                   count);
    }
    return {result};
  }
};

}  // namespace

torch::Tensor FastSilu(const torch::Tensor& x) { return SiluFunction::apply(x); }

}  // namespace msf
