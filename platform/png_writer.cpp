#include "platform/png_writer.hpp"

#include <png.h>

#include <stdexcept>
#include <vector>

namespace depthscope::platform {

void writePng(const std::filesystem::path& path, const RgbaView& picture) {
  const auto width = static_cast<std::size_t>(picture.width),
             height = static_cast<std::size_t>(picture.height);
  std::vector<std::uint8_t> rgb(width * height * 3);
  std::uint8_t* out = rgb.data();
  for (int y = 0; y < picture.height; ++y) {
    const std::uint8_t* in = picture.row(y);
    for (std::size_t x = 0; x < width; ++x, in += 4, out += 3) {
      out[0] = in[0];
      out[1] = in[1];
      out[2] = in[2];
    }
  }
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width);
  image.height = static_cast<png_uint_32>(height);
  image.format = PNG_FORMAT_RGB;
  if (!png_image_write_to_file(&image, path.c_str(), 0, rgb.data(), 0, nullptr))
    throw std::runtime_error(path.string() + ": cannot be written: " + image.message);
}

}  // namespace depthscope::platform
