#include "slam/scope_path.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <cmath>
#include <numbers>

#include "slam/global_bundle.hpp"
#include "slam/pose_optimizer.hpp"
#include "tests/slam/synthetic_map.hpp"

namespace depthscope::slam {
namespace {

using namespace testing;

constexpr double kBreath_hz = 0.25;
constexpr double kDuration_s = 14;
constexpr int kViews = 56;
constexpr double kNoise_px = 0.3;

/// A scope that sweeps from side to side, half a keyframe's interval between two frames.
Pose scopeAt(double t) {
  const double turn = 2 * std::numbers::pi * t;
  return cameraAt(
      {1.5 * std::sin(0.11 * turn), 0.4 * std::sin(0.17 * turn), 0.3 * std::cos(0.07 * turn)},
      {0.05 * std::sin(0.13 * turn), 0.1 * std::sin(0.11 * turn), 0.02 * std::cos(0.05 * turn)});
}

/// The map that a scope makes of a world which breathes, taking it to be still.
class ScopePathTest : public ::testing::Test {
 protected:
  ScopePathTest() {
    settings_.capacity.keyframes = kViews + 4;
    settings_.capacity.observations_per_point = kViews;
  }

  World at(double t, double strength) const {
    World world = world_;
    Eigen::Matrix3d shape;
    shape << 1, 0.3, -0.2, 0.3, -0.4, 0.5, -0.2, 0.5, -0.6;
    const double phase = 2 * std::numbers::pi * kBreath_hz * t + 0.7;
    for (auto& p : world.points)
      p += strength * std::sin(phase) * shape * (p - Eigen::Vector3d(0, 0, 6));
    return world;
  }

  /// Path as tracked, and as scopePath() gives it.
  struct Paths {
    std::vector<StampedPose> tracked, scope;
    double tissue_rhythm_hz;
  };
  Paths run(double strength, double duration_s = kDuration_s) {
    Map map(settings_, testCameraModel());
    map.start();
    Trajectory trajectory(2 * kViews);
    std::vector<KeyframeId> keyframes;
    std::vector<std::vector<std::pair<KeyframeId, int>>> seen(world_.points.size());
    const auto timeOf = [&](int half) { return duration_s * half / (2 * kViews); };
    for (int i = 0; i < kViews; ++i) {
      const double t = timeOf(2 * i);
      std::vector<int> ids;
      const FeatureSet f = at(t, strength).view(scopeAt(t), ids, kNoise_px);
      keyframes.push_back(map.addKeyframe(f, scopeAt(t), 2 * i, t));
      for (std::size_t k = 0; k < ids.size(); ++k)
        seen[ids[k]].push_back({keyframes.back(), static_cast<int>(k)});
    }
    std::vector<PointId> point_of(world_.points.size(), kNone);
    for (std::size_t i = 0; i < seen.size(); ++i) {
      if (seen[i].size() < 2) continue;
      point_of[i] = map.addPoint(world_.points[i], 0);
      for (const auto& [keyframe, feature] : seen[i]) map.observe(point_of[i], keyframe, feature);
      map.refreshPoint(point_of[i]);
      map.point(point_of[i]).residual = 1;
    }
    BundleAdjuster adjuster(kViews + 4, 2000, 20000);
    GlobalBundle(settings_, map, adjuster).adjust(map.activeId(), 30, nullptr);
    for (int half = 0; half < 2 * kViews; ++half) {
      const KeyframeId reference = keyframes[half / 2];
      AnchoredPose pose;
      pose.frame = half;
      pose.timestamp_s = timeOf(half);
      pose.anchor(map, reference,
                  track(map, point_of, pose.timestamp_s, strength) *
                      map.keyframe(reference).T_camera_world.inverse());
      trajectory.add(pose);
    }
    const ScopePath path = scopePath(map, map.activeId(), trajectory);
    return {trajectory.corrected(map, map.activeId()), path.poses, path.tissue_rhythm_hz};
  }

  /// Against the map, still as it is.
  Pose track(const Map& map, const std::vector<PointId>& point_of, double t,
             double strength) const {
    std::vector<int> ids;
    const FeatureSet f = at(t, strength).view(scopeAt(t), ids, kNoise_px);
    std::vector<PoseObservation> observations;
    for (std::size_t k = 0; k < ids.size(); ++k)
      if (point_of[ids[k]] != kNone && map.point(point_of[ids[k]]).alive)
        observations.push_back(
            {map.point(point_of[ids[k]]).position, {f.keypoints[k].ux, f.keypoints[k].uy}});
    Pose pose = scopeAt(t);
    EXPECT_TRUE(optimizePose(testCamera(), observations, pose).ok);
    return pose;
  }

  using Positions = Eigen::Matrix<double, Eigen::Dynamic, 3>;
  static Positions positions(const std::vector<StampedPose>& path) {
    Positions p(path.size(), 3);
    for (std::size_t i = 0; i < path.size(); ++i)
      p.row(static_cast<Eigen::Index>(i)) = path[i].T_world_camera.t;
    return p;
  }
  /// Of a motion, that in the rhythm of breathing: its coefficients for 1, cosine and sine.
  static Eigen::Matrix3d inRhythm(const std::vector<StampedPose>& path, const Positions& motion) {
    return basis(path).colPivHouseholderQr().solve(motion);
  }
  static Positions basis(const std::vector<StampedPose>& path) {
    Positions f(path.size(), 3);
    for (std::size_t i = 0; i < path.size(); ++i) {
      const double phase = 2 * std::numbers::pi * kBreath_hz * path[i].timestamp_s;
      f.row(static_cast<Eigen::Index>(i)) << 1, std::cos(phase), std::sin(phase);
    }
    return f;
  }
  /// RMS of the positions after the best similarity, without what moves in the rhythm.
  static double error(const std::vector<StampedPose>& path) {
    const Positions is = positions(path);
    Positions should(path.size(), 3);
    for (std::size_t i = 0; i < path.size(); ++i)
      should.row(static_cast<Eigen::Index>(i)) = scopeAt(path[i].timestamp_s).inverse().t;
    const Eigen::Matrix4d T = Eigen::umeyama(is.transpose(), should.transpose());
    const Positions off =
        ((is * T.topLeftCorner<3, 3>().transpose()).rowwise() + T.col(3).head<3>().transpose()) -
        should;
    const Positions rest = off - basis(path) * inRhythm(path, off);
    return std::sqrt(rest.squaredNorm() / static_cast<double>(path.size()));
  }
  static double largestChange(const Paths& paths) {
    EXPECT_EQ(paths.scope.size(), paths.tracked.size());
    return (positions(paths.scope) - positions(paths.tracked)).cwiseAbs().maxCoeff();
  }

  World world_{300};
  SlamSettings settings_ = smallSettings();
};

TEST_F(ScopePathTest, WhatBreathingDoesToThePathIsTakenBack) {
  const Paths paths = run(0.01);
  EXPECT_NEAR(paths.tissue_rhythm_hz, kBreath_hz, 0.01);
  EXPECT_LT(error(paths.scope), 0.5 * error(paths.tracked));
}

TEST_F(ScopePathTest, WhatScopeAndTissueDoTogetherStaysAsTracked) {
  const Paths paths = run(0.01);
  ASSERT_GT(largestChange(paths), 1e-3);
  const Positions change = positions(paths.scope) - positions(paths.tracked);
  EXPECT_LT(inRhythm(paths.scope, change).cwiseAbs().maxCoeff(),
            0.1 * change.cwiseAbs().maxCoeff());
}

TEST_F(ScopePathTest, OverTissueThatIsStillThePathIsAsTracked) {
  const Paths paths = run(0);
  EXPECT_EQ(paths.tissue_rhythm_hz, 0);
  EXPECT_EQ(largestChange(paths), 0);
}

TEST_F(ScopePathTest, TwoBreathsAreTooFewToTell) {
  EXPECT_EQ(largestChange(run(0.01, 2 / kBreath_hz)), 0);
}

}  // namespace
}  // namespace depthscope::slam
