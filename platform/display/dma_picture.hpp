#pragma once
#include <array>
#include <cstdint>
#include <optional>

#include "capture/frame.hpp"
#include "overlay/pixel_rect.hpp"

namespace depthscope::platform {

/// A picture in memory that a display can read by itself. The descriptors are borrowed.
struct DmaPicture {
  struct Plane {
    int fd = -1;               // of the DMABUF
    std::uint32_t offset = 0;  // [bytes] within it
    std::uint32_t pitch = 0;   // [bytes] from row to row
  };
  /// How the display has to turn it into R, G, B.
  enum class Encoding : std::uint8_t { Rgb, Bt601, Bt709, Bt2020 };

  std::uint32_t fourcc = 0;   // DRM_FORMAT_...
  int width = 0, height = 0;  // [px]
  int plane_count = 1;
  std::array<Plane, 3> planes{};
  Encoding encoding = Encoding::Rgb;
  bool full_range = true;  // no matter for Rgb

  /// Whether all but the memory is the same.
  bool sameKind(const DmaPicture& other) const {
    return fourcc == other.fourcc && width == other.width && height == other.height &&
           plane_count == other.plane_count && encoding == other.encoding &&
           full_range == other.full_range;
  }
};

/// Where a captured picture lies for a display, if it lies in DMABUFs and displays know its format.
std::optional<DmaPicture> dmaPicture(const capture::Frame& frame);

/// An overlay on its own: premultiplied R G B A, rows packed, transparent outside of `rect`.
struct LayerView {
  const std::uint8_t* pixels = nullptr;
  int width = 0, height = 0;  // [px]
  overlay::PixelRect rect;
};

}  // namespace depthscope::platform
