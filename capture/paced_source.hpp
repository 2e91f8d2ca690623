#pragma once
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

#include "capture/clip_player.hpp"
#include "capture/file_source.hpp"

namespace depthscope::capture {

/// A clip at its own rate, like a camera: a thread decodes ahead into a short queue; positions
/// arrive at their times, and the newest that has arrived is handed out. All times are counted from
/// the first read().
class PacedSource final : public FrameSource {
 public:
  PacedSource(const FileSourceSettings& settings, PacingClock& clock);
  ~PacedSource() override;
  PacedSource(const PacedSource&) = delete;
  PacedSource& operator=(const PacedSource&) = delete;

  ReadResult read(std::chrono::nanoseconds timeout) override;
  FrameFormat format() const override { return format_; }
  double fps() const override { return player_.fps(); }
  std::uint64_t skipped() const override;
  std::string damage() const override;

 private:
  using Nanoseconds = std::chrono::nanoseconds;
  struct Entry {
    Nanoseconds arrival{};  // since the start
    SourceStatus status = SourceStatus::Ok;
    Frame frame;  // empty unless Ok
  };

  void decodeAhead();
  void finish();
  Entry arrivalOf(const ClipPosition& position);
  bool makeRoom(std::unique_lock<std::mutex>& lock, Entry& entry);
  void render(Entry& entry);
  void dropFront();
  bool waitUntil(std::unique_lock<std::mutex>& lock, Nanoseconds since_start);
  Nanoseconds elapsed() const;
  ReadResult takeFront();

  std::filesystem::path path_;
  PacingClock& clock_;
  ClipPlayer player_;           // the decoding thread's, but for fps()
  FrameFormat format_;          // of the last picture handed out; before it, the clip's
  Nanoseconds last_arrival_{};  // the decoding thread's: positions arrive in their order

  mutable std::mutex mutex_;  // guards all below
  std::condition_variable changed_;
  std::vector<Entry> queue_;  // by arrival; its capacity is fixed
  bool started_ = false;
  PacingClock::TimePoint start_{};
  Nanoseconds next_arrival_{};  // no position that is still to be queued arrives before
  bool ended_ = false;          // the whole clip is queued
  bool stop_ = false;
  std::uint64_t skipped_ = 0;
  ClipDamage damage_;

  std::thread decoder_;
};

}  // namespace depthscope::capture
