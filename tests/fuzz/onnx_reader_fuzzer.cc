// libFuzzer target: whatever the bytes, reading a model ends with a graph or a sentence.
#include <cstdint>
#include <string_view>

#include "detection/branch_merging.h"
#include "detection/fusion.h"
#include "detection/onnx_reader.h"
#include "detection/specialize.h"
#include "detection/storage_plan.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const auto graph = msf::ParseOnnx({reinterpret_cast<const char*>(data), size}, "fuzz.onnx");
  if (!graph.ok()) return 0;
  const auto declared = msf::DeclaredInputSize(*graph);
  if (!declared.ok()) return 0;
  const auto side = [](int64_t own) { return own > 0 ? own : 32; };
  auto fixed = msf::Specialize(*graph, side(declared->height), side(declared->width));
  if (!fixed.ok()) return 0;
  msf::Fuse(*fixed);
  msf::MergeBranches(*fixed);
  msf::PlanStorage(*fixed, msf::NetworkPrecision::kInt8, {}, {});
  return 0;
}
