#include "slam/homography.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>

namespace depthscope::slam {
namespace {

using Row9 = Eigen::Matrix<double, 1, 9>;

/// Similarity that brings points to mean 0 and mean distance sqrt(2).
bool normalizer(std::span<const Eigen::Vector2d> points, Eigen::Matrix3d& T) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const auto& p : points) mean += p;
  mean /= static_cast<double>(points.size());
  double distance = 0;
  for (const auto& p : points) distance += (p - mean).norm();
  distance /= static_cast<double>(points.size());
  if (!(distance > 0)) return false;
  const double s = std::sqrt(2.0) / distance;
  T << s, 0, -s * mean.x(), 0, s, -s * mean.y(), 0, 0, 1;
  return true;
}

/// The two equations x2 x (H x1) = 0 gives for the rows of H, stacked.
void equations(const Eigen::Vector3d& x1, const Eigen::Vector3d& x2, Row9& a, Row9& b) {
  a << Eigen::RowVector3d::Zero(), -x1.transpose(), x2.y() * x1.transpose();
  b << x1.transpose(), Eigen::RowVector3d::Zero(), -x2.x() * x1.transpose();
}

using Vector9 = Eigen::Matrix<double, 9, 1>;

/// Coordinates of four points of which the last is `weights` of the others, up to scale; `across`
/// holds, for each of those, the plane of the other two, as a row.
struct ProjectiveFrame {
  Eigen::Matrix3d points, across;
  Eigen::Vector3d weights;

  explicit ProjectiveFrame(std::span<const Eigen::Vector2d> p) {
    for (int i = 0; i < 3; ++i) points.col(i) = p[i].homogeneous();
    for (int i = 0; i < 3; ++i)
      across.row(i) = points.col((i + 1) % 3).cross(points.col((i + 2) % 3)).transpose();
    weights = across * p[3].homogeneous();
  }
};

/// The homography between two frames (Hartley & Zisserman, section 2.3.1 and table 4.1), free of
/// divisions: singular, not infinite, where three points are on a line.
Eigen::Matrix3d solveMinimal(std::span<const Eigen::Vector2d> first,
                             std::span<const Eigen::Vector2d> second) {
  const ProjectiveFrame a(first), b(second);
  const Eigen::Vector3d& w = a.weights;
  const Eigen::Vector3d others(w.y() * w.z(), w.z() * w.x(), w.x() * w.y());
  return b.points * b.weights.cwiseProduct(others).asDiagonal() * a.across;
}

bool solveLeastSquares(std::span<const Eigen::Vector2d> first,
                       std::span<const Eigen::Vector2d> second, Eigen::Matrix3d& H) {
  Eigen::Matrix3d T1, T2;
  if (!normalizer(first, T1) || !normalizer(second, T2)) return false;
  Eigen::Matrix<double, 9, 9> AtA = Eigen::Matrix<double, 9, 9>::Zero();
  for (std::size_t i = 0; i < first.size(); ++i) {
    Row9 a, b;
    equations(T1 * first[i].homogeneous(), T2 * second[i].homogeneous(), a, b);
    AtA += a.transpose().lazyProduct(a) + b.transpose().lazyProduct(b);
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 9, 9>> eigen(AtA);
  const Vector9 h = eigen.eigenvectors().col(0);
  H << h(0), h(1), h(2), h(3), h(4), h(5), h(6), h(7), h(8);
  H = T2.inverse() * H * T1;
  return true;
}

}  // namespace

bool fitHomography(std::span<const Eigen::Vector2d> first, std::span<const Eigen::Vector2d> second,
                   Eigen::Matrix3d& H_second_first) {
  if (first.size() < 4 || first.size() != second.size()) return false;
  Eigen::Matrix3d H;
  if (first.size() == 4)
    H = solveMinimal(first, second);
  else if (!solveLeastSquares(first, second, H))
    return false;
  H /= H.norm();
  if (!H.allFinite() || std::abs(H.determinant()) < 1e-9) return false;
  H_second_first = H;
  return true;
}

int decomposeHomography(const Eigen::Matrix3d& H_second_first,
                        std::array<Pose, 8>& T_second_first) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(H_second_first,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  if (svd.info() != Eigen::Success) return 0;
  const Eigen::Matrix3d& U = svd.matrixU();
  const Eigen::Matrix3d V = svd.matrixV();
  const double s = U.determinant() * V.determinant();
  const double d1 = svd.singularValues()(0), d2 = svd.singularValues()(1),
               d3 = svd.singularValues()(2);
  constexpr double kDistinct = 1 + 1e-6;  // a motion of a millionth of the depth is no motion
  if (!(d3 > 0) || (d1 / d2 < kDistinct && d2 / d3 < kDistinct)) return 0;

  // Components of the plane's normal in the frame V: (x1, 0, x3), both signs of each.
  const double span = d1 * d1 - d3 * d3;
  const double x1 = std::sqrt(std::max(0.0, (d1 * d1 - d2 * d2) / span));
  const double x3 = std::sqrt(std::max(0.0, (d2 * d2 - d3 * d3) / span));
  int count = 0;
  for (const double sign_d : {1.0, -1.0}) {  // of d', the plane's distance times d2
    for (const double e1 : {1.0, -1.0}) {
      for (const double e3 : {1.0, -1.0}) {
        const double n1 = e1 * x1, n3 = e3 * x3;
        const double sine = (d1 - sign_d * d3) * n1 * n3 / d2;
        const double cosine = (sign_d * d1 * n3 * n3 + d3 * n1 * n1) / d2;
        Eigen::Matrix3d R;
        if (sign_d > 0)
          R << cosine, 0, -sine, 0, 1, 0, sine, 0, cosine;
        else
          R << cosine, 0, sine, 0, -1, 0, sine, 0, -cosine;
        const Eigen::Vector3d t(n1, 0, -sign_d * n3);  // times (d1 - d3) or (d1 + d3), a scale
        T_second_first[count++] = {s * U * R * V.transpose(), (U * t).normalized()};
      }
    }
  }
  return count;
}

}  // namespace depthscope::slam
