// What a surface costs the thread that draws overlays: making it ready, and drawing it.
#include <benchmark/benchmark.h>

#include <cmath>

#include "overlay/compositor.hpp"
#include "overlay/surface_prep.hpp"
#include "tests/types/grid_mesh.hpp"

namespace {

using namespace depthscope;
using namespace depthscope::overlay;

CameraModel camera() {
  CameraModel c;
  c.width = 1280;
  c.height = 720;
  c.fx = c.fy = 900;
  c.cx = 639.5;
  c.cy = 359.5;
  return c;
}

/// Wavy tissue of about so many triangles that fills the view.
SurfaceMesh tissue(std::int64_t triangles) {
  const auto n = static_cast<std::uint32_t>(std::sqrt(static_cast<double>(triangles) / 2));
  SurfaceMesh mesh = gridMesh(n, [](float u, float v) {
    return Eigen::Vector3f(-50 + 100 * u, -35 + 70 * v, 80 + 8 * std::sin(9 * u) * std::cos(7 * v));
  });
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    mesh.confidence[i] = 0.5f + 0.5f * std::cos(0.2f * (mesh.vertices[i].x() + 50));
  return mesh;
}

void prepare(benchmark::State& state) {
  const SurfaceMesh mesh = tissue(state.range(0));
  SurfacePrep prep;
  PreparedSurface out;
  for (auto _ : state) prep.prepare(mesh, {}, out);
}
BENCHMARK(prepare)->Arg(5000)->Arg(20000)->Arg(100000)->Unit(benchmark::kMillisecond);

/// Second argument: in a cross-fade from one surface to the next.
void draw(benchmark::State& state) {
  const SurfaceMesh mesh = tissue(state.range(0));
  Compositor compositor(camera(), {});
  std::vector<std::uint8_t> layer(std::size_t{1280} * 720 * 4);
  OverlayState overlay;
  overlay.status = Status::Tracking;
  overlay.confidence = 1;
  overlay.time_s = 0;
  compositor.setSurface(mesh);
  compositor.drawLayer(1280, 720, overlay, layer);
  if (state.range(1) != 0) compositor.setSurface(mesh);
  overlay.time_s = 10;
  compositor.drawLayer(1280, 720, overlay, layer);
  for (auto _ : state) {
    overlay.time_s += 1e-9;
    compositor.drawLayer(1280, 720, overlay, layer);
  }
}
BENCHMARK(draw)
    ->ArgsProduct({{5000, 20000, 100000}, {0, 1}})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

}  // namespace

BENCHMARK_MAIN();
