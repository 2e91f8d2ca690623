#pragma once
#include <gtest/gtest.h>

#include <Eigen/Core>

namespace depthscope::slam::testing {

/// Compares an analytic Jacobian with central differences of `function` about zero:
/// function(Vector<Inputs>) -> Vector<Outputs>, the input being the perturbation.
template <int Outputs, int Inputs, class Function>
::testing::AssertionResult jacobianMatches(const Eigen::Matrix<double, Outputs, Inputs>& analytic,
                                           const Function& function, double step = 1e-6,
                                           double tolerance = 1e-6) {
  Eigen::Matrix<double, Outputs, Inputs> numeric;
  for (int i = 0; i < Inputs; ++i) {
    Eigen::Matrix<double, Inputs, 1> delta = Eigen::Matrix<double, Inputs, 1>::Zero();
    delta(i) = step;
    const Eigen::Matrix<double, Outputs, 1> after = function(delta);
    delta(i) = -step;
    const Eigen::Matrix<double, Outputs, 1> before = function(delta);
    numeric.col(i) = (after - before) / (2 * step);
  }
  const double scale = 1 + numeric.cwiseAbs().maxCoeff();
  if ((numeric - analytic).cwiseAbs().maxCoeff() <= tolerance * scale)
    return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "analytic\n" << analytic << "\nnumeric\n" << numeric;
}

}  // namespace depthscope::slam::testing
