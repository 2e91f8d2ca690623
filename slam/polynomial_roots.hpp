#pragma once
#include <array>

namespace depthscope::slam {

/// A polynomial of degree ten: coefficients[i] belongs to x^i.
using DecicPolynomial = std::array<double, 11>;

/// Real roots, each once, in no particular order. Returns how many of `roots` there are; none for
/// coefficients that are not finite. Where the first or the last coefficient is zero, roots are
/// missed. Two roots nearer to each other than 1e-8 (in x, or in 1/x beyond one) may be found as
/// one, or not at all.
///
/// Sturm's theorem counts the roots of an interval, halving tells them apart, and Newton's method
/// finds them (Nister 2004, section 3.2.3: An efficient solution to the five-point relative pose
/// problem). Roots beyond one are sought as those of the polynomial in 1/x, so that no interval is
/// unbounded.
int realRoots(const DecicPolynomial& coefficients, std::array<double, 10>& roots);

}  // namespace depthscope::slam
