#pragma once
#include <filesystem>

#include "capture/av_support.hpp"
#include "capture/clip_reader.hpp"

namespace depthscope::capture {

/// The first video stream of a file, decoded by libav*. Only plain video containers of the local
/// file system are opened, so that a hostile file cannot make libav fetch another one.
class VideoDecoder final : public ClipReader {
 public:
  /// Throws InputError when `path` is not a video with a stream that can be decoded.
  explicit VideoDecoder(const std::filesystem::path& path);

  Outcome next(AVFrame& picture) override;
  bool rewind() override;
  double fps() const override { return fps_; }
  std::int64_t frameCount() const override { return frame_count_; }
  ClipDamage damage() const override { return damage_; }

 private:
  void open();
  void feed();
  void finishPass();

  std::filesystem::path path_;
  AvPtr<AVFormatContext> container_;
  AvPtr<AVCodecContext> codec_;
  AvPtr<AVPacket> packet_;
  int stream_ = -1;
  double fps_ = 0;                          // [1/s]
  std::int64_t frame_count_ = 0;            // announced by the container, 0: not
  std::int64_t decoded_ = 0;                // in this pass
  std::int64_t last_pts_ = AV_NOPTS_VALUE;  // [time base of the stream]
  bool draining_ = false;                   // the container has no more packets
  ClipDamage damage_;
};

}  // namespace depthscope::capture
