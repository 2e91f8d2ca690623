#pragma once
#include <cstdint>

#include "overlay/gl_object.hpp"
#include "overlay/pixel_rect.hpp"

namespace depthscope::overlay {

/// The overlay's own picture: premultiplied RGBA with a depth buffer, transparent where nothing was
/// drawn. Rows run as in a picture: window row 0 is its top row.
class Layer {
 public:
  /// Makes it `width` x `height` (no-op if it is). False when the driver cannot.
  bool resize(int width, int height);
  int width() const { return width_; }
  int height() const { return height_; }

  /// Draw calls go to colour and depth; both are cleared.
  void beginSolid();
  /// Draw calls go to the colour alone, so that depthTexture() may be read.
  void beginFlat();
  GLuint depthTexture() const { return depth_.name(); }

  /// Reads `rect` of the colours into `rgba` (rect.width() * 4 bytes a row).
  void read(const PixelRect& rect, std::uint8_t* rgba);

 private:
  int width_ = 0, height_ = 0;
  GlTexture color_, depth_;
  GlFramebuffer solid_, flat_;
};

}  // namespace depthscope::overlay
