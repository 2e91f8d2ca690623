#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "slam/intrinsics.hpp"
#include "slam/two_view_models.hpp"
#include "types/pose.hpp"

namespace depthscope::slam {

/// x2^T [t]x R x1 for a match in normalized coordinates: zero where the two rays meet.
double epipolarResidual(const Pose& T_second_first, const Eigen::Vector2d& first,
                        const Eigen::Vector2d& second);

/// Its derivative by (w, v), 1x6, where R becomes exp(w) R and t becomes t + v.
Eigen::Matrix<double, 1, 6> epipolarJacobian(const Pose& T_second_first,
                                             const Eigen::Vector2d& first,
                                             const Eigen::Vector2d& second);

/// Improves T_second_first, |t| = 1, to a minimum of Huber's cost of the Sampson errors (Hartley &
/// Zisserman, section 11.4.3) of the matches that `selected` marks. Five unknowns and no points: it
/// walks straight where bundle adjustment of two near views creeps along a valley. Returns the
/// standard deviation of the direction of t [rad], infinite where the matches do not determine it.
double refineEpipolarGeometry(const TwoViewMatches& matches, std::span<const std::uint8_t> selected,
                              double sigma_px, int iterations, Pose& T_second_first);

}  // namespace depthscope::slam
