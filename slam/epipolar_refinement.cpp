#include "slam/epipolar_refinement.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "slam/projection.hpp"

namespace depthscope::slam {
namespace {

using Matrix5d = Eigen::Matrix<double, 5, 5>;
using Vector5d = Eigen::Matrix<double, 5, 1>;

constexpr double kConvergedStep = 1e-7;  // [rad]: less than a thousandth of a pixel

/// Two directions across t, in which it moves on the unit sphere.
Eigen::Matrix<double, 3, 2> tangents(const Eigen::Vector3d& t) {
  Eigen::Matrix<double, 3, 2> B;
  B.col(0) = t.unitOrthogonal();
  B.col(1) = t.cross(B.col(0));
  return B;
}

struct NormalEquations {
  Matrix5d H = Matrix5d::Zero();
  Vector5d b = Vector5d::Zero();
  double cost = 0;
};

/// 1 / (variance of the residual for unit noise in the pixels): Sampson's denominator.
double inverseVariance(const Intrinsics& camera, const Eigen::Matrix3d& E,
                       const Eigen::Vector3d& x1, const Eigen::Vector3d& x2) {
  const Eigen::Vector3d l2 = E * x1, l1 = E.transpose() * x2;
  const double ax = l2.x() / camera.fx, ay = l2.y() / camera.fy;
  const double bx = l1.x() / camera.fx, by = l1.y() / camera.fy;
  return 1 / (ax * ax + ay * ay + bx * bx + by * by);
}

NormalEquations accumulate(const TwoViewMatches& m, std::span<const std::uint8_t> selected,
                           double sigma_px, const Pose& T_second_first) {
  const Eigen::Matrix3d E = skew(T_second_first.t) * T_second_first.R;
  const Eigen::Matrix<double, 3, 2> B = tangents(T_second_first.t);
  const double delta = std::sqrt(kChi2OneDof95);
  NormalEquations n;
  for (int i = 0; i < m.size(); ++i) {
    if (!selected[i]) continue;
    const double r = epipolarResidual(T_second_first, m.first[i], m.second[i]);
    const double information =
        inverseVariance(m.camera, E, m.first[i].homogeneous(), m.second[i].homogeneous()) /
        (sigma_px * sigma_px);
    const double chi2 = r * r * information;
    if (!std::isfinite(chi2)) continue;
    const double w = information * huberWeight(chi2, delta);
    const auto J6 = epipolarJacobian(T_second_first, m.first[i], m.second[i]);
    Vector5d J;
    J << J6.head<3>().transpose(), (J6.tail<3>() * B).transpose();
    n.H.noalias() += J * (w * J.transpose());
    n.b.noalias() -= J * (w * r);
    n.cost += huberCost(chi2, delta);
  }
  return n;
}

/// What accumulate() would give for the cost alone.
double cost(const TwoViewMatches& m, std::span<const std::uint8_t> selected, double sigma_px,
            const Pose& T_second_first) {
  const Eigen::Matrix3d E = skew(T_second_first.t) * T_second_first.R;
  const double delta = std::sqrt(kChi2OneDof95);
  const double fx2 = 1 / (m.camera.fx * m.camera.fx), fy2 = 1 / (m.camera.fy * m.camera.fy);
  const double inv_sigma2 = 1 / (sigma_px * sigma_px);
  double sum = 0;
  for (int i = 0; i < m.size(); ++i) {
    if (!selected[i]) continue;
    const Eigen::Vector3d x1 = m.first[i].homogeneous(), x2 = m.second[i].homogeneous();
    const Eigen::Vector3d l2 = E * x1;
    const Eigen::Vector2d l1 = E.leftCols<2>().transpose() * x2;
    const double r = x2.dot(l2);
    const double variance =
        fx2 * (l2.x() * l2.x() + l1.x() * l1.x()) + fy2 * (l2.y() * l2.y() + l1.y() * l1.y());
    const double chi2 = r * r * inv_sigma2 / variance;
    if (std::isfinite(chi2)) sum += huberCost(chi2, delta);
  }
  return sum;
}

double directionDeviation(const Matrix5d& H) {
  const Eigen::LDLT<Matrix5d> ldlt(H);
  const Matrix5d covariance = ldlt.solve(Matrix5d::Identity());
  const double variance = covariance(3, 3) + covariance(4, 4);
  const bool determined = ldlt.info() == Eigen::Success && ldlt.isPositive() && variance > 0;
  return determined ? std::sqrt(variance) : std::numeric_limits<double>::infinity();
}

}  // namespace

double epipolarResidual(const Pose& T_second_first, const Eigen::Vector2d& first,
                        const Eigen::Vector2d& second) {
  const Eigen::Vector3d x1 = first.homogeneous(), x2 = second.homogeneous();
  return x2.dot(T_second_first.t.cross(T_second_first.R * x1));
}

Eigen::Matrix<double, 1, 6> epipolarJacobian(const Pose& T_second_first,
                                             const Eigen::Vector2d& first,
                                             const Eigen::Vector2d& second) {
  const Eigen::Vector3d x1 = first.homogeneous(), x2 = second.homogeneous();
  const Eigen::Vector3d y = T_second_first.R * x1;
  Eigen::Matrix<double, 1, 6> J;
  J << y.cross(x2.cross(T_second_first.t)).transpose(), y.cross(x2).transpose();
  return J;
}

double refineEpipolarGeometry(const TwoViewMatches& matches, std::span<const std::uint8_t> selected,
                              double sigma_px, int iterations, Pose& T_second_first) {
  double lambda = 1e-6;
  NormalEquations n = accumulate(matches, selected, sigma_px, T_second_first);
  for (int i = 0; i < iterations; ++i) {
    Matrix5d damped = n.H;
    damped.diagonal() *= 1 + lambda;
    const Vector5d step = damped.ldlt().solve(n.b);
    if (!step.allFinite()) break;
    const Pose candidate{
        expSO3(step.head<3>()) * T_second_first.R,
        (T_second_first.t + tangents(T_second_first.t) * step.tail<2>()).normalized()};
    const bool converged = step.norm() < kConvergedStep;
    // Most steps are refused: the equations are set up anew only for one that is not.
    if (cost(matches, selected, sigma_px, candidate) <= n.cost) {
      T_second_first = candidate;
      n = accumulate(matches, selected, sigma_px, candidate);
      lambda = std::max(lambda / 10, 1e-12);
    } else {
      lambda *= 10;
    }
    if (converged) break;
  }
  return directionDeviation(n.H);
}

}  // namespace depthscope::slam
