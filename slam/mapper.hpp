#pragma once
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <span>
#include <thread>
#include <vector>

#include "slam/global_bundle.hpp"
#include "slam/keyframe_database.hpp"
#include "slam/local_bundle.hpp"
#include "slam/loop_closer.hpp"
#include "slam/map_culler.hpp"
#include "slam/place_recognizer.hpp"
#include "slam/point_creator.hpp"
#include "slam/point_fuser.hpp"
#include "slam/slam_system.hpp"

namespace depthscope::slam {

/// A frame that is to become a keyframe, as the tracker hands it over.
struct KeyframeRequest {
  FeatureSet features;
  std::vector<PointRef> points;  // per feature
  Pose T_camera_world;
  Twist twist;
  Sim3 correction;  // Map::correction() when it was made
  std::int64_t frame = 0;
  double timestamp_s = 0;
};

/// Makes keyframes out of frames and keeps the map accurate and small (Mur-Artal et al. 2015,
/// section VI). Works in the caller's time (Lockstep) or in a thread of its own (Threaded). The
/// only writer of the map once it exists.
class Mapper {
 public:
  Mapper(const SlamSettings& settings, const CameraModel& camera, Map& map,
         KeyframeDatabase& database, FrameRecords& records, MappingMode mode);
  ~Mapper();

  /// True if a keyframe would be taken on at once, or as soon as an adjustment of the whole map has
  /// finished its step.
  bool idle() const;
  /// Hands over a keyframe, its pose in the world as `correction` (Map::correction) left it.
  /// Threaded: false when one is waiting already; a bundle adjustment in progress is cut short.
  bool submit(const FeatureSet& features, std::span<const PointRef> points,
              const Pose& T_camera_world, const Sim3& correction, std::int64_t frame,
              double timestamp_s, const Twist& twist = {});
  /// After the initializer has made a map: adjusts it and starts to look after its points. Call
  /// while idle.
  void adoptInitialMap();
  /// Frees keyframe slots for a new map. Call while idle.
  void makeRoom(int keyframes) { culler_.makeRoom(keyframes); }
  /// Returns once nothing is in progress; what was waiting is thrown away.
  void drain();
  /// Time the last keyframe took [ms], once each; negative when there was none since the last call.
  double takeMapMs();
  int loopsClosed() const { return loops_closed_; }
  std::size_t bytes() const { return adjuster_.bytes() + loop_closer_.bytes(); }

 private:
  void run();
  void process(const KeyframeRequest& request);
  void adjustAround(KeyframeId id);
  void recognizePlace(KeyframeId id);
  void planWholeMap(std::uint32_t map_id);
  void adjustWholeMap();
  KeyframeId insert(const KeyframeRequest& request);
  std::span<const KeyframeId> bestNeighbours(KeyframeId id, int count);

  SlamSettings settings_;
  Map& map_;
  KeyframeDatabase& database_;
  FrameRecords& records_;
  MappingMode mode_;
  PointCreator creator_;
  PointFuser fuser_;
  BundleAdjuster adjuster_;
  LocalBundle bundle_;
  GlobalBundle global_bundle_;
  MapCuller culler_;
  PlaceRecognizer recognizer_;
  MapMerger merger_;
  LoopCloser loop_closer_;
  std::uint32_t unadjusted_map_ = 0;  // that is to be adjusted as a whole
  int steps_left_ = 0;                // of that
  int since_whole_map_ = 0;           // keyframes since a map was adjusted as a whole
  std::atomic<int> loops_closed_ = 0;
  std::vector<PointRef> recent_;
  std::vector<int> votes_;
  std::vector<KeyframeId> neighbours_, window_, around_;

  mutable std::mutex queue_mutex_;
  std::condition_variable queue_changed_;
  KeyframeRequest waiting_, current_;
  bool has_waiting_ = false, busy_ = false, quit_ = false;
  bool interruptible_ = false;           // what keeps it busy: the adjustment of the whole map
  std::atomic<bool> interrupt_ = false;  // stop adjusting: something newer waits
  std::atomic<double> map_ms_ = -1;
  std::thread thread_;
};

}  // namespace depthscope::slam
