#include "overlay/text_rasterizer.hpp"

#include <ft2build.h>
#include FT_FREETYPE_H

#include <algorithm>
#include <cmath>

#include "types/error.hpp"

namespace depthscope::overlay {
namespace {

constexpr std::uint32_t kReplacement = 0xfffd, kEllipsis = 0x2026;

int surroundPx(int size_px) {
  return std::max(1, static_cast<int>(std::lround(size_px / 9.0)));
}

/// The next code point of `text` from `at`, which is moved past it.
std::uint32_t nextCodePoint(std::string_view text, std::size_t& at) {
  const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(text[i]); };
  const std::uint8_t lead = byte(at++);
  if (lead < 0x80) return lead < 0x20 ? ' ' : lead;
  const int more = lead >= 0xf0 && lead < 0xf8   ? 3
                   : lead >= 0xe0 && lead < 0xf0 ? 2
                   : lead >= 0xc0 && lead < 0xe0 ? 1
                                                 : 0;
  if (more == 0) return kReplacement;
  std::uint32_t code = lead & (0x3f >> more);
  for (int i = 0; i < more; ++i) {
    if (at >= text.size() || (byte(at) & 0xc0) != 0x80) return kReplacement;
    code = code << 6 | (byte(at++) & 0x3f);
  }
  return code;
}

}  // namespace

struct TextRasterizer::Face {
  FT_Library library = nullptr;
  FT_Face face = nullptr;
  int size_px = 0;

  ~Face() {
    if (face) FT_Done_Face(face);
    if (library) FT_Done_FreeType(library);
  }
  void setSize(int px) {
    if (px != size_px) FT_Set_Pixel_Sizes(face, 0, static_cast<FT_UInt>(px));
    size_px = px;
  }
  int ascent() const { return static_cast<int>((face->size->metrics.ascender + 63) >> 6); }
  int descent() const { return static_cast<int>((-face->size->metrics.descender + 63) >> 6); }
  bool load(std::uint32_t code) {
    return FT_Load_Char(face, code, FT_LOAD_RENDER | FT_LOAD_TARGET_LIGHT) == 0;
  }
  int advance(std::uint32_t code) {
    return FT_Load_Char(face, code, FT_LOAD_TARGET_LIGHT) == 0
               ? static_cast<int>(face->glyph->advance.x >> 6)
               : 0;
  }
  void paste(int x, int baseline, TextBitmap& out) const {
    const FT_Bitmap& glyph = face->glyph->bitmap;
    if (glyph.pixel_mode != FT_PIXEL_MODE_GRAY) return;
    for (unsigned r = 0; r < glyph.rows; ++r)
      for (unsigned c = 0; c < glyph.width; ++c) {
        const int px = x + face->glyph->bitmap_left + static_cast<int>(c);
        const int py = baseline - face->glyph->bitmap_top + static_cast<int>(r);
        if (px < 0 || py < 0 || px >= out.width || py >= out.height) continue;
        std::uint8_t& to = out.pixels[2 * static_cast<std::size_t>(py * out.width + px)];
        to = std::max(to, glyph.buffer[static_cast<int>(r) * glyph.pitch + static_cast<int>(c)]);
      }
  }
};

TextRasterizer::TextRasterizer(const std::string& font_file) : face_(std::make_unique<Face>()) {
  const std::string file = font_file.empty() ? DEPTHSCOPE_DEFAULT_FONT : font_file;
  if (FT_Init_FreeType(&face_->library) != 0) throw InputError("overlay: FreeType does not start");
  if (FT_New_Face(face_->library, file.c_str(), 0, &face_->face) != 0)
    throw InputError(
        "overlay.font_file: " + file +
        ": cannot be read as a font; expected a TrueType file (Debian: fonts-dejavu-core)");
}

TextRasterizer::~TextRasterizer() = default;

int TextRasterizer::height(int size_px) {
  face_->setSize(size_px);
  return face_->ascent() + face_->descent() + 2 * surroundPx(size_px);
}

void TextRasterizer::rasterize(std::string_view text, int size_px, int max_width, TextBitmap& out) {
  const int margin = surroundPx(size_px);
  out.height = height(size_px);
  const int ellipsis = face_->advance(kEllipsis);
  const int room = max_width - 2 * margin;
  int width = 0, fitting = 0;  // of all; of what fits together with an ellipsis
  std::size_t fitting_bytes = 0;
  for (std::size_t at = 0; at < text.size() && width <= room;) {
    width += face_->advance(nextCodePoint(text, at));
    if (width + ellipsis <= room) fitting = width, fitting_bytes = at;
  }
  const bool cut = width > room;
  if (cut) text = text.substr(0, fitting_bytes), width = std::min(fitting + ellipsis, room);
  out.width = std::max(width, 0) + 2 * margin;
  out.pixels.assign(2 * static_cast<std::size_t>(out.width * out.height), 0);

  int x = margin;
  const int baseline = margin + face_->ascent();
  const auto put = [&](std::uint32_t code) {
    if (!face_->load(code)) return;
    face_->paste(x, baseline, out);
    x += static_cast<int>(face_->face->glyph->advance.x >> 6);
  };
  for (std::size_t at = 0; at < text.size();) put(nextCodePoint(text, at));
  if (cut) put(kEllipsis);

  // The surround: the glyphs dilated by a disc with a soft rim.
  for (int y = 0; y < out.height; ++y)
    for (int px = 0; px < out.width; ++px) {
      float most = 0;
      for (int dy = -margin; dy <= margin; ++dy)
        for (int dx = -margin; dx <= margin; ++dx) {
          const int sx = px + dx, sy = y + dy;
          if (sx < 0 || sy < 0 || sx >= out.width || sy >= out.height) continue;
          const float reach =
              std::clamp(static_cast<float>(margin) + 0.8f -
                             std::hypot(static_cast<float>(dx), static_cast<float>(dy)),
                         0.0f, 1.0f);
          most =
              std::max(most, reach * out.pixels[2 * static_cast<std::size_t>(sy * out.width + sx)]);
        }
      out.pixels[2 * static_cast<std::size_t>(y * out.width + px) + 1] =
          static_cast<std::uint8_t>(most);
    }
}

}  // namespace depthscope::overlay
