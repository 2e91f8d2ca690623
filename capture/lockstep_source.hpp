#pragma once
#include "capture/clip_player.hpp"
#include "capture/file_source.hpp"

namespace depthscope::capture {

/// Every position of a clip, one a call, decoded in the caller's thread.
class LockstepSource final : public FrameSource {
 public:
  LockstepSource(const FileSourceSettings& settings, PacingClock& clock);

  ReadResult read(std::chrono::nanoseconds timeout) override;
  FrameFormat format() const override { return format_; }
  double fps() const override { return player_.fps(); }
  std::uint64_t skipped() const override { return 0; }
  std::string damage() const override { return describe(player_.damage(), path_); }

 private:
  std::filesystem::path path_;
  PacingClock& clock_;
  ClipPlayer player_;
  FrameFormat format_;             // of the last picture handed out; before it, the clip's
  bool position_pending_ = false;  // decoded, but there was no free buffer for it
};

}  // namespace depthscope::capture
