#pragma once
#include <Eigen/Core>
#include <array>

#include "recon/grid.hpp"
#include "types/camera_model.hpp"

namespace depthscope::recon {

/// Of the pictures' pyramid, each half the size of the one before. At a third level the fine
/// vessels of smooth walls are gone: of a wall 100 to 140 mm away the best of all depths,
/// neighbours not asked, was right to 6 mm in 64 % of its pixels there, in 87 % at the second.
inline constexpr int kLevels = 2;

/// Intrinsics of one level of a pinhole view [px]; the centre of the first pixel is (0, 0).
struct PinholeLevel {
  int width = 0, height = 0;
  float f = 1, cx = 0, cy = 0;
};

/// The finest level of a PinholeView.
PinholeLevel finestLevel(const CameraModel& camera, int factor, int max_width);

/// The undistorted view that all views are matched in: it holds what the lens shows, up to
/// 56 degrees from the axis, at about the resolution of the reduced picture.
class PinholeView {
 public:
  /// For pictures of `camera` reduced by `factor`; `max_width` [px] bounds the finest level.
  PinholeView(const CameraModel& camera, int factor, int max_width);

  /// Level 0 is the finest.
  const PinholeLevel& level(int l) const { return levels_[static_cast<std::size_t>(l)]; }
  /// Where a pixel of the finest level lies in the reduced picture [px]; negative: nowhere.
  const Eigen::Vector2f& source(int x, int y) const { return source_.at(x, y); }
  /// Bends a reduced picture into the view; 0 where the lens does not see. `out` keeps its storage.
  void rectify(const Grid<std::uint8_t>& reduced, Grid<std::uint8_t>& out) const;

 private:
  std::array<PinholeLevel, kLevels> levels_;
  Grid<Eigen::Vector2f> source_;  // of each pixel in the reduced picture [px]; negative: none
};

}  // namespace depthscope::recon
