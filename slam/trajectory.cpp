#include "slam/trajectory.hpp"

#include <algorithm>

namespace depthscope::slam {

void Trajectory::Record::set(const Pose& T_camera_reference) {
  q_camera_reference = T_camera_reference.quaternion().cast<float>();
  t_camera_reference = T_camera_reference.t.cast<float>();
}

Pose Trajectory::Record::now(const Map& map) const {
  return {q_camera_reference.cast<double>().normalized().toRotationMatrix(),
          t_camera_reference.cast<double>() * (map.keyframe(reference).unit / unit)};
}

void Trajectory::add(std::int64_t frame, double timestamp_s, KeyframeId reference,
                     const Pose& T_camera_reference, double unit) {
  if (records_.empty()) return;
  Record& r = records_[next_];
  r.frame = frame;
  r.timestamp_s = timestamp_s;
  r.reference = reference;
  r.unit = static_cast<float>(unit);
  r.set(T_camera_reference);
  next_ = (next_ + 1) % records_.size();
  count_ = std::min(count_ + 1, records_.size());
}

void Trajectory::rebase(const Map& map, KeyframeId from, KeyframeId to) {
  const Pose T_from_to =
      map.keyframe(from).T_camera_world * map.keyframe(to).T_camera_world.inverse();
  for (std::size_t i = 0; i < count_; ++i) {
    if (records_[i].reference != from) continue;
    records_[i].set(records_[i].now(map) * T_from_to);
    records_[i].reference = to;
    records_[i].unit = static_cast<float>(map.keyframe(to).unit);
  }
}

void Trajectory::drop(KeyframeId reference) {
  for (std::size_t i = 0; i < count_; ++i)
    if (records_[i].reference == reference) records_[i].reference = kNone;
}

void Trajectory::dropMap(const Map& map, std::uint32_t map_id) {
  for (KeyframeId k = 0; k < map.keyframeCapacity(); ++k)
    if (map.keyframe(k).alive && map.keyframe(k).map_id == map_id) drop(k);
}

std::uint32_t Trajectory::mainMap(const Map& map) const {
  std::uint32_t main = map.activeId();
  std::size_t most = 0;
  for (std::uint32_t id = 1; id <= map.lastId(); ++id) {
    const std::size_t frames = static_cast<std::size_t>(
        std::count_if(records_.begin(), records_.begin() + static_cast<std::ptrdiff_t>(count_),
                      [&](const Record& r) {
                        return r.reference != kNone && map.keyframe(r.reference).map_id == id;
                      }));
    if (frames < most || frames == 0) continue;
    most = frames;
    main = id;
  }
  return main;
}

std::vector<StampedPose> Trajectory::corrected(const Map& map, std::uint32_t map_id) const {
  std::vector<StampedPose> poses;
  poses.reserve(count_);
  const std::size_t oldest = count_ == records_.size() ? next_ : 0;
  for (std::size_t i = 0; i < count_; ++i) {
    const Record& r = records_[(oldest + i) % records_.size()];
    if (r.reference == kNone || map.keyframe(r.reference).map_id != map_id) continue;
    const Pose T_camera_world = r.now(map) * map.keyframe(r.reference).T_camera_world;
    poses.push_back({r.frame, r.timestamp_s, T_camera_world.inverse()});
  }
  return poses;
}

}  // namespace depthscope::slam
