#include "platform/display/dma_picture.hpp"

#include <drm_fourcc.h>

namespace depthscope::platform {
namespace {

using capture::PixelFormat;

/// 0: displays have no such format.
std::uint32_t fourccOf(PixelFormat format) {
  switch (format) {
    case PixelFormat::Rgb24:
      return DRM_FORMAT_BGR888;  // named from the highest byte of a little-endian word down
    case PixelFormat::Bgr24:
      return DRM_FORMAT_RGB888;
    case PixelFormat::Rgba32:
      return DRM_FORMAT_XBGR8888;
    case PixelFormat::Bgrx32:
      return DRM_FORMAT_XRGB8888;
    case PixelFormat::Yuv420p:
      return DRM_FORMAT_YUV420;
    case PixelFormat::Yuv422p:
      return DRM_FORMAT_YUV422;
    case PixelFormat::Yuv444p:
      return DRM_FORMAT_YUV444;
    case PixelFormat::Nv12:
      return DRM_FORMAT_NV12;
    case PixelFormat::Nv16:
      return DRM_FORMAT_NV16;
    case PixelFormat::Yuyv:
      return DRM_FORMAT_YUYV;
    case PixelFormat::Uyvy:
      return DRM_FORMAT_UYVY;
    default:
      return 0;
  }
}

bool isRgb(PixelFormat format) {
  return format == PixelFormat::Rgb24 || format == PixelFormat::Bgr24 ||
         format == PixelFormat::Rgba32 || format == PixelFormat::Bgrx32;
}

DmaPicture::Encoding encodingOf(const capture::FrameFormat& format) {
  if (isRgb(format.pixel_format)) return DmaPicture::Encoding::Rgb;
  switch (format.matrix) {
    case capture::YuvMatrix::Bt601:
      break;
    case capture::YuvMatrix::Bt709:
      return DmaPicture::Encoding::Bt709;
    case capture::YuvMatrix::Bt2020:
      return DmaPicture::Encoding::Bt2020;
  }
  return DmaPicture::Encoding::Bt601;
}

}  // namespace

std::optional<DmaPicture> dmaPicture(const capture::Frame& frame) {
  const capture::FrameFormat& format = frame.format;
  DmaPicture picture;
  picture.fourcc = fourccOf(format.pixel_format);
  picture.width = format.width;
  picture.height = format.height;
  picture.plane_count = capture::planeCount(format.pixel_format);
  picture.encoding = encodingOf(format);
  picture.full_range = format.range == capture::YuvRange::Full;
  // No plane stretches RGB of limited range.
  if (picture.fourcc == 0 || (picture.encoding == DmaPicture::Encoding::Rgb && !picture.full_range))
    return std::nullopt;
  for (std::size_t i = 0; i < static_cast<std::size_t>(picture.plane_count); ++i) {
    if (frame.dma[i].fd < 0 || frame.planes[i].stride <= 0) return std::nullopt;
    picture.planes[i] = {frame.dma[i].fd, frame.dma[i].offset,
                         static_cast<std::uint32_t>(frame.planes[i].stride)};
  }
  return picture;
}

}  // namespace depthscope::platform
