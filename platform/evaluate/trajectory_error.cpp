#include "platform/evaluate/trajectory_error.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <set>
#include <sstream>
#include <string>

#include "types/error.hpp"

namespace depthscope::platform {
namespace {

constexpr double kMaxTimeDifference_s = 0.012;  // a third of a frame at 30/s
constexpr std::size_t kMinPoses = 10;           // fewer cannot be judged
constexpr std::size_t kRotationStride = 5;      // rotations are compared on every fifth pose

bool finite(const StampedPose& p) {
  return std::isfinite(p.timestamp_s) && p.position.allFinite() &&
         p.orientation.coeffs().allFinite();
}

/// Index of the pose of `truth` (sorted by time) nearest in time.
std::size_t nearestInTime(std::span<const StampedPose> truth, double timestamp_s) {
  const auto after =
      std::lower_bound(truth.begin(), truth.end(), timestamp_s,
                       [](const StampedPose& p, double t) { return p.timestamp_s < t; });
  const auto i = static_cast<std::size_t>(after - truth.begin());
  if (i == 0) return 0;
  if (i == truth.size()) return i - 1;
  const bool earlier = timestamp_s - truth[i - 1].timestamp_s <= truth[i].timestamp_s - timestamp_s;
  return earlier ? i - 1 : i;
}

double rootMeanSquare(const std::vector<double>& values) {
  double sum = 0;
  for (double v : values) sum += v * v;
  return values.empty() ? 0 : std::sqrt(sum / static_cast<double>(values.size()));
}

Eigen::Vector3d mean(std::span<const Eigen::Vector3d> points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& p : points) sum += p;
  return sum / static_cast<double>(points.size());
}

}  // namespace

std::vector<StampedPose> readTrajectory(const std::filesystem::path& path) {
  std::ifstream in(path);
  if (!in) throw InputError(path.string() + ": cannot be opened for reading");
  std::vector<StampedPose> poses;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (line.find_first_not_of(" \t\r") == std::string::npos || line.starts_with('#')) continue;
    // By strtod, not a stream: a stream refuses "nan", which is a pose that was not tracked.
    const char* at = line.c_str();
    std::array<double, 8> v{};
    for (double& value : v) {
      char* end = nullptr;
      value = std::strtod(at, &end);
      if (end == at)
        throw InputError(path.string() + ":" + std::to_string(number) +
                         ": expected 'timestamp tx ty tz qx qy qz qw'");
      at = end;
    }
    poses.push_back(
        {v[0], {v[1], v[2], v[3]}, Eigen::Quaterniond(v[7], v[4], v[5], v[6]).normalized()});
  }
  std::stable_sort(poses.begin(), poses.end(), [](const StampedPose& a, const StampedPose& b) {
    return a.timestamp_s < b.timestamp_s;
  });
  return poses;
}

Similarity alignSimilarity(std::span<const Eigen::Vector3d> from,
                           std::span<const Eigen::Vector3d> to) {
  const Eigen::Vector3d from_mean = mean(from), to_mean = mean(to);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double variance = 0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const Eigen::Vector3d x = from[i] - from_mean;
    covariance += (to[i] - to_mean) * x.transpose();
    variance += x.squaredNorm();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d sign = Eigen::Vector3d::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0) sign.z() = -1;
  Similarity s;
  s.R = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
  s.scale = variance > 0 ? svd.singularValues().dot(sign) / variance : 1;
  s.t = to_mean - s.scale * (s.R * from_mean);
  return s;
}

TrajectoryError compareTrajectories(std::span<const StampedPose> truth,
                                    std::span<const StampedPose> estimate) {
  TrajectoryError out;
  out.frames = truth.size();
  if (truth.empty()) return out;
  for (std::size_t i = 1; i < truth.size(); ++i)
    out.path_length += (truth[i].position - truth[i - 1].position).norm();

  std::vector<const StampedPose*> matched;
  for (const StampedPose& pose : estimate) {
    if (!finite(pose)) continue;
    const std::size_t i = nearestInTime(truth, pose.timestamp_s);
    if (std::abs(truth[i].timestamp_s - pose.timestamp_s) >= kMaxTimeDifference_s) continue;
    matched.push_back(&pose);
    out.truth_index.push_back(i);
  }
  const std::set<std::size_t> tracked(out.truth_index.begin(), out.truth_index.end());
  out.tracked_percent =
      100. * static_cast<double>(tracked.size()) / static_cast<double>(truth.size());
  if (matched.size() < kMinPoses) return out;

  std::vector<Eigen::Vector3d> from, to;
  for (std::size_t i = 0; i < matched.size(); ++i) {
    from.push_back(matched[i]->position);
    to.push_back(truth[out.truth_index[i]].position);
  }
  out.T_truth_estimate = alignSimilarity(from, to);
  std::vector<double> rotation_deg;
  for (std::size_t i = 0; i < matched.size(); ++i) {
    out.aligned.push_back(out.T_truth_estimate * from[i]);
    out.error.push_back((out.aligned.back() - to[i]).norm());
    if (i % kRotationStride != 0) continue;
    const Eigen::Quaterniond q(out.T_truth_estimate.R * matched[i]->orientation.toRotationMatrix());
    rotation_deg.push_back(q.angularDistance(truth[out.truth_index[i]].orientation) * 180 /
                           std::numbers::pi);
  }
  out.ate_rmse = rootMeanSquare(out.error);
  out.rotation_rmse_deg = rootMeanSquare(rotation_deg);
  return out;
}

}  // namespace depthscope::platform
