// Times of the geometric core on synthetic scenes of the sizes that tracking and mapping give it.
#include <benchmark/benchmark.h>

#include <random>
#include <vector>

#include "slam/bundle_adjuster.hpp"
#include "slam/pnp.hpp"
#include "slam/pose_optimizer.hpp"
#include "slam/two_view.hpp"

namespace {

using namespace depthscope;
using namespace depthscope::slam;

const Intrinsics kCamera{500, 500, 320, 240};

double uniform(std::mt19937& rng, double low, double high) {
  return low + (high - low) * (static_cast<double>(rng()) / 4294967296.0);
}

Eigen::Vector3d inBox(std::mt19937& rng, double half) {
  return {uniform(rng, -half, half), uniform(rng, -half, half), uniform(rng, -half, half)};
}

Eigen::Vector2d measure(std::mt19937& rng, const Pose& T_camera_world, const Eigen::Vector3d& p) {
  return kCamera.project(T_camera_world * p) +
         Eigen::Vector2d(uniform(rng, -1, 1), uniform(rng, -1, 1));
}

/// Arguments: free poses, fixed poses, points, observations per point.
void localBundleAdjustment(benchmark::State& state) {
  const int free = static_cast<int>(state.range(0)), fixed = static_cast<int>(state.range(1));
  const int points = static_cast<int>(state.range(2)), seen_by = static_cast<int>(state.range(3));
  BundleAdjuster ba(free + fixed, points, points * seen_by);
  BaSettings settings;
  settings.max_iterations = 5;
  settings.min_relative_decrease = 0;
  for (auto _ : state) {
    state.PauseTiming();
    std::mt19937 rng(1);
    ba.clear();
    std::vector<Pose> truth;
    for (int i = 0; i < free + fixed; ++i) {
      truth.push_back({expSO3(inBox(rng, 0.1)), inBox(rng, 0.5)});
      const Pose start = truth.back().retract(inBox(rng, 0.01), inBox(rng, 0.02));
      ba.addPose(i < fixed ? truth.back() : start, i < fixed);
    }
    for (int p = 0; p < points; ++p) {
      const Eigen::Vector3d point = inBox(rng, 2) + Eigen::Vector3d(0, 0, 6);
      ba.addPoint(point + inBox(rng, 0.05));
      const int first = static_cast<int>(uniform(rng, 0, free + fixed));
      for (int k = 0; k < seen_by; ++k) {
        const int pose = (first + k * 5) % (free + fixed);
        ba.addObservation({pose, p, measure(rng, truth[pose], point).cast<float>(), 1, true});
      }
    }
    state.ResumeTiming();
    benchmark::DoNotOptimize(ba.solve(kCamera, settings));
  }
}
BENCHMARK(localBundleAdjustment)
    ->Args({15, 15, 2000, 6})
    ->Args({30, 30, 4000, 8})
    ->Args({60, 20, 6000, 8})
    ->Unit(benchmark::kMillisecond);

std::vector<PoseObservation> frameObservations(int n, double outlier_share, const Pose& truth) {
  std::mt19937 rng(2);
  std::vector<PoseObservation> observations(n);
  for (PoseObservation& o : observations) {
    o.point_world = truth.inverse() * (inBox(rng, 2) + Eigen::Vector3d(0, 0, 6));
    o.pixel = measure(rng, truth, o.point_world);
    if (uniform(rng, 0, 1) < outlier_share) o.pixel = {uniform(rng, 0, 640), uniform(rng, 0, 480)};
  }
  return observations;
}

/// Arguments: observations, share of outliers in percent.
void poseOptimization(benchmark::State& state) {
  const Pose truth{expSO3({0.1, 0.2, 0.3}), {0.3, 0.2, 0.1}};
  auto observations =
      frameObservations(static_cast<int>(state.range(0)), 0.01 * state.range(1), truth);
  for (auto _ : state) {
    for (PoseObservation& o : observations) o.inlier = true;
    Pose pose = truth.retract({0.01, 0.01, -0.01}, {0.02, 0.02, 0.02});
    benchmark::DoNotOptimize(optimizePose(kCamera, observations, pose));
  }
}
BENCHMARK(poseOptimization)->Args({300, 10})->Args({800, 10})->Unit(benchmark::kMillisecond);

void perspectivePose(benchmark::State& state) {
  const Pose truth{expSO3({0.1, 0.2, 0.3}), {0.3, 0.2, 0.1}};
  auto observations =
      frameObservations(static_cast<int>(state.range(0)), 0.01 * state.range(1), truth);
  PnpSolver solver({}, static_cast<int>(observations.size()));
  PnpResult result;
  for (auto _ : state) benchmark::DoNotOptimize(solver.solve(kCamera, observations, result));
}
BENCHMARK(perspectivePose)->Args({200, 50})->Args({200, 90})->Unit(benchmark::kMillisecond);

/// Arguments: matches, baseline in thousandths of the depth (0: the camera stands still).
void twoViewReconstruction(benchmark::State& state) {
  std::mt19937 rng(3);
  std::vector<Eigen::Vector2f> first, second;
  const Pose T_second_first{expSO3({0.02, -0.01, 0.01}), {0.006 * state.range(1), 0, 0}};
  for (int i = 0; i < state.range(0); ++i) {
    const Eigen::Vector3d p = inBox(rng, 1.5) + Eigen::Vector3d(0, 0, 6);
    first.push_back(measure(rng, {}, p).cast<float>());
    second.push_back(measure(rng, T_second_first, p).cast<float>());
    if (i % 4 == 0)
      second.back() = Eigen::Vector2d(uniform(rng, 0, 640), uniform(rng, 0, 480)).cast<float>();
  }
  TwoViewInitializer initializer({}, kCamera, static_cast<int>(state.range(0)));
  TwoViewResult result;
  for (auto _ : state) benchmark::DoNotOptimize(initializer.reconstruct(first, second, result));
}
BENCHMARK(twoViewReconstruction)
    ->Args({500, 0})
    ->Args({500, 50})
    ->Args({1000, 50})
    ->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
