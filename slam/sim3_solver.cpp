#include "slam/sim3_solver.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "slam/projection.hpp"
#include "slam/random_sample.hpp"

namespace depthscope::slam {

namespace {

/// Both errors below the threshold: what is left of it, summed; else 0.
double worth(const Intrinsics& camera, const Sim3Match& match, const Sim3& T_old_new,
             const Sim3& T_new_old, double chi2_inlier) {
  const auto [a, b] = sim3Errors(camera, match, T_old_new, T_new_old);
  return a <= chi2_inlier && b <= chi2_inlier ? 2 * chi2_inlier - a - b : 0;
}

/// Whether the sides of two triangles have about one ratio: cheaper than to find that out by
/// aligning them.
bool similarTriangles(const std::array<Eigen::Vector3d, 3>& from,
                      const std::array<Eigen::Vector3d, 3>& to) {
  constexpr double kMaxSpread2 = 1.7 * 1.7;  // of the ratios, squared
  double least = std::numeric_limits<double>::infinity(), most = 0;
  for (int i = 0; i < 3; ++i) {
    const double ratio2 =
        (to[i] - to[(i + 1) % 3]).squaredNorm() / (from[i] - from[(i + 1) % 3]).squaredNorm();
    least = std::min(least, ratio2);
    most = std::max(most, ratio2);
  }
  return most < kMaxSpread2 * least;
}

int classify(const Intrinsics& camera, std::span<Sim3Match> matches, const Sim3& T_old_new,
             double chi2_inlier) {
  const Sim3 T_new_old = T_old_new.inverse();
  int inliers = 0;
  for (Sim3Match& m : matches) {
    const auto [a, b] = sim3Errors(camera, m, T_old_new, T_new_old);
    m.inlier = a <= chi2_inlier && b <= chi2_inlier;
    inliers += m.inlier;
  }
  return inliers;
}

}  // namespace

bool alignPoints(std::span<const Eigen::Vector3d> from, std::span<const Eigen::Vector3d> to,
                 Sim3& T_to_from) {
  const double n = static_cast<double>(from.size());
  Eigen::Vector3d centre_from = Eigen::Vector3d::Zero(), centre_to = centre_from;
  for (std::size_t i = 0; i < from.size(); ++i) {
    centre_from += from[i] / n;
    centre_to += to[i] / n;
  }
  Eigen::Matrix3d M = Eigen::Matrix3d::Zero(), F = M;
  double spread_from = 0, spread_to = 0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const Eigen::Vector3d f = from[i] - centre_from, t = to[i] - centre_to;
    M += f * t.transpose();
    F += f * f.transpose();
    spread_from += f.squaredNorm();
    spread_to += t.squaredNorm();
  }
  // Collinear points leave a turn about their line open.
  constexpr double kMinPlanarity = 1e-3;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> shape(F, Eigen::EigenvaluesOnly);
  if (!(spread_to > 0) || !(shape.eigenvalues()(1) > kMinPlanarity * spread_from)) return false;

  Eigen::Matrix4d N;  // Horn 1987, section 4.A
  N << M.trace(), M(1, 2) - M(2, 1), M(2, 0) - M(0, 2), M(0, 1) - M(1, 0),   //
      0, M(0, 0) - M(1, 1) - M(2, 2), M(0, 1) + M(1, 0), M(2, 0) + M(0, 2),  //
      0, 0, -M(0, 0) + M(1, 1) - M(2, 2), M(1, 2) + M(2, 1),                 //
      0, 0, 0, -M(0, 0) - M(1, 1) + M(2, 2);
  N.triangularView<Eigen::StrictlyLower>() = N.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> eigen(N);
  const Eigen::Vector4d q = eigen.eigenvectors().col(3);
  T_to_from.R = Eigen::Quaterniond(q(0), q(1), q(2), q(3)).normalized().toRotationMatrix();
  T_to_from.s = std::sqrt(spread_to / spread_from);
  T_to_from.t = centre_to - T_to_from.s * (T_to_from.R * centre_from);
  return T_to_from.allFinite();
}

std::array<double, 2> sim3Errors(const Intrinsics& camera, const Sim3Match& m,
                                 const Sim3& T_old_new, const Sim3& T_new_old) {
  const auto chi2 = [&](const Eigen::Vector3d& p, const Eigen::Vector2d& pixel, double inv_sigma2) {
    if (!(p.z() > kMinDepth)) return std::numeric_limits<double>::infinity();
    return (camera.project(p) - pixel).squaredNorm() * inv_sigma2;
  };
  return {chi2(m.T_view_old * (T_old_new * m.point_new), m.pixel_old, m.inv_sigma2_old),
          chi2(m.T_view_new * (T_new_old * m.point_old), m.pixel_new, m.inv_sigma2_new)};
}

int solveSim3(const Intrinsics& camera, std::span<Sim3Match> matches, const Sim3Settings& settings,
              Sim3& T_old_new) {
  constexpr int kSample = 3;
  for (Sim3Match& m : matches) m.inlier = false;
  const int n = static_cast<int>(matches.size());
  if (n < settings.min_inliers) return 0;
  std::mt19937 generator(static_cast<std::uint32_t>(n));
  double best = 0;
  for (int i = 0; i < settings.ransac_iterations; ++i) {
    const auto sample = drawSample<kSample>(generator, n);
    std::array<Eigen::Vector3d, kSample> from, to;
    for (int k = 0; k < kSample; ++k) {
      from[k] = matches[sample[k]].point_new;
      to[k] = matches[sample[k]].point_old;
    }
    Sim3 T;
    if (!similarTriangles(from, to)) continue;
    if (!alignPoints(from, to, T)) continue;
    const Sim3 T_inverse = T.inverse();
    double value = 0;
    // What made the guess must agree with it itself: three wrong matches seldom do.
    bool plausible = true;
    for (const int k : sample)
      plausible = plausible && worth(camera, matches[k], T, T_inverse, settings.chi2_inlier) > 0;
    if (!plausible) continue;
    for (const Sim3Match& m : matches)
      value += worth(camera, m, T, T_inverse, settings.chi2_inlier);
    if (value <= best) continue;
    best = value;
    T_old_new = T;
  }
  if (best == 0) return 0;
  classify(camera, matches, T_old_new, settings.chi2_inlier);
  return refineSim3(camera, matches, settings, T_old_new);
}

void linearizeSim3(const Intrinsics& camera, const Sim3Match& m, const Sim3& T_old_new,
                   Eigen::Matrix<double, 4, 1>& residual, Eigen::Matrix<double, 4, 7>& J) {
  // p in the old world; exp(x) moves it by w x p + v + sigma p.
  const Eigen::Vector3d p = T_old_new * m.point_new;
  const Eigen::Vector3d seen_old = m.T_view_old * p;
  Eigen::Matrix<double, 3, 7> motion;
  motion << -skew(p), Eigen::Matrix3d::Identity(), p;
  residual.head<2>() = camera.project(seen_old) - m.pixel_old;
  J.topRows<2>() = projectionJacobian(camera, seen_old) * m.T_view_old.R * motion;

  // exp(-x) moves the old point the other way before the inverse takes it into the new world.
  const Sim3 T_new_old = T_old_new.inverse();
  const Eigen::Vector3d seen_new = m.T_view_new * (T_new_old * m.point_old);
  motion << -skew(m.point_old), Eigen::Matrix3d::Identity(), m.point_old;
  residual.tail<2>() = camera.project(seen_new) - m.pixel_new;
  J.bottomRows<2>() =
      projectionJacobian(camera, seen_new) * m.T_view_new.R * (-T_new_old.s * T_new_old.R) * motion;
}

int refineSim3(const Intrinsics& camera, std::span<Sim3Match> matches, const Sim3Settings& settings,
               Sim3& T_old_new) {
  const double delta = std::sqrt(settings.chi2_inlier);
  Sim3 T = T_old_new;
  int inliers = classify(camera, matches, T, settings.chi2_inlier);
  for (int round = 0; round < settings.rounds; ++round) {
    for (int i = 0; i < settings.iterations; ++i) {
      Matrix7d H = Matrix7d::Zero();
      Vector7d b = Vector7d::Zero();
      for (const Sim3Match& m : matches) {
        if (!m.inlier) continue;
        const auto [e_old, e_new] = sim3Errors(camera, m, T, T.inverse());
        if (!std::isfinite(e_old) || !std::isfinite(e_new)) continue;
        Eigen::Matrix<double, 4, 1> r;
        Eigen::Matrix<double, 4, 7> J;
        linearizeSim3(camera, m, T, r, J);
        const double w_old = m.inv_sigma2_old * huberWeight(e_old, delta);
        const double w_new = m.inv_sigma2_new * huberWeight(e_new, delta);
        const Eigen::Vector4d w(w_old, w_old, w_new, w_new);
        H.noalias() += J.transpose() * w.asDiagonal() * J;
        b.noalias() -= J.transpose() * w.asDiagonal() * r;
      }
      const Eigen::LDLT<Matrix7d> ldlt(H);
      const Vector7d step = ldlt.solve(b);
      if (ldlt.info() != Eigen::Success || !step.allFinite()) return 0;
      T = expSim3(step) * T;
      if (step.norm() < 1e-8) break;
    }
    const int before = inliers;
    inliers = classify(camera, matches, T, settings.chi2_inlier);
    if (inliers < settings.min_inliers) return 0;
    if (inliers == before && round > 0) break;
  }
  T.R = orthonormal(T.R);
  T_old_new = T;
  return inliers;
}

}  // namespace depthscope::slam
