#include "overlay/surface_prep.hpp"

#include <gmock/gmock.h>

#include <limits>
#include <map>
#include <set>

#include "tests/overlay/overlay_scene.hpp"

namespace depthscope::overlay {
namespace {

Eigen::Vector3f position(const SurfaceVertex& v) {
  return {v.position[0], v.position[1], v.position[2]};
}

TEST(SurfacePrep, GivesTheCornersOfEveryTriangleThreeWireColoursWithFewCopies) {
  const SurfaceMesh mesh = wall(-10, 10, -10, 10, 50, 60, 40);
  PreparedSurface out;
  SurfacePrep().prepare(mesh, plainSettings(), out);
  ASSERT_EQ(out.indices.size(), 3 * mesh.triangles.size());
  for (std::size_t i = 0; i < out.indices.size(); i += 3)
    for (int c = 0; c < 3; ++c) {
      int ones = 0;
      for (std::size_t k = 0; k < 3; ++k) ones += out.vertices[out.indices[i + k]].bary[c] == 255;
      EXPECT_EQ(ones, 1);
    }
  EXPECT_LT(out.vertices.size(), mesh.vertices.size() * 3 / 2);
}

TEST(SurfacePrep, CutsLongEdgesAndTheirNeighboursAlike) {
  const SurfaceMesh mesh = wall(-10, 10, -10, 10, 50, 50, 2);
  PreparedSurface out;
  SurfacePrep().prepare(mesh, plainSettings(), out);
  std::map<std::set<std::array<float, 3>>, int> edges;
  double area = 0;
  for (std::size_t i = 0; i < out.indices.size(); i += 3) {
    Eigen::Vector3f p[3];
    for (std::size_t k = 0; k < 3; ++k) p[k] = position(out.vertices[out.indices[i + k]]);
    area += 0.5 * (p[1] - p[0]).cross(p[2] - p[0]).norm();
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3f &a = p[k], &b = p[(k + 1) % 3];
      EXPECT_LE((a - b).norm(), out.diagonal / 40 * 1.0001f);
      ++edges[{{a.x(), a.y(), a.z()}, {b.x(), b.y(), b.z()}}];
    }
  }
  EXPECT_NEAR(area, 400, 1e-2);
  for (const auto& [edge, uses] : edges) {
    const bool on_border = std::all_of(edge.begin(), edge.end(),
                                       [&](const auto& v) { return std::abs(v[0]) > 9.99f; }) ||
                           std::all_of(edge.begin(), edge.end(),
                                       [&](const auto& v) { return std::abs(v[1]) > 9.99f; });
    EXPECT_EQ(uses, on_border ? 1 : 2);
  }
}

TEST(SurfacePrep, FadesTowardsTheBorderAndWithConfidence) {
  SurfaceMesh mesh = wall(-10, 10, -10, 10, 50, 50, 40);
  mesh.confidence[20 * 41 + 20] = 0;
  OverlaySettings settings = plainSettings();
  settings.border_fade = 0.1f;
  PreparedSurface out;
  SurfacePrep().prepare(mesh, settings, out);
  for (const SurfaceVertex& v : out.vertices) {
    const Eigen::Vector3f p = position(v);
    const float rim = 10 - std::max(std::abs(p.x()), std::abs(p.y()));
    if (rim < 0.01f) {
      EXPECT_EQ(v.fade, 0);
    }
    if (p.norm() < 0.01f) {
      EXPECT_EQ(v.fade, 0);
    }
    if (rim > 3 && p.norm() > 1) {
      EXPECT_EQ(v.fade, 255);
    }
    if (rim > 0.8f && rim < 2) {
      EXPECT_THAT(v.fade, testing::AllOf(testing::Gt(20), testing::Lt(255)));
    }
  }
}

TEST(SurfacePrep, LeavesOutWhatIsBroken) {
  SurfaceMesh mesh = wall(-10, 10, -10, 10, 50, 50, 4);
  const std::size_t sound = mesh.triangles.size();
  mesh.triangles.push_back({0, 1, 1000000});
  mesh.triangles.push_back({3, 3, 4});
  mesh.vertices.push_back({std::numeric_limits<float>::quiet_NaN(), 0, 0});
  mesh.triangles.push_back({0, 1, static_cast<std::uint32_t>(mesh.vertices.size() - 1)});
  PreparedSurface out;
  SurfacePrep prep;
  prep.prepare(mesh, plainSettings(),
               out);  // normals and confidence are too short now as well
  EXPECT_GE(out.indices.size(), 3 * sound);
  for (const SurfaceVertex& v : out.vertices) EXPECT_TRUE(position(v).allFinite());
  prep.prepare(SurfaceMesh{}, plainSettings(), out);
  EXPECT_TRUE(out.empty());
}

TEST(SurfacePrep, KeepsACoarseCopyForTheCorner) {
  PreparedSurface out;
  OverlaySettings settings = plainSettings();
  settings.max_triangles = 100000;
  SurfacePrep().prepare(wall(-10, 10, -10, 10, 50, 50, 150), settings, out);
  EXPECT_EQ(out.indices.size(), 3u * 2 * 150 * 150);
  EXPECT_LT(out.inset_indices.size(), out.indices.size() / 8);
  EXPECT_GT(out.inset_indices.size(), 3000u);
}

TEST(SurfacePrep, ADenseSurfaceIsDrawnWithFewerTrianglesAndLooksTheSame) {
  // A dome, fading to one side.
  SurfaceMesh mesh = wall(-10, 10, -10, 10, 50, 50, 220);
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    Eigen::Vector3f& v = mesh.vertices[i];
    v.z() = 50 + 0.1f * v.head<2>().squaredNorm();
    mesh.confidence[i] = v.x() < 0 ? 0.2f : 1.0f;
  }
  OverlaySettings settings = plainSettings();
  settings.max_triangles = 20000;
  PreparedSurface out;
  SurfacePrep().prepare(mesh, settings, out);
  EXPECT_LE(out.indices.size(), 3u * 20000);
  EXPECT_GT(out.indices.size(), 3u * 10000) << "no coarser than it must be";
  double area = 0;
  for (std::size_t i = 0; i < out.indices.size(); i += 3) {
    Eigen::Vector3f p[3];
    for (std::size_t k = 0; k < 3; ++k) p[k] = position(out.vertices[out.indices[i + k]]);
    area += 0.5 * std::abs((p[1] - p[0]).head<2>().x() * (p[2] - p[0]).y() -
                           (p[1] - p[0]).y() * (p[2] - p[0]).x());
  }
  EXPECT_NEAR(area, 400, 8) << "without holes or folds";
  for (const SurfaceVertex& v : out.vertices) {
    const Eigen::Vector3f p = position(v) + out.origin.cast<float>();
    EXPECT_NEAR(p.z(), 50 + 0.1f * p.head<2>().squaredNorm(), 0.02f);
    if (p.x() < -0.2f) {
      EXPECT_LT(v.fade, 80);
    }
    if (p.x() > 0.2f) {
      EXPECT_GT(v.fade, 250);
    }
  }
}

}  // namespace
}  // namespace depthscope::overlay
