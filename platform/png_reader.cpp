#include "platform/png_reader.hpp"

#include <png.h>

#include <bit>
#include <csetjmp>
#include <cstdio>
#include <memory>

#include "types/error.hpp"

namespace depthscope::platform {
namespace {

constexpr png_uint_32 kMaxSide_px = 16384;

/// libpng's objects for reading one file.
struct PngReader {
  explicit PngReader(std::FILE* file)
      : png(png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, giveUp, ignore)) {
    if (png != nullptr) info = png_create_info_struct(png);
    if (info != nullptr) png_init_io(png, file);
  }
  ~PngReader() { png_destroy_read_struct(&png, &info, nullptr); }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;

  static void giveUp(png_structp png, png_const_charp) { png_longjmp(png, 1); }
  static void ignore(png_structp, png_const_charp) {}
  png_structp png = nullptr;
  png_infop info = nullptr;
};

/// False where libpng finds an error; it comes back here by longjmp, past nothing that has a
/// destructor.
bool readHeader(const PngReader& reader, png_uint_32& width, png_uint_32& height, bool& grey16) {
  if (setjmp(png_jmpbuf(reader.png)) != 0) return false;
  png_read_info(reader.png, reader.info);
  width = png_get_image_width(reader.png, reader.info);
  height = png_get_image_height(reader.png, reader.info);
  grey16 = png_get_bit_depth(reader.png, reader.info) == 16 &&
           png_get_color_type(reader.png, reader.info) == PNG_COLOR_TYPE_GRAY;
  if (std::endian::native == std::endian::little) png_set_swap(reader.png);
  return true;
}

bool readRows(const PngReader& reader, png_bytepp rows) {
  if (setjmp(png_jmpbuf(reader.png)) != 0) return false;
  png_read_image(reader.png, rows);
  return true;
}

}  // namespace

Gray16Picture readGray16Png(const std::filesystem::path& path) {
  const auto fail = [&] { throw InputError(path.string() + ": expected a 16-bit grey PNG"); };
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"),
                                                             std::fclose);
  if (!file) throw InputError(path.string() + ": cannot be read");
  const PngReader reader(file.get());
  png_uint_32 width = 0, height = 0;
  bool grey16 = false;
  if (reader.info == nullptr || !readHeader(reader, width, height, grey16) || !grey16 ||
      width > kMaxSide_px || height > kMaxSide_px)
    fail();
  Gray16Picture picture;
  picture.width = static_cast<int>(width);
  picture.height = static_cast<int>(height);
  picture.pixels.resize(std::size_t{width} * height);
  std::vector<png_bytep> rows(height);
  for (png_uint_32 y = 0; y < height; ++y)
    rows[y] = reinterpret_cast<png_bytep>(picture.pixels.data() + std::size_t{y} * width);
  if (!readRows(reader, rows.data())) fail();
  return picture;
}

}  // namespace depthscope::platform
