#include "slam/bundle_adjuster.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace depthscope::slam {
namespace {

constexpr double kMinLambda = 1e-10, kMaxLambda = 1e12;

/// Squared whitened error; infinite behind the camera.
double chi2(const Intrinsics& camera, const Pose& T_camera_world,
            const Eigen::Vector3d& point_world, const Eigen::Vector2d& pixel, double inv_sigma2) {
  const Eigen::Vector3d p = T_camera_world * point_world;
  if (!(p.z() > kMinDepth)) return std::numeric_limits<double>::infinity();
  return (camera.project(p) - pixel).squaredNorm() * inv_sigma2;
}

/// What an observation behind the camera costs: so much that no step is taken to get there, finite
/// so that one which starts there does not spoil the comparison of costs.
constexpr double kBehindCameraChi2 = 1e6;

}  // namespace

BundleAdjuster::BundleAdjuster(int max_poses, int max_points, int max_observations)
    : reduced_(max_poses) {
  poses_.reserve(max_poses);
  candidate_poses_.resize(max_poses);
  points_.reserve(max_points);
  candidate_points_.resize(max_points);
  observations_.reserve(max_observations);
  block_of_pose_.resize(max_poses);
  first_term_.resize(max_points + 1);
  terms_.resize(max_observations);
  W_.resize(max_observations);
  point_blocks_.resize(max_points);
  point_step_.resize(max_points);
  pose_H_.resize(max_poses);
  pose_b_.resize(max_poses);
  pose_step_.resize(max_poses);
  eliminated_.resize(max_poses);
  border_.resize(max_poses);
  border_solved_.resize(max_poses);
}

std::size_t BundleAdjuster::bytes() const {
  const auto of = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
  return of(poses_) + of(candidate_poses_) + of(points_) + of(candidate_points_) +
         of(observations_) + of(block_of_pose_) + of(first_term_) + of(terms_) + of(W_) +
         of(point_blocks_) + of(point_step_) + of(pose_H_) + of(pose_b_) + of(pose_step_) +
         of(eliminated_) + of(border_) + of(border_solved_) + reduced_.bytes();
}

void BundleAdjuster::clear() {
  poses_.clear();
  points_.clear();
  observations_.clear();
}

int BundleAdjuster::addPose(const Pose& T_camera_world, bool fixed) {
  if (poses_.size() == poses_.capacity()) return -1;
  poses_.push_back({T_camera_world, fixed});
  return static_cast<int>(poses_.size()) - 1;
}

int BundleAdjuster::addPoint(const Eigen::Vector3d& point_world) {
  if (points_.size() == points_.capacity()) return -1;
  points_.push_back(point_world);
  return static_cast<int>(points_.size()) - 1;
}

int BundleAdjuster::addObservation(const BaObservation& observation) {
  assert(observation.pose >= 0 && observation.pose < static_cast<int>(poses_.size()));
  assert(observation.point >= 0 && observation.point < static_cast<int>(points_.size()));
  if (observations_.size() == observations_.capacity()) return -1;
  observations_.push_back(observation);
  return static_cast<int>(observations_.size()) - 1;
}

BaSummary BundleAdjuster::solve(const Intrinsics& camera, const BaSettings& settings,
                                const std::atomic<bool>* stop) {
  BaSummary summary;
  indexProblem();
  const double huber_delta = std::sqrt(settings.chi2_inlier);
  summary.initial_cost = summary.final_cost = cost(camera, huber_delta, poses_, points_);
  if (first_term_[points_.size()] == 0 || !std::isfinite(summary.initial_cost)) {
    classify(camera, settings.chi2_inlier, summary);
    return summary;
  }
  summary.end = BaSummary::End::IterationLimit;

  double lambda = settings.initial_lambda, growth = 2;
  bool linearized = false;
  while (summary.iterations < settings.max_iterations) {
    if (stop && stop->load(std::memory_order_relaxed)) {
      summary.end = BaSummary::End::Stopped;
      break;
    }
    if (!linearized) linearize(camera, huber_delta);
    linearized = true;
    ++summary.iterations;

    double decrease = -1, predicted = 0;
    if (computeStep(lambda)) {
      predicted = predictedDecrease(lambda);
      applyStep();
      decrease =
          summary.final_cost - cost(camera, huber_delta, candidate_poses_, candidate_points_);
    }
    if (decrease > 0) {
      std::copy_n(candidate_poses_.begin(), poses_.size(), poses_.begin());
      std::copy_n(candidate_points_.begin(), points_.size(), points_.begin());
      const bool converged = decrease <= settings.min_relative_decrease * summary.final_cost;
      summary.final_cost -= decrease;
      if (converged) {
        summary.end = BaSummary::End::Converged;
        break;
      }
      // Nielsen's rule: the better the model foretold the decrease, the less damping.
      const double gain = 2 * decrease / predicted - 1;
      lambda = std::max(kMinLambda, lambda * std::max(1.0 / 3, 1 - gain * gain * gain));
      growth = 2;
      linearized = false;
    } else {
      lambda *= growth;
      growth *= 2;
      if (lambda > kMaxLambda || predicted < 0 ||
          (predicted > 0 && predicted <= settings.min_relative_decrease * summary.final_cost)) {
        summary.end = BaSummary::End::Converged;
        break;
      }
    }
  }
  classify(camera, settings.chi2_inlier, summary);
  return summary;
}

void BundleAdjuster::indexProblem() {
  free_poses_ = 0;
  for (std::size_t i = 0; i < poses_.size(); ++i)
    block_of_pose_[i] = poses_[i].fixed ? -1 : free_poses_++;

  // Counting sort by point, stable; points seen too seldom get no terms.
  const auto points = points_.size();
  std::fill_n(first_term_.begin(), points + 1, 0);
  for (const BaObservation& o : observations_)
    if (o.inlier) ++first_term_[o.point];
  std::int32_t sum = 0;
  for (std::size_t p = 0; p < points; ++p) {
    const std::int32_t count = first_term_[p];
    first_term_[p] = count < kMinTermsOfPoint ? -1 : sum;
    if (count >= kMinTermsOfPoint) sum += count;
  }
  for (const BaObservation& o : observations_) {
    if (!o.inlier || first_term_[o.point] < 0) continue;
    terms_[first_term_[o.point]++] = {o.pixel.cast<double>(), o.inv_sigma2, o.pose,
                                      block_of_pose_[o.pose], o.shift};
  }
  // Each entry has moved on to the end of its point: shift it back to the beginning.
  std::int32_t begin = 0;
  for (std::size_t p = 0; p < points; ++p) {
    const std::int32_t end = std::max(begin, first_term_[p]);
    first_term_[p] = begin;
    begin = end;
  }
  first_term_[points] = begin;
}

void BundleAdjuster::linearize(const Intrinsics& camera, double huber_delta) {
  std::fill_n(pose_H_.begin(), free_poses_, Matrix6d::Zero());
  std::fill_n(pose_b_.begin(), free_poses_, Vector6d::Zero());
  for (int p = 0; p < static_cast<int>(points_.size()); ++p) linearizePoint(camera, huber_delta, p);
}

void BundleAdjuster::linearizePoint(const Intrinsics& camera, double huber_delta, int point) {
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  for (int t = first_term_[point]; t < first_term_[point + 1]; ++t) {
    const Term& term = terms_[t];
    const Pose& T_camera_world = poses_[term.pose].T_camera_world;
    const Eigen::Vector3d p = T_camera_world * points_[point];
    if (!(p.z() > kMinDepth)) {
      W_[t].setZero();
      continue;
    }
    const Eigen::Vector2d r = camera.project(p) - term.pixel;
    const double weight =
        term.inv_sigma2 * huberWeight(r.squaredNorm() * term.inv_sigma2, huber_delta);
    const Eigen::Matrix<double, 2, 3> Jp =
        pointJacobian(projectionJacobian(camera, p), T_camera_world.R);
    const Eigen::Matrix<double, 2, 3> wJp = weight * Jp;
    H.noalias() += Jp.transpose() * wJp;
    b.noalias() -= wJp.transpose() * r;
    if (term.block < 0) continue;
    const Eigen::Matrix<double, 2, 6> Jc = poseJacobian(camera, p);
    W_[t].noalias() = Jc.transpose() * wJp;
    pose_H_[term.block].noalias() += Jc.transpose() * (weight * Jc);
    pose_b_[term.block].noalias() -= Jc.transpose() * (weight * r);
  }
  point_blocks_[point].H = H;
  point_blocks_[point].b = b;
}

bool BundleAdjuster::computeStep(double lambda) {
  reduced_.reset(free_poses_);
  for (int i = 0; i < free_poses_; ++i) {
    reduced_.block(i, i) = pose_H_[i];
    reduced_.block(i, i).diagonal() += lambda * pose_H_[i].diagonal();
    pose_step_[i] = pose_b_[i];
  }
  for (int p = 0; p < static_cast<int>(points_.size()); ++p) eliminatePoint(p, lambda);
  if (!reduced_.factor()) return false;
  reduced_.solve({pose_step_.data(), static_cast<std::size_t>(free_poses_)});
  backSubstitute();
  return true;
}

void BundleAdjuster::eliminatePoint(int point, double lambda) {
  PointBlock& block = point_blocks_[point];
  Eigen::Matrix3d damped = block.H;
  damped.diagonal() += lambda * block.H.diagonal();
  block.L_inv = inverseCholeskyFactor(damped);
  const Eigen::Vector3d b = block.L_inv * block.b;

  // With Y = W L^-T the Schur complement is what is left after subtracting Y_i Y_j^T everywhere.
  const int begin = first_term_[point];
  const int end = std::min(first_term_[point + 1], begin + static_cast<int>(eliminated_.size()));
  for (int i = begin; i < end; ++i) {
    const int row = terms_[i].block;
    if (row < 0) continue;
    Matrix63& Y = eliminated_[i - begin];
    Y.noalias() = W_[i] * block.L_inv.transpose();
    pose_step_[row].noalias() -= Y * b;
    for (int j = begin; j <= i; ++j) {
      const int column = terms_[j].block;
      if (column < 0) continue;
      if (column <= row)
        reduced_.block(row, column).noalias() -= Y * eliminated_[j - begin].transpose();
      else
        reduced_.block(column, row).noalias() -= eliminated_[j - begin] * Y.transpose();
    }
  }
}

void BundleAdjuster::backSubstitute() {
  for (int p = 0; p < static_cast<int>(points_.size()); ++p) {
    const PointBlock& block = point_blocks_[p];
    Eigen::Vector3d b = block.b;
    for (int t = first_term_[p]; t < first_term_[p + 1]; ++t)
      if (terms_[t].block >= 0) b.noalias() -= W_[t].transpose() * pose_step_[terms_[t].block];
    point_step_[p].noalias() = block.L_inv.transpose() * (block.L_inv * b);
  }
}

double BundleAdjuster::predictedDecrease(double lambda) const {
  double sum = 0;
  for (int i = 0; i < free_poses_; ++i)
    sum += pose_step_[i].dot(pose_b_[i]) +
           lambda * pose_step_[i].cwiseAbs2().dot(pose_H_[i].diagonal());
  for (std::size_t p = 0; p < points_.size(); ++p)
    sum += point_step_[p].dot(point_blocks_[p].b) +
           lambda * point_step_[p].cwiseAbs2().dot(point_blocks_[p].H.diagonal());
  return sum;
}

void BundleAdjuster::applyStep() {
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    candidate_poses_[i] = poses_[i];
    if (block_of_pose_[i] < 0) continue;
    const Vector6d& step = pose_step_[block_of_pose_[i]];
    candidate_poses_[i].T_camera_world =
        poses_[i].T_camera_world.retract(step.head<3>(), step.tail<3>());
  }
  for (std::size_t p = 0; p < points_.size(); ++p)
    candidate_points_[p] = points_[p] + point_step_[p];
}

double BundleAdjuster::cost(const Intrinsics& camera, double huber_delta,
                            std::span<const BaPose> poses,
                            std::span<const Eigen::Vector3d> points) const {
  double sum = 0;
  for (std::size_t p = 0; p < points_.size(); ++p) {
    for (int t = first_term_[p]; t < first_term_[p + 1]; ++t) {
      const Term& term = terms_[t];
      const double e2 =
          chi2(camera, poses[term.pose].T_camera_world, points[p], term.pixel, term.inv_sigma2);
      sum += huberCost(std::min(e2, kBehindCameraChi2), huber_delta);
    }
  }
  return sum;
}

void BundleAdjuster::classify(const Intrinsics& camera, double chi2_inlier, BaSummary& summary) {
  double sum = 0;
  for (BaObservation& o : observations_) {
    const double e2 = chi2(camera, poses_[o.pose].T_camera_world, points_[o.point],
                           o.pixel.cast<double>(), o.inv_sigma2);
    o.inlier = e2 <= chi2_inlier;
    if (o.inlier) sum += e2;
    ++(o.inlier ? summary.inliers : summary.outliers);
  }
  summary.rms_px = summary.inliers > 0 ? std::sqrt(sum / summary.inliers) : 0;
}

}  // namespace depthscope::slam
