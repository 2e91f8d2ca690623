// What happens when memory runs out in the middle of a reconstruction: the old surface stays, and
// the next reconstruction works.
#include <gmock/gmock.h>

#include <cstdlib>
#include <new>

#include "recon/reconstructor.hpp"
#include "recon/view_picture.hpp"
#include "rendered_views.hpp"
#include "synthetic_cloud.hpp"

// PCL's octree holds its arrays by bare pointers: what it had when memory ran out is lost, a few
// hundred kilobytes.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
  return "leak:pcl::poisson\n";
}

namespace {
thread_local long allocations_until_failure = -1;  // negative: never fail

void* allocate(std::size_t size) {
  if (allocations_until_failure == 0) throw std::bad_alloc();
  if (allocations_until_failure > 0) --allocations_until_failure;
  if (void* p = std::malloc(size ? size : 1)) return p;
  throw std::bad_alloc();
}
}  // namespace

void* operator new(std::size_t size) {
  return allocate(size);
}
void* operator new[](std::size_t size) {
  return allocate(size);
}
void operator delete(void* p) noexcept {
  std::free(p);
}
void operator delete[](void* p) noexcept {
  std::free(p);
}
void operator delete(void* p, std::size_t) noexcept {
  std::free(p);
}
void operator delete[](void* p, std::size_t) noexcept {
  std::free(p);
}

namespace depthscope::recon {
namespace {

/// Lets the k-th allocation of a reconstruction fail, for ever greater k, until none is left to
/// fail: the surface of before has to stay each time. Gives back how often it struck.
int strikeEverywhere(Reconstructor& reconstructor, const SparseCloud& cloud, SurfaceMesh& mesh) {
  const auto vertices = mesh.vertices;
  int struck = 0;
  for (long k = 0;; k = k + 1 + k / 3) {
    allocations_until_failure = k;
    const ReconStatus status = reconstructor.reconstruct(cloud, mesh);
    allocations_until_failure = -1;
    if (status == ReconStatus::Ok) return struck;
    EXPECT_EQ(status, ReconStatus::OutOfMemory) << "at allocation " << k;
    EXPECT_TRUE(mesh.vertices == vertices);
    ++struck;
  }
}

TEST(OutOfMemory, KeepsTheOldSurfaceWhereverItStrikes) {
  const SparseCloud cloud = heightCloud(cap, 16, 0.005f);
  Reconstructor reconstructor({}, sparseSettings());
  SurfaceMesh mesh;
  ASSERT_EQ(reconstructor.reconstruct(cloud, mesh), ReconStatus::Ok);
  const auto vertices = mesh.vertices;
  EXPECT_GT(strikeEverywhere(reconstructor, cloud, mesh), 20);
  EXPECT_TRUE(mesh.vertices ==
              vertices);  // the first that went through gives the same surface again
}

TEST(OutOfMemory, KeepsTheOldSurfaceOfPicturesToo) {
  const RenderedViews scene = renderViews(flat, 6);
  ReconSettings settings;
  settings.dense.new_depth_maps = 2;
  Reconstructor reconstructor(scene.camera, settings);
  for (const ViewPicture& picture : scene.pictures) reconstructor.addPicture(picture);
  SurfaceMesh mesh;
  ASSERT_EQ(reconstructor.reconstruct(scene.cloud, mesh), ReconStatus::Ok);
  EXPECT_GT(strikeEverywhere(reconstructor, scene.cloud, mesh), 10);
  allocations_until_failure = 0;  // a picture is left out, no more
  reconstructor.addPicture(scene.pictures.front());
  allocations_until_failure = -1;
  EXPECT_EQ(reconstructor.reconstruct(scene.cloud, mesh), ReconStatus::Ok);
  ASSERT_EQ(mesh.colors.size(), mesh.vertices.size());
  EXPECT_EQ(mesh.colors.front(), (Rgb{120, 60, 50}));
}

}  // namespace
}  // namespace depthscope::recon
