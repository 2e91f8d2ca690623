#pragma once
#include <memory>
#include <optional>

#include "capture/frame.hpp"
#include "overlay/gl_object.hpp"
#include "overlay/shader_program.hpp"
#include "platform/display/dma_picture.hpp"

namespace depthscope::platform {

/// Draws captured pictures with an overlay by OpenGL ES 3, the very pixels that capture::toRgba()
/// and overlay::blendRow() make. Its context must be current wherever it is used.
class PicturePainter {
 public:
  /// Throws InputError when the driver refuses the shaders.
  PicturePainter();

  /// Whether the picture's memory can be handed to the driver as it lies.
  static bool takes(const capture::Frame& frame);
  /// Into the framebuffer that is bound, with the picture's top left at (x, y) of a screen of this
  /// size whose first row in memory is at y = 0; black around it. False: the driver failed.
  bool paint(const capture::Frame& frame, const LayerView& layer, int x, int y, int screen_width,
             int screen_height);

 private:
  /// How the shader reads a picture.
  enum class Kind : GLint { Gray, Rgb24, Bgr24, Rgb32, Bgr32, Yuyv, Uyvy, SemiPlanar, Planar };
  static Kind kindOf(capture::PixelFormat format);

  void prepare(const capture::FrameFormat& format);
  void upload(const capture::Frame& frame, const LayerView& layer);
  void setColours(const capture::FrameFormat& format);

  overlay::ShaderProgram program_;
  overlay::GlVertexArray no_vertices_;
  std::array<std::unique_ptr<overlay::GlTexture>, 4> textures_;  // three planes, the layer
  std::optional<capture::FrameFormat> format_;                   // that they are made for
  struct Uniforms {
    GLint origin, layer_rect, kind, chroma_shift, y_offset, y, v_red, u_blue, green, expand;
  } at_;
};

}  // namespace depthscope::platform
