#include "slam/slam_system.hpp"

#include <chrono>
#include <mutex>

#include "slam/frame_records.hpp"
#include "slam/map.hpp"
#include "slam/mapper.hpp"
#include "slam/scope_path.hpp"
#include "slam/tracker.hpp"

namespace depthscope::slam {

struct SlamSystem::Impl {
  Impl(const CameraModel& camera, const SlamSettings& settings, MappingMode mapping_mode)
      : mode(mapping_mode),
        map(settings, camera),
        database(settings, settings.vocabulary.empty() ? Vocabulary::builtIn()
                                                       : Vocabulary::load(settings.vocabulary)),
        records{Trajectory(settings.trajectory_frames),
                ViewKeeper(settings.capacity.views, settings.tracker.view_motion)},
        mapper(settings, camera, map, database, records, mapping_mode),
        tracker(camera, settings, map, database, mapper, records),
        place_in_cloud(static_cast<std::size_t>(map.keyframeCapacity())) {}

  MappingMode mode;
  /// Map mutex held.
  void copyCloud(std::uint32_t map_id, SparseCloud& out) const;

  Map map;
  KeyframeDatabase database;
  FrameRecords records;
  Mapper mapper;
  Tracker tracker;
  StageTimes times;
  mutable std::vector<std::uint32_t>
      place_in_cloud;  // of each keyframe; guarded by the map's mutex
};

SlamSystem::SlamSystem(const CameraModel& camera, const SlamSettings& settings, MappingMode mode)
    : impl_(std::make_unique<Impl>(camera, settings, mode)) {}

SlamSystem::~SlamSystem() = default;

PoseEstimate SlamSystem::track(const GrayView& image, std::int64_t frame, double timestamp_s) {
  const auto start = std::chrono::steady_clock::now();
  const PoseEstimate estimate = impl_->tracker.track(image, frame, timestamp_s);
  const double whole_ms =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  impl_->times.extract_ms = impl_->tracker.lastExtractMs();
  impl_->times.map_ms = impl_->mapper.takeMapMs();
  // In lockstep the mapper worked within the call.
  const bool mapped_here = impl_->mode == MappingMode::Lockstep && impl_->times.map_ms > 0;
  impl_->times.track_ms = whole_ms - (mapped_here ? impl_->times.map_ms : 0);
  return estimate;
}

bool SlamSystem::wantsPicture() const {
  return impl_->tracker.wantsPicture();
}

ViewOutline SlamSystem::view() const {
  return impl_->tracker.view();
}

StageTimes SlamSystem::lastTimes() const {
  return impl_->times;
}

SlamStatistics SlamSystem::statistics() const {
  SlamStatistics s;
  const std::lock_guard lock(impl_->map.mutex);
  s.keyframes = impl_->map.keyframeCount();
  s.map_points = impl_->map.pointCount();
  s.maps = impl_->map.mapCount();
  s.lost_events = impl_->tracker.lostEvents();
  s.relocalizations = impl_->tracker.relocalizations();
  s.loops_closed = impl_->mapper.loopsClosed();
  s.readout_s = impl_->map.shutter().readout();
  return s;
}

SlamMemory SlamSystem::memory() const {
  return {impl_->map.keyframeBytes(), impl_->map.pointBytes(), impl_->database.bytes(),
          impl_->mapper.bytes()};
}

void SlamSystem::copyCloud(SparseCloud& out) const {
  const std::lock_guard lock(impl_->map.mutex);
  impl_->copyCloud(impl_->map.activeId(), out);
}

void SlamSystem::copyMainCloud(SparseCloud& out) const {
  const std::lock_guard lock(impl_->map.mutex);
  impl_->copyCloud(impl_->records.trajectory.mainMap(impl_->map), out);
}

void SlamSystem::Impl::copyCloud(std::uint32_t map_id, SparseCloud& out) const {
  out.map_id = map_id;
  out.points.clear();
  out.views_T_camera_world.clear();
  out.view_frames.clear();
  out.sightings.clear();
  for (KeyframeId k = 0; k < map.keyframeCapacity(); ++k) {
    if (!map.keyframe(k).alive || map.keyframe(k).map_id != map_id) continue;
    place_in_cloud[k] = static_cast<std::uint32_t>(out.view_frames.size());
    out.views_T_camera_world.push_back(map.keyframe(k).T_camera_world);
    out.view_frames.push_back(map.keyframe(k).frame);
  }
  out.keyframes = out.view_frames.size();
  for (const AnchoredPose& view : records.views.poses()) {
    if (!view.inMap(map, map_id) || map.keyframe(view.reference).frame == view.frame) continue;
    out.views_T_camera_world.push_back(view.T_camera_world(map));
    out.view_frames.push_back(view.frame);
  }
  for (PointId id = 0; id < map.pointEnd(); ++id) {
    const MapPoint& p = map.point(id);
    if (!p.alive || p.map_id != map_id) continue;
    double squared = 0;
    for (const Observation& o : map.observations(id)) {
      const Keyframe& k = map.keyframe(o.keyframe);
      const Keypoint& kp = k.features.keypoints[o.feature];
      const Eigen::Vector3d p_camera = k.T_camera_world * p.position;
      squared +=
          (map.intrinsics().project(p_camera) - map.shutter().atMiddleRow(kp, k.twist, p_camera))
              .squaredNorm();
      out.sightings.push_back(
          {static_cast<std::uint32_t>(out.points.size()), place_in_cloud[o.keyframe]});
    }
    const int n = p.observation_count;
    out.points.push_back({p.position.cast<float>(), -p.normal.cast<float>(), n,
                          static_cast<float>(std::sqrt(squared / std::max(n, 1)))});
  }
}

std::vector<StampedPose> SlamSystem::correctedTrajectory() const {
  const std::lock_guard lock(impl_->map.mutex);
  return impl_->records.trajectory.corrected(impl_->map,
                                             impl_->records.trajectory.mainMap(impl_->map));
}

ScopePath SlamSystem::scopePath() const {
  const std::lock_guard lock(impl_->map.mutex);
  const Trajectory& trajectory = impl_->records.trajectory;
  return slam::scopePath(impl_->map, trajectory.mainMap(impl_->map), trajectory);
}

void SlamSystem::reset() {
  impl_->tracker.reset();
}

}  // namespace depthscope::slam
