#include "platform/daemon/map_scale_keeper.hpp"

#include "platform/ipc/surface_mailbox.hpp"
#include "types/error.hpp"

namespace depthscope::platform {
namespace {

constexpr std::string_view in_snapshot = "snapshot ";
constexpr std::chrono::milliseconds longest_wait{200};  // for the pose of a snapshot

}  // namespace

MapScale MapScaleKeeper::measure(std::string_view request) {
  const bool snapshot = request.starts_with(in_snapshot);
  if (snapshot) request.remove_prefix(in_snapshot.size());
  const ScaleRequest picked = parseScaleRequest(request);
  requireInPicture(picked, camera_);
  const PoseEstimate pose = snapshot ? poseOfSnapshot() : poseNow();
  const SurfaceMesh mesh = surface();
  if (mesh.map_id != pose.map_id)
    throw InputError("the surface is of another map than the picture, expected a new surface");
  scale_ = measureScale(mesh, camera_, pose.T_camera_world, picked);
  return *scale_;
}

PoseEstimate MapScaleKeeper::poseNow() const {
  const auto pose = link_.trackedPose(poses_.now());
  if (!pose) throw InputError("the scope is not tracked at the moment");
  return *pose;
}

PoseEstimate MapScaleKeeper::poseOfSnapshot() const {
  if (!snapshot_pose_)
    throw InputError("there is no snapshot in which the scope was tracked, expected a new one");
  return *snapshot_pose_;
}

SurfaceMesh MapScaleKeeper::surface() const {
  SurfaceMesh mesh;
  SurfaceMailboxReader reader(memory_);
  if (!surfaceIsCurrent() || reader.takeNewest(mesh) != SurfaceMailboxReader::Result::Taken ||
      mesh.empty())
    throw InputError("there is no surface yet");
  return mesh;
}

bool MapScaleKeeper::noteSnapshot(std::int64_t frame) {
  snapshot_pose_.reset();
  if (frame < 0 || !poses_.until(frame, poses_.now() + longest_wait)) return true;
  const auto pose = link_.trackedPose(poses_.now());
  if (!pose) return true;
  if (pose->frame != frame) return false;
  snapshot_pose_ = pose;
  return true;
}

void MapScaleKeeper::arStarted() {
  forget();
  surfaces_before_ = memory_.block().surfaces_published.load(std::memory_order_acquire);
}

void MapScaleKeeper::forget() {
  scale_.reset();
  snapshot_pose_.reset();
}

bool MapScaleKeeper::surfaceIsCurrent() const {
  return memory_.block().surfaces_published.load(std::memory_order_acquire) != surfaces_before_;
}

std::optional<MapScale> MapScaleKeeper::of(const SurfaceMesh& mesh) const {
  return scale_ && scale_->map_id == mesh.map_id && surfaceIsCurrent() ? scale_ : std::nullopt;
}

std::optional<MapScale> MapScaleKeeper::ofTrackedMap() const {
  WirePose wire;
  PoseEstimate pose;
  const bool known = scale_ && memory_.block().pose.read(wire) && decodePose(wire, pose) &&
                     pose.map_id == scale_->map_id;
  return known ? scale_ : std::nullopt;
}

}  // namespace depthscope::platform
