#include "recon/dense/dense_reconstructor.hpp"

#include <gmock/gmock.h>
#include <pthread.h>

#include <ctime>
#include <thread>

#include "mesh_area.hpp"
#include "rendered_views.hpp"

namespace depthscope::recon {
namespace {

constexpr int kTriangles = 100000;
constexpr int kThreads = 2;

float hill(float x, float y) {
  return 0.4f * std::exp(-2 * (x * x + y * y));
}

/// The surface after all keyframes were handed over.
SurfaceMesh reconstructed(const RenderedViews& scene, const DenseSettings& settings = {}) {
  DenseReconstructor reconstructor(scene.camera, settings, kThreads);
  for (const ViewPicture& picture : scene.pictures) reconstructor.addPicture(picture);
  SurfaceMesh mesh;
  EXPECT_EQ(reconstructor.reconstruct(indexOf(scene.camera, scene.cloud), kTriangles, mesh, {}),
            ReconStatus::Ok);
  return mesh;
}

/// Root mean square distance of the vertices to the surface, along z.
double error(const SurfaceMesh& mesh, Height height, float scale = 1) {
  double sum = 0;
  for (const auto& v : mesh.vertices)
    sum += std::pow(v.z() / scale - height(v.x() / scale, v.y() / scale), 2);
  return std::sqrt(sum / static_cast<double>(mesh.vertices.size()));
}

TEST(DenseReconstructor, FindsAHill) {
  const SurfaceMesh mesh = reconstructed(renderViews(hill, 6));
  EXPECT_GT(area(mesh), 5);            // of about 4.3 x 3.2 that the cameras see together
  EXPECT_LT(error(mesh, hill), 0.01);  // 0.25 % of the distance
  ASSERT_EQ(mesh.normals.size(), mesh.vertices.size());
  ASSERT_EQ(mesh.confidence.size(), mesh.vertices.size());
  ASSERT_EQ(mesh.observations.size(), mesh.vertices.size());
  for (std::uint16_t seen : mesh.observations) {
    ASSERT_GE(seen, 1);
    ASSERT_LE(seen, 6);
  }
  for (const auto& n : mesh.normals) ASSERT_GT(n.z(), 0.3f);  // towards the cameras
  for (const auto& t : mesh.triangles)
    ASSERT_GE((mesh.vertices[t[1]] - mesh.vertices[t[0]])
                  .cross(mesh.vertices[t[2]] - mesh.vertices[t[0]])
                  .z(),
              -1e-6f);
}

TEST(DenseReconstructor, LeavesAHoleWhereThereIsNoTexture) {
  const SurfaceMesh mesh =
      reconstructed(renderViews(flat, 6, [](float x, float y) { return std::hypot(x, y) < 0.5f; }));
  EXPECT_GT(area(mesh), 4);
  for (const auto& v : mesh.vertices) EXPECT_GT(v.head<2>().norm(), 0.35f) << v.transpose();
}

/// Closer than views of a large map may be that get a depth map: 0.025 of the depth.
TEST(DenseReconstructor, FindsAHillAtTheStartOfAMapInViewsThatLieClose) {
  const SurfaceMesh mesh = reconstructed(renderViews(hill, 4, nullptr, 0.1));
  EXPECT_GT(area(mesh), 5);
  EXPECT_LT(error(mesh, hill), 0.04);  // 1 % of the distance
}

TEST(DenseReconstructor, GivesTheSameBitsTwice) {
  const RenderedViews scene = renderViews(hill, 6);
  const SurfaceMesh a = reconstructed(scene), b = reconstructed(scene);
  EXPECT_EQ(a.vertices, b.vertices);
  EXPECT_EQ(a.triangles, b.triangles);
  EXPECT_EQ(a.confidence, b.confidence);
}

TEST(DenseReconstructor, GivesTheSameBitsOnAnyNumberOfThreads) {
  const RenderedViews scene = renderViews(hill, 7);
  std::vector<SurfaceMesh> meshes;
  for (int threads : {1, 2, 3}) {
    DenseReconstructor reconstructor(scene.camera, {}, threads);
    for (const ViewPicture& picture : scene.pictures) reconstructor.addPicture(picture);
    ASSERT_EQ(reconstructor.reconstruct(indexOf(scene.camera, scene.cloud), kTriangles,
                                        meshes.emplace_back(), {}),
              ReconStatus::Ok);
  }
  for (const SurfaceMesh& mesh : meshes) {
    EXPECT_EQ(mesh.vertices, meshes.front().vertices);
    EXPECT_EQ(mesh.confidence, meshes.front().confidence);
  }
}

TEST(DenseReconstructor, KeepsDepthMapsAndFollowsTheMapsUnitOfLength) {
  const RenderedViews scene = renderViews(hill, 6);
  DenseReconstructor reconstructor(scene.camera, {}, kThreads);
  for (const ViewPicture& picture : scene.pictures) reconstructor.addPicture(picture);
  SurfaceMesh mesh;
  ASSERT_EQ(reconstructor.reconstruct(indexOf(scene.camera, scene.cloud), kTriangles, mesh, {}),
            ReconStatus::Ok);
  SparseCloud doubled = scene.cloud;
  for (auto& p : doubled.points) p.position *= 2;
  for (auto& T : doubled.views_T_camera_world) T.t *= 2;
  ASSERT_EQ(reconstructor.reconstruct(indexOf(scene.camera, doubled), kTriangles, mesh, {}),
            ReconStatus::Ok);
  EXPECT_LT(error(mesh, hill, 2), 0.01);
  EXPECT_GT(area(mesh), 4 * 5);
}

TEST(DenseReconstructor, SeesMoreFromViewsBetweenAndBesideKeyframes) {
  const RenderedViews scene = renderViews(hill, 7);
  SparseCloud cloud = scene.cloud;
  cloud.keyframes = 3;
  std::erase_if(cloud.sightings, [](const Sighting& s) { return s.view >= 3; });
  SparseCloud keyframes_alone = cloud;
  keyframes_alone.views_T_camera_world.resize(3);
  keyframes_alone.view_frames.resize(3);
  DenseSettings settings;
  settings.min_confidence = 0.7;  // more than three views give beside the middle
  const auto areaFor = [&](const SparseCloud& c) {
    DenseReconstructor reconstructor(scene.camera, settings, kThreads);
    for (const ViewPicture& picture : scene.pictures) reconstructor.addPicture(picture);
    SurfaceMesh mesh;
    const bool ok = reconstructor.reconstruct(indexOf(scene.camera, c), kTriangles, mesh, {}) ==
                    ReconStatus::Ok;
    return ok ? area(mesh) : 0.f;
  };
  EXPECT_GT(areaFor(cloud), 1.2f * areaFor(keyframes_alone));
}

TEST(DenseReconstructor, MakesNoMoreDepthMapsAtATimeThanAllowed) {
  const RenderedViews scene = renderViews(hill, 6);
  DenseSettings settings;
  settings.new_depth_maps = 1;  // a single depth map is confirmed by none
  DenseReconstructor reconstructor(scene.camera, settings, kThreads);
  for (const ViewPicture& picture : scene.pictures) reconstructor.addPicture(picture);
  SurfaceMesh mesh;
  EXPECT_EQ(reconstructor.reconstruct(indexOf(scene.camera, scene.cloud), kTriangles, mesh, {}),
            ReconStatus::TooFewPoints);
  for (int i = 0; i < 3; ++i)
    (void)reconstructor.reconstruct(indexOf(scene.camera, scene.cloud), kTriangles, mesh, {});
  EXPECT_EQ(reconstructor.reconstruct(indexOf(scene.camera, scene.cloud), kTriangles, mesh, {}),
            ReconStatus::Ok);
}

TEST(DenseReconstructor, GoesOnWhenPicturesAndDepthMapsAreFull) {
  const RenderedViews scene = renderViews(hill, 8);
  DenseSettings settings;
  settings.pictures = 5;
  settings.depth_maps = 3;
  DenseReconstructor reconstructor(scene.camera, settings, kThreads);
  SurfaceMesh mesh;
  SparseCloud cloud = scene.cloud;
  for (const ViewPicture& picture : scene.pictures) {
    reconstructor.addPicture(picture);
    (void)reconstructor.reconstruct(indexOf(scene.camera, cloud), kTriangles, mesh, {});
  }
  EXPECT_EQ(reconstructor.reconstruct(indexOf(scene.camera, cloud), kTriangles, mesh, {}),
            ReconStatus::Ok);
  EXPECT_LT(error(mesh, hill), 0.04);  // 1 % of the distance
}

TEST(DenseReconstructor, MakesVoxelsLargerWhereTheSurfaceWouldNotFit) {
  const RenderedViews scene = renderViews(flat, 6);
  DenseSettings few_blocks;
  few_blocks.max_blocks = 300;
  const std::size_t free = reconstructed(scene).triangles.size();
  EXPECT_LT(reconstructed(scene, few_blocks).triangles.size(), free * 3 / 4);
  DenseReconstructor reconstructor(scene.camera, {}, kThreads);
  for (const ViewPicture& picture : scene.pictures) reconstructor.addPicture(picture);
  SurfaceMesh mesh;
  const int limit = static_cast<int>(free / 2);
  ASSERT_EQ(reconstructor.reconstruct(indexOf(scene.camera, scene.cloud), limit, mesh, {}),
            ReconStatus::Ok);
  EXPECT_LE(mesh.triangles.size(), free / 2);
}

TEST(DenseReconstructor, NeedsPicturesAndStopsWhenAsked) {
  const RenderedViews scene = renderViews(flat, 4);
  DenseReconstructor reconstructor(scene.camera, {}, kThreads);
  SurfaceMesh mesh;
  EXPECT_EQ(reconstructor.reconstruct(indexOf(scene.camera, scene.cloud), kTriangles, mesh, {}),
            ReconStatus::TooFewPoints);
  const SparseCloud empty;
  EXPECT_EQ(reconstructor.reconstruct(indexOf(scene.camera, empty), kTriangles, mesh, {}),
            ReconStatus::TooFewPoints);
  for (const ViewPicture& picture : scene.pictures) reconstructor.addPicture(picture);
  std::stop_source source;
  source.request_stop();
  EXPECT_EQ(reconstructor.reconstruct(indexOf(scene.camera, scene.cloud), kTriangles, mesh,
                                      source.get_token()),
            ReconStatus::Cancelled);
  EXPECT_EQ(reconstructor.reconstruct(indexOf(scene.camera, scene.cloud), kTriangles, mesh, {}),
            ReconStatus::Ok);
}

double cpuMs(clockid_t clock) {
  timespec t{};
  ::clock_gettime(clock, &t);
  return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_nsec) * 1e-6;
}

/// However far it has come, what is cancelled stops at once: in the reconstruction's own processor
/// time, which other load on the machine does not stretch.
TEST(DenseReconstructor, StopsWithinFiftyMillisecondsWhereverItIs) {
#ifdef DEPTHSCOPE_SANITIZED
  constexpr double kSlower = 20;
#else
  constexpr double kSlower = 1;
#endif
  const RenderedViews scene = renderViews(hill, 8);
  clockid_t clock{};
  ASSERT_EQ(::pthread_getcpuclockid(::pthread_self(), &clock), 0);
  int cancelled = 0;
  for (double after_ms = 2;; after_ms *= 1.4) {
    DenseReconstructor reconstructor(scene.camera, {}, kThreads);
    for (const ViewPicture& picture : scene.pictures) reconstructor.addPicture(picture);
    std::stop_source source;
    const double start = cpuMs(clock);
    double asked = 0;
    std::jthread stopper([&](const std::stop_token& done) {
      while (!done.stop_requested() && cpuMs(clock) < start + after_ms) std::this_thread::yield();
      asked = cpuMs(clock);
      source.request_stop();
    });
    SurfaceMesh mesh;
    const ReconStatus status = reconstructor.reconstruct(indexOf(scene.camera, scene.cloud),
                                                         kTriangles, mesh, source.get_token());
    const double stopped = cpuMs(clock);
    stopper.request_stop();
    stopper.join();
    if (status == ReconStatus::Ok) break;
    EXPECT_EQ(status, ReconStatus::Cancelled);
    EXPECT_LT(stopped - asked, 50 * kSlower) << "cancelled after " << after_ms << " ms";
    ++cancelled;
  }
  EXPECT_GT(cancelled, 5);
}

}  // namespace
}  // namespace depthscope::recon
