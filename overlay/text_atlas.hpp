#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "overlay/gl_object.hpp"
#include "overlay/text_rasterizer.hpp"

namespace depthscope::overlay {

/// Where a line of text lies in the atlas.
struct TextSpot {
  int x = 0, y = 0, width = 0, height = 0;  // texels
  bool empty() const { return width == 0; }
};

/// Lines of text in one texture: a fixed number of slots, one above the other, each as wide as the
/// longest text allowed. Text is drawn when it changes, not when it is shown.
class TextAtlas {
 public:
  /// `slots` lines, none higher than `max_size_px` asks for and none wider than `width_px`.
  TextAtlas(TextRasterizer& rasterizer, int slots, int max_size_px, int width_px);

  /// Puts `text` into `slot`; does nothing when it is there already.
  void set(int slot, std::string_view text, int size_px);
  const TextSpot& spot(int slot) const { return slots_[static_cast<std::size_t>(slot)].spot; }
  GLuint texture() const { return texture_.name(); }

 private:
  struct Slot {
    std::string text;
    int size_px = 0;
    TextSpot spot;
  };

  TextRasterizer& rasterizer_;
  int slot_height_, width_;
  std::vector<Slot> slots_;
  TextBitmap bitmap_;
  GlTexture texture_;
};

}  // namespace depthscope::overlay
