#pragma once
#include <random>
#include <vector>

#include "slam/map.hpp"
#include "tests/slam/synthetic_scene.hpp"

namespace depthscope::slam::testing {

inline CameraModel testCameraModel() {
  const Intrinsics c = testCamera();
  CameraModel m;
  m.width = static_cast<int>(kWidth_px);
  m.height = static_cast<int>(kHeight_px);
  m.fx = c.fx;
  m.fy = c.fy;
  m.cx = c.cx;
  m.cy = c.cy;
  return m;
}

inline SlamSettings smallSettings() {
  SlamSettings s;
  s.extractor.features = s.extractor.features_at_most = 400;
  s.capacity.keyframes = 12;
  s.capacity.map_points = 2000;
  s.capacity.observations_per_point = 16;
  s.capacity.local_points = 1000;
  return s;
}

inline Descriptor randomDescriptor(std::mt19937& rng) {
  Descriptor d;
  for (auto& word : d.bits) word = (static_cast<std::uint64_t>(rng()) << 32) | rng();
  return d;
}

/// A world whose every point looks like nothing else.
struct World {
  std::vector<Eigen::Vector3d> points;
  std::vector<Descriptor> descriptors;

  explicit World(int n, unsigned seed = 3) : points(volumePoints(n, seed, 4, 8)) {
    std::mt19937 rng(seed);
    for (int i = 0; i < n; ++i) descriptors.push_back(randomDescriptor(rng));
  }

  /// What a camera at `T_camera_world` sees: feature i is point `feature_points[i]`.
  FeatureSet view(const Pose& T_camera_world, std::vector<int>& feature_points,
                  double noise_px = 0) const {
    FeatureSet set(400, testCameraModel());
    std::mt19937 rng(11);
    feature_points.clear();
    for (std::size_t i = 0; i < points.size() && set.size() < 400; ++i) {
      const Eigen::Vector3d p = T_camera_world * points[i];
      if (p.z() < 0.1) continue;
      const Eigen::Vector2d px = testCamera().project(p) + gaussian2(rng, noise_px);
      if (px.x() < 0 || px.y() < 0 || px.x() >= kWidth_px || px.y() >= kHeight_px) continue;
      Keypoint k;
      k.x = k.ux = static_cast<float>(px.x());
      k.y = k.uy = static_cast<float>(px.y());
      set.keypoints.push_back(k);
      set.descriptors.push_back(descriptors[i]);
      feature_points.push_back(static_cast<int>(i));
    }
    set.grid.build(set.keypoints);
    return set;
  }
};

/// A map of `world` as `poses` see it: every point seen by at least two of them, positions exact.
struct MappedWorld {
  Map map;
  std::vector<KeyframeId> keyframes;
  std::vector<PointId> point_of;  // per world point, kNone where fewer than two keyframes see it

  MappedWorld(const SlamSettings& settings, const World& world, const std::vector<Pose>& poses)
      : map(settings, testCameraModel()), point_of(world.points.size(), kNone) {
    map.start();
    std::vector<std::vector<std::pair<KeyframeId, int>>> seen(world.points.size());
    for (std::size_t i = 0; i < poses.size(); ++i) {
      std::vector<int> ids;
      const FeatureSet f = world.view(poses[i], ids);
      keyframes.push_back(
          map.addKeyframe(f, poses[i], static_cast<std::int64_t>(i), static_cast<double>(i)));
      for (std::size_t k = 0; k < ids.size(); ++k)
        seen[ids[k]].push_back({keyframes.back(), static_cast<int>(k)});
    }
    for (std::size_t i = 0; i < seen.size(); ++i) {
      if (seen[i].size() < 2) continue;
      point_of[i] = map.addPoint(world.points[i], 0);
      for (const auto& [keyframe, feature] : seen[i]) map.observe(point_of[i], keyframe, feature);
      map.refreshPoint(point_of[i]);
    }
  }
};

/// Cameras side by side, `step` apart along x, all looking along z.
inline std::vector<Pose> sidewaysPoses(int n, double step = 0.3) {
  std::vector<Pose> poses;
  for (int i = 0; i < n; ++i) poses.push_back(cameraAt({step * i, 0, 0}, {0, 0, 0}));
  return poses;
}

}  // namespace depthscope::slam::testing
