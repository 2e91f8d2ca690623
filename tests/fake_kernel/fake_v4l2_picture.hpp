#pragma once
#include <linux/videodev2.h>

#include <array>
#include <cstddef>
#include <functional>
#include <vector>

namespace depthscope::fake {

struct Rgb {
  double r = 0, g = 0, b = 0;  // 0..1, nonlinear
};

/// How colours become samples.
struct Encoding {
  double k_red = 0.299, k_blue = 0.114;
  bool limited = true;
};

/// Where a picture of some format lies in a card's buffer.
struct FakeLayout {
  __u32 fourcc = 0, width = 0, height = 0;
  std::size_t pieces = 1;                       // separate pieces of memory
  std::array<std::size_t, 3> stride{}, size{};  // [bytes] of each piece: a line, all
};

/// The layout as a driver would choose it, with lines `padding` bytes longer than need be (a
/// multiple of 4). Compressed formats have no lines. `size` is all 0 for an unknown format.
FakeLayout fakeLayout(__u32 fourcc, __u32 width, __u32 height, std::size_t padding);

/// Paints `colour(x, y)` into the pieces of a buffer, in double precision and sample by sample;
/// chroma is taken at the first of the pixels that share it.
void paint(const FakeLayout& layout, const Encoding& encoding,
           const std::function<Rgb(int x, int y)>& colour, const std::array<std::byte*, 3>& pieces);

}  // namespace depthscope::fake
