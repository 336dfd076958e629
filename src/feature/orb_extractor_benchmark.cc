#include <benchmark/benchmark.h>

#include "feature/orb_extractor.h"
#include "feature/test_images.h"

namespace msf {
namespace {

void BM_Extract(benchmark::State& state) {
  const RgbdFrame frame = FrameOf(TexturedImage(640, 480, 1));
  OrbExtractor extractor({.num_features = static_cast<int>(state.range(0))});
  int points = 0;
  while (state.KeepRunning()) {
    const FrameFeatures features = extractor.Extract(frame);
    points = features.size();
    benchmark::DoNotOptimize(points);
  }
  state.counters["points"] = points;
}
BENCHMARK(BM_Extract)->Arg(1000)->Arg(1500)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace msf
