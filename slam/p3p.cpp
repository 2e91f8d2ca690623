#include "slam/p3p.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace depthscope::slam {
namespace {

constexpr int kPolishSteps = 3;

/// One real root of x^3 + b x^2 + c x + d, by Newton's method from where it converges from one
/// side.
double realRootOfCubic(double b, double c, double d) {
  const double discriminant = b * b - 3 * c;
  double x = -b / 3;
  if (discriminant > 0) {
    const double inflection = -b / 3, reach = std::sqrt(discriminant) / 3;
    const double high = inflection - reach;  // local maximum
    const double value = ((high + b) * high + c) * high + d;
    // A maximum above zero has a root to its left; one below zero leaves the only root to the right
    // of the minimum. There the curve bends one way only, and Newton's steps do not overshoot.
    x = value > 0 ? inflection - 2 * reach : inflection + 2 * reach;
  } else if (((x + b) * x + c) * x + d == 0) {
    return x;
  } else {
    x += std::cbrt(-(((x + b) * x + c) * x + d));
  }
  for (int i = 0; i < 50; ++i) {
    const double f = ((x + b) * x + c) * x + d;
    const double df = (3 * x + 2 * b) * x + c;
    if (f == 0 || df == 0) break;
    const double step = f / df;
    x -= step;
    if (std::abs(step) <= 1e-15 * std::abs(x)) break;
  }
  return x;
}

struct Constraints {
  double b12, b13, b23;  // cosines between the bearings
  double a12, a13, a23;  // squared distances between the points
};

/// Gauss-Newton on the three laws of cosines; false when the distances do not satisfy them.
bool polish(const Constraints& k, Eigen::Vector3d& l) {
  for (int i = 0; i <= kPolishSteps; ++i) {
    const Eigen::Vector3d r(l(0) * l(0) + l(1) * l(1) - 2 * k.b12 * l(0) * l(1) - k.a12,
                            l(0) * l(0) + l(2) * l(2) - 2 * k.b13 * l(0) * l(2) - k.a13,
                            l(1) * l(1) + l(2) * l(2) - 2 * k.b23 * l(1) * l(2) - k.a23);
    if (i == kPolishSteps) return r.cwiseAbs().maxCoeff() <= 1e-8 * (k.a12 + k.a13 + k.a23);
    Eigen::Matrix3d J;
    J << l(0) - k.b12 * l(1), l(1) - k.b12 * l(0), 0,  //
        l(0) - k.b13 * l(2), 0, l(2) - k.b13 * l(0),   //
        0, l(1) - k.b23 * l(2), l(2) - k.b23 * l(1);
    Eigen::Matrix3d J_inv;
    bool invertible = false;
    J.computeInverseWithCheck(J_inv, invertible, 0);
    if (invertible) l -= 0.5 * (J_inv * r);
  }
  return false;
}

/// The eigenvector to `value` of a symmetric matrix; the other eigenvalues are not near to it.
Eigen::Vector3d eigenvectorOf(const Eigen::Matrix3d& M, double value) {
  const Eigen::Matrix3d N = M - value * Eigen::Matrix3d::Identity();
  // Of rank two: what is normal to two of its columns, the two most different in direction.
  Eigen::Vector3d longest = N.col(0).cross(N.col(1));
  for (const int other : {0, 1}) {
    const Eigen::Vector3d n = N.col(other).cross(N.col(2));
    if (n.squaredNorm() > longest.squaredNorm()) longest = n;
  }
  return longest.normalized();
}

/// The pose that takes three points into the camera frame, where they stand at `points_camera`.
Pose alignTriangles(const std::array<Eigen::Vector3d, 3>& points_camera,
                    const std::array<Eigen::Vector3d, 3>& points_world) {
  const auto frame = [](const std::array<Eigen::Vector3d, 3>& p) {
    Eigen::Matrix3d F;
    F.col(0) = (p[1] - p[0]).normalized();
    F.col(2) = F.col(0).cross(p[2] - p[0]).normalized();
    F.col(1) = F.col(2).cross(F.col(0));
    return F;
  };
  Pose pose;
  pose.R = frame(points_camera) * frame(points_world).transpose();
  pose.t = points_camera[0] - pose.R * points_world[0];
  return pose;
}

}  // namespace

int solveP3p(const std::array<Eigen::Vector3d, 3>& bearings,
             const std::array<Eigen::Vector3d, 3>& points_world, std::array<Pose, 4>& poses) {
  const Constraints k{bearings[0].dot(bearings[1]),
                      bearings[0].dot(bearings[2]),
                      bearings[1].dot(bearings[2]),
                      (points_world[0] - points_world[1]).squaredNorm(),
                      (points_world[0] - points_world[2]).squaredNorm(),
                      (points_world[1] - points_world[2]).squaredNorm()};
  if (!(k.a12 > 0 && k.a13 > 0 && k.a23 > 0)) return 0;

  // With the distances l, l^T Mij l = aij; two combinations without a constant term are two conics.
  Eigen::Matrix3d M12, M13, M23;
  M12 << 1, -k.b12, 0, -k.b12, 1, 0, 0, 0, 0;
  M13 << 1, 0, -k.b13, 0, 0, 0, -k.b13, 0, 1;
  M23 << 0, 0, 0, 0, 1, -k.b23, 0, -k.b23, 1;
  const double scale = 1 / (k.a12 + k.a13 + k.a23);
  const Eigen::Matrix3d D1 = scale * (M12 * k.a23 - M23 * k.a12);
  const Eigen::Matrix3d D2 = scale * (M13 * k.a23 - M23 * k.a13);

  // det(D1 + g D2) = 0: a degenerate conic of their pencil, which is a pair of planes through 0.
  const auto mixed = [](const Eigen::Matrix3d& A, const Eigen::Matrix3d& B) {
    return A.col(0).dot(B.col(1).cross(B.col(2))) + B.col(0).dot(A.col(1).cross(B.col(2))) +
           B.col(0).dot(B.col(1).cross(A.col(2)));
  };
  const double c3 = D2.determinant(), c2 = mixed(D1, D2), c1 = mixed(D2, D1), c0 = D1.determinant();
  if (std::abs(c3) < 1e-14) return 0;
  const double g = realRootOfCubic(c2 / c3, c1 / c3, c0 / c3);

  // One eigenvalue is zero; the others' sum and product are the trace and the minors' sum.
  const Eigen::Matrix3d D = D1 + g * D2;
  const double half_sum = D.trace() / 2;
  const double product = D(0, 0) * D(1, 1) - D(0, 1) * D(0, 1) + D(0, 0) * D(2, 2) -
                         D(0, 2) * D(0, 2) + D(1, 1) * D(2, 2) - D(1, 2) * D(1, 2);
  if (!(product < 0)) return 0;  // of one sign: no real planes
  const double larger =
      half_sum + std::copysign(std::sqrt(half_sum * half_sum - product), half_sum);
  const double plus = std::max(larger, product / larger),
               minus = std::min(larger, product / larger);
  const Eigen::Vector3d e_plus = eigenvectorOf(D, plus), e_minus = eigenvectorOf(D, minus);
  const double ratio = std::sqrt(-minus / plus);

  int count = 0;
  for (const double sign : {1.0, -1.0}) {
    const Eigen::Vector3d n = e_plus + sign * ratio * e_minus;
    if (std::abs(n(0)) < 1e-12) continue;
    // On this plane l1 = w0 l2 + w1 l3; with l3 = tau l2 the first conic is quadratic in tau.
    const double w0 = -n(1) / n(0), w1 = -n(2) / n(0);
    const double qa = D1(0, 0) * w1 * w1 + 2 * D1(0, 2) * w1 + D1(2, 2);
    const double qb = D1(0, 0) * w0 * w1 + D1(0, 1) * w1 + D1(0, 2) * w0 + D1(1, 2);
    const double qc = D1(0, 0) * w0 * w0 + 2 * D1(0, 1) * w0 + D1(1, 1);
    const double disc = qb * qb - qa * qc;
    if (disc < 0 || qa == 0) continue;
    const double q = -(qb + std::copysign(std::sqrt(disc), qb));
    for (const double tau : {q / qa, q != 0 ? qc / q : 0.0}) {
      if (!(tau > 0) || count == 4) continue;
      const double l2 = std::sqrt(k.a23 / (1 + tau * tau - 2 * k.b23 * tau));
      Eigen::Vector3d l(l2 * (w0 + w1 * tau), l2, l2 * tau);
      if (!(l(0) > 0) || !polish(k, l) || !(l.minCoeff() > 0)) continue;
      poses[count++] = alignTriangles({l(0) * bearings[0], l(1) * bearings[1], l(2) * bearings[2]},
                                      points_world);
    }
  }
  return count;
}

}  // namespace depthscope::slam
