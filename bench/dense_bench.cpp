// What the stages of the dense reconstruction cost, on a rendered hill in pictures of 320x240.
#include <benchmark/benchmark.h>

#include "recon/dense/dense_reconstructor.hpp"
#include "tests/recon/rendered_views.hpp"

namespace depthscope::recon {
namespace {

constexpr int kTriangles = 100000;

const RenderedViews& scene() {
  static const RenderedViews rendered =
      renderViews([](float x, float y) { return 0.4f * std::exp(-2 * (x * x + y * y)); }, 12);
  return rendered;
}

void takePicture(benchmark::State& state) {
  const PinholeView view(scene().camera, 1, DenseSettings{}.picture_width);
  RectifiedPicture out;
  for (auto _ : state) rectify(scene().pictures[0].luma, view, {}, DepthEstimator::kRadius, out);
}
BENCHMARK(takePicture)->Unit(benchmark::kMillisecond);

void makeDepthMap(benchmark::State& state) {
  const DenseSettings settings;
  const PinholeView view(scene().camera, 1, settings.picture_width);
  std::vector<RectifiedPicture> pictures(4);
  std::vector<DepthSource> sources;
  const auto& poses = scene().cloud.views_T_camera_world;
  for (std::size_t k = 0; k < pictures.size(); ++k) {
    rectify(scene().pictures[k].luma, view, settings, DepthEstimator::kRadius, pictures[k]);
    if (k > 0) sources.push_back({&pictures[k], poses[k] * poses[0].inverse()});
  }
  std::vector<DepthSeed> seeds;
  for (const SparsePoint& p : scene().cloud.points) {
    const Eigen::Vector3d c = poses[0] * p.position.cast<double>();
    seeds.push_back({scene().camera.project(c).cast<float>(), static_cast<float>(1 / c.z())});
  }
  DepthEstimator estimator(view, settings);
  DepthMap out;
  for (auto _ : state) estimator.estimate(pictures[0], sources, seeds, 1, out, {});
}
BENCHMARK(makeDepthMap)->Unit(benchmark::kMillisecond);

/// Confirmation, fusion and extraction of twelve depth maps that are there already.
void fuseTwelve(benchmark::State& state) {
  DenseSettings settings;
  settings.new_depth_maps = 12;
  settings.min_motion = 0.01;
  DenseReconstructor reconstructor(scene().camera, settings, ReconSettings{}.threads);
  for (const ViewPicture& picture : scene().pictures) reconstructor.addPicture(picture);
  const CloudIndex index = indexOf(scene().camera, scene().cloud);
  SurfaceMesh mesh;
  (void)reconstructor.reconstruct(index, kTriangles, mesh, {});
  for (auto _ : state) (void)reconstructor.reconstruct(index, kTriangles, mesh, {});
}
BENCHMARK(fuseTwelve)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace depthscope::recon

BENCHMARK_MAIN();
