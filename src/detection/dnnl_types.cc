#include "detection/dnnl_types.h"

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

bool HasBfloat16() {
  switch (dnnl::get_effective_cpu_isa()) {
    case dnnl::cpu_isa::avx512_core:
    case dnnl::cpu_isa::avx512_core_vnni:
    case dnnl::cpu_isa::avx512_core_bf16:
    case dnnl::cpu_isa::avx512_core_amx:
      return true;
    default:
      return false;
  }
}

bool HasFastBfloat16() {
  switch (dnnl::get_effective_cpu_isa()) {
    case dnnl::cpu_isa::avx512_core_bf16:
    case dnnl::cpu_isa::avx512_core_amx:
      return true;
    default:
      return false;
  }
}

bool HasMatrixUnit() { return dnnl::get_effective_cpu_isa() == dnnl::cpu_isa::avx512_core_amx; }

bool HasFastInt8() {
  switch (dnnl::get_effective_cpu_isa()) {
    case dnnl::cpu_isa::avx2_vnni:
    case dnnl::cpu_isa::avx512_core_vnni:
    case dnnl::cpu_isa::avx512_core_bf16:
    case dnnl::cpu_isa::avx512_core_amx:
      return true;
    default:
      return false;
  }
}

}  // namespace msf
