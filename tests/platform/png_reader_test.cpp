#include "platform/png_reader.hpp"

#include <gtest/gtest.h>
#include <png.h>

#include <fstream>
#include <vector>

#include "temporary_folder.hpp"
#include "types/error.hpp"

namespace depthscope::platform {
namespace {

/// Writes grey values as libpng's 16-bit linear format, which is stored as it is.
void write(const std::filesystem::path& path, const std::vector<std::uint16_t>& pixels, int width) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width);
  image.height = static_cast<png_uint_32>(pixels.size() / static_cast<std::size_t>(width));
  image.format = PNG_FORMAT_LINEAR_Y;
  ASSERT_TRUE(png_image_write_to_file(&image, path.c_str(), 0, pixels.data(), 0, nullptr));
}

TEST(PngReader, KeepsEveryBitOfADepthMap) {
  const TemporaryFolder folder;
  const std::vector<std::uint16_t> pixels = {0, 1, 255, 256, 10000, 65535};
  write(folder.path() / "depth.png", pixels, 3);
  const Gray16Picture read = readGray16Png(folder.path() / "depth.png");
  EXPECT_EQ(read.width, 3);
  EXPECT_EQ(read.height, 2);
  EXPECT_EQ(read.pixels, pixels);
  EXPECT_EQ(read.at(1, 1), 10000);
}

TEST(PngReader, NamesWhatCannotBeRead) {
  const TemporaryFolder folder;
  EXPECT_THROW(readGray16Png(folder.path() / "none.png"), InputError);
  std::ofstream(folder.path() / "text.png") << "no picture";
  EXPECT_THROW(readGray16Png(folder.path() / "text.png"), InputError);

  const std::uint8_t grey8[4] = {1, 2, 3, 4};
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = image.height = 2;
  image.format = PNG_FORMAT_GRAY;
  ASSERT_TRUE(
      png_image_write_to_file(&image, (folder.path() / "grey8.png").c_str(), 0, grey8, 0, nullptr));
  EXPECT_THROW(readGray16Png(folder.path() / "grey8.png"), InputError);
}

TEST(PngReader, RefusesAPictureThatBreaksOff) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "depth.png";
  std::vector<std::uint16_t> pixels(64 * 64);
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<std::uint16_t>(i * 977);
  write(path, pixels, 64);
  std::filesystem::resize_file(path, std::filesystem::file_size(path) / 2);
  EXPECT_THROW(readGray16Png(path), InputError);
}

}  // namespace
}  // namespace depthscope::platform
