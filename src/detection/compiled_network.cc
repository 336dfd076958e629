#include "detection/compiled_network.h"

#include <fmt/format.h>

#include "detection/branch_merging.h"
#include "detection/dnnl_steps.h"
#include "detection/fusion.h"
#include "detection/network_builder.h"
#include "detection/openmp_threads.h"
#include "detection/specialize.h"
#include "detection/weight_rounding.h"

namespace msf {
namespace {

StatusOr<ActivationRanges> RangesFor(const Graph& graph, NetworkPrecision precision) {
  if (precision != NetworkPrecision::kInt8) return ActivationRanges();
  const auto found = graph.metadata.find(kActivationRangesKey);
  if (found == graph.metadata.end()) {
    return Status::Error(
        graph.source +
        ": holds no activation ranges, so it cannot run in int8; make such a model with 'msf-slam "
        "detector quantize', or choose precision bf16 or fp32");
  }
  StatusOr<ActivationRanges> ranges = ParseActivationRanges(found->second);
  if (!ranges.ok()) return Status::Error(graph.source + ": " + ranges.message());
  return ranges;
}

// What the executor cannot do at all: integers that depend on the image.
Status CheckFloats(const Graph& graph) {
  for (const Node& node : graph.nodes) {
    for (const ValueId output : node.outputs) {
      if (graph.value(output).type == ElementType::kFloat) continue;
      return Status::Error(graph.source + ": " + Describe(node) +
                           " computes integers from the image, not supported");
    }
  }
  return Status::Ok();
}

Storage InputStorage(bool float_input) {
  if (float_input) return {};
  return {NumberFormat::kUint8, true, 1.0f / 255.0f, 0};  // 8-bit pixels stand for 0..1
}

bool ShouldMerge(const CompileOptions& options) {
  if (options.merging != CompileOptions::Merging::kAuto)
    return options.merging == CompileOptions::Merging::kAlways;
  return options.precision != NetworkPrecision::kFloat32 && HasMatrixUnit();
}

}  // namespace

StatusOr<std::unique_ptr<CompiledNetwork>> CompiledNetwork::Compile(const Graph& graph,
                                                                    const CompileOptions& options) {
  StatusOr<Graph> fixed = Specialize(graph, options.height, options.width);
  if (!fixed.ok()) return fixed.status();
  MSF_RETURN_IF_ERROR(CheckFloats(*fixed));
  StatusOr<ActivationRanges> ranges = RangesFor(graph, options.precision);
  if (!ranges.ok()) return ranges.status();
  Fuse(*fixed);
  if (ShouldMerge(options)) MergeBranches(*fixed);
  StoragePlan plan =
      PlanStorage(*fixed, options.precision, *ranges, InputStorage(options.float_input));
  MSF_RETURN_IF_ERROR(CorrectRoundedWeights(*fixed, plan, *ranges, LargestInt8Weight()));
  const OpenMpThreadsScope threads(options.threads);
  std::unique_ptr<CompiledNetwork> network(new CompiledNetwork());
  network->graph_ = *std::move(fixed);
  network->threads_ = options.threads;
  NetworkBuilder builder(*network, options, std::move(plan));
  if (Status status = builder.Build(); !status.ok()) return status;
  return network;
}

uint8_t* CompiledNetwork::pixels() { return static_cast<uint8_t*>(input_); }

float* CompiledNetwork::float_input() { return static_cast<float*>(input_); }

Status CompiledNetwork::Run() {
  const OpenMpThreadsScope threads(threads_);
  for (const auto& step : steps_) MSF_RETURN_IF_ERROR(step->Run());
  return Status::Ok();
}

const std::string& CompiledNetwork::input_name() const {
  return graph_.value(graph_.inputs[0]).name;
}

}  // namespace msf
