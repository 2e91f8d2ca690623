#include "platform/display/picture_copy.hpp"

#include <algorithm>
#include <cstring>

#include "types/vector_clones.hpp"

namespace depthscope::platform {
namespace {

DEPTHSCOPE_CLONES
void toBgrx(const std::uint8_t* __restrict rgba, int pixels, std::uint8_t* __restrict out) {
  for (int i = 0; i < pixels; ++i) {
    std::uint32_t p = 0;
    std::memcpy(&p, rgba + 4 * i, 4);
    p = (p & 0xff00ff00u) | (p & 0xffu) << 16 | (p >> 16 & 0xffu);
    std::memcpy(out + 4 * i, &p, 4);
  }
}

DEPTHSCOPE_CLONES
void toBgr24(const std::uint8_t* __restrict rgba, int pixels, std::uint8_t* __restrict out) {
  for (int i = 0; i < pixels; ++i) {
    out[3 * i + 0] = rgba[4 * i + 2];
    out[3 * i + 1] = rgba[4 * i + 1];
    out[3 * i + 2] = rgba[4 * i + 0];
  }
}

DEPTHSCOPE_CLONES
void toRgb565(const std::uint8_t* __restrict rgba, int pixels, std::uint8_t* __restrict out) {
  for (int i = 0; i < pixels; ++i) {
    const unsigned red = rgba[4 * i] >> 3, green = rgba[4 * i + 1] >> 2,
                   blue = rgba[4 * i + 2] >> 3;
    const auto word = static_cast<std::uint16_t>(red << 11 | green << 5 | blue);
    std::memcpy(out + 2 * i, &word, 2);
  }
}

constexpr int fraction_bits = 8;
constexpr int one = 1 << fraction_bits;

/// A place between two samples of a line of `count`, for the middle of sample `i` of `scaled` ones.
struct Between {
  int first, second;
  int weight;  // of the second, of `one`
};

Between between(int i, int count, int scaled) {
  const std::int64_t at =
      std::max<std::int64_t>(0, ((2 * i + 1) * std::int64_t{count} * one / scaled - one) / 2);
  const int first = std::min(static_cast<int>(at >> fraction_bits), count - 1);
  return {first, std::min(first + 1, count - 1), static_cast<int>(at & (one - 1))};
}

}  // namespace

void copyRow(const std::uint8_t* rgba, int pixels, PixelLayout layout, std::uint8_t* out) {
  switch (layout) {
    case PixelLayout::Rgbx32:
      std::memcpy(out, rgba, static_cast<std::size_t>(pixels) * 4);
      break;
    case PixelLayout::Bgrx32:
      toBgrx(rgba, pixels, out);
      break;
    case PixelLayout::Bgr24:
      toBgr24(rgba, pixels, out);
      break;
    case PixelLayout::Rgb565:
      toRgb565(rgba, pixels, out);
      break;
  }
}

int bytesPerPixel(PixelLayout layout) {
  return layout == PixelLayout::Rgb565 ? 2 : layout == PixelLayout::Bgr24 ? 3 : 4;
}

Placement placePicture(int picture_width, int picture_height, int screen_width, int screen_height) {
  Placement place{0, 0, picture_width, picture_height};
  if (picture_width > screen_width || picture_height > screen_height) {
    const std::int64_t by_width = std::int64_t{screen_width} * picture_height;
    const std::int64_t by_height = std::int64_t{screen_height} * picture_width;
    if (by_width <= by_height) {
      place.width = screen_width;
      place.height = static_cast<int>(std::max<std::int64_t>(1, by_width / picture_width));
    } else {
      place.height = screen_height;
      place.width = static_cast<int>(std::max<std::int64_t>(1, by_height / picture_height));
    }
  }
  place.x = (screen_width - place.width) / 2;
  place.y = (screen_height - place.height) / 2;
  return place;
}

/// Row `row` of the scaled picture, by bilinear interpolation.
const std::uint8_t* PictureCopier::scaledRow(const RgbaView& picture, const Placement& place,
                                             int row) {
  row_.resize(std::max(row_.size(), static_cast<std::size_t>(place.width) * 4));
  const Between y = between(row, picture.height, place.height);
  const std::uint8_t *upper = picture.row(y.first), *lower = picture.row(y.second);
  for (int i = 0; i < place.width; ++i) {
    const Between x = between(i, picture.width, place.width);
    for (int c = 0; c < 4; ++c) {
      const int top =
          upper[4 * x.first + c] * (one - x.weight) + upper[4 * x.second + c] * x.weight;
      const int low =
          lower[4 * x.first + c] * (one - x.weight) + lower[4 * x.second + c] * x.weight;
      row_[static_cast<std::size_t>(4 * i + c)] = static_cast<std::uint8_t>(
          (top * (one - y.weight) + low * y.weight + one * one / 2) >> (2 * fraction_bits));
    }
  }
  return row_.data();
}

void PictureCopier::copy(const RgbaView& picture, const ScanoutView& screen) {
  const Placement place = placePicture(picture.width, picture.height, screen.width, screen.height);
  const bool scaled = place.width != picture.width || place.height != picture.height;
  for (int y = 0; y < place.height; ++y) {
    std::uint8_t* to = screen.data + static_cast<std::ptrdiff_t>(place.y + y) * screen.stride +
                       static_cast<std::ptrdiff_t>(place.x) * bytesPerPixel(screen.layout);
    copyRow(scaled ? scaledRow(picture, place, y) : picture.row(y), place.width, screen.layout, to);
  }
}

}  // namespace depthscope::platform
