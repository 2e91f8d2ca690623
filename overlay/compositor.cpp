#include "overlay/compositor.hpp"

#include <algorithm>
#include <cstring>
#include <vector>

#include "overlay/blend.hpp"
#include "overlay/overlay_renderer.hpp"

namespace depthscope::overlay {
namespace {

constexpr std::uint8_t kFaultPixel[4] = {13, 15, 18, 255};

bool fits(int width, int height, std::span<const std::uint8_t> out) {
  return width > 0 && height > 0 &&
         out.size() >= static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4;
}

}  // namespace

struct Compositor::Impl {
  Impl(const CameraModel& camera, const OverlaySettings& settings) : renderer(camera, settings) {}

  /// Reads `rect` of the layer into `pixels`.
  bool read(const PixelRect& rect) {
    const auto bytes =
        static_cast<std::size_t>(rect.width()) * static_cast<std::size_t>(rect.height()) * 4;
    if (pixels.size() < bytes) pixels.resize(bytes);
    return renderer.read(rect, pixels.data());
  }

  OverlayRenderer renderer;
  std::vector<std::uint8_t> pixels;  // of the layer
};

Compositor::Compositor(const CameraModel& camera, const OverlaySettings& settings)
    : impl_(std::make_unique<Impl>(camera, settings)) {}

Compositor::~Compositor() = default;

void Compositor::setSettings(const OverlaySettings& settings) {
  impl_->renderer.setSettings(settings);
}
void Compositor::setSurface(const SurfaceMesh& mesh) {
  impl_->renderer.setSurface(mesh);
}
void Compositor::setLabels(std::span<const Label> labels) {
  impl_->renderer.setLabels(labels);
}

// The layer is blended over the picture here and not by the graphics driver: the picture then never
// leaves memory, is the same bit for bit wherever the layer is transparent, and costs one copy.
bool Compositor::composite(const RgbaView& picture, const OverlayState& state,
                           std::span<std::uint8_t> out) {
  const int w = picture.width, h = picture.height;
  if (picture.empty() || !fits(w, h, out)) return false;
  const std::optional<PixelRect> drawn = impl_->renderer.draw(w, h, state);
  const bool ok = drawn && (drawn->empty() || impl_->read(*drawn));
  const PixelRect rect = ok ? *drawn : PixelRect{};
  for (int y = 0; y < h; ++y) {
    const std::uint8_t* from = picture.row(y);
    std::uint8_t* to = out.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(w) * 4;
    const bool covered = y >= rect.y0 && y < rect.y1;
    const int x0 = covered ? rect.x0 : w, x1 = covered ? rect.x1 : w;
    if (from != to) {
      std::memcpy(to, from, static_cast<std::size_t>(x0) * 4);
      std::memcpy(to + x1 * 4, from + x1 * 4, static_cast<std::size_t>(w - x1) * 4);
    }
    if (covered) {
      const auto row =
          static_cast<std::size_t>(y - rect.y0) * static_cast<std::size_t>(rect.width()) * 4;
      blendRow(impl_->pixels.data() + row, from + x0 * 4, to + x0 * 4, rect.width());
    }
  }
  return ok;
}

bool Compositor::drawLayer(int width, int height, const OverlayState& state,
                           std::span<std::uint8_t> out) {
  if (!fits(width, height, out)) return false;
  std::fill(out.begin(), out.end(), std::uint8_t{0});
  const std::optional<PixelRect> drawn = impl_->renderer.draw(width, height, state);
  if (!drawn || drawn->empty()) return drawn.has_value();
  if (!impl_->read(*drawn)) return false;
  const auto row_bytes = static_cast<std::size_t>(drawn->width()) * 4;
  for (int y = drawn->y0; y < drawn->y1; ++y)
    std::memcpy(out.data() + (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                              static_cast<std::size_t>(drawn->x0)) *
                                 4,
                impl_->pixels.data() + static_cast<std::size_t>(y - drawn->y0) * row_bytes,
                row_bytes);
  return true;
}

bool Compositor::compositeFault(int width, int height, std::string_view message,
                                std::span<std::uint8_t> out) {
  if (!fits(width, height, out)) return false;
  const auto bytes = static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4;
  for (std::size_t i = 0; i < bytes; i += 4) std::memcpy(out.data() + i, kFaultPixel, 4);
  const std::optional<PixelRect> drawn = impl_->renderer.drawFault(width, height, message);
  if (!drawn || !impl_->read(*drawn)) return false;
  blendRow(impl_->pixels.data(), out.data(), out.data(), width * height);
  return true;
}

}  // namespace depthscope::overlay
