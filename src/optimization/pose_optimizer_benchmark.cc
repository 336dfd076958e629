#include <benchmark/benchmark.h>

#include "optimization/pose_optimizer.h"
#include "optimization/test_scene.h"

namespace msf {
namespace {

// Tracking: a constant-velocity prediction about 1 cm and half a degree off, some wrong matches.
void BM_OptimizePose(benchmark::State& state) {
  const Camera camera = TestCamera();
  TestSceneOptions scene;
  scene.num_poses = 1;
  scene.num_points = static_cast<int>(state.range(0));
  scene.noise_px = 1;
  scene.outlier_share = 0.1;
  const BundleProblem problem = MakeTestProblem(camera, scene);
  const std::vector<PoseObservation> observations = ObservationsOfPose(problem, 0);
  Vector6d twist;
  twist << 0.01, -0.01, 0.005, 0.008, -0.005, 0.006;
  const Rigid3d T_cw_initial = Rigid3d::Exp(twist) * problem.poses[0].T_cw;
  while (state.KeepRunning())
    benchmark::DoNotOptimize(OptimizePose(camera, T_cw_initial, observations, {}));
  state.counters["observations"] = static_cast<double>(observations.size());
}
BENCHMARK(BM_OptimizePose)->Arg(100)->Arg(300)->Arg(600)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace msf
