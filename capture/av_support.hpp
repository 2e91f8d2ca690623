#pragma once
// libav* in C++ clothes: owners, error texts, what its pictures are called here. Internal to
// capture/.
extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/frame.h>
#include <libswscale/swscale.h>
}

#include <memory>
#include <optional>
#include <string>

#include "capture/frame.hpp"

namespace depthscope::capture {

struct AvDelete {
  void operator()(AVFormatContext* p) const { avformat_close_input(&p); }
  void operator()(AVCodecContext* p) const { avcodec_free_context(&p); }
  void operator()(AVPacket* p) const { av_packet_free(&p); }
  void operator()(AVFrame* p) const { av_frame_free(&p); }
  void operator()(SwsContext* p) const { sws_freeContext(p); }
};
template <typename T>
using AvPtr = std::unique_ptr<T, AvDelete>;

/// Throw std::bad_alloc when there is no memory.
AvPtr<AVFrame> makeAvFrame();
AvPtr<AVPacket> makeAvPacket();
/// An open single-threaded decoder, or null when libav has none for these parameters. One thread,
/// because what frame threads make of a damaged stream depends on their timing.
/// `strict`: what is not sound is not decoded at all, rather than as far as it goes.
AvPtr<AVCodecContext> openDecoder(const AVCodecParameters& parameters, bool strict = false);

/// Keeps libav* from writing to standard error: what goes wrong is said by our own messages.
void silenceAv();
/// "Invalid data found when processing input" and the like.
std::string avErrorText(int error);

/// The format that holds pictures like this one: its own where PixelFormat has it, else the
/// nearest; nothing when libswscale cannot read it. Range unknown: limited, but full for the yuvj
/// formats; matrix unknown: by height.
std::optional<FrameFormat> frameFormatOf(const AVFrame& picture);
AVPixelFormat avPixelFormat(PixelFormat format);
/// The picture's pixel format with yuvj420p and its kin, which are old names for full range,
/// replaced.
AVPixelFormat plainPixelFormat(const AVFrame& picture);
/// Whether libav marked the picture as decoded from damaged data.
bool isDamaged(const AVFrame& picture);

}  // namespace depthscope::capture
