// What happens when memory runs out in the middle of a reconstruction: the old surface stays, and
// the next reconstruction works.
#include <gmock/gmock.h>

#include <cstdlib>
#include <new>

#include "recon/reconstructor.hpp"
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

TEST(OutOfMemory, KeepsTheOldSurfaceWhereverItStrikes) {
  const SparseCloud cloud = heightCloud(cap, 16, 0.005f);
  Reconstructor reconstructor({}, sparseSettings());
  SurfaceMesh mesh;
  ASSERT_EQ(reconstructor.reconstruct(cloud, mesh), ReconStatus::Ok);
  const auto vertices = mesh.vertices;
  int struck = 0;
  for (long k = 0;; k = k + 1 + k / 3) {
    allocations_until_failure = k;
    const ReconStatus status = reconstructor.reconstruct(cloud, mesh);
    allocations_until_failure = -1;
    if (status == ReconStatus::Ok) break;
    ASSERT_EQ(status, ReconStatus::OutOfMemory) << "at allocation " << k;
    ASSERT_TRUE(mesh.vertices == vertices);
    ++struck;
  }
  EXPECT_GT(struck, 20);
  EXPECT_TRUE(mesh.vertices ==
              vertices);  // the first that went through gives the same surface again
}

}  // namespace
}  // namespace depthscope::recon
