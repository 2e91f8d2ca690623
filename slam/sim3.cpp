#include "slam/sim3.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <array>
#include <cmath>

namespace depthscope::slam {

namespace {

/// sin(x) / x.
double sinc(double x) {
  return std::abs(x) < 1e-4 ? 1 - x * x / 6 : std::sin(x) / x;
}

/// Integral of exp(tau (sigma I + [w]x)) over tau in 0..1: takes the v of a tangent vector to the
/// translation of its exponential. By Gauss and Legendre with eight nodes, which is good to 1e-13
/// for |w| <= pi and needs no care where w or sigma vanish.
Eigen::Matrix3d translationMatrix(const Eigen::Vector3d& w, double sigma) {
  constexpr std::array<double, 4> kNode{0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                        0.9602898564975363};
  constexpr std::array<double, 4> kWeight{0.3626837833783620, 0.3137066458778873,
                                          0.2223810344533745, 0.1012285362903763};
  const double angle = w.norm();
  double a = 0, b = 0, c = 0;  // of I, [w]x and [w]x^2 in Rodrigues' formula
  for (int i = 0; i < 8; ++i) {
    const double tau = 0.5 * (1 + (i < 4 ? -kNode[i] : kNode[i - 4]));
    const double weight = 0.5 * kWeight[i % 4] * std::exp(sigma * tau);
    const double half = sinc(angle * tau / 2);
    a += weight;
    b += weight * tau * sinc(angle * tau);
    c += weight * tau * tau * half * half / 2;
  }
  const Eigen::Matrix3d W = skew(w);
  return a * Eigen::Matrix3d::Identity() + b * W + c * W * W;
}

/// ad_x y = [x, y], the Lie bracket.
Matrix7d bracket(const Vector7d& x) {
  const Eigen::Vector3d w = x.head<3>(), v = x.segment<3>(3);
  Matrix7d ad = Matrix7d::Zero();
  ad.block<3, 3>(0, 0) = skew(w);
  ad.block<3, 3>(3, 0) = skew(v);
  ad.block<3, 3>(3, 3) = skew(w) + x(6) * Eigen::Matrix3d::Identity();
  ad.block<3, 1>(3, 6) = -v;
  return ad;
}

}  // namespace

Sim3 expSim3(const Vector7d& tangent) {
  const Eigen::Vector3d w = tangent.head<3>(), v = tangent.segment<3>(3);
  return {std::exp(tangent(6)), expSO3(w), translationMatrix(w, tangent(6)) * v};
}

Vector7d logSim3(const Sim3& T) {
  Vector7d x;
  const Eigen::Vector3d w = logSO3(T.R);
  x << w, Eigen::Vector3d::Zero(), std::log(T.s);
  x.segment<3>(3) = translationMatrix(w, x(6)).inverse() * T.t;
  return x;
}

Matrix7d adjoint(const Sim3& T) {
  Matrix7d Ad = Matrix7d::Zero();
  Ad.block<3, 3>(0, 0) = T.R;
  Ad.block<3, 3>(3, 0) = skew(T.t) * T.R;
  Ad.block<3, 3>(3, 3) = T.s * T.R;
  Ad.block<3, 1>(3, 6) = -T.t;
  Ad(6, 6) = 1;
  return Ad;
}

Matrix7d leftJacobianInverse(const Vector7d& x) {
  // Bernoulli's numbers over the factorials: x / (1 - exp(-x)) with the sign of the left Jacobian.
  const Matrix7d ad = bracket(x);
  const Matrix7d ad2 = ad * ad;
  const Matrix7d ad4 = ad2 * ad2;
  return Matrix7d::Identity() - 0.5 * ad + ad2 / 12 - ad4 / 720 + ad4 * ad2 / 30240;
}

}  // namespace depthscope::slam
