#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "capture/frame_source.hpp"
#include "capture/picture_restorer.hpp"
#include "capture/v4l2_node.hpp"
#include "capture/v4l2_settings.hpp"
#include "capture/v4l2_signal.hpp"
#include "capture/v4l2_stream.hpp"

namespace depthscope::capture {

/// A capture card as the source of pictures. It may be missing, be pulled out and come back, lose
/// its signal or change its mode at any time: read() says so, tries again by itself, and hands out
/// pictures as soon as there are some. No udev: looking for the device every `retry_ms` costs
/// nothing while there is no picture anyway, and finds it as fast.
///
/// read(): a fault that was not said before comes at once; one that lasts comes after `timeout`.
/// Pictures that the driver flags as damaged are never handed out, for such a buffer may hold an
/// older picture; when nothing else comes, the status is DamagedFrames. Pictures older than 100 ms
/// or two frame times are not handed out either. Interlaced pictures come as the newer of the two
/// fields, the lines between interpolated.
class V4l2Source final : public FrameSource {
 public:
  /// Makes a first attempt to open the card, but a missing one is no error. Throws InputError when
  /// the settings make no sense or the EDID file does not. `calls` outlives the source and its
  /// Frames.
  V4l2Source(const V4l2Settings& settings, kernel::SystemCalls& calls);
  ~V4l2Source() override;
  V4l2Source(const V4l2Source&) = delete;
  V4l2Source& operator=(const V4l2Source&) = delete;

  ReadResult read(std::chrono::nanoseconds timeout) override;
  FrameFormat format() const override { return format_; }
  double fps() const override { return fps_; }
  std::uint64_t skipped() const override;
  std::uint64_t damagedFrames() const override;
  std::string_view detail() const override { return detail_; }

 private:
  using Time = kernel::SystemCalls::Time;
  using Nanoseconds = std::chrono::nanoseconds;

  bool bringUp();
  bool openNode();
  bool startStream();
  void takeDown();
  bool fail(SourceStatus status, std::string detail);
  bool failCall(const char* step, int error);
  void checkSignal();
  bool waitForNews(Time until);
  void takeEvents();
  Frame takeFrame();
  ReadResult handOut(Frame frame);
  void restartIfStuck();
  SourceStatus status() const;

  const V4l2Settings settings_;
  const std::vector<std::uint8_t> edid_;
  kernel::SystemCalls& calls_;
  V4l2Node node_;
  V4l2Input input_;
  SignalState signal_;
  std::shared_ptr<V4l2Stream> stream_;  // none: there is a fault
  PictureRestorer restorer_;
  bool has_events_ = false;  // the card tells when its signal changes
  bool hung_up_ = false;     // poll(2) told of an error

  SourceStatus status_ = SourceStatus::NoDevice;  // while there is no stream
  SourceStatus said_ = SourceStatus::Ok;          // last one returned
  std::string detail_;
  Time next_attempt_, next_check_;
  Time last_picture_;  // handed out, or the stream's start
  bool damaged_since_picture_ = false;

  FrameFormat format_;
  double fps_ = 0;  // [1/s]
  bool handed_out_ = false;
  std::uint64_t sequence_base_ = 0, last_sequence_ = 0;
  V4l2Counts counts_before_;  // of earlier streams
};

}  // namespace depthscope::capture
