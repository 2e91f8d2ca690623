#include "slam/essential.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <cmath>
#include <numbers>

namespace depthscope::slam {
namespace {

// Polynomials in x, y, z as coefficient vectors. Order of the monomials, by degree:
//   linear     x y z 1
//   quadratic  x2 xy y2 xz yz z2 x y z 1
//   cubic      x3 x2y xy2 y3 x2z xyz y2z xz2 yz2 z3, then those of the quadratic
using Linear = Eigen::Matrix<double, 4, 1>;
using Quadratic = Eigen::Matrix<double, 10, 1>;
using Cubic = Eigen::Matrix<double, 20, 1>;

constexpr int kLinearByLinear[4][4] = {{0, 1, 3, 6}, {1, 2, 4, 7}, {3, 4, 5, 8}, {6, 7, 8, 9}};
constexpr int kQuadraticByLinear[10][4] = {
    {0, 1, 4, 10}, {1, 2, 5, 11},    {2, 3, 6, 12},    {4, 5, 7, 13},    {5, 6, 8, 14},
    {7, 8, 9, 15}, {10, 11, 13, 16}, {11, 12, 14, 17}, {13, 14, 15, 18}, {16, 17, 18, 19}};

Quadratic multiply(const Linear& a, const Linear& b) {
  Quadratic product = Quadratic::Zero();
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) product(kLinearByLinear[i][j]) += a(i) * b(j);
  return product;
}

Cubic multiply(const Quadratic& a, const Linear& b) {
  Cubic product = Cubic::Zero();
  for (int i = 0; i < 10; ++i)
    for (int j = 0; j < 4; ++j) product(kQuadraticByLinear[i][j]) += a(i) * b(j);
  return product;
}

/// E as linear polynomials: element (r, c) of x X + y Y + z Z + W, where X..W span the null space
/// of the epipolar constraints.
struct EssentialPencil {
  Eigen::Matrix<double, 9, 4> basis;  // column-major 3x3 matrices as columns
  Linear operator()(int r, int c) const { return basis.row(3 * c + r).transpose(); }
};

EssentialPencil nullSpace(const std::array<Eigen::Vector2d, 5>& first,
                          const std::array<Eigen::Vector2d, 5>& second) {
  Eigen::Matrix<double, 9, 5> A_transposed;
  for (int i = 0; i < 5; ++i) {
    const Eigen::Vector3d x1 = first[i].homogeneous(), x2 = second[i].homogeneous();
    const Eigen::Matrix3d outer = x2 * x1.transpose();
    A_transposed.col(i) = Eigen::Map<const Eigen::Matrix<double, 9, 1>>(outer.data());
  }
  const Eigen::HouseholderQR<Eigen::Matrix<double, 9, 5>> qr(A_transposed);
  EssentialPencil pencil;
  pencil.basis = Eigen::Matrix<double, 9, 9>::Identity().rightCols<4>();
  pencil.basis.applyOnTheLeft(qr.householderQ());
  return pencil;
}

/// det E = 0 and 2 E E^T E - tr(E E^T) E = 0: ten cubics, a row each.
Eigen::Matrix<double, 10, 20> constraints(const EssentialPencil& E) {
  Eigen::Matrix<double, 10, 20> C;
  Quadratic EEt[3][3];
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c)
      EEt[r][c] =
          multiply(E(r, 0), E(c, 0)) + multiply(E(r, 1), E(c, 1)) + multiply(E(r, 2), E(c, 2));
  const Quadratic half_trace = 0.5 * (EEt[0][0] + EEt[1][1] + EEt[2][2]);
  for (int r = 0; r < 3; ++r) EEt[r][r] -= half_trace;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c)
      C.row(3 * r + c) = (multiply(EEt[r][0], E(0, c)) + multiply(EEt[r][1], E(1, c)) +
                          multiply(EEt[r][2], E(2, c)))
                             .transpose();
  const auto minor = [&](int a, int b) {
    return Quadratic(multiply(E(1, a), E(2, b)) - multiply(E(1, b), E(2, a)));
  };
  C.row(9) = (multiply(minor(1, 2), E(0, 0)) - multiply(minor(0, 2), E(0, 1)) +
              multiply(minor(0, 1), E(0, 2)))
                 .transpose();
  return C;
}

/// Gauss-Jordan with partial pivoting until the first ten columns are the identity.
bool eliminate(Eigen::Matrix<double, 10, 20>& C) {
  for (int j = 0; j < 10; ++j) {
    int pivot = j;
    for (int i = j + 1; i < 10; ++i)
      if (std::abs(C(i, j)) > std::abs(C(pivot, j))) pivot = i;
    if (std::abs(C(pivot, j)) < 1e-14) return false;
    if (pivot != j) C.row(j).swap(C.row(pivot));
    C.row(j) /= C(j, j);
    for (int i = 0; i < 10; ++i)
      if (i != j) C.row(i) -= C(i, j) * C.row(j);
  }
  return true;
}

}  // namespace

int solveEssentialFivePoint(const std::array<Eigen::Vector2d, 5>& first,
                            const std::array<Eigen::Vector2d, 5>& second,
                            std::array<Eigen::Matrix3d, 10>& E) {
  const EssentialPencil pencil = nullSpace(first, second);
  Eigen::Matrix<double, 10, 20> C = constraints(pencil);
  if (!eliminate(C)) return 0;

  // Multiplication by x of the quadratic monomials, modulo the constraints: its eigenvectors are
  // those monomials at the solutions. x times the first six is cubic, x times x y z 1 is quadratic.
  Eigen::Matrix<double, 10, 10> action = Eigen::Matrix<double, 10, 10>::Zero();
  constexpr int kCubicOfQuadratic[6] = {0, 1, 2, 4, 5, 7};
  for (int i = 0; i < 6; ++i) action.row(i) = -C.row(kCubicOfQuadratic[i]).tail<10>();
  constexpr int kQuadraticOfLinear[4] = {0, 1, 3, 6};
  for (int i = 0; i < 4; ++i) action(6 + i, kQuadraticOfLinear[i]) = 1;

  const Eigen::EigenSolver<Eigen::Matrix<double, 10, 10>> eigen(action);
  if (eigen.info() != Eigen::Success) return 0;
  int count = 0;
  for (int i = 0; i < 10; ++i) {
    if (eigen.eigenvalues()(i).imag() != 0) continue;
    const Linear xyz1 = eigen.pseudoEigenvectors().col(i).tail<4>();
    const Eigen::Matrix<double, 9, 1> e = pencil.basis.lazyProduct(xyz1);
    const Eigen::Matrix3d candidate =
        Eigen::Map<const Eigen::Matrix3d>(e.data()) * (std::numbers::sqrt2 / e.norm());
    if (candidate.allFinite()) E[count++] = candidate;
  }
  return count;
}

void decomposeEssential(const Eigen::Matrix3d& E, std::array<Pose, 4>& T_second_first) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(E, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d U = svd.matrixU(), V = svd.matrixV();
  if (U.determinant() < 0) U = -U;
  if (V.determinant() < 0) V = -V;
  Eigen::Matrix3d W;
  W << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  const Eigen::Matrix3d R1 = U * W * V.transpose(), R2 = U * W.transpose() * V.transpose();
  const Eigen::Vector3d t = U.col(2);
  T_second_first = {Pose{R1, t}, Pose{R1, -t}, Pose{R2, t}, Pose{R2, -t}};
}

}  // namespace depthscope::slam
