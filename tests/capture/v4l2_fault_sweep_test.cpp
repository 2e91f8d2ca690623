// Every system call of a capture card's life fails once, in every way: at its k-th call, for every
// k, once or until the fault is lifted.
#include <cstdio>

#include "tests/capture/v4l2_test_card.hpp"

namespace depthscope::capture {
namespace {

using fake::FaultPlan;

constexpr auto kTimeout = 80ms;     // of a read, as in the video loop
constexpr auto kShown = 5ms;        // that showing a picture takes
constexpr auto kOldest = 120ms;     // what may pass for a live picture
constexpr auto kUnnoticed = 110ms;  // that a card may show noise before anyone asks it why
constexpr auto kLate = 200ms;
constexpr auto kRecovery = 500ms;  // from the lifting of a fault to a picture

/// A card's life from plugging in to plugging in again, lived by a program that shows its pictures.
class Life {
 public:
  explicit Life(const FaultPlan& plan, FakeV4l2Card::Options options = {})
      : card_(kernel_, options) {
    late_ = plan.kind == FaultPlan::Kind::Late;
    card_.setMode(mode_);
    card_.setScene([](int, int, std::uint64_t, int) { return Rgb{0.2, 0.6, 0.2}; });
    kernel_.plug("/dev/video0", card_);
    kernel_.inject(plan);
    V4l2Settings settings{.device = "auto"};
    settings.restart_ms = 300;
    source_ = std::make_unique<V4l2Source>(settings, kernel_);
  }

  void live() {
    show(120ms);
    changed_ = kernel_.now();
    card_.setSignal(FakeV4l2Card::Signal::Missing);
    show(150ms);
    card_.setSignal(FakeV4l2Card::Signal::Good);
    show(150ms);
    changed_ = kernel_.now();
    card_.setMode(fake::timingsSmall(12, 8, 50));
    show(150ms);
    card_.damageNext(2);
    show(100ms);
    card_.disconnect();
    kernel_.unplug("/dev/video0");
    show(150ms);
    card_.reconnect();
    kernel_.plug("/dev/video0", card_);
    show(150ms);
  }

  /// The fault is over: there has to be a picture soon.
  void recover() {
    kernel_.inject({});
    const auto lifted = kernel_.now();
    pictures_ = 0;
    while (pictures_ == 0 && kernel_.now() - lifted < 2s) show(1ms);
    if (kernel_.now() - lifted > kRecovery) fail("no picture within 500 ms of the fault's end");
  }

  void end() {
    shown_ = Frame();
    source_.reset();
    if (kernel_.openDescriptors() != 0) fail("descriptors leaked");
    if (kernel_.mappings() != 0) fail("mappings leaked");
    if (kernel_.misuses() != 0) fail("used what was not open");
  }

  std::uint64_t calls() const { return kernel_.calls(); }
  const std::string& failure() const { return failure_; }

 private:
  void show(std::chrono::nanoseconds duration) {
    const auto end = kernel_.now() + duration;
    do {
      const auto asked = kernel_.now();
      const auto calls = kernel_.calls();
      ReadResult result = source_->read(kTimeout);
      if (!late_ && kernel_.now() - asked > kTimeout + 5ms) fail("read() took longer than it may");
      if (kernel_.calls() - calls > 2000) fail("read() spins");
      if (result.frame.empty() != (result.status != SourceStatus::Ok))
        fail("status and frame differ");
      if (result.status == SourceStatus::Ok) check(result.frame);
      shown_ = std::move(result.frame);
      kernel_.advance(kShown);
    } while (kernel_.now() < end);
  }

  void check(const Frame& frame) {
    ++pictures_;
    if (!late_ && kernel_.now() - frame.capture_time > kOldest) fail("a stale picture as live");
    if (frame.capture_time <= last_) fail("a picture twice or backwards");
    if (has_sequence_ && frame.sequence <= last_sequence_) fail("numbers do not grow");
    has_sequence_ = true;
    last_ = frame.capture_time;
    last_sequence_ = frame.sequence;
    if (kernel_.now() - changed_ <= (late_ ? kUnnoticed + kLate + kTimeout : kUnnoticed)) return;
    if (farthest(frame, [](int, int) { return Rgb{0.2, 0.6, 0.2}; }) > 3) fail("wrong pixels");
  }

  void fail(const char* what) {
    if (failure_.empty()) failure_ = what;
  }

  const v4l2_dv_timings mode_ = fake::timingsSmall(8, 8, 60);
  FakeKernel kernel_;
  FakeV4l2Card card_;
  std::unique_ptr<V4l2Source> source_;
  Frame shown_;
  bool late_ = false, has_sequence_ = false;
  int pictures_ = 0;
  std::uint64_t last_sequence_ = 0;
  kernel::SystemCalls::Time last_{}, changed_{};
  std::string failure_;
};

std::string name(const FaultPlan& plan) {
  const char* kind = plan.kind == FaultPlan::Kind::Late    ? "late"
                     : plan.kind == FaultPlan::Kind::Short ? "short"
                                                           : strerrorname_np(plan.error);
  return std::string(kind) + (plan.forever ? " from call " : " at call ") +
         std::to_string(plan.call);
}

void sweep(const FakeV4l2Card::Options& options) {
  Life whole({}, options);
  whole.live();
  const std::uint64_t calls = whole.calls();
  whole.recover();
  whole.end();
  ASSERT_EQ(whole.failure(), "");
  std::vector<FaultPlan> kinds;
  for (const bool forever : {false, true}) {
    for (const int error : {EIO, ENODEV, EAGAIN, EINTR, EINVAL})
      kinds.push_back({.forever = forever, .error = error});
    kinds.push_back({.forever = forever, .kind = FaultPlan::Kind::Short});
  }
  kinds.push_back({.kind = FaultPlan::Kind::Late, .delay = kLate});
  kinds.push_back({.forever = true, .kind = FaultPlan::Kind::Late, .delay = 3ms});
  int injected = 0, failures = 0;
  for (FaultPlan plan : kinds)
    for (plan.call = 1; plan.call <= calls; ++plan.call) {
      Life life(plan, options);
      life.live();
      life.recover();
      life.end();
      ++injected;
      if (life.failure().empty()) continue;
      if (++failures <= 20) ADD_FAILURE() << name(plan) << ": " << life.failure();
    }
  std::printf("%d faults injected in %d calls, %d survived\n", injected, static_cast<int>(calls),
              injected - failures);
}

TEST(V4l2FaultSweep, ACardWithEventsSurvivesEveryFault) {
  sweep({});
}

TEST(V4l2FaultSweep, AMultiplanarCardWithoutEventsSurvivesEveryFault) {
  FakeV4l2Card::Options options;
  options.multiplanar = true;
  options.events = false;
  options.orphans = false;
  options.formats = {V4L2_PIX_FMT_NV12M};
  sweep(options);
}

}  // namespace
}  // namespace depthscope::capture
