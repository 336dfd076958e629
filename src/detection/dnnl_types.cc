#include "detection/dnnl_types.h"

#include <algorithm>
#include <initializer_list>

#include "detection/dnnl_steps.h"

namespace msf {

const dnnl::engine& CpuEngine() {
  static const dnnl::engine kEngine(dnnl::engine::kind::cpu, 0);
  return kEngine;
}

dnnl::memory::data_type DataType(NumberFormat format) {
  switch (format) {
    case NumberFormat::kFloat32:
      return dnnl::memory::data_type::f32;
    case NumberFormat::kBfloat16:
      return dnnl::memory::data_type::bf16;
    case NumberFormat::kUint8:
      return dnnl::memory::data_type::u8;
  }
  return dnnl::memory::data_type::undef;
}

dnnl::memory::desc ImageDesc(const Shape& shape, NumberFormat format) {
  return {shape, DataType(format), dnnl::memory::format_tag::nhwc};
}

dnnl::memory::dims PadEnd(const Window& window, const Shape& input) {
  dnnl::memory::dims pads;
  for (int d = 0; d < 2; ++d) {
    const int64_t extent = (window.kernel[d] - 1) * window.dilation[d] + 1;
    const int64_t covered = (window.output[d] - 1) * window.stride[d] + extent;
    pads.push_back(covered - window.pad_begin[d] - input[static_cast<size_t>(d) + 2]);
  }
  return pads;
}

namespace {

using Isa = dnnl::cpu_isa;

// Whether oneDNN computes with one of these instruction sets here.
bool HasOneOf(std::initializer_list<Isa> sets) {
  return std::find(sets.begin(), sets.end(), dnnl::get_effective_cpu_isa()) != sets.end();
}

}  // namespace

bool HasBfloat16() {
  return HasOneOf({Isa::avx512_core, Isa::avx512_core_vnni}) || HasFastBfloat16();
}

bool HasFastBfloat16() { return HasOneOf({Isa::avx512_core_bf16, Isa::avx512_core_amx}); }

bool HasMatrixUnit() { return HasOneOf({Isa::avx512_core_amx}); }

int LargestInt8Weight() {
  const bool has_dot_products =
      HasOneOf({Isa::avx2_vnni, Isa::avx512_core_vnni}) || HasFastBfloat16();
  return has_dot_products ? 127 : 64;
}

}  // namespace msf
