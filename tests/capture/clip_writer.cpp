#include "tests/capture/clip_writer.hpp"

#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
}

namespace depthscope::capture {

namespace {

void check(int result, const char* what) {
  if (result < 0) throw std::runtime_error(std::string("clip writer: ") + what);
}

struct Delete {
  void operator()(AVCodecContext* p) const { avcodec_free_context(&p); }
  void operator()(AVFrame* p) const { av_frame_free(&p); }
  void operator()(AVPacket* p) const { av_packet_free(&p); }
  void operator()(AVFormatContext* p) const {
    if (p->pb) avio_closep(&p->pb);
    avformat_free_context(p);
  }
};
template <typename T>
using Owned = std::unique_ptr<T, Delete>;

AVPixelFormat avFormat(const FrameFormat& format) {
  switch (format.pixel_format) {
    case PixelFormat::Gray8:
      return AV_PIX_FMT_GRAY8;
    case PixelFormat::Rgb24:
      return AV_PIX_FMT_RGB24;
    case PixelFormat::Bgr24:
      return AV_PIX_FMT_BGR24;
    case PixelFormat::Rgba32:
      return AV_PIX_FMT_RGBA;
    case PixelFormat::Yuv420p:
      return format.range == YuvRange::Full ? AV_PIX_FMT_YUVJ420P : AV_PIX_FMT_YUV420P;
    case PixelFormat::Nv12:
      return AV_PIX_FMT_NV12;
    default:
      break;
  }
  return AV_PIX_FMT_NONE;
}

Owned<AVCodecContext> openEncoder(AVCodecID id, const FrameFormat& format, int fps) {
  const AVCodec* encoder = avcodec_find_encoder(id);
  Owned<AVCodecContext> codec(avcodec_alloc_context3(encoder));
  codec->width = format.width;
  codec->height = format.height;
  codec->pix_fmt = avFormat(format);
  codec->time_base = {1, fps};
  codec->framerate = {fps, 1};
  codec->color_range = format.range == YuvRange::Full ? AVCOL_RANGE_JPEG : AVCOL_RANGE_MPEG;
  codec->colorspace = format.matrix == YuvMatrix::Bt709 ? AVCOL_SPC_BT709 : AVCOL_SPC_SMPTE170M;
  codec->thread_count = 1;
  check(avcodec_open2(codec.get(), encoder, nullptr), "encoder");
  return codec;
}

Owned<AVFrame> draw(const FrameFormat& format, int frame, const Pattern& pattern) {
  Owned<AVFrame> picture(av_frame_alloc());
  picture->width = format.width;
  picture->height = format.height;
  picture->format = avFormat(format);
  picture->pts = frame;
  check(av_frame_get_buffer(picture.get(), 0), "picture");
  for (int plane = 0; plane < planeCount(format.pixel_format); ++plane) {
    const PlaneSize size = planeSize(format, plane);
    for (int y = 0; y < size.rows; ++y)
      for (int x = 0; x < size.row_bytes; ++x)
        picture->data[plane][y * picture->linesize[plane] + x] = pattern(frame, plane, x, y);
  }
  return picture;
}

}  // namespace

TemporaryFolder::TemporaryFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "depthscope-XXXXXX").string();
  if (!mkdtemp(name.data())) throw std::runtime_error("no temporary folder");
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::uint8_t gradient(int frame, int plane, int x, int y) {
  return static_cast<std::uint8_t>(16 + (frame * 7 + plane * 31 + x * 2 + y * 3) % 200);
}

void writeVideo(const std::filesystem::path& path, const FrameFormat& format, int frames, int fps,
                const Pattern& pattern) {
  const bool yuv = format.pixel_format == PixelFormat::Yuv420p;
  Owned<AVCodecContext> codec =
      openEncoder(yuv ? AV_CODEC_ID_FFV1 : AV_CODEC_ID_RAWVIDEO, format, fps);
  AVFormatContext* context = nullptr;
  check(avformat_alloc_output_context2(&context, nullptr, nullptr, path.c_str()), "container");
  const Owned<AVFormatContext> container(context);
  AVStream* stream = avformat_new_stream(context, nullptr);
  stream->time_base = codec->time_base;
  stream->avg_frame_rate = codec->framerate;
  check(avcodec_parameters_from_context(stream->codecpar, codec.get()), "parameters");
  check(avio_open(&context->pb, path.c_str(), AVIO_FLAG_WRITE), "file");
  check(avformat_write_header(context, nullptr), "header");
  const Owned<AVPacket> packet(av_packet_alloc());
  for (int frame = 0; frame < frames; ++frame) {
    check(avcodec_send_frame(codec.get(), draw(format, frame, pattern).get()), "encoding");
    check(avcodec_receive_packet(codec.get(), packet.get()), "encoding");
    packet->duration = 1;
    av_packet_rescale_ts(packet.get(), codec->time_base, stream->time_base);
    check(av_interleaved_write_frame(context, packet.get()), "writing");
  }
  check(av_write_trailer(context), "trailer");
}

void writePicture(const std::filesystem::path& path, const FrameFormat& format, int frame,
                  const Pattern& pattern) {
  const bool png = path.extension() != ".jpg";
  const Owned<AVCodecContext> codec =
      openEncoder(png ? AV_CODEC_ID_PNG : AV_CODEC_ID_MJPEG, format, 30);
  const Owned<AVPacket> packet(av_packet_alloc());
  check(avcodec_send_frame(codec.get(), draw(format, frame, pattern).get()), "encoding");
  check(avcodec_receive_packet(codec.get(), packet.get()), "encoding");
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(packet->data), packet->size);
}

void truncateFile(const std::filesystem::path& path, const std::filesystem::path& to,
                  std::size_t bytes) {
  std::ifstream in(path, std::ios::binary);
  std::vector<char> data((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  data.resize(std::min(bytes, data.size()));
  std::ofstream(to, std::ios::binary).write(data.data(), static_cast<std::streamsize>(data.size()));
}

}  // namespace depthscope::capture
