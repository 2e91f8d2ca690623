#include <gmock/gmock.h>

#include <cmath>

#include "tests/overlay/overlay_scene.hpp"

namespace depthscope::overlay {
namespace {

using Eigen::Vector3d;

/// Small squares around given points of the camera frame, facing the camera.
SurfaceMesh patches(const std::vector<Vector3d>& centres, float half_size) {
  SurfaceMesh mesh;
  for (const Vector3d& c : centres) {
    const Eigen::Vector3f p = c.cast<float>();
    append(mesh, wall(p.x() - half_size, p.x() + half_size, p.y() - half_size, p.y() + half_size,
                      p.z(), p.z(), 1));
  }
  return mesh;
}

/// Every patch must be drawn with its centre within half a pixel of where the camera model puts it.
void expectPatchesWhereTheLensPutsThem(const CameraModel& camera) {
  std::vector<Vector3d> centres;
  for (double y = 45; y < camera.height - 10; y += 32)
    for (double x = 14; x < camera.width - 10; x += 32) {
      const Eigen::Vector2d n = camera.unproject({x, y});
      const double z = 60 + 0.1 * x;
      centres.push_back({n.x() * z, n.y() * z, z});
    }
  // These would land in the picture if nothing guarded against them.
  centres.push_back({0.05, 0.05, -60});
  centres.push_back({-260, 5, 60});
  Compositor compositor(camera, plainSettings());
  compositor.setSurface(patches(centres, 1.4f));
  const Image layer = layerOf(compositor, tracking(), camera.width, camera.height);
  int drawn = 0;
  for (std::size_t i = 0; i + 2 < centres.size(); ++i) {
    const Eigen::Vector2d expected = camera.project(centres[i]);
    Eigen::Vector2d sum(0, 0);
    int n = 0;
    const int ex = static_cast<int>(expected.x()), ey = static_cast<int>(expected.y());
    for (int y = std::max(ey - 10, 0); y <= std::min(ey + 10, camera.height - 1); ++y)
      for (int x = std::max(ex - 10, 0); x <= std::min(ex + 10, camera.width - 1); ++x)
        if (layer.at(x, y)[3] > 0) sum += Eigen::Vector2d(x, y), ++n;
    ASSERT_GT(n, 7) << "patch " << i << " at " << expected.transpose();
    EXPECT_LT((sum / n - expected).norm(), 0.5) << "patch " << i << " at " << expected.transpose();
    drawn += n;
  }
  EXPECT_EQ(layer.covered(0, kBelowMark, camera.width, camera.height), drawn)
      << "something else was drawn";
}

TEST(CompositorSurface, LandsWhereThePinholeCameraSeesIt) {
  expectPatchesWhereTheLensPutsThem(testCamera());
}

TEST(CompositorSurface, IsBentLikeABarrelLens) {
  CameraModel c = testCamera();
  c.fx = c.fy = 205;
  c.k = {-0.28, 0.07, 0.0006, -0.0004, 0};
  expectPatchesWhereTheLensPutsThem(c);
}

TEST(CompositorSurface, IsBentLikeAFisheyeLens) {
  CameraModel c = testCamera();
  c.kind = CameraModel::Kind::Fisheye;
  c.fx = c.fy = 190;
  c.k = {-0.03, 0.005, 0, 0, 0};
  expectPatchesWhereTheLensPutsThem(c);
}

TEST(CompositorSurface, BendsTheEdgesOfLargeTriangles) {
  CameraModel c = testCamera();
  c.fx = c.fy = 205;
  c.k = {-0.28, 0.07, 0, 0, 0};
  Compositor compositor(c, plainSettings());
  compositor.setSurface(
      wall(-30, 30, 20, 30, 60, 60, 1));  // two triangles; their upper edge is bent
  const Image layer = layerOf(compositor, tracking());
  for (int x = 70; x < 250; x += 12) {
    int y = kBelowMark;
    while (y < 239 && layer.at(x, y)[3] == 0) ++y;
    double px = 0, best = 1e9, edge = 0;
    for (double u = -30; u <= 30; u += 0.01) {
      const Eigen::Vector2d p = c.project({u, 20, 60});
      if (std::abs(p.x() - x) < best) best = std::abs(p.x() - x), px = p.x(), edge = p.y();
    }
    EXPECT_NEAR(y, edge + 0.5, 1.0) << "column " << px;
  }
}

TEST(CompositorSurface, NearIsBrighterThanFarEverywhere) {
  Compositor compositor(testCamera(), plainSettings());
  compositor.setSurface(wall(-40, 60, -30, 30, 40, 90, 40));
  const Image out = compositeOf(compositor, Image(320, 240, 110), tracking());
  // Means over columns, so that contour lines do not matter.
  double before = 1e9;
  for (int x = 10; x + 20 <= 230; x += 20) {
    double sum = 0;
    for (int y = 60; y < 180; ++y)
      for (int dx = 0; dx < 20; ++dx) sum += out.luminance(x + dx, y);
    EXPECT_LT(sum, before + 20 * 120 * 0.5) << x;
    before = sum;
  }
  EXPECT_GT(out.luminance(12, 120), out.luminance(228, 120) + 40);
}

TEST(CompositorSurface, WhatIsNearerHidesWhatIsBehind) {
  for (bool near_first : {true, false}) {
    const SurfaceMesh near_wall = wall(-5, 5, -5, 5, 45, 45),
                      far_wall = wall(-40, 40, -30, 30, 90, 90);
    SurfaceMesh mesh = near_first ? near_wall : far_wall;
    append(mesh, near_first ? far_wall : near_wall);
    Compositor compositor(testCamera(), plainSettings());
    compositor.setSurface(mesh);
    const Image layer = layerOf(compositor, tracking());
    EXPECT_GT(layer.luminance(160, 120), layer.luminance(60, 120) + 30) << near_first;
  }
}

TEST(CompositorSurface, ContourLinesLieAtEqualStepsOfDepth) {
  OverlaySettings settings = plainSettings();
  Compositor compositor(testCamera(), settings);
  compositor.setSurface(wall(-40, 60, -30, 30, 40, 90, 40));
  const Image layer = layerOf(compositor, tracking());
  // Alpha is higher on a line. Depth along the middle row from the wall's plane: z = 40 + (X + 40)
  // / 2, X = x z / f.
  std::vector<double> depths;
  for (int x = 20; x < 220; ++x) {
    const int a = layer.at(x, 120)[3];
    if (a > layer.at(x - 1, 120)[3] && a >= layer.at(x + 1, 120)[3] && a > 140) {
      const double n = (x - 159.5) / 260;
      depths.push_back(60 / (1 - n / 2));
    }
  }
  ASSERT_GE(depths.size(), 3u);
  const double step = depths[1] - depths[0];
  for (std::size_t i = 1; i < depths.size(); ++i)
    EXPECT_NEAR(depths[i] - depths[i - 1], step, 0.35);
}

TEST(CompositorSurface, TheMeshShowsWiresOnALightFill) {
  OverlaySettings settings = plainSettings();
  settings.cue = CueMode::Mesh;
  Compositor compositor(testCamera(), settings);
  compositor.setSurface(wall(-30, 30, -25, 25, 50, 52, 8));
  const Image layer = layerOf(compositor, tracking());
  int least = 255, most = 0;
  for (int x = 60; x < 260; ++x) {
    least = std::min<int>(least, layer.at(x, 125)[3]);
    most = std::max<int>(most, layer.at(x, 125)[3]);
  }
  EXPECT_GT(least, 20);
  EXPECT_GT(most, 2 * least);
}

TEST(CompositorSurface, IsNotDrawnWhereNothingWasObserved) {
  Compositor compositor(testCamera(), plainSettings());
  SurfaceMesh mesh = wall(-30, 30, -25, 25, 50, 52, 8);
  mesh.confidence.assign(mesh.vertices.size(), 0.0f);
  compositor.setSurface(mesh);
  EXPECT_EQ(layerOf(compositor, tracking()).covered(0, kBelowMark, 320, 240), 0);
}

TEST(CompositorSurface, OneOfAnotherMapIsNotDrawn) {
  Compositor compositor(testCamera(), plainSettings());
  SurfaceMesh mesh = wall(-30, 30, -25, 25, 50, 52, 8);
  mesh.map_id = 3;
  compositor.setSurface(mesh);
  OverlayState state = tracking();
  EXPECT_EQ(layerOf(compositor, state).covered(0, kBelowMark, 320, 240), 0);
  state.map_id = 3;
  EXPECT_GT(layerOf(compositor, state).covered(0, kBelowMark, 320, 240), 10000);
  mesh.map_id = 4;  // the one before goes on as long as the pose is of its map
  compositor.setSurface(mesh);
  EXPECT_GT(layerOf(compositor, state).covered(0, kBelowMark, 320, 240), 10000);
}

TEST(CompositorSurface, ANewOneReplacesTheOldInACrossFade) {
  OverlaySettings settings = plainSettings();
  settings.crossfade_s = 0.4f;
  settings.opacity = 1;
  Compositor compositor(testCamera(), settings);
  OverlayState state = tracking();
  const auto alphaAt = [&](double time, int x) {
    state.time_s = time;
    return static_cast<int>(layerOf(compositor, state).at(x, 120)[3]);
  };
  compositor.setSurface(wall(-30, -1, -25, 25, 50, 52, 8));
  EXPECT_EQ(alphaAt(10.0, 80), 0);
  EXPECT_NEAR(alphaAt(10.2, 80), 127, 2);
  EXPECT_EQ(alphaAt(10.4, 80), 255);
  compositor.setSurface(wall(1, 30, -25, 25, 50, 52, 21));  // of another number of vertices
  EXPECT_EQ(alphaAt(12.0, 80), 255);
  EXPECT_EQ(alphaAt(12.0, 240), 0);
  EXPECT_NEAR(alphaAt(12.1, 80), 191, 2);
  EXPECT_NEAR(alphaAt(12.1, 240), 64, 2);
  EXPECT_EQ(alphaAt(12.4, 80), 0);
  EXPECT_EQ(alphaAt(12.4, 240), 255);
  compositor.setSurface(wall(-30, -1, -25, 25, 50, 52, 8));
  EXPECT_EQ(alphaAt(-1, 80), 255) << "without a time the new one is there at once";
}

TEST(CompositorSurface, IsDrawnWithinTheViewOfTheScopeOnly) {
  for (CueMode cue : {CueMode::Chromadepth, CueMode::Mesh}) {
    OverlaySettings settings = plainSettings();
    settings.cue = cue;
    Compositor compositor(testCamera(), settings);
    compositor.setSurface(wall(-60, 60, -50, 50, 50, 52, 8));
    const int whole = layerOf(compositor, tracking()).covered(0, kBelowMark, 320, 240);
    EXPECT_EQ(whole, 320 * (240 - kBelowMark));
    // A round view of radius 90 around (170, 130).
    ViewOutline view;
    const auto halfWidth = [](double y) {
      const double d = 90.0 * 90.0 - (y - 130) * (y - 130);
      return d > 0 ? std::sqrt(d) : 0.0;
    };
    for (int b = 0; b < ViewOutline::bands; ++b) {
      const double half = halfWidth((b + 0.5) * 240 / ViewOutline::bands - 0.5);
      view.spans[static_cast<std::size_t>(b)] = {static_cast<float>(170 - half),
                                                 static_cast<float>(170 + half)};
    }
    compositor.setView(view);
    const Image layer = layerOf(compositor, tracking());
    for (int y = kBelowMark; y < 240; ++y)
      for (int x = 0; x < 320; ++x) {
        const double r = std::hypot(x - 170, y - 130);
        if (r > 91) {
          ASSERT_EQ(layer.at(x, y)[3], 0) << x << " " << y;
        }
        if (r < 82) {
          ASSERT_GT(layer.at(x, y)[3], 10) << x << " " << y;
        }
      }
    compositor.setView({});
    EXPECT_EQ(layerOf(compositor, tracking()).covered(0, kBelowMark, 320, 240), whole);
  }
}

}  // namespace
}  // namespace depthscope::overlay
