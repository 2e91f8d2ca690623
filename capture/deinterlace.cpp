#include "capture/deinterlace.hpp"

#include <algorithm>
#include <cstring>

namespace depthscope::capture {
namespace {

void meanRow(const std::uint8_t* __restrict above, const std::uint8_t* __restrict below, int bytes,
             std::uint8_t* __restrict out) {
  for (int i = 0; i < bytes; ++i) out[i] = static_cast<std::uint8_t>((above[i] + below[i] + 1) / 2);
}

}  // namespace

void deinterlace(const Frame& from, const FieldLines& lines, Frame& whole) {
  using Place = FieldLines::Place;
  const int parity = lines.top ? 0 : 1;
  for (std::size_t p = 0; p < static_cast<std::size_t>(planeCount(whole.format.pixel_format));
       ++p) {
    const PlaneSize size = planeSize(whole.format, static_cast<int>(p));
    const int count = std::max(1, (size.rows - parity + 1) / 2);
    const int step = lines.place == Place::Woven ? 2 : 1;
    const int first = lines.place == Place::Woven        ? parity
                      : lines.place == Place::SecondHalf ? (size.rows + 1) / 2
                                                         : 0;
    const auto lineOf = [&](int line) {
      return from.planes[p].data +
             (first + std::clamp(line, 0, count - 1) * step) * from.planes[p].stride;
    };
    for (int row = 0; row < size.rows; ++row) {
      std::uint8_t* out = whole.planes[p].data + row * whole.planes[p].stride;
      if (row % 2 == parity)
        std::memcpy(out, lineOf(row / 2), static_cast<std::size_t>(size.row_bytes));
      else
        meanRow(lineOf((row - 1 - parity) / 2), lineOf((row + 1 - parity) / 2), size.row_bytes,
                out);
    }
  }
}

}  // namespace depthscope::capture
