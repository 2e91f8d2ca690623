#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "types/image_view.hpp"

namespace depthscope::platform {

/// How a display's memory holds a pixel.
enum class PixelLayout : std::uint8_t {
  Rgbx32,  // bytes R G B A
  Bgrx32,  // bytes B G R A
  Bgr24,   // bytes B G R
  Rgb565,  // a 16-bit word, red in the highest bits
};

int bytesPerPixel(PixelLayout layout);

/// Memory that is scanned out.
struct ScanoutView {
  std::uint8_t* data = nullptr;
  int width = 0, height = 0;  // [px]
  int stride = 0;             // [bytes]
  PixelLayout layout = PixelLayout::Bgrx32;
};

/// Where a picture comes to lie on a screen.
struct Placement {
  int x = 0, y = 0;           // [px] top left
  int width = 0, height = 0;  // [px] the picture's own unless it is scaled down
};

/// Writes `pixels` pixels of R G B A bytes as the layout has them.
void copyRow(const std::uint8_t* rgba, int pixels, PixelLayout layout, std::uint8_t* out);

/// In the middle, pixel for pixel; a picture larger than the screen is scaled down as far as
/// needed, in its proportions.
Placement placePicture(int picture_width, int picture_height, int screen_width, int screen_height);

/// Copies pictures into scan-out memory. The memory is only ever written, in one sweep of whole
/// rows, since much of it is write-combined.
class PictureCopier {
 public:
  /// Sets `picture` at its place; what is around stays as it is. Allocates only when the width of a
  /// picture to scale down grows.
  void copy(const RgbaView& picture, const ScanoutView& screen);

 private:
  const std::uint8_t* scaledRow(const RgbaView& picture, const Placement& place, int row);

  std::vector<std::uint8_t> row_;
};

}  // namespace depthscope::platform
