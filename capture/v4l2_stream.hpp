#pragma once
#include <atomic>
#include <memory>
#include <vector>

#include "capture/frame.hpp"
#include "capture/v4l2_format.hpp"
#include "capture/v4l2_node.hpp"
#include "kernel/mapping.hpp"

namespace depthscope::capture {

/// What was counted since the stream began.
struct V4l2Counts {
  std::uint64_t skipped = 0;  // by the driver for want of a buffer, or here for a newer one
  std::uint64_t damaged = 0;  // that the driver flagged, or that were cut short
};

/// A running stream of a card: its buffers, mapped, lent out as Frames without a copy and given
/// back to the card by queueReturned(). The memory stays for as long as a Frame is held, also when
/// the card is gone; the card's file is the caller's and outlives the calls made here, but not the
/// Frames. One thread, but for what Frames do when they are destroyed.
class V4l2Stream final : public FrameLender {
 public:
  using Time = kernel::SystemCalls::Time;

  /// Buffers that the card keeps at least, so that it never has nowhere to put a picture.
  static constexpr int kKept = 2;

  /// Asks for `buffers` (the driver may give more or fewer), maps and queues them and starts the
  /// card. Null on failure, with -errno in `error` and the call that failed in `step`.
  static std::shared_ptr<V4l2Stream> start(kernel::SystemCalls& calls, const V4l2Node& node,
                                           const V4l2Layout& layout, int buffers, int& error,
                                           const char*& step);

  /// Ends the stream and gives the card's buffers up. What Frames still hold stays readable; told
  /// so, the driver lets go of them, where merely closing its file would leave it busy until then.
  void stop();

  /// Gives the card what Frames have brought back; 0 or -errno.
  int queueReturned();

  /// A picture in the card's own memory.
  struct Taken {
    int error = 0;          // -errno: the stream is over
    Frame frame;            // empty: none there
    std::size_t bytes = 0;  // that the first piece of memory holds, for compressed ones
    __u32 field = V4L2_FIELD_NONE;
  };
  /// The newest picture that is there and sound; older ones go back to the card. One captured
  /// longer ago than `max_age` is no live picture any more, and is skipped too.
  Taken take(std::chrono::nanoseconds max_age);

  /// Counts a picture that was taken as one that turned out to be damaged, or as skipped.
  void countDamaged() { ++counts_.damaged; }
  void countSkipped() { ++counts_.skipped; }
  const V4l2Counts& counts() const { return counts_; }
  /// Time of the last buffer that came back from the card, sound or not; else of the start.
  Time lastSign() const { return last_sign_; }
  bool exportsDma() const { return !dma_.empty(); }

 private:
  struct Filled {
    int slot = -1;
    std::size_t bytes = 0;
    std::array<std::size_t, 3> data_offset{};
    __u32 field = V4L2_FIELD_NONE;
    std::uint64_t sequence = 0;
    Time captured;
    bool timed = false;  // by the driver
    bool sound = true;
  };

  V4l2Stream(kernel::SystemCalls& calls, const V4l2Node& node, const V4l2Layout& layout);
  int request(int buffers, const char*& step);
  int map(int slot, const char*& step);
  void exportDma();
  int queue(int slot);
  int dequeue(Filled& filled);
  void judge(const v4l2_buffer& buffer, const v4l2_plane* planes, Filled& filled);
  void setTime(const v4l2_buffer& buffer, Filled& filled) const;
  Frame wrap(const Filled& filled);
  void takeBack(int slot) override;

  kernel::SystemCalls& calls_;
  const V4l2Node& node_;
  V4l2Layout layout_;
  int count_ = 0;                           // buffers there are
  int queued_ = 0;                          // of them with the card
  std::vector<kernel::Mapping> memory_;     // by slot and piece
  std::vector<kernel::OwnedFd> dma_;        // likewise, or none
  std::atomic<std::uint64_t> returned_{0};  // bit i: slot i is to be queued again
  bool has_sequence_ = false;
  __u32 last_sequence_ = 0;
  std::uint64_t sequence_ = 0;  // of the last buffer, without the driver's wrap-around
  Time last_sign_;
  V4l2Counts counts_;
};

}  // namespace depthscope::capture
