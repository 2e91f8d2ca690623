// What faults of the picture cost: the clip is tracked under each of them, and the paths are
// compared with the true one. Usage: fault_bench [CLIP CAMERA GROUNDTRUTH]; without them the sample
// clip.
#include <cstdio>
#include <cstring>
#include <vector>

#include "bench/luma_reader.hpp"
#include "bench/picture_faults.hpp"
#include "platform/camera_file.hpp"
#include "platform/evaluate/trajectory_error.hpp"
#include "slam/slam_system.hpp"

namespace {

using namespace depthscope;

void track(const char* clip, const CameraModel& camera,
           const std::vector<platform::StampedPose>& truth, const bench::PictureFault& fault) {
  bench::LumaReader reader(clip);
  slam::SlamSettings settings;
  settings.trajectory_frames = 100000;
  slam::SlamSystem slam(camera, settings, slam::MappingMode::Lockstep);
  std::mt19937 random(1);
  std::vector<platform::StampedPose> path;
  GrayView view;
  for (int frame = 0; !(view = reader.next()).empty(); ++frame) {
    cv::Mat picture(view.height, view.width, CV_8U);
    for (int y = 0; y < view.height; ++y)
      std::memcpy(picture.ptr(y), view.row(y), static_cast<std::size_t>(view.width));
    fault.apply(picture, frame, random);
    const double time_s = frame / (camera.fps > 0 ? camera.fps : 30);
    slam.track({picture.data, view.width, view.height, view.width}, frame, time_s);
  }
  for (const slam::StampedPose& p : slam.correctedTrajectory())
    path.push_back({p.timestamp_s, p.T_world_camera.t, p.T_world_camera.quaternion()});
  const platform::TrajectoryError error = platform::compareTrajectories(truth, path);
  std::printf("%-16s tracked %5.1f %%  lost %d  maps %d  ATE %.3g\n", fault.name,
              error.tracked_percent, slam.statistics().lost_events, slam.statistics().maps,
              error.ate_rmse);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 1 && argc != 4) {
    std::fprintf(stderr, "usage: fault_bench [CLIP CAMERA GROUNDTRUTH]\n");
    return 2;
  }
  const char* clip = argc > 1 ? argv[1] : DEPTHSCOPE_SAMPLE "/video.mp4";
  try {
    const CameraModel camera =
        platform::loadCameraFile(argc > 1 ? argv[2] : DEPTHSCOPE_SAMPLE "/camera.yaml");
    const auto truth =
        platform::readTrajectory(argc > 1 ? argv[3] : DEPTHSCOPE_SAMPLE "/groundtruth.txt");
    for (const bench::PictureFault& fault : bench::pictureFaults())
      track(clip, camera, truth, fault);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "fault_bench: %s\n", e.what());
    return 2;
  }
  return 0;
}
