#pragma once
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "slam/slam_system.hpp"
#include "tests/slam/synthetic_map.hpp"

namespace depthscope::slam::testing {

/// A textured plane at z = 1 (world), tilted a little, as a camera sees it.
class PlaneWorld {
 public:
  explicit PlaneWorld(int seed = 4) {
    cv::RNG rng(static_cast<std::uint64_t>(seed));
    cv::Mat noise(220, 220, CV_8U);
    rng.fill(noise, cv::RNG::UNIFORM, 30, 220);
    cv::resize(noise, texture_, {1800, 1800}, 0, 0, cv::INTER_CUBIC);
  }

  cv::Mat view(const Pose& T_camera_world) const {
    const CameraModel c = testCameraModel();
    const Eigen::Matrix3d H = pictureFromTexture(T_camera_world);
    cv::Mat Hcv(3, 3, CV_64F), image;
    for (int i = 0; i < 9; ++i) Hcv.at<double>(i / 3, i % 3) = H(i / 3, i % 3);
    cv::warpPerspective(texture_, image, Hcv, {c.width, c.height}, cv::INTER_LINEAR,
                        cv::BORDER_CONSTANT, 100);
    return image;
  }

  /// As a camera sees it that exposes each row at a time of its own: `T_camera_world(row)`, rows
  /// counted as shares of the picture from -0.5 to 0.5.
  template <typename PoseOfRow>
  cv::Mat rolledView(const PoseOfRow& T_camera_world) const {
    const CameraModel c = testCameraModel();
    cv::Mat from(c.height, c.width, CV_32FC2), image;
    for (int y = 0; y < c.height; ++y) {
      const Eigen::Matrix3d H =
          pictureFromTexture(T_camera_world((y + 0.5) / c.height - 0.5)).inverse();
      for (int x = 0; x < c.width; ++x) {
        const Eigen::Vector2d uv = (H * Eigen::Vector3d(x, y, 1)).hnormalized();
        from.at<cv::Vec2f>(y, x) = {static_cast<float>(uv.x()), static_cast<float>(uv.y())};
      }
    }
    cv::remap(texture_, image, from, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_CONSTANT, 100);
    return image;
  }

 private:
  /// Homography from pixels of the texture to those of the picture.
  static Eigen::Matrix3d pictureFromTexture(const Pose& T_camera_world) {
    const CameraModel c = testCameraModel();
    Eigen::Matrix3d K;
    K << c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1;
    // Texture pixel (u, v, 1) -> world point on the plane.
    Eigen::Matrix3d plane;
    const double s = 3.0 / 1800;
    plane << s, 0, -1.5, 0, s, -1.5, 0.1 * s, 0.15 * s, 0.85;
    return K * (T_camera_world.R * plane + T_camera_world.t * Eigen::RowVector3d(0, 0, 1));
  }

  cv::Mat texture_;
};

inline Pose poseAt(int frame) {
  const double s = 0.008 * frame;
  return cameraAt({s, 0.3 * s * s, 0.1 * std::sin(3 * s)}, {0.02 * s, -0.05 * s, 0.1 * s});
}

inline GrayView viewOf(const cv::Mat& m) {
  return {m.data, m.cols, m.rows, static_cast<std::ptrdiff_t>(m.step)};
}

inline SlamSettings testSettings() {
  SlamSettings s;
  s.extractor.features = s.extractor.features_at_most = 600;
  s.capacity.keyframes = 64;
  s.capacity.map_points = 8000;
  s.trajectory_frames = 200;
  return s;
}

inline std::vector<PoseEstimate> run(SlamSystem& slam, const PlaneWorld& world, int from, int to) {
  std::vector<PoseEstimate> estimates;
  for (int i = from; i < to; ++i) {
    const cv::Mat image = world.view(poseAt(i));
    estimates.push_back(slam.track(viewOf(image), i, i / 30.0));
  }
  return estimates;
}

/// Largest distance between the true path and the estimated one, first scaled to the same length;
/// both start at the same frame's camera.
template <typename PoseOfFrame = Pose(int)>
double pathError(const std::vector<PoseEstimate>& estimates, const PoseOfFrame& pose_at = poseAt) {
  std::vector<Eigen::Vector3d> mine, truth;
  Pose first_mine, first_truth;
  for (const PoseEstimate& e : estimates) {
    if (e.state != TrackingState::Tracking) continue;
    const Pose t = pose_at(static_cast<int>(e.frame));
    if (mine.empty()) {
      first_mine = e.T_camera_world;
      first_truth = t;
    }
    mine.push_back(first_mine * e.T_camera_world.inverse().t);
    truth.push_back(first_truth * t.inverse().t);
  }
  double ab = 0, aa = 0, worst = 0;
  for (std::size_t i = 0; i < mine.size(); ++i) {
    ab += mine[i].dot(truth[i]);
    aa += mine[i].squaredNorm();
  }
  for (std::size_t i = 0; i < mine.size(); ++i)
    worst = std::max(worst, (ab / aa * mine[i] - truth[i]).norm());
  return worst;
}

}  // namespace depthscope::slam::testing
