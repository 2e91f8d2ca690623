#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "overlay/overlay_settings.hpp"
#include "overlay/overlay_state.hpp"
#include "overlay/status_mark.hpp"

namespace depthscope::overlay {

/// The mark that stands for a state. `camera_size`: whether the picture has the camera file's size.
Mark markFor(const OverlayState& state, const OverlaySettings& settings, bool camera_size);

/// Says in the picture how overlay and source are doing. Works in memory alone, without the
/// graphics driver: what must be said when everything else has failed is said by this.
///
/// Texts are drawn when first needed for a picture's size and kept; after that nothing is
/// allocated.
class StatusPainter {
 public:
  /// Throws InputError when the font is not to be had.
  explicit StatusPainter(const std::string& font_file);

  /// Draws everything that may have to be said beforehand: all marks, and `messages`.
  void prepare(int width, int height, std::span<const std::string_view> messages);

  /// Where the mark goes in a picture of this size: its top left corner.
  PixelRect markRect(int width, int height, Mark mark, std::string_view message);
  void paintMark(Mark mark, std::string_view message, std::span<std::uint8_t> picture, int width,
                 int height);
  /// The same on the pixels of `rect` of an overlay's own layer (premultiplied).
  void paintMarkOnLayer(Mark mark, std::string_view message, int width, int height,
                        std::span<std::uint8_t> layer, const PixelRect& rect);

  /// A whole picture, R G B A, that says why there is none: dark, the message in its middle.
  void paintFault(std::string_view message, std::span<std::uint8_t> picture, int width, int height);
  /// Marks a picture that is no longer live: darkened to half, the message across its middle.
  void paintStale(std::string_view message, std::span<std::uint8_t> picture, int width, int height);

 private:
  enum class Kind : std::uint8_t { Mark, Notice };
  struct Entry {
    Kind kind;
    Mark mark;
    std::string message;
    Stamp stamp;
  };

  void fit(int width, int height);
  const Stamp& markStamp(Mark mark, std::string_view message);
  const Stamp& noticeStamp(std::string_view message);
  const Stamp* find(Kind kind, Mark mark, std::string_view message) const;
  void paintNotice(std::string_view message, std::span<std::uint8_t> picture, int width,
                   int height);

  TextRasterizer rasterizer_;
  int width_ = 0, height_ = 0;  // [px] of the picture that the stamps are for
  std::vector<Entry> stamps_;
};

}  // namespace depthscope::overlay
