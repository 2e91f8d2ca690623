#include "slam/essential.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "slam/polynomial_roots.hpp"

namespace depthscope::slam {
namespace {

// Polynomials in x, y, z as coefficients. Order of the monomials:
//   linear     x y z 1
//   quadratic  x2 xy y2 xz yz z2 x y z 1
//   cubic      x3 y3 x2y xy2 x2z x2 y2z y2 xyz xy, then xz2 xz x, yz2 yz y, z3 z2 z 1
// That of the cubic is Nister's: what is left of the last six rows when the first ten columns are
// eliminated is a polynomial in z for each of x, y and 1.
using Linear = std::array<double, 4>;
using Quadratic = std::array<double, 10>;
using Cubic = std::array<double, 20>;
using Cubics = std::array<Cubic, 10>;

constexpr int kPolishSteps = 6;
constexpr double kConvergedStep2 = 1e-16;  // squared, relative: the next is of its square's order

constexpr int kLinearByLinear[4][4] = {{0, 1, 3, 6}, {1, 2, 4, 7}, {3, 4, 5, 8}, {6, 7, 8, 9}};
constexpr int kQuadraticByLinear[10][4] = {
    {0, 2, 4, 5},     {2, 3, 8, 9},   {3, 1, 6, 7},   {4, 8, 10, 11},   {8, 6, 13, 14},
    {10, 13, 16, 17}, {5, 9, 11, 12}, {9, 7, 14, 15}, {11, 14, 17, 18}, {12, 15, 18, 19}};

// Unrolled, the tables are known at compile time and the sums stay in registers.
void addProduct(double sign, const Linear& a, const Linear& b, Quadratic& sum) {
#pragma GCC unroll 4
  for (int i = 0; i < 4; ++i)
#pragma GCC unroll 4
    for (int j = 0; j < 4; ++j) sum[kLinearByLinear[i][j]] += sign * a[i] * b[j];
}

void addProduct(const Quadratic& a, const Linear& b, Cubic& sum) {
#pragma GCC unroll 10
  for (int i = 0; i < 10; ++i)
#pragma GCC unroll 4
    for (int j = 0; j < 4; ++j) sum[kQuadraticByLinear[i][j]] += a[i] * b[j];
}

/// E as linear polynomials: element (r, c) of x X + y Y + z Z + W, where X..W span the null space
/// of the epipolar constraints.
struct EssentialPencil {
  Eigen::Matrix<double, 9, 4> basis;  // column-major 3x3 matrices as columns
  Linear operator()(int r, int c) const {
    const auto row = basis.row(3 * c + r);
    return {row[0], row[1], row[2], row[3]};
  }
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

/// Chooses the basis for views that hardly turn: skew matrices then all but span the null space
/// and satisfy every constraint but for what little else there is. Unless that alone goes with z,
/// and is scaled to be as large as it will be, it is lost against them.
void separateSymmetric(EssentialPencil& pencil) {
  auto& N = pencil.basis;
  Eigen::Matrix<double, 3, 4> skew_part;
  skew_part << N.row(5) - N.row(7), N.row(6) - N.row(2), N.row(1) - N.row(3);
  // The one direction without a skew part.
  Eigen::Vector4d v;
  for (int i = 0; i < 4; ++i) {
    Eigen::Matrix3d minor;
    for (int k = 0, c = 0; c < 4; ++c)
      if (c != i) minor.col(k++) = skew_part.col(c);
    v[i] = i % 2 ? -minor.determinant() : minor.determinant();
  }
  const double norm = v.norm();
  if (!(norm > 0)) return;
  // Householder's reflection that takes it to the third axis.
  v /= norm;
  v[2] += v[2] < 0 ? -1 : 1;
  const Eigen::Vector4d scaled = v * (2 / v.squaredNorm());
  const Eigen::Matrix<double, 9, 1> along = N * v;
  N.noalias() -= along * scaled.transpose();
  double symmetric2 = 0;
  for (const int c : {0, 1, 3}) {
    const auto e = N.col(c);
    symmetric2 += e[0] * e[0] + e[4] * e[4] + e[8] * e[8] +
                  0.5 * ((e[1] + e[3]) * (e[1] + e[3]) + (e[2] + e[6]) * (e[2] + e[6]) +
                         (e[5] + e[7]) * (e[5] + e[7]));
  }
  N.col(2) *= std::sqrt(std::max(symmetric2, 1e-12));
}

/// det E = 0 and 2 E E^T E - tr(E E^T) E = 0: ten cubics, a row each.
Cubics constraints(const EssentialPencil& pencil) {
  Linear E[3][3];
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) E[r][c] = pencil(r, c);
  Quadratic EEt[3][3] = {};
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c <= r; ++c)
      for (int k = 0; k < 3; ++k) addProduct(1, E[r][k], E[c][k], EEt[r][c]);
  for (int i = 0; i < 10; ++i) {
    const double half_trace = 0.5 * (EEt[0][0][i] + EEt[1][1][i] + EEt[2][2][i]);
    for (int r = 0; r < 3; ++r) EEt[r][r][i] -= half_trace;
  }
  Cubics C{};
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c)
      for (int k = 0; k < 3; ++k)
        addProduct(EEt[std::max(r, k)][std::min(r, k)], E[k][c], C[3 * r + c]);
  for (int c = 0; c < 3; ++c) {
    const int a = (c + 1) % 3, b = (c + 2) % 3;
    Quadratic minor{};
    addProduct(1, E[1][a], E[2][b], minor);
    addProduct(-1, E[1][b], E[2][a], minor);
    addProduct(minor, E[0][c], C[9]);
  }
  return C;
}

void subtract(double factor, const Cubic& from, Cubic& row) {
  for (int i = 0; i < 20; ++i) row[i] -= factor * from[i];
}

/// Gaussian elimination with partial pivoting until the first ten columns of the last six rows,
/// which alone are asked for, are those of the identity.
bool eliminate(Cubics& C) {
  for (int j = 0; j < 10; ++j) {
    int pivot = j;
    for (int i = j + 1; i < 10; ++i)
      if (std::abs(C[i][j]) > std::abs(C[pivot][j])) pivot = i;
    if (!(std::abs(C[pivot][j]) >= 1e-14)) return false;
    if (pivot != j) std::swap(C[j], C[pivot]);
    const double inverse = 1 / C[j][j];
    for (double& c : C[j]) c *= inverse;
    for (int i = j + 1; i < 10; ++i) subtract(C[i][j], C[j], C[i]);
  }
  for (int j = 9; j > 4; --j)
    for (int i = 4; i < j; ++i) subtract(C[i][j], C[j], C[i]);
  return true;
}

/// Three equations B(z) (x, y, 1)^T = 0; coefficients by the power of z.
struct EquationsInZ {
  struct Row {
    std::array<double, 4> x, y;
    std::array<double, 5> one;
  };
  std::array<Row, 3> rows;
};

/// Of two rows that begin with m z and m, for a monomial m, the first minus z times the second is
/// free of it.
EquationsInZ::Row withoutLeading(const Cubic& with_z, const Cubic& without) {
  EquationsInZ::Row row{};
  for (int power = 0; power < 3; ++power) {
    row.x[power] += with_z[12 - power];
    row.x[power + 1] -= without[12 - power];
    row.y[power] += with_z[15 - power];
    row.y[power + 1] -= without[15 - power];
  }
  for (int power = 0; power < 4; ++power) {
    row.one[power] += with_z[19 - power];
    row.one[power + 1] -= without[19 - power];
  }
  return row;
}

/// det B.
DecicPolynomial determinant(const EquationsInZ& B) {
  DecicPolynomial det{};
  for (int r = 0; r < 3; ++r) {
    const auto &a = B.rows[(r + 1) % 3], &b = B.rows[(r + 2) % 3];
    std::array<double, 7> minor{};
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) minor[i + j] += a.x[i] * b.y[j] - a.y[i] * b.x[j];
    for (int i = 0; i < 7; ++i)
      for (int j = 0; j < 5; ++j) det[i + j] += minor[i] * B.rows[r].one[j];
  }
  return det;
}

/// (x, y, 1) up to scale where det B(z) = 0: across the two rows that say most about it.
Eigen::Vector3d nullVector(const EquationsInZ& B, double z) {
  std::array<Eigen::Vector3d, 3> rows;
  for (int r = 0; r < 3; ++r) {
    const auto& [x, y, one] = B.rows[r];
    rows[r] = {((x[3] * z + x[2]) * z + x[1]) * z + x[0], ((y[3] * z + y[2]) * z + y[1]) * z + y[0],
               (((one[4] * z + one[3]) * z + one[2]) * z + one[1]) * z + one[0]};
  }
  Eigen::Vector3d best = rows[0].cross(rows[1]);
  for (const auto& other : {rows[1].cross(rows[2]).eval(), rows[2].cross(rows[0]).eval()})
    if (other.squaredNorm() > best.squaredNorm()) best = other;
  return best;
}

/// One step of Newton's method on the three eliminated rows that begin with x2, y2 and xy.
Eigen::Vector3d newtonStep(const Cubics& C, const Eigen::Vector3d& xyz) {
  const double x = xyz.x(), y = xyz.y(), z = xyz.z();
  Eigen::Matrix3d J;
  Eigen::Vector3d f;
  for (int i = 0; i < 3; ++i) {
    const Cubic& c = C[5 + 2 * i];
    const double of_x = (c[10] * z + c[11]) * z + c[12], of_y = (c[13] * z + c[14]) * z + c[15];
    f[i] = of_x * x + of_y * y + ((c[16] * z + c[17]) * z + c[18]) * z + c[19];
    J.row(i) << of_x, of_y,
        (2 * c[10] * z + c[11]) * x + (2 * c[13] * z + c[14]) * y +
            (3 * c[16] * z + 2 * c[17]) * z + c[18];
  }
  f += Eigen::Vector3d(x * x, y * y, x * y);
  J(0, 0) += 2 * x;
  J(1, 1) += 2 * y;
  J(2, 0) += y;
  J(2, 1) += x;
  return -(J.inverse() * f);
}

/// Betters a solution: the determinant is known less well than the rows that it was made of. False
/// where it leads nowhere.
bool polish(const Cubics& C, Eigen::Vector3d& xyz) {
  for (int i = 0; i < kPolishSteps; ++i) {
    const Eigen::Vector3d step = newtonStep(C, xyz);
    xyz += step;
    if (step.squaredNorm() < kConvergedStep2 * (1 + xyz.squaredNorm())) return true;
  }
  return false;
}

}  // namespace

int solveEssentialFivePoint(const std::array<Eigen::Vector2d, 5>& first,
                            const std::array<Eigen::Vector2d, 5>& second,
                            std::array<Eigen::Matrix3d, 10>& E) {
  EssentialPencil pencil = nullSpace(first, second);
  separateSymmetric(pencil);
  Cubics C = constraints(pencil);
  if (!eliminate(C)) return 0;
  const EquationsInZ B{
      {withoutLeading(C[4], C[5]), withoutLeading(C[6], C[7]), withoutLeading(C[8], C[9])}};
  std::array<double, 10> roots;
  const int real = realRoots(determinant(B), roots);
  int count = 0;
  for (int i = 0; i < real; ++i) {
    const Eigen::Vector3d xy1 = nullVector(B, roots[i]);
    Eigen::Vector3d xyz(xy1.x() / xy1.z(), xy1.y() / xy1.z(), roots[i]);
    if (!polish(C, xyz)) continue;
    const Eigen::Matrix<double, 9, 1> e = pencil.basis.lazyProduct(xyz.homogeneous());
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
