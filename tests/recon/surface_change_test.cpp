#include "recon/surface_change.hpp"

#include <gmock/gmock.h>

namespace depthscope::recon {
namespace {

/// A level square of vertices 0.1 apart, at height z; normals up.
SurfaceMesh sheet(float z, int side = 20) {
  SurfaceMesh mesh;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      mesh.vertices.emplace_back(0.1f * static_cast<float>(x), 0.1f * static_cast<float>(y), z);
      mesh.normals.emplace_back(Eigen::Vector3f::UnitZ());
    }
  return mesh;
}

TEST(SurfaceChange, IsNothingForTheSameSurface) {
  const SurfaceChange change = compareSurfaces(sheet(1), sheet(1), 0.05f, 0.5f);
  EXPECT_EQ(change.largest, 0);
  EXPECT_EQ(change.share_beyond, 0);
}

TEST(SurfaceChange, MeasuresAlongTheNormal) {
  SurfaceMesh moved = sheet(1.03f);
  for (auto& v : moved.vertices) v.x() += 0.04f;  // other vertices of the same plane
  const SurfaceChange change = compareSurfaces(sheet(1), moved, 0.05f, 0.5f);
  EXPECT_NEAR(change.largest, 0.03f, 1e-5f);
  EXPECT_EQ(change.share_beyond, 0);
}

TEST(SurfaceChange, TellsThePartThatJumps) {
  SurfaceMesh dented = sheet(1);
  for (std::size_t i = 0; i < dented.vertices.size() / 4; ++i) dented.vertices[i].z() -= 0.08f;
  const SurfaceChange change = compareSurfaces(sheet(1), dented, 0.05f, 0.5f);
  EXPECT_NEAR(change.largest, 0.08f, 1e-5f);
  EXPECT_NEAR(change.share_beyond, 0.25f, 0.06f);
}

TEST(SurfaceChange, LeavesOutWhatIsOnlyInOne) {
  SurfaceMesh elsewhere = sheet(1);
  for (auto& v : elsewhere.vertices) v.x() += 10;
  EXPECT_EQ(compareSurfaces(sheet(1), elsewhere, 0.05f, 0.5f).largest, 0);
  EXPECT_EQ(compareSurfaces(sheet(1), {}, 0.05f, 0.5f).largest, 0);
  EXPECT_EQ(compareSurfaces({}, sheet(1), 0.05f, 0.5f).largest, 0);
}

}  // namespace
}  // namespace depthscope::recon
