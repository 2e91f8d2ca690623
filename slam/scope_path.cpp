#include "slam/scope_path.hpp"

#include <Eigen/Cholesky>
#include <span>

#include "slam/map_observation.hpp"
#include "slam/tissue_rhythm.hpp"

namespace depthscope::slam {
namespace {

/// A connected map as a TissueRhythm is looked for in it.
struct Scene {
  std::vector<TimedView> views;
  std::vector<int> view_of_keyframe;
  std::vector<Eigen::Vector3d> points;
  std::vector<BaObservation> observations;
};

Scene sceneOf(const Map& map, std::uint32_t map_id) {
  Scene scene;
  scene.view_of_keyframe.assign(map.keyframeCapacity(), kNone);
  for (KeyframeId k = 0; k < map.keyframeCapacity(); ++k) {
    const Keyframe& keyframe = map.keyframe(k);
    if (!keyframe.alive || keyframe.map_id != map_id) continue;
    scene.view_of_keyframe[k] = static_cast<int>(scene.views.size());
    scene.views.push_back({keyframe.T_camera_world, keyframe.timestamp_s});
  }
  for (PointId id = 0; id < map.pointEnd(); ++id) {
    const MapPoint& point = map.point(id);
    if (!point.alive || point.map_id != map_id) continue;
    for (const Observation& o : map.observations(id)) {
      const Keyframe& view = map.keyframe(o.keyframe);
      BaObservation& added = scene.observations.emplace_back(mapObservation(
          map.shutter(), view, o.feature, view.twist, point.position, point.trust()));
      added.pose = scene.view_of_keyframe[o.keyframe];
      added.point = static_cast<int>(scene.points.size());
    }
    scene.points.push_back(point.position);
  }
  return scene;
}

/// By how much a pose was moved, in the world: rotation vector [rad], and translation of the
/// camera.
Vector6d changeBetween(const StampedPose& before, const StampedPose& after) {
  Vector6d m;
  m << logSO3(after.T_world_camera.R * before.T_world_camera.R.transpose()),
      after.T_world_camera.t - before.T_world_camera.t;
  return m;
}

/// Gives `path` what `tracked` has of a motion in the given rhythm.
void keepCommonMotion(double frequency_hz, std::span<const StampedPose> tracked,
                      std::span<StampedPose> path) {
  const auto basis = [&](double timestamp_s) {
    const Eigen::Vector2d p = phasor(frequency_hz, timestamp_s);
    return Eigen::Vector3d(1, p.x(), p.y());
  };
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, 6> b = Eigen::Matrix<double, 3, 6>::Zero();
  for (std::size_t i = 0; i < path.size(); ++i) {
    const Eigen::Vector3d f = basis(path[i].timestamp_s);
    H += f * f.transpose();
    b += f * changeBetween(tracked[i], path[i]).transpose();
  }
  const Eigen::LDLT<Eigen::Matrix3d> ldlt(H);
  const Eigen::Matrix<double, 3, 6> common = ldlt.solve(b);
  if (ldlt.info() != Eigen::Success || !common.allFinite()) return;
  for (StampedPose& pose : path) {
    const Vector6d m = common.transpose() * basis(pose.timestamp_s);
    pose.T_world_camera.R = expSO3(-m.head<3>()) * pose.T_world_camera.R;
    pose.T_world_camera.t -= m.tail<3>();
  }
}

}  // namespace

ScopePath scopePath(const Map& map, std::uint32_t map_id, const Trajectory& trajectory) {
  std::vector<StampedPose> tracked = trajectory.corrected(map, map_id);
  const Scene scene = sceneOf(map, map_id);
  const auto rhythm =
      TissueRhythm::find(map.intrinsics(), scene.views, scene.points, scene.observations);
  if (!rhythm) return {std::move(tracked), 0};
  ScopePath path{trajectory.corrected(map, map_id,
                                      [&](KeyframeId reference, double timestamp_s) {
                                        const Vector6d c = rhythm->correction(
                                            scene.view_of_keyframe[reference], timestamp_s);
                                        return map.keyframe(reference).T_camera_world.retract(
                                            c.head<3>(), c.tail<3>());
                                      }),
                 rhythm->frequency_hz()};
  keepCommonMotion(path.tissue_rhythm_hz, tracked, path.poses);
  return path;
}

}  // namespace depthscope::slam
