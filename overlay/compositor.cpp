#include "overlay/compositor.hpp"

#include <algorithm>
#include <cstring>
#include <vector>

#include "overlay/blend.hpp"
#include "overlay/overlay_renderer.hpp"
#include "overlay/status_painter.hpp"

namespace depthscope::overlay {
namespace {

bool fits(int width, int height, std::span<const std::uint8_t> out) {
  return width > 0 && height > 0 &&
         out.size() >= static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4;
}

}  // namespace

struct Compositor::Impl {
  Impl(const CameraModel& camera_, const OverlaySettings& settings_)
      : camera(camera_),
        settings(settings_),
        renderer(camera_, settings_),
        painter(settings_.font_file) {}

  /// Draws the layer into `pixels` (of the rectangle that is returned). `ok` tells whether the
  /// driver did its part; the mark is there either way.
  PixelRect draw(int width, int height, const OverlayState& state, bool& ok);

  CameraModel camera;
  OverlaySettings settings;
  OverlayRenderer renderer;
  StatusPainter painter;
  std::vector<std::uint8_t> pixels;  // of the layer
};

PixelRect Compositor::Impl::draw(int width, int height, const OverlayState& state, bool& ok) {
  Mark mark = markFor(state, settings, width == camera.width && height == camera.height);
  // A surgeon who turned the cues off sees the bare picture while all is well.
  const bool marked =
      settings.cue != CueMode::Off || mark != Mark::Tracking || !state.message.empty();
  const PixelRect mark_rect =
      marked ? painter.markRect(width, height, mark, state.message) : PixelRect{};
  const std::optional<PixelRect> drawn = renderer.draw(width, height, state, mark_rect);
  const bool cues = drawn && !drawn->empty();
  PixelRect rect = cues ? *drawn : mark_rect;
  const auto reserve = [&] {
    const auto bytes =
        static_cast<std::size_t>(rect.width()) * static_cast<std::size_t>(rect.height()) * 4;
    if (pixels.size() < bytes) pixels.resize(bytes);
    return bytes;
  };
  std::size_t bytes = reserve();
  ok = drawn && (!cues || renderer.read(rect, pixels.data()));
  if (!ok) mark = Mark::NoAr;  // what is tracked is of no use when it cannot be drawn
  if (!cues || !ok) {
    rect = marked ? painter.markRect(width, height, mark, state.message) : PixelRect{};
    bytes = reserve();
    std::fill_n(pixels.begin(), bytes, std::uint8_t{0});
  }
  if (marked)
    painter.paintMarkOnLayer(mark, state.message, width, height, std::span(pixels).first(bytes),
                             rect);
  return rect;
}

Compositor::Compositor(const CameraModel& camera, const OverlaySettings& settings)
    : impl_(std::make_unique<Impl>(camera, settings)) {}

Compositor::~Compositor() = default;

void Compositor::setSettings(const OverlaySettings& settings) {
  impl_->settings = settings;
  impl_->renderer.setSettings(settings);
}
void Compositor::setSurface(const SurfaceMesh& mesh) {
  impl_->renderer.setSurface(mesh);
}
void Compositor::setView(const ViewOutline& view) {
  impl_->renderer.setView(view);
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
  bool ok = false;
  const PixelRect rect = impl_->draw(w, h, state, ok);
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

std::optional<PixelRect> Compositor::drawLayer(int width, int height, const OverlayState& state,
                                               std::span<std::uint8_t> out) {
  if (!fits(width, height, out)) return std::nullopt;
  std::fill(out.begin(), out.end(), std::uint8_t{0});
  bool ok = false;
  const PixelRect rect = impl_->draw(width, height, state, ok);
  const auto row_bytes = static_cast<std::size_t>(rect.width()) * 4;
  for (int y = rect.y0; y < rect.y1; ++y)
    std::memcpy(out.data() + (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                              static_cast<std::size_t>(rect.x0)) *
                                 4,
                impl_->pixels.data() + static_cast<std::size_t>(y - rect.y0) * row_bytes,
                row_bytes);
  return ok ? std::optional(rect) : std::nullopt;
}

}  // namespace depthscope::overlay
