#include "slam/mapper.hpp"

#include <algorithm>
#include <chrono>

#include "types/allocation_scope.hpp"

namespace depthscope::slam {
namespace {

constexpr int kWholeMapSteps = 10;  // of an adjustment of the whole map, at most

}  // namespace

Mapper::Mapper(const SlamSettings& settings, const CameraModel& camera, Map& map,
               KeyframeDatabase& database, FrameRecords& records, MappingMode mode)
    : settings_(settings),
      map_(map),
      database_(database),
      records_(records),
      mode_(mode),
      creator_(settings, map),
      fuser_(settings, map),
      adjuster_(std::max(settings.capacity.keyframes,
                         settings.mapper.window_keyframes + settings.mapper.window_fixed + 1),
                settings.capacity.local_points, settings.capacity.local_points * 12),
      bundle_(settings, map, adjuster_),
      global_bundle_(settings, map, adjuster_),
      culler_(settings, map, records),
      recognizer_(settings, map, database),
      merger_(map, fuser_),
      loop_closer_(settings, map, merger_) {
  const int features = settings.extractor.capacity();
  recent_.reserve(settings.capacity.map_points);
  votes_.resize(settings.capacity.keyframes);
  neighbours_.reserve(settings.capacity.keyframes);
  window_.reserve(settings.capacity.keyframes);
  around_.reserve(settings.capacity.keyframes);
  for (KeyframeRequest* r : {&waiting_, &current_}) {
    r->features = FeatureSet(features, camera);
    r->points.reserve(features);
  }
  if (mode_ == MappingMode::Threaded) thread_ = std::thread([this] { run(); });
}

Mapper::~Mapper() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(queue_mutex_);
    quit_ = true;
  }
  interrupt_ = true;
  queue_changed_.notify_all();
  thread_.join();
}

bool Mapper::idle() const {
  const std::lock_guard lock(queue_mutex_);
  return !has_waiting_ && (!busy_ || interruptible_);
}

bool Mapper::submit(const FeatureSet& features, std::span<const PointRef> points,
                    const Pose& T_camera_world, const Sim3& correction, std::int64_t frame,
                    double timestamp_s, const Twist& twist) {
  {
    const std::lock_guard lock(queue_mutex_);
    if (has_waiting_) return false;
    waiting_.features = features;
    waiting_.points.assign(points.begin(), points.end());
    waiting_.T_camera_world = T_camera_world;
    waiting_.twist = twist;
    waiting_.correction = correction;
    waiting_.frame = frame;
    waiting_.timestamp_s = timestamp_s;
    has_waiting_ = mode_ == MappingMode::Threaded;
    interrupt_ = has_waiting_;
  }
  if (mode_ == MappingMode::Lockstep)
    process(waiting_);
  else
    queue_changed_.notify_all();
  return true;
}

void Mapper::run() {
  const AllocationScope no_allocations;
  while (true) {
    {
      std::unique_lock lock(queue_mutex_);
      queue_changed_.wait(lock, [this] { return has_waiting_ || quit_; });
      if (quit_) return;
      std::swap(waiting_, current_);
      has_waiting_ = false;
      busy_ = true;
      interrupt_ = false;
    }
    process(current_);
    {
      const std::lock_guard lock(queue_mutex_);
      interruptible_ = true;
    }
    adjustWholeMap();
    {
      const std::lock_guard lock(queue_mutex_);
      busy_ = interruptible_ = false;
    }
    queue_changed_.notify_all();
  }
}

void Mapper::drain() {
  std::unique_lock lock(queue_mutex_);
  has_waiting_ = false;
  interrupt_ = true;
  queue_changed_.wait(lock, [this] { return !busy_; });
  recent_.clear();
}

double Mapper::takeMapMs() {
  return map_ms_.exchange(-1);
}

void Mapper::adoptInitialMap() {
  window_.clear();
  recent_.clear();
  for (KeyframeId k = 0; k < map_.keyframeCapacity(); ++k)
    if (map_.keyframe(k).alive && map_.keyframe(k).map_id == map_.activeId()) window_.push_back(k);
  bundle_.adjust(window_, 20, nullptr);
  for (PointId p = 0; p < map_.pointEnd(); ++p)
    if (map_.point(p).alive && map_.point(p).map_id == map_.activeId())
      recent_.push_back(map_.ref(p));
}

void Mapper::process(const KeyframeRequest& request) {
  const auto start = std::chrono::steady_clock::now();
  culler_.makeRoom(1);
  const KeyframeId id = insert(request);
  culler_.cullRecentPoints(recent_, map_.keyframe(id).serial);
  creator_.create(id, bestNeighbours(id, settings_.mapper.neighbours), recent_);
  fuser_.fuse(id, bestNeighbours(id, settings_.mapper.neighbours));
  adjustAround(id);
  culler_.cullKeyframes(bestNeighbours(id, 2 * settings_.mapper.window_keyframes));
  recognizePlace(id);
  planWholeMap(map_.keyframe(id).map_id);
  if (mode_ == MappingMode::Lockstep) adjustWholeMap();
  map_ms_ =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

void Mapper::adjustAround(KeyframeId id) {
  const auto neighbours = bestNeighbours(id, settings_.mapper.window_keyframes - 1);
  window_.assign(neighbours.begin(), neighbours.end());
  window_.push_back(id);
  bundle_.adjust(window_, settings_.mapper.iterations,
                 mode_ == MappingMode::Threaded ? &interrupt_ : nullptr);
}

void Mapper::recognizePlace(KeyframeId id) {
  constexpr int kFusedAround = 6;
  const auto link = recognizer_.recognize(id);
  if (!link) return;
  const auto neighbours = bestNeighbours(id, kFusedAround);
  around_.assign(neighbours.begin(), neighbours.end());
  if (map_.keyframe(link->now).map_id != map_.keyframe(link->before).map_id) {
    merger_.merge(*link, recognizer_.pairs(), recognizer_.window(), around_);
  } else if (loop_closer_.close(*link, recognizer_.pairs(), recognizer_.window(), around_)) {
    ++loops_closed_;
  } else {
    return;
  }
  adjustAround(id);
  unadjusted_map_ = map_.keyframe(id).map_id;
  steps_left_ = kWholeMapSteps;
}

/// Now and then a map that outgrew the window is adjusted as a whole: where the scope comes back
/// to what it saw long ago, old and new pull at each other from beyond every window.
void Mapper::planWholeMap(std::uint32_t map_id) {
  const int every = settings_.mapper.whole_map_every;
  if (++since_whole_map_ < every || every == 0 || steps_left_ > 0) return;
  const int keyframes = map_.keyframesOf(map_id);
  if (keyframes <= settings_.mapper.window_keyframes) {
    since_whole_map_ = 0;
    if (keyframes >= every) global_bundle_.estimateReadout(map_id);
    return;
  }
  unadjusted_map_ = map_id;
  steps_left_ = kWholeMapSteps;
}

/// In the background when threaded: a new keyframe interrupts it, and what is left is done after
/// that.
void Mapper::adjustWholeMap() {
  if (steps_left_ == 0) return;
  const BaSummary summary = global_bundle_.adjust(
      unadjusted_map_, steps_left_, mode_ == MappingMode::Threaded ? &interrupt_ : nullptr);
  since_whole_map_ = 0;
  steps_left_ = summary.end == BaSummary::End::Stopped ? steps_left_ - summary.iterations : 0;
}

KeyframeId Mapper::insert(const KeyframeRequest& request) {
  const std::lock_guard lock(map_.mutex);
  const Sim3 T_now_request = map_.correction() * request.correction.inverse();
  const KeyframeId id =
      map_.addKeyframe(request.features, T_now_request.moved(request.T_camera_world), request.frame,
                       request.timestamp_s);
  map_.keyframe(id).twist = {request.twist.w, T_now_request.s * request.twist.v};
  // With its third keyframe the two that a map began with: the picture that begins it takes longest
  // anyhow, and nobody looks for places in a map of two.
  for (KeyframeId k = 0; k < map_.keyframeCapacity(); ++k)
    if (map_.keyframe(k).alive && !database_.contains(map_, k)) database_.add(map_, k);
  records_.views.becameKeyframe(map_, request.frame, id);
  for (int f = 0; f < request.features.size(); ++f) {
    const PointId p = map_.resolve(request.points[f]);
    if (p != kNone && map_.observe(p, id, f)) map_.refreshGeometry(p);
  }
  return id;
}

std::span<const KeyframeId> Mapper::bestNeighbours(KeyframeId id, int count) {
  map_.countShared(id, votes_);
  neighbours_.clear();
  for (KeyframeId k = 0; k < map_.keyframeCapacity(); ++k)
    if (votes_[k] > 0) neighbours_.push_back(k);
  std::sort(neighbours_.begin(), neighbours_.end(), [&](KeyframeId a, KeyframeId b) {
    return votes_[a] != votes_[b] ? votes_[a] > votes_[b]
                                  : map_.keyframe(a).serial > map_.keyframe(b).serial;
  });
  neighbours_.resize(std::min<std::size_t>(neighbours_.size(), count));
  return neighbours_;
}

}  // namespace depthscope::slam
