#include "slam/shape_problem.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>

namespace depthscope::slam {
namespace {

constexpr double kShapeSigma = 0.03;  // relative change of lengths that is no surprise
constexpr double kDamping = 1e-6;  // relative: nothing holds place, direction and scale of it all

/// The median along each axis; zero of none.
Eigen::Vector3d middleOf(std::span<const Eigen::Vector3d> points) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  if (points.empty()) return middle;
  std::vector<double> sorted(points.size());
  for (int axis = 0; axis < 3; ++axis) {
    std::transform(points.begin(), points.end(), sorted.begin(),
                   [&](const Eigen::Vector3d& p) { return p[axis]; });
    const auto half = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), half, sorted.end());
    middle[axis] = *half;
  }
  return middle;
}

}  // namespace

ShapeProblem::ShapeProblem(const Intrinsics& camera, std::span<const TimedView> views,
                           std::span<const Eigen::Vector3d> points,
                           std::span<const BaObservation> observations)
    : camera_(camera),
      views_(views),
      n_(static_cast<int>(views.size())),
      middle_(middleOf(points)),
      H_poses_(Eigen::MatrixXd::Zero(6 * n_, 6 * n_)),
      H_mixed_(Eigen::MatrixXd::Zero(6 * n_, kShapes * n_)),
      H_shapes_(Eigen::MatrixXd::Zero(kShapes * n_, kShapes * n_)),
      b_poses_(Eigen::VectorXd::Zero(6 * n_)),
      b_shapes_(Eigen::VectorXd::Zero(kShapes * n_)),
      held_(views.size(), Block::Zero()) {
  for (std::size_t begin = 0, end = 0; begin < observations.size(); begin = end) {
    const int point = observations[begin].point;
    while (end < observations.size() && observations[end].point == point) ++end;
    addPoint(points[point], observations.subspan(begin, end - begin));
  }
}

bool ShapeProblem::eliminatePoses() {
  H_poses_.diagonal() *= 1 + kDamping;
  Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> llt(H_poses_);
  if (llt.info() != Eigen::Success) return false;
  llt.matrixL().solveInPlace(H_mixed_);
  llt.matrixL().solveInPlace(b_poses_);
  H_shapes_.noalias() -= H_mixed_.transpose() * H_mixed_;
  b_shapes_.noalias() -= H_mixed_.transpose() * b_poses_;
  return true;
}

ShapeRhythm ShapeProblem::fit(double frequency_hz, double& gain) const {
  using Rhythm = Eigen::Matrix<double, 2 * kShapes, 1>;  // cosine, sine
  Eigen::MatrixXd basis = Eigen::MatrixXd::Zero(kShapes * n_, 2 * kShapes);
  for (int i = 0; i < n_; ++i) {
    const Eigen::Vector2d p = phasor(frequency_hz, views_[i].timestamp_s);
    basis.block<kShapes, kShapes>(kShapes * i, 0).diagonal().setConstant(p.x());
    basis.block<kShapes, kShapes>(kShapes * i, kShapes).diagonal().setConstant(p.y());
  }
  Eigen::Matrix<double, 2 * kShapes, 2 * kShapes> H = basis.transpose() * (H_shapes_ * basis);
  H.diagonal().array() += 1 / (kShapeSigma * kShapeSigma);
  const Rhythm b = basis.transpose() * b_shapes_;
  const Eigen::LDLT<decltype(H)> ldlt(H);
  const Rhythm x = ldlt.solve(b);
  gain = 0;
  if (ldlt.info() != Eigen::Success || !x.allFinite()) return {frequency_hz};
  const double noise = cost_ / (2 * terms_);  // variance of one of a term's two coordinates
  gain = b.dot(x) / (2 * kShapes * noise);
  return {frequency_hz, x.head<kShapes>(), x.tail<kShapes>()};
}

std::vector<PoseResponse> ShapeProblem::responses(const ShapeRhythm& rhythm) const {
  Eigen::VectorXd shapes(kShapes * n_);
  for (int i = 0; i < n_; ++i)
    shapes.segment<kShapes>(kShapes * i) = rhythm.at(views_[i].timestamp_s);
  Eigen::VectorXd poses = -(H_mixed_ * shapes);
  H_poses_.triangularView<Eigen::Lower>().transpose().solveInPlace(poses);
  std::vector<PoseResponse> responses(views_.size());
  for (int i = 0; i < n_; ++i) {
    const Block& H = held_[i];
    const Matrix6d H_pose = H.topLeftCorner<6, 6>() + kDamping * Matrix6d::Identity();
    PoseResponse& r = responses[i];
    r.change = -H_pose.ldlt().solve(H.topRightCorner<6, kShapes>().eval());
    r.offset = poses.segment<6>(6 * i) - r.change * shapes.segment<kShapes>(kShapes * i);
  }
  return responses;
}

/// How a point moves with each of the shapes.
Eigen::Matrix<double, 3, kShapes> ShapeProblem::motionWithShapes(
    const Eigen::Vector3d& point) const {
  const Eigen::Vector3d d = point - middle_;
  Eigen::Matrix<double, 3, kShapes> M;
  M << d.x(), d.x(), d.y(), d.z(), 0,  //
      -d.y(), d.y(), d.x(), 0, d.z(),  //
      0, -2 * d.z(), 0, d.x(), d.y();
  return M;
}

void ShapeProblem::addPoint(const Eigen::Vector3d& point,
                            std::span<const BaObservation> observations) {
  if (observations.size() < kMinTermsOfPoint) return;
  const Eigen::Matrix<double, 3, kShapes> M = motionWithShapes(point);
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  seen_.clear();
  for (const BaObservation& o : observations) {
    const Pose& T = views_[o.pose].T_camera_world;
    const Eigen::Vector3d p = T * point;
    if (!(p.z() > kMinDepth)) continue;
    const Eigen::Vector2d r = camera_.project(p) - o.pixel.cast<double>();
    const double chi2 = r.squaredNorm() * o.inv_sigma2, delta = std::sqrt(kChi2TwoDof95);
    const double w = o.inv_sigma2 * huberWeight(chi2, delta);
    cost_ += huberCost(chi2, delta);
    ++terms_;
    const Eigen::Matrix<double, 2, 3> Jp = pointJacobian(projectionJacobian(camera_, p), T.R);
    Eigen::Matrix<double, 2, kBlock> J;
    J << poseJacobian(camera_, p), Jp * M;
    H.noalias() += Jp.transpose() * (w * Jp);
    b.noalias() -= Jp.transpose() * (w * r);
    seen_.push_back({o.pose, J.transpose() * (w * Jp)});
    const Block own = J.transpose() * (w * J);
    held_[o.pose] += own;
    add(o.pose, o.pose, own);
    add(o.pose, -(J.transpose() * (w * r)));
  }
  H.diagonal() *= 1 + kDamping;
  Eigen::Matrix3d H_inverse;
  bool invertible = false;
  H.computeInverseWithCheck(H_inverse, invertible, 0);
  if (!invertible) return;
  for (const Term& i : seen_) {
    const Eigen::Matrix<double, kBlock, 3> W = i.W * H_inverse;
    add(i.view, -(W * b));
    for (const Term& j : seen_) add(i.view, j.view, -(W * j.W.transpose()));
  }
}

void ShapeProblem::add(int i, int j, const Block& block) {
  H_poses_.block<6, 6>(6 * i, 6 * j) += block.topLeftCorner<6, 6>();
  H_mixed_.block<6, kShapes>(6 * i, kShapes * j) += block.topRightCorner<6, kShapes>();
  H_shapes_.block<kShapes, kShapes>(kShapes * i, kShapes * j) +=
      block.bottomRightCorner<kShapes, kShapes>();
}

void ShapeProblem::add(int i, const Eigen::Matrix<double, kBlock, 1>& b) {
  b_poses_.segment<6>(6 * i) += b.head<6>();
  b_shapes_.segment<kShapes>(kShapes * i) += b.tail<kShapes>();
}

}  // namespace depthscope::slam
