// Time of the whole of tracking a picture, in milliseconds and in units of the yardstick: OpenCV's
// ORB with as many features and levels, one thread, on the same pictures, turn and turn about.
// Usage: tracking_bench [CLIP CAMERA]; without them the sample clip.
#include <chrono>
#include <cstdio>
#include <opencv2/core/utility.hpp>

#include "bench/luma_reader.hpp"
#include "bench/opencv_orb.hpp"
#include "platform/camera_file.hpp"
#include "platform/histogram.hpp"
#include "slam/slam_system.hpp"
#include "types/error.hpp"

namespace {

using namespace depthscope;

struct Times {
  platform::Histogram track, map, yardstick;
  int tracked = 0;
};

Times measure(const char* clip, const char* camera_file) {
  const CameraModel camera = platform::loadCameraFile(camera_file);
  bench::LumaReader reader(clip);
  bench::OpenCvOrb orb;
  slam::SlamSystem slam(camera, {}, slam::MappingMode::Lockstep);
  Times times;
  GrayView picture;
  for (std::int64_t frame = 0; !(picture = reader.next()).empty(); ++frame) {
    const auto start = std::chrono::steady_clock::now();
    orb(picture);
    times.yardstick.add(
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
            .count());
    const double fps = camera.fps > 0 ? camera.fps : 30;
    const PoseEstimate pose = slam.track(picture, frame, static_cast<double>(frame) / fps);
    times.tracked += pose.state == TrackingState::Tracking;
    times.track.add(slam.lastTimes().track_ms);
    if (slam.lastTimes().map_ms >= 0) times.map.add(slam.lastTimes().map_ms);
  }
  if (times.track.count() == 0) throw InputError(std::string(clip) + ": no pictures in the clip");
  return times;
}

void print(const char* what, const platform::Histogram& times, double yardstick_ms) {
  std::printf("%-10s", what);
  for (const double p : {0.5, 0.95, 0.99})
    std::printf("  p%.0f %6.2f ms = %4.2f", 100 * p, times.percentile(p),
                times.percentile(p) / yardstick_ms);
  std::printf("\n");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 2 || argc > 3 || (argc > 1 && argv[1][0] == '-')) {
    std::fprintf(stderr, "usage: tracking_bench [CLIP CAMERA]\n");
    return 2;
  }
  cv::setNumThreads(1);
  try {
    const Times times =
        argc > 1 ? measure(argv[1], argv[2])
                 : measure(DEPTHSCOPE_SAMPLE "/video.mp4", DEPTHSCOPE_SAMPLE "/camera.yaml");
    const double yardstick_ms = times.yardstick.percentile(0.5);
    std::printf("%d of %llu pictures tracked; times, and in units of OpenCV's median\n",
                times.tracked, static_cast<unsigned long long>(times.track.count()));
    print("opencv_orb", times.yardstick, yardstick_ms);
    print("track", times.track, yardstick_ms);
    print("map", times.map, yardstick_ms);
  } catch (const InputError& error) {
    std::fprintf(stderr, "tracking_bench: %s\n", error.what());
    return 2;
  }
  return 0;
}
