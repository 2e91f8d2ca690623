#include "recon/surface_trimming.hpp"

#include <gmock/gmock.h>

#include "recon/mesh_geometry.hpp"

namespace depthscope::recon {
namespace {

/// A flat mesh of cells x cells unit squares, two triangles each, counter-clockwise seen from +z.
SurfaceMesh sheet(std::uint32_t cells, float z = 0) {
  SurfaceMesh mesh;
  const std::uint32_t row = cells + 1;
  for (std::uint32_t i = 0; i < row; ++i)
    for (std::uint32_t j = 0; j < row; ++j)
      mesh.vertices.emplace_back(static_cast<float>(i), static_cast<float>(j), z);
  for (std::uint32_t i = 0; i < cells; ++i)
    for (std::uint32_t j = 0; j < cells; ++j) {
      const std::uint32_t a = i * row + j, b = a + row;
      mesh.triangles.push_back({a, b, b + 1});
      mesh.triangles.push_back({a, b + 1, a + 1});
    }
  return mesh;
}

void append(SurfaceMesh& mesh, const SurfaceMesh& other) {
  const auto offset = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (auto t : other.triangles)
    mesh.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
}

/// Support on the points of an integer lattice, normals up, where `keep` says so.
template <typename Keep>
SupportCloud::Ptr support(int side, Keep keep) {
  auto cloud = std::make_shared<SupportCloud>();
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) {
      if (!keep(i, j)) continue;
      pcl::PointNormal p;
      p.x = static_cast<float>(i);
      p.y = static_cast<float>(j);
      p.z = 0;
      p.normal_z = 1;
      p.curvature = 4;
      cloud->push_back(p);
    }
  return cloud;
}

TEST(TrimToSupport, CutsAwayWhatNoPointSupports) {
  SurfaceMesh mesh = sheet(40);
  trimToSupport(mesh, support(41, [](int i, int) { return i <= 20; }), 1.f, {});
  float farthest = 0;
  for (const auto& v : mesh.vertices) farthest = std::max(farthest, v.x());
  // The last support is at 20; two local spacings (the 6th neighbour at an edge: 2) further at
  // most.
  EXPECT_GE(farthest, 20.f);
  EXPECT_LE(farthest, 24.f);
}

TEST(TrimToSupport, KeepsHolesOfTheObservation) {
  SurfaceMesh mesh = sheet(40);
  trimToSupport(mesh, support(41, [](int i, int j) { return std::hypot(i - 20, j - 20) > 10; }),
                1.f, {});
  for (const auto& v : mesh.vertices)
    EXPECT_GT((v - Eigen::Vector3f(20, 20, 0)).norm(), 5.f) << v.transpose();
  EXPECT_GT(mesh.triangles.size(), 1000u);
}

TEST(TrimToSupport, DropsTheSheetThatFacesAway) {
  SurfaceMesh mesh = sheet(20);
  SurfaceMesh back = sheet(20, -0.5f);
  for (auto& t : back.triangles) std::swap(t[1], t[2]);
  back.triangles.resize(back.triangles.size() / 2);
  append(mesh, back);
  trimToSupport(mesh, support(21, [](int, int) { return true; }), 1.f, {});
  for (const auto& v : mesh.vertices) EXPECT_EQ(v.z(), 0.f);
}

TEST(TrimToSupport, TurnsTheMeshTowardsTheCameras) {
  SurfaceMesh mesh = sheet(20);
  for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  trimToSupport(mesh, support(21, [](int, int) { return true; }), 1.f, {});
  ASSERT_EQ(mesh.normals.size(), mesh.vertices.size());
  ASSERT_FALSE(mesh.empty());
  for (const auto& n : mesh.normals) EXPECT_NEAR(n.z(), 1.f, 1e-6);
}

TEST(TrimToSupport, GivesLessConfidenceWhereFewerPointsAre) {
  SurfaceMesh mesh = sheet(20);
  auto points = support(21, [](int i, int) { return i <= 10; });
  trimToSupport(mesh, points, 1.f, {});
  float inside = -1, outside = -1;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (mesh.vertices[v] == Eigen::Vector3f(5, 10, 0)) inside = mesh.confidence[v];
    if (mesh.vertices[v] == Eigen::Vector3f(12, 10, 0)) outside = mesh.confidence[v];
  }
  EXPECT_FLOAT_EQ(inside, 1.f);
  EXPECT_GE(outside, 0.f);
  EXPECT_LT(outside, 0.7f);
}

TEST(TrimToSupport, CountsTheKeyframesThatSawTheNearestPoint) {
  SurfaceMesh mesh = sheet(20);
  auto points = support(21, [](int, int) { return true; });
  auto counted = std::make_shared<SupportCloud>(*points);
  for (auto& p : *counted) p.curvature = p.x < 10 ? 3 : 11;
  trimToSupport(mesh, counted, 1.f, {});
  ASSERT_EQ(mesh.observations.size(), mesh.vertices.size());
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    EXPECT_EQ(mesh.observations[v], mesh.vertices[v].x() < 9.5f ? 3 : 11) << v;
}

TEST(DropSmallIslands, KeepsTheMainPieceAndRenumbers) {
  SurfaceMesh mesh = sheet(2, 5);  // the island comes first, so that renumbering matters
  append(mesh, sheet(10));
  mesh.observations.assign(mesh.vertices.size(), 1);
  mesh.observations.back() = 7;
  dropSmallIslands(mesh, 20.f);
  EXPECT_EQ(mesh.vertices.size(), 121u);
  ASSERT_EQ(mesh.observations.size(), 121u);
  EXPECT_EQ(mesh.observations.back(), 7);
  EXPECT_EQ(mesh.triangles.size(), 200u);
  for (const auto& t : mesh.triangles)
    for (auto v : t) EXPECT_LT(v, 121u);
  for (const auto& v : mesh.vertices) EXPECT_EQ(v.z(), 0.f);
}

}  // namespace
}  // namespace depthscope::recon
