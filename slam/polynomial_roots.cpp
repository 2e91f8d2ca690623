#include "slam/polynomial_roots.hpp"

#include <algorithm>
#include <cmath>

namespace depthscope::slam {
namespace {

constexpr int kDegree = 10;
constexpr double kNarrowest = 1e-8;  // of an interval: roots within it count as one
constexpr int kNewtonSteps = 40;     // enough even where every one of them halves the interval
constexpr double kConverged = 1e-8;  // of a step: the next would be of the order of its square

/// Sturm's chain as the quotients of Euclid's algorithm: f[k] = (slope x + offset) f[k+1] - scale
/// f[k+2]. Evaluating that takes two products a member, not one for each of its coefficients.
class SturmChain {
 public:
  explicit SturmChain(const DecicPolynomial& f) {
    DecicPolynomial upper = f, lower{};
    for (int i = 1; i <= kDegree; ++i) lower[i - 1] = i * f[i];
    for (int degree = kDegree; degree > 0; --degree) divide(upper, lower, degree);
    last_ = upper[0];
  }

  bool usable() const { return usable_; }

  /// Changes of sign along the chain: its decrease over an interval is the number of roots there.
  int changes(double x) const {
    int changes = 0;
    double below = 0, f = last_;
    for (int k = kDegree - 1; k >= 0; --k) {
      const double above = (slope_[k] * x + offset_[k]) * f - scale_[k] * below;
      changes += std::signbit(above) != std::signbit(f);
      below = f;
      f = above;
    }
    return changes;
  }

 private:
  /// One step of Euclid's algorithm, on polynomials of degree `degree` and one less.
  void divide(DecicPolynomial& upper, DecicPolynomial& lower, int degree) {
    const int k = kDegree - degree;
    const double inverse = 1 / lower[degree - 1];
    slope_[k] = upper[degree] * inverse;
    offset_[k] = (upper[degree - 1] - (degree > 1 ? slope_[k] * lower[degree - 2] : 0)) * inverse;
    DecicPolynomial rest{};
    double largest = 0;
    for (int i = 0; i + 1 < degree; ++i) {
      rest[i] = offset_[k] * lower[i] + (i > 0 ? slope_[k] * lower[i - 1] : 0) - upper[i];
      largest = std::max(largest, std::abs(rest[i]));
    }
    usable_ = usable_ && std::isfinite(slope_[k]) && std::isfinite(offset_[k]);
    scale_[k] = largest;
    // Else the members would shrink until nothing is left of them.
    if (largest > 0)
      for (int i = 0; i + 1 < degree; ++i) rest[i] /= largest;
    upper = lower;
    lower = rest;
  }

  std::array<double, kDegree> slope_, offset_, scale_;
  double last_ = 0;
  bool usable_ = true;
};

/// The root within an interval at whose ends the polynomial has different signs: Newton's method,
/// or the middle of the interval where that would leave it.
bool refineRoot(const DecicPolynomial& f, double begin, double end, double& root) {
  const auto value = [&](double x, double& slope) {
    double y = f[kDegree];
    slope = 0;
    for (int i = kDegree - 1; i >= 0; --i) {
      slope = slope * x + y;
      y = y * x + f[i];
    }
    return y;
  };
  double slope = 0;
  const bool negative = value(begin, slope) < 0;
  if (negative == (value(end, slope) < 0)) return false;
  root = 0.5 * (begin + end);
  for (int i = 0; i < kNewtonSteps; ++i) {
    const double y = value(root, slope);
    ((y < 0) == negative ? begin : end) = root;
    double next = root - y / slope;
    if (!(next > begin && next < end)) next = 0.5 * (begin + end);
    const double step = std::abs(next - root);
    root = next;
    if (step < kConverged) break;
  }
  return true;
}

/// Appends the roots in (-1, 1].
class RootFinder {
 public:
  RootFinder(const DecicPolynomial& f, std::array<double, 10>& roots, int& count)
      : f_(f), chain_(f), roots_(roots), count_(count) {}

  void find() {
    if (chain_.usable()) split(-1, chain_.changes(-1), 1, chain_.changes(1));
  }

 private:
  void split(double begin, int changes_begin, double end, int changes_end) {
    const int inside = changes_begin - changes_end;
    if (inside <= 0 || count_ == kDegree) return;
    const double middle = 0.5 * (begin + end);
    if (inside == 1) {
      count_ += refineRoot(f_, begin, end, roots_[count_]);
    } else if (end - begin < kNarrowest) {
      roots_[count_++] = middle;
    } else {
      const int changes = chain_.changes(middle);
      split(begin, changes_begin, middle, changes);
      split(middle, changes, end, changes_end);
    }
  }

  const DecicPolynomial& f_;
  SturmChain chain_;
  std::array<double, 10>& roots_;
  int& count_;
};

}  // namespace

int realRoots(const DecicPolynomial& coefficients, std::array<double, 10>& roots) {
  int count = 0;
  RootFinder(coefficients, roots, count).find();
  const int within_one = count;
  DecicPolynomial reversed = coefficients;
  std::reverse(reversed.begin(), reversed.end());
  RootFinder(reversed, roots, count).find();
  for (int i = within_one; i < count; ++i) roots[i] = 1 / roots[i];
  return count;
}

}  // namespace depthscope::slam
