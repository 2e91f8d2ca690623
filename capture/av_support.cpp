#include "capture/av_support.hpp"

extern "C" {
#include <libavutil/log.h>
#include <libavutil/pixdesc.h>
}

#include <array>
#include <new>

namespace depthscope::capture {

namespace {

constexpr int kLastStandardDefinitionLine = 576;

bool isJpegFormat(int format) {
  return format == AV_PIX_FMT_YUVJ420P || format == AV_PIX_FMT_YUVJ422P ||
         format == AV_PIX_FMT_YUVJ444P || format == AV_PIX_FMT_YUVJ440P ||
         format == AV_PIX_FMT_YUVJ411P;
}

PixelFormat nearestFormat(AVPixelFormat format, const AVPixFmtDescriptor& descriptor) {
  switch (format) {
    case AV_PIX_FMT_NV12:
      return PixelFormat::Nv12;
    case AV_PIX_FMT_BGR24:
      return PixelFormat::Bgr24;
    default:
      break;
  }
  if (descriptor.flags & (AV_PIX_FMT_FLAG_RGB | AV_PIX_FMT_FLAG_PAL)) return PixelFormat::Rgb24;
  return descriptor.nb_components <= 2 ? PixelFormat::Gray8 : PixelFormat::Yuv420p;
}

YuvMatrix matrixOf(const AVFrame& picture) {
  switch (picture.colorspace) {
    case AVCOL_SPC_BT470BG:
    case AVCOL_SPC_SMPTE170M:
    case AVCOL_SPC_FCC:
      return YuvMatrix::Bt601;
    case AVCOL_SPC_UNSPECIFIED:
      return picture.height > kLastStandardDefinitionLine ? YuvMatrix::Bt709 : YuvMatrix::Bt601;
    default:
      return YuvMatrix::Bt709;
  }
}

}  // namespace

AvPtr<AVFrame> makeAvFrame() {
  AvPtr<AVFrame> frame(av_frame_alloc());
  if (!frame) throw std::bad_alloc();
  return frame;
}

AvPtr<AVPacket> makeAvPacket() {
  AvPtr<AVPacket> packet(av_packet_alloc());
  if (!packet) throw std::bad_alloc();
  return packet;
}

AvPtr<AVCodecContext> openDecoder(const AVCodecParameters& parameters, bool strict) {
  const AVCodec* decoder = avcodec_find_decoder(parameters.codec_id);
  if (!decoder) return nullptr;
  AvPtr<AVCodecContext> codec(avcodec_alloc_context3(decoder));
  if (!codec) throw std::bad_alloc();
  if (avcodec_parameters_to_context(codec.get(), &parameters) < 0) return nullptr;
  codec->thread_count = 1;
  // A damaged picture, marked as such, rather than a gap that would shift the time of all that
  // follow.
  codec->flags |= AV_CODEC_FLAG_OUTPUT_CORRUPT;
  if (strict)
    codec->err_recognition |= AV_EF_CRCCHECK | AV_EF_BITSTREAM | AV_EF_BUFFER | AV_EF_EXPLODE;
  if (avcodec_open2(codec.get(), decoder, nullptr) < 0) return nullptr;
  return codec;
}

void silenceAv() {
  av_log_set_level(AV_LOG_QUIET);
}

std::string avErrorText(int error) {
  std::array<char, AV_ERROR_MAX_STRING_SIZE> text{};
  av_strerror(error, text.data(), text.size());
  return text.data();
}

std::optional<FrameFormat> frameFormatOf(const AVFrame& picture) {
  const AVPixelFormat format = plainPixelFormat(picture);
  const AVPixFmtDescriptor* descriptor = av_pix_fmt_desc_get(format);
  if (!descriptor || !sws_isSupportedInput(format)) return std::nullopt;
  FrameFormat result;
  result.pixel_format = nearestFormat(format, *descriptor);
  result.width = picture.width;
  result.height = picture.height;
  const bool full = picture.color_range == AVCOL_RANGE_JPEG || isJpegFormat(picture.format);
  result.range = full ? YuvRange::Full : YuvRange::Limited;
  switch (
      result.pixel_format) {  // what has no meaning is always the same: equal formats compare equal
    case PixelFormat::Yuv420p:
    case PixelFormat::Nv12:
      result.matrix = matrixOf(picture);
      break;
    case PixelFormat::Gray8:
      break;
    default:
      result.range = YuvRange::Full;
  }
  return result;
}

AVPixelFormat avPixelFormat(PixelFormat format) {
  switch (format) {
    case PixelFormat::Gray8:
      return AV_PIX_FMT_GRAY8;
    case PixelFormat::Rgb24:
      return AV_PIX_FMT_RGB24;
    case PixelFormat::Bgr24:
      return AV_PIX_FMT_BGR24;
    case PixelFormat::Rgba32:
      return AV_PIX_FMT_RGBA;
    case PixelFormat::Yuv420p:
      return AV_PIX_FMT_YUV420P;
    case PixelFormat::Bgrx32:
      return AV_PIX_FMT_BGR0;
    case PixelFormat::Yuv422p:
      return AV_PIX_FMT_YUV422P;
    case PixelFormat::Yuv444p:
      return AV_PIX_FMT_YUV444P;
    case PixelFormat::Nv12:
      return AV_PIX_FMT_NV12;
    case PixelFormat::Nv16:
      return AV_PIX_FMT_NV16;
    case PixelFormat::Yuyv:
      return AV_PIX_FMT_YUYV422;
    case PixelFormat::Uyvy:
      return AV_PIX_FMT_UYVY422;
  }
  return AV_PIX_FMT_NONE;
}

AVPixelFormat plainPixelFormat(const AVFrame& picture) {
  switch (picture.format) {
    case AV_PIX_FMT_YUVJ420P:
      return AV_PIX_FMT_YUV420P;
    case AV_PIX_FMT_YUVJ422P:
      return AV_PIX_FMT_YUV422P;
    case AV_PIX_FMT_YUVJ444P:
      return AV_PIX_FMT_YUV444P;
    case AV_PIX_FMT_YUVJ440P:
      return AV_PIX_FMT_YUV440P;
    case AV_PIX_FMT_YUVJ411P:
      return AV_PIX_FMT_YUV411P;
    default:
      return static_cast<AVPixelFormat>(picture.format);
  }
}

bool isDamaged(const AVFrame& picture) {
  return (picture.flags & AV_FRAME_FLAG_CORRUPT) != 0 || picture.decode_error_flags != 0;
}

}  // namespace depthscope::capture
