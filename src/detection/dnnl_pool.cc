#include <unordered_map>

#include "detection/dnnl_steps.h"
#include "detection/dnnl_types.h"

namespace msf {
namespace {

class PoolStep : public Step {
 public:
  PoolStep(const PoolSpec& spec, const StepMemory& buffers) : stream_(CpuEngine()) {
    const dnnl::engine& engine = CpuEngine();
    const dnnl::memory::desc source = ImageDesc(spec.input_shape, spec.format);
    const dnnl::memory::desc target = ImageDesc(spec.output_shape, spec.format);
    const Window& w = spec.window;
    const auto algorithm =
        spec.maximum ? dnnl::algorithm::pooling_max : dnnl::algorithm::pooling_avg_exclude_padding;
    const dnnl::pooling_forward::desc desc(
        dnnl::prop_kind::forward_inference, algorithm, source, target, {w.stride[0], w.stride[1]},
        {w.kernel[0], w.kernel[1]}, {w.pad_begin[0], w.pad_begin[1]}, PadEnd(w, spec.input_shape));
    dnnl::primitive_attr attributes;
    attributes.set_scratchpad_mode(dnnl::scratchpad_mode::user);
    const dnnl::pooling_forward::primitive_desc chosen(desc, attributes, engine);
    primitive_ = dnnl::pooling_forward(chosen);
    scratch_bytes_ = chosen.scratchpad_desc().get_size();
    arguments_ = {{DNNL_ARG_SRC, dnnl::memory(source, engine, buffers.input)},
                  {DNNL_ARG_DST, dnnl::memory(target, engine, buffers.output)},
                  {DNNL_ARG_SCRATCHPAD, dnnl::memory(chosen.scratchpad_desc(), engine, nullptr)}};
  }

  Status Run() override {
    primitive_.execute(stream_, arguments_);
    return Status::Ok();
  }
  size_t ScratchBytes() const override { return scratch_bytes_; }
  void SetScratch(void* scratch) override {
    arguments_.at(DNNL_ARG_SCRATCHPAD).set_data_handle(scratch);
  }

 private:
  dnnl::stream stream_;
  dnnl::pooling_forward primitive_;
  size_t scratch_bytes_ = 0;
  std::unordered_map<int, dnnl::memory> arguments_;
};

}  // namespace

std::unique_ptr<Step> MakePoolStep(const PoolSpec& spec, const StepMemory& memory) {
  return std::make_unique<PoolStep>(spec, memory);
}

}  // namespace msf
