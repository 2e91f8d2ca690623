#include "recon/surface_painter.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "recon/mesh_geometry.hpp"
#include "tests/types/grid_mesh.hpp"

namespace depthscope::recon {
namespace {

constexpr std::uint8_t kWall = 90;

/// Cameras that look along z at a plane 4 away, 4 x 3 in size, painted by `color`.
class Scene {
 public:
  explicit Scene(CameraModel camera = pinhole()) : camera_(camera), painter_(camera, 8) {
    mesh =
        gridMesh(40, [](float u, float v) { return Eigen::Vector3f(4 * u - 2, 3 * v - 1.5f, 4); });
    computeNormals(mesh);
    for (std::size_t i = 0; i < mesh.vertices.size(); i += 7)
      cloud.points.push_back({mesh.vertices[i], -Eigen::Vector3f::UnitZ(), 3, 0});
  }

  static CameraModel pinhole() {
    CameraModel c;
    c.width = 640;
    c.height = 480;
    c.fx = c.fy = 500;
    c.cx = 319.5;
    c.cy = 239.5;
    return c;
  }
  /// A keyframe at `centre`; `color(x, y)` of the plane's points.
  template <class Color>
  void look(const Eigen::Vector3d& centre, Color&& color) {
    const ColorReduction size(camera_.width, camera_.height);
    ViewPicture picture;
    picture.frame = static_cast<std::int64_t>(cloud.view_frames.size());
    picture.color.reset(size.width, size.height);
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x) {
        const Eigen::Vector2d pixel = (Eigen::Vector2d(x, y).array() + 0.5) * size.factor - 0.5;
        const Eigen::Vector3d p =
            centre + (4 - centre.z()) * camera_.unproject(pixel).homogeneous();
        picture.color.at(x, y) = color(p.x(), p.y());
      }
    const auto k = static_cast<std::uint32_t>(picture.frame);
    Pose T_camera_world;
    T_camera_world.t = -centre;
    cloud.views_T_camera_world.push_back(T_camera_world);
    cloud.view_frames.push_back(picture.frame);
    ++cloud.keyframes;
    for (std::uint32_t p = 0; p < cloud.points.size(); ++p) {
      const Eigen::Vector3d seen = cloud.points[p].position.cast<double>() - centre;
      const Eigen::Vector2d pixel = camera_.project(seen);
      if (pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() < camera_.width &&
          pixel.y() < camera_.height)
        cloud.sightings.push_back({p, k});
    }
    painter_.addPicture(picture);
  }
  void paint() {
    std::sort(cloud.sightings.begin(), cloud.sightings.end(), [](auto a, auto b) {
      return std::pair(a.point, a.view) < std::pair(b.point, b.view);
    });
    painter_.paint(CloudIndex(cloud, cloud.sightings), mesh);
  }
  /// The colour of the vertex nearest to a place of the plane.
  Rgb at(float x, float y) const {
    const auto distance = [&](const Eigen::Vector3f& v) {
      return (v - Eigen::Vector3f(x, y, 4)).norm();
    };
    std::size_t best = 0;
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
      if (distance(mesh.vertices[v]) < distance(mesh.vertices[best])) best = v;
    return mesh.colors[best];
  }

  SurfaceMesh mesh;
  SparseCloud cloud;

 private:
  CameraModel camera_;
  SurfacePainter painter_;
};

Rgb halves(double x, double) {
  return x < 0 ? Rgb{200, 40, 30} : Rgb{40, 180, 60};
}

TEST(SurfacePainter, GivesEachPlaceTheColourItHasInThePicture) {
  Scene scene;
  scene.look({0, 0, 0}, halves);
  scene.look({0.5, 0.2, 0.5}, halves);
  scene.paint();
  ASSERT_EQ(scene.mesh.colors.size(), scene.mesh.vertices.size());
  for (float x : {-1.5f, -0.3f, 0.3f, 1.5f}) EXPECT_EQ(scene.at(x, 0.5f), halves(x, 0)) << x;
}

TEST(SurfacePainter, FollowsTheLens) {
  CameraModel camera = Scene::pinhole();
  camera.k = {-0.3, 0.05, 0, 0, 0};
  Scene scene(camera);
  const auto rings = [](double x, double y) {
    return std::hypot(x, y) < 1.75 ? Rgb{200, 40, 30} : Rgb{40, 180, 60};
  };
  scene.look({0, 0, 0}, rings);
  scene.paint();
  // Without the lens the first would have the colour of 1.81.
  EXPECT_EQ(scene.at(1.7f, 0), rings(1.7, 0));
  EXPECT_EQ(scene.at(1.8f, 0), rings(1.8, 0));
}

TEST(SurfacePainter, TheKeyframeThatSeesAPlaceFromNearCountsMost) {
  Scene scene;
  scene.look({0, 0, -4}, [](double, double) { return Rgb{40, 40, 40}; });
  scene.look({0, 0, 2}, [](double, double) { return Rgb{200, 200, 200}; });
  scene.paint();
  EXPECT_GT(scene.at(0, 0)[0], 195);
  EXPECT_EQ(scene.at(1.9f, 0)[0], 40) << "seen from afar only";
}

TEST(SurfacePainter, WhatWasSeenOnlyLongAgoHasColour) {
  Scene scene;
  scene.look({-3, 0, 0}, halves);
  for (int i = 0; i < 5; ++i) scene.look({2.5 + 0.1 * i, 0, 0}, halves);
  scene.paint();
  EXPECT_EQ(scene.at(-1.9f, 0), halves(-1, 0));
}

TEST(SurfacePainter, HighlightsAndDarkSurroundingsDoNotCount) {
  Scene scene;
  scene.look({0, 0, 2}, [](double x, double y) {  // nearer, so that it would win
    if (std::hypot(x - 0.5, y) < 0.15) return Rgb{255, 255, 255};
    return std::hypot(x, y) > 0.9 ? Rgb{0, 0, 0} : Rgb{kWall, 30, 30};
  });
  scene.look({0, 0, 0}, [](double, double) { return Rgb{kWall, 30, 30}; });
  scene.paint();
  EXPECT_NEAR(scene.at(0.5f, 0)[2], 30, 1);
  EXPECT_NEAR(scene.at(1, 0.3f)[0], kWall, 1);
}

TEST(SurfacePainter, WhatLiesBehindIsNotPaintedByWhatHidesIt) {
  Scene scene;
  // A small plate in front, in the middle of the first view; the second sees past it.
  append(scene.mesh, gridMesh(8, [](float u, float v) {
           return Eigen::Vector3f(0.4f * u - 0.2f, 0.4f * v - 0.2f, 2);
         }));
  computeNormals(scene.mesh);
  scene.look({0, 0, 0}, [](double x, double y) {
    return std::max(std::abs(x), std::abs(y)) < 0.4 ? Rgb{220, 0, 0} : Rgb{kWall, 30, 30};
  });
  scene.look({2, 0, 0}, [](double, double) { return Rgb{kWall, 30, 30}; });
  scene.paint();
  EXPECT_NEAR(scene.at(0, 0)[0], kWall, 1);
}

TEST(SurfacePainter, GapsTakeTheColourAroundThem) {
  Scene scene;
  scene.look({0, 0, 2}, [](double, double) { return Rgb{kWall, 30, 30}; });
  scene.paint();
  // The view ends at x = 1.28.
  EXPECT_EQ(scene.at(1.5f, 0)[0], kWall);
}

TEST(SurfacePainter, WithoutPicturesThereAreNoColours) {
  Scene scene;
  scene.mesh.colors.assign(3, {});
  scene.paint();
  EXPECT_TRUE(scene.mesh.colors.empty());
  SurfacePainter(CameraModel(), 4)
      .paint(CloudIndex(scene.cloud, scene.cloud.sightings), scene.mesh);
  EXPECT_TRUE(scene.mesh.colors.empty());
}

}  // namespace
}  // namespace depthscope::recon
