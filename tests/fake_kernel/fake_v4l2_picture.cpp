#include "tests/fake_kernel/fake_v4l2_picture.hpp"

#include <algorithm>
#include <cmath>

namespace depthscope::fake {
namespace {

/// Where component samples go: in units of bytes from the start of a piece.
struct Shape {
  __u32 fourcc;
  std::size_t pieces, planes;
  int across, down;  // pixels that share a chroma sample
  bool interleaved;  // U and V in one plane
};
constexpr Shape kPlanar[] = {
    {V4L2_PIX_FMT_NV12, 1, 2, 2, 2, true},     {V4L2_PIX_FMT_NV12M, 2, 2, 2, 2, true},
    {V4L2_PIX_FMT_NV16, 1, 2, 2, 1, true},     {V4L2_PIX_FMT_NV16M, 2, 2, 2, 1, true},
    {V4L2_PIX_FMT_YUV420, 1, 3, 2, 2, false},  {V4L2_PIX_FMT_YUV420M, 3, 3, 2, 2, false},
    {V4L2_PIX_FMT_YUV422P, 1, 3, 2, 1, false}, {V4L2_PIX_FMT_GREY, 1, 1, 1, 1, false},
};

const Shape* planar(__u32 fourcc) {
  for (const Shape& shape : kPlanar)
    if (shape.fourcc == fourcc) return &shape;
  return nullptr;
}

std::size_t packedBytes(__u32 fourcc) {
  switch (fourcc) {
    case V4L2_PIX_FMT_YUYV:
    case V4L2_PIX_FMT_UYVY:
      return 2;
    case V4L2_PIX_FMT_BGR24:
    case V4L2_PIX_FMT_RGB24:
      return 3;
    case V4L2_PIX_FMT_XBGR32:
      return 4;
    default:
      return 0;
  }
}

std::byte sample(double value) {
  return static_cast<std::byte>(std::clamp(std::lround(value), 0l, 255l));
}

struct Samples {
  std::byte y, u, v, r, g, b;
};

Samples encode(const Rgb& c, const Encoding& e) {
  const double y = e.k_red * c.r + (1 - e.k_red - e.k_blue) * c.g + e.k_blue * c.b;
  const double u = (c.b - y) / (2 * (1 - e.k_blue)), v = (c.r - y) / (2 * (1 - e.k_red));
  const double zero = e.limited ? 16 : 0, span = e.limited ? 219 : 255;
  const double chroma = e.limited ? 224 : 255;
  return {sample(zero + span * y),   sample(128 + chroma * u),  sample(128 + chroma * v),
          sample(zero + span * c.r), sample(zero + span * c.g), sample(zero + span * c.b)};
}

void paintPacked(const FakeLayout& l, int x, const Samples& s, std::byte* row) {
  const std::size_t i = static_cast<std::size_t>(x);
  switch (l.fourcc) {
    case V4L2_PIX_FMT_YUYV:
    case V4L2_PIX_FMT_UYVY: {
      const std::size_t luma = l.fourcc == V4L2_PIX_FMT_UYVY, chroma = 1 - luma;
      row[2 * i + luma] = s.y;
      if (x % 2 == 0) row[2 * i + chroma] = s.u, row[2 * i + 2 + chroma] = s.v;
      break;
    }
    case V4L2_PIX_FMT_RGB24:
      row[3 * i] = s.r, row[3 * i + 1] = s.g, row[3 * i + 2] = s.b;
      break;
    case V4L2_PIX_FMT_BGR24:
      row[3 * i] = s.b, row[3 * i + 1] = s.g, row[3 * i + 2] = s.r;
      break;
    default:
      row[4 * i] = s.b, row[4 * i + 1] = s.g, row[4 * i + 2] = s.r, row[4 * i + 3] = std::byte{9};
  }
}

}  // namespace

FakeLayout fakeLayout(__u32 fourcc, __u32 width, __u32 height, std::size_t padding) {
  FakeLayout l{fourcc, width, height, 1, {}, {}};
  if (const std::size_t bytes = packedBytes(fourcc)) {
    l.stride[0] = bytes * (width + (bytes == 2 ? width % 2 : 0)) + padding;
    l.size[0] = l.stride[0] * height;
  } else if (const Shape* shape = planar(fourcc)) {
    l.pieces = shape->pieces;
    const auto chroma_rows =
        (height + static_cast<__u32>(shape->down) - 1) / static_cast<__u32>(shape->down);
    const std::size_t first = width + width % 2 + padding;
    for (std::size_t plane = 0; plane < shape->planes; ++plane) {
      const std::size_t stride = plane > 0 && !shape->interleaved ? first / 2 : first;
      const std::size_t piece = std::min(plane, shape->pieces - 1);
      if (l.stride[piece] == 0) l.stride[piece] = stride;
      l.size[piece] += stride * (plane == 0 ? height : chroma_rows);
    }
  } else if (fourcc == V4L2_PIX_FMT_MJPEG) {
    l.size[0] = 2 * width * height + 1024;
  }
  return l;
}

void paint(const FakeLayout& l, const Encoding& encoding,
           const std::function<Rgb(int x, int y)>& colour,
           const std::array<std::byte*, 3>& pieces) {
  const Shape* shape = planar(l.fourcc);
  std::array<std::byte*, 3> plane = pieces;
  if (shape && shape->pieces == 1) {
    plane[1] = plane[0] + l.stride[0] * l.height;
    const auto chroma_rows =
        (l.height + static_cast<__u32>(shape->down) - 1) / static_cast<__u32>(shape->down);
    plane[2] = plane[1] + l.stride[0] / 2 * chroma_rows;
  }
  for (int y = 0; y < static_cast<int>(l.height); ++y)
    for (int x = 0; x < static_cast<int>(l.width); ++x) {
      const Samples s = encode(colour(x, y), encoding);
      if (!shape) {
        paintPacked(l, x, s, pieces[0] + static_cast<std::size_t>(y) * l.stride[0]);
        continue;
      }
      plane[0][static_cast<std::size_t>(y) * l.stride[0] + static_cast<std::size_t>(x)] = s.y;
      if (shape->planes == 1 || x % shape->across != 0 || y % shape->down != 0) continue;
      const auto row = static_cast<std::size_t>(y / shape->down),
                 half = static_cast<std::size_t>(x / 2);
      const std::size_t whole = shape->pieces > 1 ? l.stride[1] : l.stride[0];
      if (shape->interleaved) {
        plane[1][row * whole + 2 * half] = s.u;
        plane[1][row * whole + 2 * half + 1] = s.v;
      } else {
        const std::size_t stride = shape->pieces > 1 ? l.stride[1] : l.stride[0] / 2;
        plane[1][row * stride + half] = s.u;
        plane[2][row * stride + half] = s.v;
      }
    }
}

}  // namespace depthscope::fake
