#include "slam/block_cholesky.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace depthscope::slam {
namespace {

/// In place: the lower triangle of A becomes L, the upper one zero. False unless positive definite.
bool factorBlock(Matrix6d& A) {
  for (int j = 0; j < 6; ++j) {
    const double d = A(j, j) - A.row(j).head(j).squaredNorm();
    if (!(d > 0) || !std::isfinite(d)) return false;
    A(j, j) = std::sqrt(d);
    for (int i = j + 1; i < 6; ++i)
      A(i, j) = (A(i, j) - A.row(i).head(j).dot(A.row(j).head(j))) / A(j, j);
    A.col(j).head(j).setZero();
  }
  return true;
}

/// A := A L^-T.
void divideByTranspose(Matrix6d& A, const Matrix6d& L) {
  for (int j = 0; j < 6; ++j) {
    for (int k = 0; k < j; ++k) A.col(j) -= L(j, k) * A.col(k);
    A.col(j) /= L(j, j);
  }
}

void forwardSubstitute(const Matrix6d& L, Vector6d& x) {
  for (int i = 0; i < 6; ++i) {
    x(i) /= L(i, i);
    for (int k = i + 1; k < 6; ++k) x(k) -= L(k, i) * x(i);
  }
}

void backSubstitute(const Matrix6d& L, Vector6d& x) {
  for (int i = 5; i >= 0; --i) {
    for (int k = i + 1; k < 6; ++k) x(i) -= L(k, i) * x(k);
    x(i) /= L(i, i);
  }
}

}  // namespace

Eigen::Matrix3d inverseCholeskyFactor(const Eigen::Matrix3d& A) {
  Eigen::Matrix3d M = Eigen::Matrix3d::Zero();
  const double d0 = A(0, 0);
  if (!(d0 > 0)) return M;
  const double l00 = std::sqrt(d0), l10 = A(1, 0) / l00, l20 = A(2, 0) / l00;
  const double d1 = A(1, 1) - l10 * l10;
  if (!(d1 > 0)) return M;
  const double l11 = std::sqrt(d1), l21 = (A(2, 1) - l20 * l10) / l11;
  const double d2 = A(2, 2) - l20 * l20 - l21 * l21;
  if (!(d2 > 0)) return M;
  const double l22 = std::sqrt(d2);
  M(0, 0) = 1 / l00;
  M(1, 1) = 1 / l11;
  M(2, 2) = 1 / l22;
  M(1, 0) = -l10 * M(0, 0) / l11;
  M(2, 1) = -l21 * M(1, 1) / l22;
  M(2, 0) = -(l20 * M(0, 0) + l21 * M(1, 0)) / l22;
  return M;
}

BlockCholesky::BlockCholesky(int max_blocks) {
  blocks_.resize(index(max_blocks, 0));
}

void BlockCholesky::reset(int blocks) {
  assert(index(blocks, 0) <= blocks_.size());
  size_ = blocks;
  std::fill(blocks_.begin(), blocks_.begin() + static_cast<std::ptrdiff_t>(index(blocks, 0)),
            Matrix6d::Zero());
}

bool BlockCholesky::factor() {
  for (int i = 0; i < size_; ++i) {
    for (int j = 0; j < i; ++j) {
      Matrix6d& A = block(i, j);
      for (int k = 0; k < j; ++k) A.noalias() -= block(i, k) * block(j, k).transpose();
      divideByTranspose(A, block(j, j));
    }
    Matrix6d& D = block(i, i);
    for (int k = 0; k < i; ++k) D.noalias() -= block(i, k) * block(i, k).transpose();
    if (!factorBlock(D)) return false;
  }
  return true;
}

void BlockCholesky::solve(std::span<Vector6d> x) const {
  for (int i = 0; i < size_; ++i) {
    for (int k = 0; k < i; ++k) x[i].noalias() -= block(i, k) * x[k];
    forwardSubstitute(block(i, i), x[i]);
  }
  for (int i = size_ - 1; i >= 0; --i) {
    for (int k = i + 1; k < size_; ++k) x[i].noalias() -= block(k, i).transpose() * x[k];
    backSubstitute(block(i, i), x[i]);
  }
}

}  // namespace depthscope::slam
