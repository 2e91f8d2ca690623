#include "platform/video_writer.hpp"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/imgutils.h>
#include <libswscale/swscale.h>
}

#include <stdexcept>
#include <string>

#include "types/error.hpp"

namespace depthscope::platform {
namespace {

constexpr int quality_qscale = 2;  // 1 best, 31 worst
constexpr int keyframe_interval = 12;
constexpr int max_rate_term = 65535;  // the codec's limit on the terms of its time base

struct ContextCloser {
  void operator()(AVFormatContext* c) const {
    if (c->pb != nullptr) avio_closep(&c->pb);
    avformat_free_context(c);
  }
  void operator()(AVCodecContext* c) const { avcodec_free_context(&c); }
  void operator()(AVFrame* f) const { av_frame_free(&f); }
  void operator()(AVPacket* p) const { av_packet_free(&p); }
  void operator()(SwsContext* s) const { sws_freeContext(s); }
};
template <class T>
using Owned = std::unique_ptr<T, ContextCloser>;

std::string errorText(int code) {
  char text[AV_ERROR_MAX_STRING_SIZE] = {};
  av_strerror(code, text, sizeof text);
  return text;
}

}  // namespace

struct VideoWriter::Impl {
  std::string file;
  Owned<AVFormatContext> format;
  Owned<AVCodecContext> codec;
  Owned<AVFrame> picture;
  Owned<AVPacket> packet;
  Owned<SwsContext> scaler;
  AVStream* stream = nullptr;
  bool finished = false;

  void check(int code, const char* what) const {
    if (code < 0) throw std::runtime_error(file + ": " + what + ": " + errorText(code));
  }
  void open(int width, int height, double fps);
  void openCodec(int width, int height, double fps);
  void drain();
};

void VideoWriter::Impl::openCodec(int width, int height, double fps) {
  const AVCodec* encoder = avcodec_find_encoder(AV_CODEC_ID_MPEG4);
  if (encoder == nullptr) throw std::runtime_error(file + ": FFmpeg has no mpeg4 encoder");
  codec.reset(avcodec_alloc_context3(encoder));
  codec->width = width;
  codec->height = height;
  codec->pix_fmt = AV_PIX_FMT_YUV420P;
  const AVRational rate = av_d2q(fps, max_rate_term);
  codec->time_base = av_inv_q(rate);
  codec->framerate = rate;
  codec->gop_size = keyframe_interval;
  codec->max_b_frames = 0;
  codec->thread_count = 1;
  codec->flags |= AV_CODEC_FLAG_QSCALE;
  codec->global_quality = FF_QP2LAMBDA * quality_qscale;
  codec->color_range = AVCOL_RANGE_MPEG;
  codec->colorspace = AVCOL_SPC_SMPTE170M;
  if (format->oformat->flags & AVFMT_GLOBALHEADER) codec->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
  check(avcodec_open2(codec.get(), encoder, nullptr), "encoder cannot be opened");
}

void VideoWriter::Impl::open(int width, int height, double fps) {
  AVFormatContext* context = nullptr;
  check(avformat_alloc_output_context2(&context, nullptr, "mp4", file.c_str()),
        "container cannot be made");
  format.reset(context);
  openCodec(width & ~1, height & ~1, fps);
  stream = avformat_new_stream(format.get(), nullptr);
  picture.reset(av_frame_alloc());
  packet.reset(av_packet_alloc());
  if (stream == nullptr || !picture || !packet) throw std::bad_alloc();
  check(avcodec_parameters_from_context(stream->codecpar, codec.get()), "stream cannot be set up");
  stream->time_base = codec->time_base;
  stream->avg_frame_rate = codec->framerate;
  picture->format = codec->pix_fmt;
  picture->width = codec->width;
  picture->height = codec->height;
  check(av_frame_get_buffer(picture.get(), 0), "no memory for a picture");
  scaler.reset(sws_getContext(codec->width, codec->height, AV_PIX_FMT_RGBA, codec->width,
                              codec->height, codec->pix_fmt, SWS_BILINEAR, nullptr, nullptr,
                              nullptr));
  if (!scaler) throw std::bad_alloc();
  const int opened = avio_open(&format->pb, file.c_str(), AVIO_FLAG_WRITE);
  if (opened < 0) throw InputError(file + ": cannot be written: " + errorText(opened));
  check(avformat_write_header(format.get(), nullptr), "header cannot be written");
}

/// Moves what the encoder has ready into the file.
void VideoWriter::Impl::drain() {
  for (;;) {
    const int code = avcodec_receive_packet(codec.get(), packet.get());
    if (code == AVERROR(EAGAIN) || code == AVERROR_EOF) return;
    check(code, "picture cannot be encoded");
    if (packet->duration == 0) packet->duration = 1;
    av_packet_rescale_ts(packet.get(), codec->time_base, stream->time_base);
    packet->stream_index = stream->index;
    check(av_interleaved_write_frame(format.get(), packet.get()), "picture cannot be written");
  }
}

VideoWriter::VideoWriter(const std::filesystem::path& path, int width, int height, double fps)
    : impl_(std::make_unique<Impl>()) {
  impl_->file = path.string();
  impl_->open(width, height, fps);
}

VideoWriter::~VideoWriter() {
  try {
    finish();
  } catch (const std::exception&) {
    // Said in the header: whoever wants to know calls finish().
  }
}

void VideoWriter::write(const RgbaView& picture, std::int64_t index) {
  Impl& d = *impl_;
  d.check(av_frame_make_writable(d.picture.get()), "no memory for a picture");
  const std::uint8_t* rows[1] = {picture.data};
  const int strides[1] = {static_cast<int>(picture.stride)};
  sws_scale(d.scaler.get(), rows, strides, 0, d.codec->height, d.picture->data,
            d.picture->linesize);
  d.picture->pts = index;
  d.picture->quality = d.codec->global_quality;
  d.check(avcodec_send_frame(d.codec.get(), d.picture.get()), "picture cannot be encoded");
  d.drain();
}

void VideoWriter::finish() {
  Impl& d = *impl_;
  if (d.finished) return;
  d.finished = true;
  d.check(avcodec_send_frame(d.codec.get(), nullptr), "encoder cannot be emptied");
  d.drain();
  d.check(av_write_trailer(d.format.get()), "index cannot be written");
  d.check(avio_closep(&d.format->pb), "file cannot be closed");
}

}  // namespace depthscope::platform
