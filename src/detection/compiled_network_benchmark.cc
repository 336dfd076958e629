// Time of networks of YOLOv8n's size with random weights: --benchmark_filter=Network
#include <benchmark/benchmark.h>

#include "detection/compiled_network.h"
#include "detection/test_networks.h"

namespace msf {
namespace {

// One range for everything: the speed does not depend on it.
void AddCrudeRanges(Graph& graph, const CompileOptions& options) {
  CompileOptions observing = options;
  observing.precision = NetworkPrecision::kFloat32;
  observing.keep_values = true;
  ActivationRanges ranges;
  const auto network = CompiledNetwork::Compile(graph, observing).value();
  for (const NetworkOutput& value : network->inner_values()) ranges[value.name] = {-0.3f, 6.0f, {}};
  graph.metadata[kActivationRangesKey] = FormatActivationRanges(ranges);
}

void BM_Network(benchmark::State& state) {
  TestNetworkOptions network_options;
  network_options.base = 16;
  network_options.classes = 20;
  network_options.msf = state.range(0) != 0;
  TestNetwork source(network_options);
  Graph graph = source.builder().Parse().value();
  CompileOptions options{state.range(3), state.range(2),
                         static_cast<NetworkPrecision>(state.range(1))};
  if (options.precision == NetworkPrecision::kInt8) AddCrudeRanges(graph, options);
  auto network = CompiledNetwork::Compile(graph, options).value();
  while (state.KeepRunning()) {
    if (!network->Run().ok()) state.SkipWithError("run failed");
  }
  state.counters["MB"] = static_cast<double>(network->activation_bytes()) * 1e-6;
  state.counters["int8"] = network->num_int8_convolutions();
}

void BM_Compile(benchmark::State& state) {
  TestNetworkOptions network_options;
  network_options.base = 16;
  network_options.msf = true;
  TestNetwork source(network_options);
  const std::string bytes = source.builder().Bytes();
  Graph graph = ParseOnnx(bytes, "benchmark").value();
  CompileOptions options{320, 416, static_cast<NetworkPrecision>(state.range(0))};
  if (options.precision == NetworkPrecision::kInt8) AddCrudeRanges(graph, options);
  while (state.KeepRunning()) {
    benchmark::DoNotOptimize(ParseOnnx(bytes, "benchmark").value());
    CompiledNetwork::Compile(graph, options).value();
  }
}

BENCHMARK(BM_Network)
    ->ArgNames({"msf", "precision", "width", "height"})
    ->ArgsProduct({{0, 1}, {0, 1, 2}, {416}, {320}})
    ->Unit(benchmark::kMillisecond);
BENCHMARK(BM_Compile)->DenseRange(0, 2)->Unit(benchmark::kMillisecond)->Iterations(1);

}  // namespace
}  // namespace msf
