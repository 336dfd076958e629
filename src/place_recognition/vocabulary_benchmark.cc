#include <benchmark/benchmark.h>

#include "feature/orb_extractor.h"
#include "feature/test_images.h"
#include "place_recognition/vocabulary.h"
#include "util/data_path.h"

namespace msf {
namespace {

void BM_LoadVocabulary(benchmark::State& state) {
  const std::filesystem::path file = *FindDataFile("models/vocabulary.msfvoc");
  while (state.KeepRunning()) benchmark::DoNotOptimize(Vocabulary::Load(file));
}
BENCHMARK(BM_LoadVocabulary)->Unit(benchmark::kMillisecond);

void BM_Transform1000(benchmark::State& state) {
  const Vocabulary vocabulary = *Vocabulary::Load(*FindDataFile("models/vocabulary.msfvoc"));
  const FrameFeatures features = OrbExtractor({}).Extract(FrameOf(TexturedImage(640, 480, 1)));
  while (state.KeepRunning()) benchmark::DoNotOptimize(vocabulary.Transform(features.descriptors));
}
BENCHMARK(BM_Transform1000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace msf
