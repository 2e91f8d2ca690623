#include "platform/display/gpu/picture_painter.hpp"

#include "capture/pixel_convert.hpp"
#include "platform/display/gpu/picture_shaders.hpp"

namespace depthscope::platform {
namespace {

using capture::PixelFormat;

constexpr std::size_t layer_texture = 3;

struct TexelFormat {
  GLenum internal, format;
  int bytes;
};
constexpr TexelFormat one_byte{GL_R8UI, GL_RED_INTEGER, 1};
constexpr TexelFormat two_bytes{GL_RG8UI, GL_RG_INTEGER, 2};
constexpr TexelFormat four_bytes{GL_RGBA8UI, GL_RGBA_INTEGER, 4};

TexelFormat texelFormat(PixelFormat format, int plane) {
  switch (format) {
    case PixelFormat::Rgba32:
    case PixelFormat::Bgrx32:
    case PixelFormat::Yuyv:
    case PixelFormat::Uyvy:
      return four_bytes;
    case PixelFormat::Nv12:
    case PixelFormat::Nv16:
      return plane == 0 ? one_byte : two_bytes;
    default:
      return one_byte;
  }
}

void allocate(std::unique_ptr<overlay::GlTexture>& texture, const TexelFormat& texel, int width,
              int height) {
  texture = std::make_unique<overlay::GlTexture>();
  glBindTexture(GL_TEXTURE_2D, texture->name());
  glTexStorage2D(GL_TEXTURE_2D, 1, texel.internal, width, height);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
}

bool driverIsWell() {
  constexpr int most_errors = 8;  // a context that is lost may say so for ever
  bool well = true;
  for (int i = 0; i < most_errors && glGetError() != GL_NO_ERROR; ++i) well = false;
  return well;
}

}  // namespace

PicturePainter::PicturePainter()
    : program_("picture", {shader_text::picture_vert}, {shader_text::picture_frag}),
      at_{program_.uniform("u_origin"),   program_.uniform("u_layer_rect"),
          program_.uniform("u_kind"),     program_.uniform("u_chroma_shift"),
          program_.uniform("u_y_offset"), program_.uniform("u_y"),
          program_.uniform("u_v_red"),    program_.uniform("u_u_blue"),
          program_.uniform("u_green"),    program_.uniform("u_expand")} {
  program_.use();
  const char* samplers[] = {"u_first", "u_second", "u_third", "u_layer"};
  for (GLint unit = 0; unit < 4; ++unit) glUniform1i(program_.uniform(samplers[unit]), unit);
  glBindVertexArray(no_vertices_.name());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glDisable(GL_DITHER);
}

PicturePainter::Kind PicturePainter::kindOf(PixelFormat format) {
  switch (format) {
    case PixelFormat::Gray8:
      return Kind::Gray;
    case PixelFormat::Rgb24:
      return Kind::Rgb24;
    case PixelFormat::Bgr24:
      return Kind::Bgr24;
    case PixelFormat::Rgba32:
      return Kind::Rgb32;
    case PixelFormat::Bgrx32:
      return Kind::Bgr32;
    case PixelFormat::Yuyv:
      return Kind::Yuyv;
    case PixelFormat::Uyvy:
      return Kind::Uyvy;
    case PixelFormat::Nv12:
    case PixelFormat::Nv16:
      return Kind::SemiPlanar;
    default:
      return Kind::Planar;
  }
}

bool PicturePainter::takes(const capture::Frame& frame) {
  const PixelFormat format = frame.format.pixel_format;
  for (int p = 0; p < capture::planeCount(format); ++p) {
    const std::ptrdiff_t stride = frame.planes[static_cast<std::size_t>(p)].stride;
    if (stride <= 0 || stride % texelFormat(format, p).bytes != 0) return false;
  }
  return true;
}

bool PicturePainter::paint(const capture::Frame& frame, const LayerView& layer, int x, int y,
                           int screen_width, int screen_height) {
  const capture::FrameFormat& format = frame.format;
  if (format_ != format) prepare(format);
  upload(frame, layer);
  glViewport(0, 0, screen_width, screen_height);
  glClearColor(0, 0, 0, 1);
  glClear(GL_COLOR_BUFFER_BIT);
  glViewport(x, y, format.width, format.height);
  glUniform2i(at_.origin, x, y);
  glUniform4i(at_.layer_rect, layer.rect.x0, layer.rect.y0, layer.rect.x1, layer.rect.y1);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  return driverIsWell();
}

/// Textures and constants for pictures of this format.
void PicturePainter::prepare(const capture::FrameFormat& format) {
  for (int p = 0; p < capture::planeCount(format.pixel_format); ++p) {
    const TexelFormat texel = texelFormat(format.pixel_format, p);
    const capture::PlaneSize size = capture::planeSize(format, p);
    allocate(textures_[static_cast<std::size_t>(p)], texel, size.row_bytes / texel.bytes,
             size.rows);
  }
  allocate(textures_[layer_texture], four_bytes, format.width, format.height);
  setColours(format);
  format_ = format;
}

void PicturePainter::setColours(const capture::FrameFormat& format) {
  const PixelFormat pixels = format.pixel_format;
  const Kind kind = kindOf(pixels);
  const capture::YuvCoefficients& c = capture::coefficientsOf(format);
  const bool half_height = pixels == PixelFormat::Yuv420p || pixels == PixelFormat::Nv12;
  glUniform1i(at_.kind, static_cast<GLint>(kind));
  glUniform2i(at_.chroma_shift, pixels == PixelFormat::Yuv444p ? 0 : 1, half_height ? 1 : 0);
  glUniform1i(at_.y_offset, c.y_offset);
  glUniform1i(at_.y, c.y);
  glUniform1i(at_.v_red, c.v_red);
  glUniform1i(at_.u_blue, c.u_blue);
  glUniform2i(at_.green, c.u_green, c.v_green);
  glUniform1i(at_.expand, kind >= Kind::Rgb24 && kind <= Kind::Bgr32 &&
                              format.range == capture::YuvRange::Limited);
}

void PicturePainter::upload(const capture::Frame& frame, const LayerView& layer) {
  const PixelFormat pixels = frame.format.pixel_format;
  for (int p = 0; p < capture::planeCount(pixels); ++p) {
    const auto plane = static_cast<std::size_t>(p);
    const TexelFormat texel = texelFormat(pixels, p);
    const capture::PlaneSize size = capture::planeSize(frame.format, p);
    glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(p));
    glBindTexture(GL_TEXTURE_2D, textures_[plane]->name());
    glPixelStorei(GL_UNPACK_ROW_LENGTH,
                  static_cast<GLint>(frame.planes[plane].stride / texel.bytes));
    glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, size.row_bytes / texel.bytes, size.rows, texel.format,
                    GL_UNSIGNED_BYTE, frame.planes[plane].data);
  }
  glActiveTexture(GL_TEXTURE0 + layer_texture);
  glBindTexture(GL_TEXTURE_2D, textures_[layer_texture]->name());
  const overlay::PixelRect& rect = layer.rect;
  if (rect.empty()) return;
  glPixelStorei(GL_UNPACK_ROW_LENGTH, layer.width);
  glTexSubImage2D(
      GL_TEXTURE_2D, 0, rect.x0, rect.y0, rect.width(), rect.height(), four_bytes.format,
      GL_UNSIGNED_BYTE,
      layer.pixels + (static_cast<std::ptrdiff_t>(rect.y0) * layer.width + rect.x0) * 4);
}

}  // namespace depthscope::platform
