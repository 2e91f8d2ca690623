#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace depthscope::overlay {

/// A line of text as coverage: two bytes a pixel, glyphs and the dark surround that sets them off
/// from any background (the surround includes the glyphs).
struct TextBitmap {
  int width = 0, height = 0;  // [px]
  std::vector<std::uint8_t> pixels;
};

/// Draws single lines of UTF-8 with FreeType. Characters that the font lacks come out as its empty
/// box, bytes that are no UTF-8 as U+FFFD.
class TextRasterizer {
 public:
  /// `font_file` empty: DejaVu Sans. Throws InputError when the file is missing or no font.
  explicit TextRasterizer(const std::string& font_file);
  ~TextRasterizer();

  /// Height of every bitmap made with `size_px`.
  int height(int size_px);
  /// Text wider than `max_width` is cut and ends in an ellipsis.
  void rasterize(std::string_view text, int size_px, int max_width, TextBitmap& out);

 private:
  struct Face;
  std::unique_ptr<Face> face_;
};

}  // namespace depthscope::overlay
