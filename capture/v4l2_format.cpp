#include "capture/v4l2_format.hpp"

#include <algorithm>

namespace depthscope::capture {
namespace {

struct KnownFormat {
  __u32 fourcc;
  PixelFormat pixels;
  bool split;  // each plane in memory of its own
  bool jpeg;
};

/// In the order of preference: full detail in colour first, then what is cheap to read.
constexpr KnownFormat kFormats[] = {
    {V4L2_PIX_FMT_YUYV, PixelFormat::Yuyv, false, false},
    {V4L2_PIX_FMT_UYVY, PixelFormat::Uyvy, false, false},
    {V4L2_PIX_FMT_NV16, PixelFormat::Nv16, false, false},
    {V4L2_PIX_FMT_NV16M, PixelFormat::Nv16, true, false},
    {V4L2_PIX_FMT_YUV422P, PixelFormat::Yuv422p, false, false},
    {V4L2_PIX_FMT_XBGR32, PixelFormat::Bgrx32, false, false},
    {V4L2_PIX_FMT_BGR24, PixelFormat::Bgr24, false, false},
    {V4L2_PIX_FMT_RGB24, PixelFormat::Rgb24, false, false},
    {V4L2_PIX_FMT_NV12, PixelFormat::Nv12, false, false},
    {V4L2_PIX_FMT_NV12M, PixelFormat::Nv12, true, false},
    {V4L2_PIX_FMT_YUV420, PixelFormat::Yuv420p, false, false},
    {V4L2_PIX_FMT_YUV420M, PixelFormat::Yuv420p, true, false},
    {V4L2_PIX_FMT_GREY, PixelFormat::Gray8, false, false},
    {V4L2_PIX_FMT_MJPEG, PixelFormat::Yuv422p, false, true},
    {V4L2_PIX_FMT_JPEG, PixelFormat::Yuv422p, false, true},
};

const KnownFormat* known(__u32 fourcc) {
  const auto* found = std::find_if(std::begin(kFormats), std::end(kFormats),
                                   [&](const KnownFormat& f) { return f.fourcc == fourcc; });
  return found == std::end(kFormats) ? nullptr : found;
}

/// The parts of struct v4l2_format that both interfaces have.
struct PlainFormat {
  __u32 width, height, fourcc, field, colorspace, encoding, quantization, memory_planes;
  std::array<__u32, 3> stride, size;
};

PlainFormat plain(const v4l2_format& f) {
  if (f.type == V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE) {
    const v4l2_pix_format_mplane& p = f.fmt.pix_mp;
    const auto& q = p.plane_fmt;
    return {p.width,
            p.height,
            p.pixelformat,
            p.field,
            p.colorspace,
            p.ycbcr_enc,
            p.quantization,
            p.num_planes,
            {q[0].bytesperline, q[1].bytesperline, q[2].bytesperline},
            {q[0].sizeimage, q[1].sizeimage, q[2].sizeimage}};
  }
  const v4l2_pix_format& p = f.fmt.pix;
  return {p.width,
          p.height,
          p.pixelformat,
          p.field,
          p.colorspace,
          p.ycbcr_enc,
          p.quantization,
          1,
          {p.bytesperline, 0, 0},
          {p.sizeimage, 0, 0}};
}

bool isRgb(PixelFormat format) {
  return format == PixelFormat::Rgb24 || format == PixelFormat::Bgr24 ||
         format == PixelFormat::Bgrx32;
}

/// What the driver leaves at "default" means what videodev2.h says it does; an unknown colour space
/// is taken as that of television of its size.
void setColour(const PlainFormat& from, FrameFormat& format) {
  const bool rgb = isRgb(format.pixel_format);
  // A grey picture is no half of a television signal: drivers send it with all levels.
  const bool gray = format.pixel_format == PixelFormat::Gray8;
  __u32 space = from.colorspace;
  if (space == V4L2_COLORSPACE_DEFAULT)
    space = rgb ? V4L2_COLORSPACE_SRGB
                : V4L2_MAP_COLORSPACE_DEFAULT(format.height <= 576, format.height > 576);
  __u32 encoding = from.encoding;
  if (encoding == V4L2_YCBCR_ENC_DEFAULT) encoding = V4L2_MAP_YCBCR_ENC_DEFAULT(space);
  __u32 range = from.quantization;
  if (range == V4L2_QUANTIZATION_DEFAULT)
    range = V4L2_MAP_QUANTIZATION_DEFAULT(rgb || gray, space, encoding);
  format.range = range == V4L2_QUANTIZATION_FULL_RANGE ? YuvRange::Full : YuvRange::Limited;
  switch (encoding) {
    case V4L2_YCBCR_ENC_709:
    case V4L2_YCBCR_ENC_XV709:
    case V4L2_YCBCR_ENC_SMPTE240M:  // differs from BT.709 in the third decimal
      format.matrix = YuvMatrix::Bt709;
      break;
    case V4L2_YCBCR_ENC_BT2020:
      format.matrix = YuvMatrix::Bt2020;
      break;
    default:
      format.matrix = YuvMatrix::Bt601;
  }
  if (rgb) format.matrix = YuvMatrix::Bt601;  // has no meaning: equal formats compare equal
}

/// How a plane's stride follows from that of the first, in one piece of memory.
std::ptrdiff_t strideOf(PixelFormat format, int plane, std::ptrdiff_t first) {
  const bool halved = format == PixelFormat::Yuv420p || format == PixelFormat::Yuv422p;
  return plane > 0 && halved ? first / 2 : first;
}

bool placePlanes(const PlainFormat& from, const KnownFormat& format, V4l2Layout& layout) {
  std::size_t offset = 0;
  for (int i = 0; i < planeCount(format.pixels); ++i) {
    const PlaneSize size = planeSize(layout.format, i);
    auto& plane = layout.planes[i];
    plane.memory = format.split ? i : 0;
    const auto told = static_cast<std::ptrdiff_t>(from.stride[plane.memory]);
    plane.stride = format.split ? told : strideOf(format.pixels, i, told);
    if (plane.stride == 0) plane.stride = size.row_bytes;
    if (plane.stride < size.row_bytes) return false;
    plane.offset = format.split ? 0 : offset;
    const std::size_t bytes =
        static_cast<std::size_t>(plane.stride) * (size.rows - 1) + size.row_bytes;
    layout.needed[plane.memory] = plane.offset + bytes;
    offset += static_cast<std::size_t>(plane.stride) * size.rows;
  }
  for (int i = 0; i < layout.memory_planes; ++i)
    if (from.size[i] < layout.needed[i]) return false;
  return true;
}

}  // namespace

std::string fourccText(__u32 fourcc) {
  std::string text;
  for (int shift = 0; shift < 32; shift += 8)
    text += static_cast<char>(fourcc >> shift & (shift == 24 ? 0x7f : 0xff));
  if (fourcc & 1u << 31) text += "-BE";
  return text;
}

std::span<const __u32> preferredFormats() {
  static constexpr auto kFourccs = [] {
    std::array<__u32, std::size(kFormats)> list{};
    for (std::size_t i = 0; i < list.size(); ++i) list[i] = kFormats[i].fourcc;
    return list;
  }();
  return kFourccs;
}

std::optional<V4l2Layout> layoutOf(const v4l2_format& format) {
  const PlainFormat from = plain(format);
  const KnownFormat* pixels = known(from.fourcc);
  constexpr auto kMax = static_cast<__u32>(FramePool::kMaxSide_px);
  if (pixels == nullptr || from.width == 0 || from.height == 0 || from.width > kMax ||
      from.height > kMax)
    return std::nullopt;
  V4l2Layout layout;
  layout.fourcc = from.fourcc;
  layout.format.pixel_format = pixels->pixels;
  layout.format.width = static_cast<int>(from.width);
  layout.format.height = static_cast<int>(from.height);
  layout.field = from.field;
  layout.jpeg = pixels->jpeg;
  setColour(from, layout.format);
  const int pieces = pixels->split ? planeCount(pixels->pixels) : 1;
  if (from.memory_planes != static_cast<__u32>(pieces)) return std::nullopt;
  layout.memory_planes = pieces;
  if (!layout.jpeg && !placePlanes(from, *pixels, layout)) return std::nullopt;
  return layout;
}

}  // namespace depthscope::capture
