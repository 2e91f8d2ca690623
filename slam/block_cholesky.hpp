#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "slam/projection.hpp"

namespace depthscope::slam {

/// Inverse of the Cholesky factor of A, lower triangular; zero when A is not positive definite.
Eigen::Matrix3d inverseCholeskyFactor(const Eigen::Matrix3d& A);

/// Symmetric positive definite system of 6x6 blocks, A x = b, in memory allocated by the
/// constructor. Written out here, and not left to a library, so that the order of every sum (and so
/// every bit of the result) is the same on every processor, whatever the size of its caches.
class BlockCholesky {
 public:
  explicit BlockCholesky(int max_blocks);

  /// Starts a system of `blocks` x `blocks` blocks, all zero.
  void reset(int blocks);
  /// Block of A; only those with row >= column are read.
  Matrix6d& block(int row, int column) { return blocks_[index(row, column)]; }
  /// Factors A = L L^T in place; false when A is not positive definite.
  bool factor();
  /// After factor(): x holds b before and the solution afterwards.
  void solve(std::span<Vector6d> x) const;
  std::size_t bytes() const { return blocks_.capacity() * sizeof(Matrix6d); }

 private:
  static std::size_t index(int row, int column) {
    return static_cast<std::size_t>(row) * (row + 1) / 2 + column;
  }
  const Matrix6d& block(int row, int column) const { return blocks_[index(row, column)]; }

  std::vector<Matrix6d> blocks_;  // lower triangle, row by row
  int size_ = 0;
};

}  // namespace depthscope::slam
