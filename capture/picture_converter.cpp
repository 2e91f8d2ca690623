#include "capture/picture_converter.hpp"

#include <cstring>

namespace depthscope::capture {

namespace {

void copyPlanes(const AVFrame& picture, Frame& frame) {
  for (int plane = 0; plane < planeCount(frame.format.pixel_format); ++plane) {
    const PlaneSize size = planeSize(frame.format, plane);
    const Plane& to = frame.planes[plane];
    for (int row = 0; row < size.rows; ++row)
      std::memcpy(to.data + row * to.stride,
                  picture.data[plane] + std::ptrdiff_t{row} * picture.linesize[plane],
                  static_cast<std::size_t>(size.row_bytes));
  }
}

const int* swsCoefficients(YuvMatrix matrix) {
  return sws_getCoefficients(matrix == YuvMatrix::Bt709 ? SWS_CS_ITU709 : SWS_CS_ITU601);
}

}  // namespace

bool PictureConverter::convert(const AVFrame& picture, Frame& frame) {
  if (picture.width == frame.format.width && picture.height == frame.format.height &&
      plainPixelFormat(picture) == avPixelFormat(frame.format.pixel_format)) {
    copyPlanes(picture, frame);
    return true;
  }
  return scale(picture, frame);
}

bool PictureConverter::scale(const AVFrame& picture, Frame& frame) {
  const std::optional<FrameFormat> from = frameFormatOf(picture);
  if (!from) return false;
  const FrameFormat& to = frame.format;
  scaler_.reset(sws_getCachedContext(
      scaler_.release(), picture.width, picture.height, plainPixelFormat(picture), to.width,
      to.height, avPixelFormat(to.pixel_format),
      SWS_BILINEAR | SWS_ACCURATE_RND | SWS_BITEXACT | SWS_FULL_CHR_H_INP | SWS_FULL_CHR_H_INT,
      nullptr, nullptr, nullptr));
  if (!scaler_) return false;
  // Refused, to no harm, where neither side is YUV.
  sws_setColorspaceDetails(scaler_.get(), swsCoefficients(from->matrix),
                           from->range == YuvRange::Full, swsCoefficients(to.matrix),
                           to.range == YuvRange::Full, 0, 1 << 16, 1 << 16);
  std::uint8_t* data[4] = {};
  int strides[4] = {};
  for (int plane = 0; plane < planeCount(to.pixel_format); ++plane) {
    data[plane] = frame.planes[plane].data;
    strides[plane] = static_cast<int>(frame.planes[plane].stride);
  }
  return sws_scale(scaler_.get(), picture.data, picture.linesize, 0, picture.height, data,
                   strides) == to.height;
}

}  // namespace depthscope::capture
