#include "recon/point_filters.hpp"

#include <gmock/gmock.h>

#include <limits>

#include "synthetic_cloud.hpp"

namespace depthscope::recon {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

SupportCloud::Ptr lattice(int side) {
  auto cloud = std::make_shared<SupportCloud>();
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) {
      pcl::PointNormal p;
      p.x = static_cast<float>(i);
      p.y = static_cast<float>(j);
      p.z = 0;
      p.normal_z = 1;
      cloud->push_back(p);
    }
  return cloud;
}

TEST(UsablePoints, LeavesOutWhatTheTrackerDoubts) {
  SparseCloud cloud = heightCloud(flat, 3, 0);
  cloud.points[0].observations = 1;
  cloud.points[1].reprojection_error_px = 50;
  EXPECT_EQ(usablePoints(cloud, {})->size(), 7u);
}

TEST(UsablePoints, RejectsPointsThatAreNotFinite) {
  SparseCloud cloud = heightCloud(flat, 3, 0);
  cloud.points[0].position.y() = kNaN;
  cloud.points[1].view_direction.x() = std::numeric_limits<float>::infinity();
  cloud.points[2].reprojection_error_px = kNaN;
  cloud.points[3].view_direction.setZero();
  EXPECT_EQ(usablePoints(cloud, {})->size(), 5u);
}

TEST(UsablePoints, LeavesOutWhatIsImmenselyFarAway) {
  SparseCloud cloud = heightCloud(flat, 5, 0);
  cloud.points[3].position.z() = -200;
  EXPECT_EQ(usablePoints(cloud, {})->size(), 24u);
}

TEST(UsablePoints, KeepsTheMostObservedWhenThereAreTooMany) {
  SparseCloud cloud = heightCloud(flat, 3, 0);
  for (std::size_t i : {1u, 4u, 8u}) cloud.points[i].observations = 20;
  ReconSettings settings;
  settings.max_points = 3;
  const auto kept = usablePoints(cloud, settings);
  ASSERT_EQ(kept->size(), 3u);
  EXPECT_EQ((*kept)[0].getVector3fMap(), cloud.points[1].position);
  EXPECT_EQ((*kept)[1].getVector3fMap(), cloud.points[4].position);
  EXPECT_EQ((*kept)[2].getVector3fMap(), cloud.points[8].position);
}

TEST(NeighbourDistances, MeasureALattice) {
  const auto distances = neighbourDistances(lattice(5), 4, 2);
  EXPECT_FLOAT_EQ(distances[12], 1.f);  // inside: four neighbours at 1
  EXPECT_FLOAT_EQ(distances[0], 2.f);   // corner: 1, 1, sqrt 2, 2
}

TEST(NeighbourDistances, UseTheFarthestWhereThereAreTooFew) {
  EXPECT_FLOAT_EQ(neighbourDistances(lattice(2), 6, 2)[0], std::sqrt(2.f));
}

TEST(Median, IsRobustToOneWildValue) {
  EXPECT_FLOAT_EQ(median({1, 2, 1e9f}), 2.f);
  EXPECT_FLOAT_EQ(median({}), 0.f);
}

TEST(FreeSpaceFilter, DropsWhatFloatsInFrontOfTheTissue) {
  SparseCloud cloud = heightCloud(flat, 30, 0);
  const float spacing = 0.1f;
  for (int i = 0; i < 20; ++i) {  // a cluster, so that the radius filter would not notice
    SparsePoint p = cloud.points[static_cast<std::size_t>(400 + i)];
    p.position.z() = 1;
    cloud.points.push_back(p);
  }
  const auto kept = freeSpaceFilter(usablePoints(cloud, {}), spacing, {});
  int tissue = 0, floating = 0;
  for (const auto& p : *kept) ++(p.z == 0 ? tissue : floating);
  EXPECT_EQ(tissue, 900);
  EXPECT_LE(floating, 4);  // at the ends of the cluster fewer rays pass
}

TEST(FreeSpaceFilter, KeepsANearTissueBesideAFarOne) {
  SparseCloud cloud = heightCloud([](float x, float) { return x < 0 ? 1.f : 0.f; }, 30, 0);
  // What lies behind the step as seen by the camera was never observed.
  std::erase_if(cloud.points,
                [](const SparsePoint& p) { return p.position.z() == 0 && p.position.x() < 0.1f; });
  const auto usable = usablePoints(cloud, {});
  EXPECT_EQ(freeSpaceFilter(usable, 0.1f, {})->size(), usable->size());
}

TEST(FreeSpaceFilter, WorksWithFewerRaysThanPoints) {
  SparseCloud cloud = heightCloud(flat, 30, 0);
  SparsePoint floating = cloud.points[435];
  floating.position.z() = 1;
  cloud.points.push_back(floating);
  ReconSettings settings;
  settings.free_space_max_rays = 200;
  EXPECT_EQ(freeSpaceFilter(usablePoints(cloud, settings), 0.1f, settings)->size(), 900u);
}

TEST(RadiusFilter, DropsAPointAloneAndKeepsTheOthers) {
  auto cloud = lattice(6);
  pcl::PointNormal lone;
  lone.x = lone.y = 3;
  lone.z = 20;
  cloud->push_back(lone);
  const auto kept = radiusFilter(cloud, 1.f, {});
  EXPECT_EQ(kept->size(), 36u);
  for (const auto& p : *kept) EXPECT_EQ(p.z, 0.f);
}

TEST(RadiusFilter, KeepsNothingOfFewerPointsThanNeighboursWanted) {
  ReconSettings settings;
  settings.outlier_min_neighbours = 9;
  EXPECT_TRUE(radiusFilter(lattice(3), 100.f, settings)->empty());
}

TEST(VoxelGrid, PutsOneMeanPointInPlaceOfACluster) {
  auto cloud = std::make_shared<SupportCloud>();
  for (float x : {0.1f, 0.2f, 0.3f}) {
    pcl::PointNormal p;
    p.x = x;
    p.y = p.z = 0.1f;
    p.normal_z = 1;
    p.curvature = 10 * x;
    cloud->push_back(p);
  }
  ReconSettings settings;
  settings.voxel_size = 1;
  const auto even = voxelGrid(cloud, 1.f, settings);
  ASSERT_EQ(even->size(), 1u);
  EXPECT_NEAR(even->front().x, 0.2f, 1e-6);
  EXPECT_NEAR(even->front().normal_z, 1.f, 1e-6);
  EXPECT_NEAR(even->front().curvature, 2.f, 1e-6);
}

}  // namespace
}  // namespace depthscope::recon
