#include <benchmark/benchmark.h>

#include "optimization/bundle_adjustment.h"
#include "optimization/test_ceres_bundle.h"
#include "optimization/test_scene.h"

namespace msf {
namespace {

BundleProblem MakeProblem(int num_poses, int num_fixed, int num_points, int window) {
  TestSceneOptions scene;
  scene.num_poses = num_poses;
  scene.num_points = num_points;
  scene.window = window;
  scene.noise_px = 1;
  scene.outlier_share = 0.03;
  BundleProblem problem = MakeTestProblem(TestCamera(), scene);
  for (int i = 0; i < num_fixed; ++i) problem.poses[i].fixed = true;
  Perturb(problem, 0.003, 0.01, 2);
  return problem;
}

void Run(benchmark::State& state, const BundleProblem& problem) {
  const Camera camera = TestCamera();
  int iterations = 0;
  while (state.KeepRunning()) {
    BundleProblem copy = problem;
    iterations = SolveBundle(camera, copy, {}).iterations;
  }
  state.counters["observations"] = static_cast<double>(problem.observations.size());
  state.counters["iterations"] = iterations;
}

// After a keyframe: its neighbours and their points, other observers fixed.
void BM_LocalBundle(benchmark::State& state) { Run(state, MakeProblem(35, 15, 2000, 8)); }
BENCHMARK(BM_LocalBundle)->Unit(benchmark::kMillisecond);

// The same with Ceres, which has no second pass here.
void BM_LocalBundleCeres(benchmark::State& state) {
  const Camera camera = TestCamera();
  const BundleProblem problem = MakeProblem(35, 15, 2000, 8);
  while (state.KeepRunning()) {
    BundleProblem copy = problem;
    benchmark::DoNotOptimize(SolveBundleWithCeres(camera, copy, {}, /*robust=*/true, 10));
  }
}
BENCHMARK(BM_LocalBundleCeres)->Unit(benchmark::kMillisecond);

// After a loop: everything.
void BM_FullBundle(benchmark::State& state) {
  Run(state,
      MakeProblem(static_cast<int>(state.range(0)), 1, static_cast<int>(state.range(0)) * 60, 10));
}
BENCHMARK(BM_FullBundle)->Arg(100)->Arg(300)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace msf
