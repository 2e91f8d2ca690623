#include "platform/png_writer.hpp"

#include <gtest/gtest.h>
#include <png.h>

#include <vector>

#include "temporary_folder.hpp"

namespace depthscope::platform {
namespace {

TEST(PngWriter, KeepsEveryPixel) {
  const TemporaryFolder folder;
  const int width = 5, height = 3, stride = 32;
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(stride * height));
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<std::uint8_t>(37 * i);
  writePng(folder.path() / "a.png", {pixels.data(), width, height, stride});

  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  ASSERT_TRUE(png_image_begin_read_from_file(&image, (folder.path() / "a.png").c_str()));
  ASSERT_EQ(image.width, 5u);
  ASSERT_EQ(image.height, 3u);
  image.format = PNG_FORMAT_RGB;
  std::vector<std::uint8_t> read(static_cast<std::size_t>(width * height * 3));
  ASSERT_TRUE(png_image_finish_read(&image, nullptr, read.data(), 0, nullptr));
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < 3; ++c)
        EXPECT_EQ(read[static_cast<std::size_t>((y * width + x) * 3 + c)],
                  pixels[static_cast<std::size_t>(y * stride + x * 4 + c)]);
}

TEST(PngWriter, NamesAFileThatCannotBeWritten) {
  const TemporaryFolder folder;
  const std::uint8_t pixel[4] = {};
  EXPECT_THROW(writePng(folder.path() / "none" / "a.png", {pixel, 1, 1, 4}), std::runtime_error);
}

}  // namespace
}  // namespace depthscope::platform
