#include "overlay/text_atlas.hpp"

#include <algorithm>

namespace depthscope::overlay {

TextAtlas::TextAtlas(TextRasterizer& rasterizer, int slots, int max_size_px, int width_px)
    : rasterizer_(rasterizer),
      slot_height_(rasterizer.height(max_size_px)),
      width_(width_px),
      slots_(static_cast<std::size_t>(slots)) {
  glBindTexture(GL_TEXTURE_2D, texture_.name());
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RG8, width_, slot_height_ * slots, 0, GL_RG, GL_UNSIGNED_BYTE,
               nullptr);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
}

void TextAtlas::set(int slot, std::string_view text, int size_px) {
  Slot& s = slots_[static_cast<std::size_t>(slot)];
  if (s.text == text && s.size_px == size_px) return;
  s.text = text;
  s.size_px = size_px;
  s.spot = {};
  if (text.empty()) return;
  rasterizer_.rasterize(text, size_px, width_, bitmap_);
  s.spot = {0, slot * slot_height_, bitmap_.width, std::min(bitmap_.height, slot_height_)};
  glBindTexture(GL_TEXTURE_2D, texture_.name());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, s.spot.y, s.spot.width, s.spot.height, GL_RG,
                  GL_UNSIGNED_BYTE, bitmap_.pixels.data());
}

}  // namespace depthscope::overlay
