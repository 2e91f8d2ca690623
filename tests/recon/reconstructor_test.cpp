#include "recon/reconstructor.hpp"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cstring>
#include <limits>

#include "mesh_area.hpp"
#include "synthetic_cloud.hpp"
#include "types/error.hpp"

namespace depthscope::recon {
namespace {

SurfaceMesh reconstructed(const SparseCloud& cloud,
                          const ReconSettings& settings = sparseSettings()) {
  SurfaceMesh mesh;
  EXPECT_EQ(Reconstructor({}, settings).reconstruct(cloud, mesh), ReconStatus::Ok);
  return mesh;
}

template <typename T>
bool sameBits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

TEST(Reconstructor, FindsAPlane) {
  const SurfaceMesh mesh = reconstructed(heightCloud(flat, 40, 0.01f));
  ASSERT_EQ(mesh.normals.size(), mesh.vertices.size());
  ASSERT_EQ(mesh.confidence.size(), mesh.vertices.size());
  ASSERT_EQ(mesh.observations.size(), mesh.vertices.size());
  EXPECT_TRUE(mesh.colors.empty());
  EXPECT_EQ(mesh.map_id, 7u);
  EXPECT_GT(area(mesh), 3.6);  // the square,
  EXPECT_LT(area(mesh), 5.8);  // with a rim of at most two spacings
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Eigen::Vector3f& p = mesh.vertices[v];
    if (p.head<2>().lpNorm<Eigen::Infinity>() > 0.9f) continue;  // the rim is less sure
    EXPECT_NEAR(p.z(), 0, 0.012) << p.transpose();
    EXPECT_GT(mesh.normals[v].z(), 0.95f);
  }
}

TEST(Reconstructor, FindsASphereCap) {
  const SurfaceMesh mesh = reconstructed(heightCloud(cap, 40, 0));
  for (const auto& p : mesh.vertices)
    if (p.head<2>().lpNorm<Eigen::Infinity>() < 0.9f) {
      EXPECT_NEAR((p - Eigen::Vector3f(0, 0, -2)).norm(), 2.f, 0.01) << p.transpose();
    }
}

TEST(Reconstructor, WindsTrianglesCounterClockwiseSeenFromTheCameras) {
  for (float side : {1.f, -1.f}) {
    SparseCloud cloud = heightCloud(cap, 30, 0.002f);
    for (auto& p : cloud.points) {
      p.position.z() *= side;
      p.view_direction.z() *= side;
    }
    const SurfaceMesh mesh = reconstructed(cloud);
    for (const auto& t : mesh.triangles) {
      const Eigen::Vector3f n = (mesh.vertices[t[1]] - mesh.vertices[t[0]])
                                    .cross(mesh.vertices[t[2]] - mesh.vertices[t[0]]);
      ASSERT_GE(n.z() * side, 0.f);
    }
  }
}

TEST(Reconstructor, IsNotMisledByOutliers) {
  SparseCloud cloud = heightCloud(flat, 40, 0.005f);
  for (std::size_t i = 7; i < cloud.points.size(); i += 20)
    cloud.points[i].position.z() =
        (i % 40 == 7 ? 0.3f : -0.5f) + 0.01f * static_cast<float>(i % 13);
  for (const auto& p : reconstructed(cloud).vertices)
    if (p.head<2>().lpNorm<Eigen::Infinity>() < 0.9f) {
      EXPECT_NEAR(p.z(), 0, 0.03) << p.transpose();
    }
}

TEST(Reconstructor, LeavesHolesWhereNothingWasSeen) {
  SparseCloud cloud = heightCloud(flat, 50, 0.002f);
  std::erase_if(cloud.points,
                [](const SparsePoint& p) { return p.position.head<2>().norm() < 0.5f; });
  const SurfaceMesh mesh = reconstructed(cloud);
  EXPECT_GT(area(mesh), 2.5);
  for (const auto& p : mesh.vertices) EXPECT_GT(p.head<2>().norm(), 0.25f) << p.transpose();
}

TEST(Reconstructor, HasNoPreferredUnitOfLength) {
  const SparseCloud cloud = heightCloud(cap, 30, 0.005f);
  SparseCloud small = cloud;
  for (auto& p : small.points) p.position *= 1.f / 1024;  // a power of two: no rounding of its own
  const SurfaceMesh a = reconstructed(cloud), b = reconstructed(small);
  EXPECT_NEAR(area(b) * 1024 * 1024, area(a), 0.02 * area(a));
}

TEST(Reconstructor, GivesTheSameBitsTwice) {
  const SparseCloud cloud = heightCloud(cap, 40, 0.01f);
  Reconstructor reconstructor({}, sparseSettings());
  SurfaceMesh first, second;
  ASSERT_EQ(reconstructor.reconstruct(cloud, first), ReconStatus::Ok);
  // Something else in between, so that nothing left over can help.
  ASSERT_EQ(reconstructor.reconstruct(heightCloud(flat, 20, 0.1f, 3), second), ReconStatus::Ok);
  ASSERT_EQ(reconstructor.reconstruct(cloud, second), ReconStatus::Ok);
  EXPECT_TRUE(sameBits(first.vertices, second.vertices));
  EXPECT_TRUE(sameBits(first.normals, second.normals));
  EXPECT_TRUE(sameBits(first.confidence, second.confidence));
  EXPECT_TRUE(sameBits(first.triangles, second.triangles));
  EXPECT_EQ(second.version, first.version + 2);
}

TEST(Reconstructor, GivesTheSameBitsOnAnyNumberOfThreads) {
  const SparseCloud cloud = heightCloud(cap, 60, 0.01f);
  ReconSettings settings = sparseSettings();
  settings.threads = 1;
  const SurfaceMesh alone = reconstructed(cloud, settings);
  for (int threads : {2, 3, 16}) {
    settings.threads = threads;
    const SurfaceMesh shared = reconstructed(cloud, settings);
    EXPECT_TRUE(sameBits(alone.vertices, shared.vertices)) << threads;
    EXPECT_TRUE(sameBits(alone.normals, shared.normals)) << threads;
    EXPECT_TRUE(sameBits(alone.confidence, shared.confidence)) << threads;
    EXPECT_TRUE(sameBits(alone.triangles, shared.triangles)) << threads;
  }
}

TEST(Reconstructor, LeavesTheMeshAloneWhenThereAreTooFewPoints) {
  SurfaceMesh mesh = reconstructed(heightCloud(flat, 20, 0.01f));
  const auto before = mesh.vertices;
  Reconstructor reconstructor({}, sparseSettings());
  EXPECT_EQ(reconstructor.reconstruct(heightCloud(flat, 8, 0.01f), mesh),
            ReconStatus::TooFewPoints);
  EXPECT_EQ(reconstructor.reconstruct({}, mesh), ReconStatus::TooFewPoints);
  EXPECT_TRUE(sameBits(mesh.vertices, before));
}

TEST(Reconstructor, GoesByMapPointsUntilPicturesConfirmOneAnother) {
  CameraModel camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = camera.fy = 500;
  camera.cx = 320;
  camera.cy = 240;
  ReconSettings settings = sparseSettings();
  settings.method = ReconSettings::Method::Dense;
  const SparseCloud cloud = heightCloud(flat, 40, 0.01f);
  SurfaceMesh mesh;
  ASSERT_EQ(Reconstructor(camera, settings).reconstruct(cloud, mesh), ReconStatus::Ok);
  EXPECT_TRUE(sameBits(mesh.vertices, reconstructed(cloud).vertices));
}

TEST(Reconstructor, CountsOnlyFinitePoints) {
  SparseCloud cloud = heightCloud(flat, 20, 0.01f);
  for (auto& p : cloud.points) p.position.x() = std::numeric_limits<float>::quiet_NaN();
  SurfaceMesh mesh;
  EXPECT_EQ(Reconstructor({}, sparseSettings()).reconstruct(cloud, mesh),
            ReconStatus::TooFewPoints);
}

TEST(Reconstructor, SurvivesPointsThatAllCoincide) {
  SparseCloud cloud = heightCloud(flat, 20, 0);
  for (auto& p : cloud.points) p.position = {1, 2, 3};
  SurfaceMesh mesh;
  EXPECT_EQ(Reconstructor({}, sparseSettings()).reconstruct(cloud, mesh),
            ReconStatus::TooFewPoints);
}

TEST(Reconstructor, SurvivesAPointImmenselyFarAway) {
  SparseCloud cloud = heightCloud(flat, 30, 0.01f);
  cloud.points[5].position = {1e30f, -1e30f, 1e30f};
  for (const auto& p : reconstructed(cloud).vertices) ASSERT_LT(p.norm(), 3.f);
}

TEST(Reconstructor, SaysByHowMuchTheSurfaceMoved) {
  SparseCloud cloud = heightCloud(flat, 20, 0.01f);
  for (std::uint32_t p = 0; p < cloud.points.size(); ++p) cloud.sightings.push_back({p, 0});
  cloud.view_frames = {0};
  cloud.keyframes = 1;
  cloud.views_T_camera_world.resize(1);
  cloud.views_T_camera_world[0].R = Eigen::Vector3d(1, -1, -1).asDiagonal();
  cloud.views_T_camera_world[0].t = {0, 0, 4};  // looks down from z = 4
  Reconstructor reconstructor({}, sparseSettings());
  SurfaceMesh mesh;
  ASSERT_EQ(reconstructor.reconstruct(cloud, mesh), ReconStatus::Ok);
  EXPECT_EQ(reconstructor.lastChange().largest, 0);  // the first
  ASSERT_EQ(reconstructor.reconstruct(cloud, mesh), ReconStatus::Ok);
  EXPECT_EQ(reconstructor.lastChange().largest, 0);
  for (SparsePoint& p : cloud.points) p.position.z() += 0.2f;  // 5 % of the distance
  ASSERT_EQ(reconstructor.reconstruct(cloud, mesh), ReconStatus::Ok);
  EXPECT_NEAR(reconstructor.lastChange().largest, 0.05f, 0.01f);
  EXPECT_GT(reconstructor.lastChange().share_beyond, 0.9f);
  ++cloud.map_id;
  ASSERT_EQ(reconstructor.reconstruct(cloud, mesh), ReconStatus::Ok);
  EXPECT_EQ(reconstructor.lastChange().largest, 0);  // of another map
}

TEST(Reconstructor, StopsWhenAsked) {
  std::stop_source source;
  source.request_stop();
  SurfaceMesh mesh;
  EXPECT_EQ(Reconstructor({}, sparseSettings())
                .reconstruct(heightCloud(flat, 40, 0.01f), mesh, source.get_token()),
            ReconStatus::Cancelled);
  EXPECT_TRUE(mesh.empty());
}

TEST(Reconstructor, StaysWithinTheTriangleLimit) {
  const SparseCloud cloud = heightCloud(cap, 40, 0.002f);
  ReconSettings settings = sparseSettings();
  const std::size_t free = reconstructed(cloud, settings).triangles.size();
  settings.max_triangles = static_cast<int>(free / 2);
  const std::size_t limited = reconstructed(cloud, settings).triangles.size();
  EXPECT_LE(limited, free / 2);
  EXPECT_GT(limited, 0u);
}

TEST(Reconstructor, NamesTheSettingThatIsOutOfRange) {
  ReconSettings settings = sparseSettings();
  settings.mls_radius = -1;
  try {
    Reconstructor reconstructor({}, settings);
    FAIL() << "accepted";
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("recon.mls_radius"));
  }
}

}  // namespace
}  // namespace depthscope::recon
