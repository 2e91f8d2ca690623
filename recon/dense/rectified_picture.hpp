#pragma once
#include <array>
#include <cstdint>

#include "recon/dense/dense_settings.hpp"
#include "recon/pinhole_view.hpp"

namespace depthscope::recon {

/// One level of a view's picture in the pinhole view.
struct RectifiedLevel {
  Grid<std::uint8_t> luma;
  Grid<std::uint8_t> usable;  // 1: the window around the pixel shows nothing but the view, else 0
};

/// A view's luma in the pinhole view, as a pyramid, ready for matching. Not usable is what lies
/// beyond the lens or near the edge of its round view, which stands still in the picture. Speculars
/// are painted over with the brightness around them: they move with the light and would match
/// falsely.
struct RectifiedPicture {
  std::array<RectifiedLevel, kLevels> levels;

  const RectifiedLevel& level(int l) const { return levels[static_cast<std::size_t>(l)]; }
};

/// Prepares a reduced picture for windows of up to `radius` pixels. `out` keeps its storage.
void rectify(const Grid<std::uint8_t>& reduced, const PinholeView& view,
             const DenseSettings& settings, int radius, RectifiedPicture& out);

}  // namespace depthscope::recon
