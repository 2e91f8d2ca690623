#include "platform/replay/run_record.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "temporary_folder.hpp"

namespace depthscope::platform {
namespace {

PoseEstimate estimate(std::int64_t frame, TrackingState state, std::uint32_t map_id = 1) {
  PoseEstimate e;
  e.frame = frame;
  e.timestamp_s = static_cast<double>(frame) / 30;
  e.state = state;
  e.map_id = map_id;
  e.T_camera_world.t = {1, 2, 3};
  return e;
}

TEST(RunRecord, CountsTrackedFramesAndStageTimes) {
  RunRecord record(10);
  record.add(estimate(0, TrackingState::Initializing), {1, 2, -1});
  record.add(estimate(1, TrackingState::Tracking), {1, 2, 8});
  record.add(estimate(2, TrackingState::Lost), {1, 2, -1});
  record.add(estimate(3, TrackingState::Tracking), {1, 2, -1});
  record.close();
  const RunMetrics& m = record.metrics();
  EXPECT_EQ(m.tracked_frames, 2);
  EXPECT_EQ(m.first_tracked_frame, 1);
  EXPECT_EQ(m.track.count(), 4u);
  EXPECT_EQ(m.map.count(), 1u);
  EXPECT_EQ(record.live().size(), 2u);
}

TEST(RunRecord, WritesCameraToWorldInTumFormat) {
  const TemporaryFolder folder;
  slam::StampedPose pose;
  pose.timestamp_s = 1 / 30.0;
  pose.T_world_camera.t = {0.5, -1.25, 2};
  writeTrajectory(folder.path() / "t.txt", {pose});
  EXPECT_EQ(readFile(folder.path() / "t.txt"),
            "0.033333 0.500000000 -1.250000000 2.000000000 0.000000000 0.000000000 0.000000000 "
            "1.000000000\n");
}

TEST(RunRecord, TheLiveTrajectoryIsOfOneMapAndInverted) {
  const TemporaryFolder folder;
  RunRecord record(10);
  record.add(estimate(0, TrackingState::Tracking, 1), {});
  record.add(estimate(30, TrackingState::Tracking, 2), {});
  writeLiveTrajectory(folder.path() / "t.txt", record.live(), 2);
  EXPECT_EQ(readFile(folder.path() / "t.txt").substr(0, 50),
            "1.000000 -1.000000000 -2.000000000 -3.000000000 0.");
}

TEST(RunRecord, MetricsHaveEveryKeyOfTheContract) {
  const TemporaryFolder folder;
  RunMetrics metrics;
  metrics.track.add(5);
  writeMetrics(folder.path() / "m.json", metrics);
  const auto json = nlohmann::json::parse(readFile(folder.path() / "m.json"));
  for (const char* key :
       {"frames", "tracked_frames", "first_tracked_frame", "lost_events", "relocalizations",
        "loops_closed", "readout_ms", "tissue_rhythm_hz", "maps", "keyframes", "map_points",
        "surface_triangles", "peak_rss_mb", "steady_state_allocations"})
    EXPECT_TRUE(json.contains(key)) << key;
  for (const char* stage : {"extract_ms", "track_ms", "map_ms", "reconstruct_ms", "composite_ms"})
    for (const char* key : {"count", "p50", "p95", "p99", "max"})
      EXPECT_TRUE(json[stage].contains(key)) << stage << key;
  EXPECT_EQ(json["track_ms"]["count"], 1);
  EXPECT_EQ(json["track_ms"]["max"], 5);
  EXPECT_GT(json["peak_rss_mb"], 1);
}

}  // namespace
}  // namespace depthscope::platform
