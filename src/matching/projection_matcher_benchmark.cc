// Matching a local map of 2000 points against an image of 1000 features.
#include <benchmark/benchmark.h>

#include <cmath>
#include <random>

#include "matching/projection_matcher.h"

namespace msf {
namespace {

FrameFeatures RandomFeatures(const Camera& camera, int count, std::mt19937_64& random) {
  std::uniform_real_distribution<float> u(0, camera.width), v(0, camera.height);
  FrameFeatures features;
  for (int i = 0; i < count; ++i) {
    features.uv_px.emplace_back(u(random), v(random));
    features.u_right_px.push_back(-1);
    features.level.push_back(static_cast<uint8_t>(random() % 8));
    Descriptor descriptor;
    for (uint64_t& bits : descriptor) bits = random();
    features.descriptors.push_back(descriptor);
  }
  features.BuildGrid(camera);
  return features;
}

void BM_MatchByProjection(benchmark::State& state) {
  std::mt19937_64 random(1);
  const Camera camera = *Camera::Preset("simulated");
  const FrameFeatures features = RandomFeatures(camera, 1000, random);
  std::vector<ProjectionQuery> queries;
  for (int q = 0; q < state.range(0); ++q) {
    const int i = static_cast<int>(random() % features.size());
    queries.push_back({.uv_px = features.uv_px[i].cast<double>() + Eigen::Vector2d(3, -2),
                       .radius_px = 20 * std::pow(1.2, features.level[i]),
                       .min_level = std::max(0, features.level[i] - 1),
                       .max_level = features.level[i],
                       .descriptor = features.descriptors[i]});
  }
  while (state.KeepRunning())
    benchmark::DoNotOptimize(MatchByProjection(features, queries, {.ratio = 0.8}));
}
BENCHMARK(BM_MatchByProjection)->Arg(500)->Arg(2000);

}  // namespace
}  // namespace msf
