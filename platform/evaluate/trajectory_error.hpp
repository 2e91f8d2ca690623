#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <filesystem>
#include <span>
#include <vector>

namespace depthscope::platform {

/// One line of a TUM trajectory file: the camera in the world.
struct StampedPose {
  double timestamp_s = 0;
  Eigen::Vector3d position;        // of the camera, world frame
  Eigen::Quaterniond orientation;  // R_world_camera
};

/// Reads a TUM file: `timestamp tx ty tz qx qy qz qw` a line, `#` starts a comment. Throws
/// InputError naming the file and line.
std::vector<StampedPose> readTrajectory(const std::filesystem::path& path);

/// p -> scale * R * p + t.
struct Similarity {
  double scale = 1;
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d t = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator*(const Eigen::Vector3d& p) const { return scale * (R * p) + t; }
};

/// Least-squares similarity that takes `from` onto `to` (Umeyama 1991). At least three points each.
Similarity alignSimilarity(std::span<const Eigen::Vector3d> from,
                           std::span<const Eigen::Vector3d> to);

/// An estimated trajectory against the truth, aligned by a similarity: a monocular map has no
/// scale.
struct TrajectoryError {
  std::size_t frames = 0;                // of the truth
  std::vector<std::size_t> truth_index;  // of each matched estimate, into the truth
  std::vector<Eigen::Vector3d> aligned;  // matched camera positions in the world of the truth
  std::vector<double> error;             // distance of each to the truth [unit of the truth]
  Similarity T_truth_estimate;
  double tracked_percent = 0;
  double ate_rmse = 0;  // [unit of the truth]
  double rotation_rmse_deg = 0;
  double path_length = 0;  // of the true camera

  /// Too few matched poses to be aligned: only `frames` and `tracked_percent` mean something.
  bool empty() const { return aligned.empty(); }
};

/// Matches poses by time and aligns them. Poses that are not finite or match no time of the truth
/// count as not tracked.
TrajectoryError compareTrajectories(std::span<const StampedPose> truth,
                                    std::span<const StampedPose> estimate);

}  // namespace depthscope::platform
