// What a surface costs the thread that draws overlays: making it ready, and drawing it.
#include <benchmark/benchmark.h>

#include <cmath>

#include "overlay/compositor.hpp"
#include "overlay/surface_prep.hpp"

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
  SurfaceMesh mesh;
  for (std::uint32_t r = 0; r <= n; ++r)
    for (std::uint32_t c = 0; c <= n; ++c) {
      const float u = static_cast<float>(c) / static_cast<float>(n),
                  v = static_cast<float>(r) / static_cast<float>(n);
      mesh.vertices.push_back(
          {-50 + 100 * u, -35 + 70 * v, 80 + 8 * std::sin(9 * u) * std::cos(7 * v)});
      mesh.normals.push_back({0, 0, -1});
      mesh.confidence.push_back(0.5f + 0.5f * std::cos(20 * u));
    }
  for (std::uint32_t r = 0; r < n; ++r)
    for (std::uint32_t c = 0; c < n; ++c) {
      const std::uint32_t a = r * (n + 1) + c, b = a + n + 1;
      mesh.triangles.push_back({a, b, a + 1});
      mesh.triangles.push_back({a + 1, b, b + 1});
    }
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
