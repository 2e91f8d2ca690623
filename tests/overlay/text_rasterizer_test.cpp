#include "overlay/text_rasterizer.hpp"

#include <gmock/gmock.h>

#include <fstream>

#include "types/error.hpp"

namespace depthscope::overlay {
namespace {

TEST(TextRasterizer, NamesTheFontFileThatIsMissing) {
  try {
    TextRasterizer text("/nowhere/none.ttf");
    FAIL() << "no error";
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), testing::AllOf(testing::HasSubstr("/nowhere/none.ttf"),
                                         testing::HasSubstr("font_file"),
                                         testing::Not(testing::HasSubstr("\n"))));
  }
}

TEST(TextRasterizer, RefusesAFileThatIsNoFont) {
  const std::string file = testing::TempDir() + "depthscope_no_font.ttf";
  std::ofstream(file) << "this is no font";
  EXPECT_THROW(TextRasterizer{file}, InputError);
}

TEST(TextRasterizer, DrawsGlyphsWithADarkSurroundAroundThem) {
  TextRasterizer text("");
  TextBitmap b;
  text.rasterize("Hepatic vein", 16, 400, b);
  EXPECT_EQ(b.height, text.height(16));
  EXPECT_GT(b.width, 60);
  int glyph = 0, surround = 0;
  for (std::size_t i = 0; i < b.pixels.size(); i += 2) {
    EXPECT_GE(b.pixels[i + 1] + 60, b.pixels[i]);
    glyph += b.pixels[i] > 128;
    surround += b.pixels[i + 1] > 128;
  }
  EXPECT_GT(glyph, 100);
  EXPECT_GT(surround, 2 * glyph);
}

TEST(TextRasterizer, CutsWhatIsTooLong) {
  TextRasterizer text("");
  TextBitmap all, cut;
  text.rasterize("A very long label that nobody could want", 16, 1000, all);
  text.rasterize("A very long label that nobody could want", 16, 120, cut);
  EXPECT_GT(all.width, 200);
  EXPECT_LE(cut.width, 120);
  EXPECT_GT(cut.width, 90);
}

TEST(TextRasterizer, SurvivesBytesThatAreNoText) {
  TextRasterizer text("");
  TextBitmap b;
  for (const char* bad : {"\xff\xfe", "\xc3", "\xf0\x9f", "a\x80z", "\n\t", ""})
    text.rasterize(bad, 14, 200, b);
  text.rasterize("Gef\xc3\xa4\xc3\x9f", 14, 200, b);
  EXPECT_GT(b.width, 20);
}

}  // namespace
}  // namespace depthscope::overlay
