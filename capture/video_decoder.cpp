#include "capture/video_decoder.hpp"

#include <cmath>
#include <new>

extern "C" {
#include <libavutil/dict.h>
#include <libavutil/mem.h>
}

#include "types/error.hpp"

namespace depthscope::capture {

namespace {

// Names of demuxers. Left out on purpose: playlists (they name other files), and text and
// still-picture formats, which libav would play as a video of one kind or another.
constexpr const char* kContainers =
    "mov,mp4,matroska,webm,avi,mpegts,mpeg,mpegvideo,m4v,h264,hevc,mjpeg,asf,ogg,flv,dv,mxf,ivf,"
    "nut,"
    "wtv,yuv4mpegpipe";

constexpr double kSlack_s = 1;

AvPtr<AVFormatContext> openContainer(const std::filesystem::path& path) {
  AVFormatContext* context = avformat_alloc_context();
  if (!context) throw std::bad_alloc();
  context->format_whitelist = av_strdup(kContainers);
  context->protocol_whitelist = av_strdup("file");
  // On failure avformat_open_input frees the context itself.
  const int error =
      avformat_open_input(&context, ("file:" + path.string()).c_str(), nullptr, nullptr);
  if (error < 0)  // EINVAL: a format that is not on the list
    throw InputError(path.string() + ": not a video that can be read" +
                     (error == AVERROR(EINVAL) ? "" : " (" + avErrorText(error) + ")") +
                     ", expected mp4, mov, mkv, avi or the like, not truncated");
  return AvPtr<AVFormatContext>(context);
}

}  // namespace

VideoDecoder::VideoDecoder(const std::filesystem::path& path)
    : path_(path), packet_(makeAvPacket()) {
  silenceAv();
  open();
}

void VideoDecoder::open() {
  codec_.reset();
  container_ = openContainer(path_);
  const int error = avformat_find_stream_info(container_.get(), nullptr);
  if (error < 0)
    throw InputError(path_.string() + ": no video could be found in it (" + avErrorText(error) +
                     ")");
  stream_ = av_find_best_stream(container_.get(), AVMEDIA_TYPE_VIDEO, -1, -1, nullptr, 0);
  if (stream_ < 0 || (container_->streams[stream_]->disposition & AV_DISPOSITION_ATTACHED_PIC) != 0)
    throw InputError(path_.string() + ": has no video stream that can be decoded");
  for (unsigned i = 0; i < container_->nb_streams; ++i)
    if (static_cast<int>(i) != stream_) container_->streams[i]->discard = AVDISCARD_ALL;
  AVStream* stream = container_->streams[stream_];
  codec_ = openDecoder(*stream->codecpar);
  if (!codec_)
    throw InputError(path_.string() + ": its video format (" +
                     avcodec_get_name(stream->codecpar->codec_id) + ") cannot be decoded");
  const AVRational rate = av_guess_frame_rate(container_.get(), stream, nullptr);
  fps_ = rate.num > 0 && rate.den > 0 ? av_q2d(rate) : 0;
  frame_count_ = stream->nb_frames;
  decoded_ = 0;
  last_pts_ = AV_NOPTS_VALUE;
  draining_ = false;
}

ClipReader::Outcome VideoDecoder::next(AVFrame& picture) {
  for (;;) {
    const int result = avcodec_receive_frame(codec_.get(), &picture);
    if (result == 0) {
      ++decoded_;
      last_pts_ = picture.best_effort_timestamp;
      if (isDamaged(picture)) ++damage_.concealed;
      return Outcome::Picture;
    }
    if (result != AVERROR(EAGAIN)) {
      if (result != AVERROR_EOF) ++damage_.unreadable;
      if (draining_) {
        finishPass();
        return Outcome::End;
      }
    }
    feed();
  }
}

/// Gives the decoder one more packet of the stream, or tells it that there are none.
void VideoDecoder::feed() {
  int result = av_read_frame(container_.get(), packet_.get());
  if (result < 0) {
    if (result != AVERROR_EOF) ++damage_.unreadable;
    draining_ = true;
    avcodec_send_packet(codec_.get(), nullptr);
    return;
  }
  if (packet_->stream_index == stream_) {
    result = avcodec_send_packet(codec_.get(), packet_.get());
    if (result < 0) ++damage_.unreadable;
  }
  av_packet_unref(packet_.get());
}

void VideoDecoder::finishPass() {
  std::int64_t announced = frame_count_;
  // Containers that announce no number of frames may announce a duration; sound that goes on a
  // little longer than the picture is no damage.
  const double last_s =
      static_cast<double>(last_pts_) * av_q2d(container_->streams[stream_]->time_base);
  const double end_s = static_cast<double>(container_->duration) / AV_TIME_BASE;
  if (announced == 0 && last_pts_ != AV_NOPTS_VALUE &&
      container_->duration_estimation_method == AVFMT_DURATION_FROM_STREAM &&
      end_s - last_s > kSlack_s)
    announced = std::llround(end_s * fps_);
  if (announced <= decoded_) return;
  damage_.read = decoded_;
  damage_.announced = announced;
}

bool VideoDecoder::rewind() {
  // Opened anew rather than sought in: not every container can be sought in, and a decoder that
  // starts afresh is sure to give the first pass's pictures again.
  try {
    open();
    return true;
  } catch (const std::exception&) {
    return false;
  }
}

}  // namespace depthscope::capture
