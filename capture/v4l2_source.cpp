#include "capture/v4l2_source.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "capture/edid.hpp"
#include "capture/v4l2_devices.hpp"
#include "capture/v4l2_edid.hpp"
#include "types/error.hpp"

namespace depthscope::capture {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;

constexpr auto kLongestTimeout = std::chrono::hours(1);  // keeps sums in range
constexpr auto kLiveAge = milliseconds(100);             // an older picture is not live any more
constexpr auto kSilence = milliseconds(250);             // without a picture: not just a pause
constexpr auto kCheckPeriod = milliseconds(500);         // of the signal, besides events
constexpr auto kCheckWithoutEvents = milliseconds(100);
constexpr auto kCheckAgain = milliseconds(20);  // after one that failed
constexpr int kMostEvents = 16;                 // taken at a time

nanoseconds frameTimes(double count, double fps) {
  return nanoseconds(fps > 0 ? static_cast<std::int64_t>(count / fps * 1e9) : 0);
}

std::vector<std::uint8_t> edidOf(const V4l2Settings& settings) {
  requireSelection(settings.device);
  if (settings.edid == "none") return {};
  if (settings.edid == "auto" || settings.edid == "builtin") return builtinEdid();
  return loadEdid(settings.edid);
}

SourceStatus statusOf(int error) {
  switch (-error) {
    case ENOENT:
    case ENODEV:
    case ENXIO:
    case ENOTTY:
      return SourceStatus::NoDevice;
    case EACCES:
    case EPERM:
      return SourceStatus::PermissionDenied;
    case EBUSY:
      return SourceStatus::DeviceBusy;
    default:
      return SourceStatus::ReadError;
  }
}

}  // namespace

V4l2Source::V4l2Source(const V4l2Settings& settings, kernel::SystemCalls& calls)
    : settings_(settings), edid_(edidOf(settings)), calls_(calls) {
  bringUp();
}

V4l2Source::~V4l2Source() {
  takeDown();
}

std::uint64_t V4l2Source::skipped() const {
  return counts_before_.skipped + (stream_ ? stream_->counts().skipped : 0);
}

std::uint64_t V4l2Source::damagedFrames() const {
  return counts_before_.damaged + (stream_ ? stream_->counts().damaged : 0);
}

// From nothing to a running stream, and back.

/// One attempt; what is already there stays. True: the stream runs.
bool V4l2Source::bringUp() {
  next_attempt_ = calls_.now() + milliseconds(settings_.retry_ms);
  if (!node_.valid() && !openNode()) return false;
  signal_ = querySignal(node_, input_);
  if (signal_.status == SourceStatus::ReadError || signal_.status == SourceStatus::NoDevice)
    takeDown();
  if (signal_.status != SourceStatus::Ok) return fail(signal_.status, signal_.detail);
  return startStream();
}

bool V4l2Source::openNode() {
  std::string detail;
  if (const int error = openSelected(calls_, settings_.device, node_, detail); error < 0)
    return fail(statusOf(error), detail);
  if (const int error = selectInput(node_, settings_.input, input_, detail); error < 0) {
    takeDown();
    return fail(error == -EINVAL ? SourceStatus::NoDevice : statusOf(error), detail);
  }
  v4l2_event_subscription subscription{};
  subscription.type = V4L2_EVENT_SOURCE_CHANGE;
  subscription.id = static_cast<__u32>(input_.index);
  const int subscribed = node_.ask(VIDIOC_SUBSCRIBE_EVENT, subscription);
  if (subscribed < 0 && subscribed != -EINVAL && subscribed != -ENOTTY)
    return failCall("SUBSCRIBE_EVENT", subscribed);
  has_events_ = subscribed == 0;
  if (input_.has_timings && !edid_.empty())
    if (const int error = offerEdid(node_, input_.index, edid_, settings_.edid == "auto");
        error < 0)
      return failCall("S_EDID", error);
  return true;
}

bool V4l2Source::startStream() {
  if (const int error = adoptTimings(node_, input_, signal_); error < 0) {
    if (error != -EINVAL && error != -ERANGE) return failCall("S_DV_TIMINGS", error);
    return fail(SourceStatus::UnsupportedMode, modeText(signal_.timings) + " is not for this card");
  }
  const v4l2_bt_timings& mode = signal_.timings.bt;
  int width = signal_.has_timings ? static_cast<int>(mode.width) : settings_.width;
  int height = signal_.has_timings ? static_cast<int>(mode.height) : settings_.height;
  V4l2Layout layout;
  std::string detail;
  if (const int error = setBestFormat(node_, settings_, width, height, layout, detail); error < 0) {
    if (error == -EINVAL) return fail(SourceStatus::UnsupportedMode, detail);
    takeDown();
    return fail(statusOf(error), detail);
  }
  if (const char* refusal = PictureRestorer::refusal(layout))
    return fail(SourceStatus::UnsupportedMode, refusal);
  fps_ =
      signal_.has_timings ? frameRate(signal_.timings) : setFrameRate(node_, layout, settings_.fps);
  int error = 0;
  const char* step = "";
  stream_ = V4l2Stream::start(calls_, node_, layout, settings_.buffers, error, step);
  if (!stream_) return failCall(step, error);
  restorer_.reset(layout, settings_.buffers);
  if (!handed_out_) format_ = restorer_.format();
  sequence_base_ = handed_out_ ? last_sequence_ + 1 : 0;
  damaged_since_picture_ = false;
  // A card opened anew because it was silent has not said anything yet.
  if (status_ != SourceStatus::NoFrames) last_picture_ = calls_.now();
  next_check_ = calls_.now() + (has_events_ ? kCheckPeriod : kCheckWithoutEvents);
  return true;
}

void V4l2Source::takeDown() {
  if (stream_) {
    counts_before_.skipped += stream_->counts().skipped;
    counts_before_.damaged += stream_->counts().damaged;
    stream_->stop();
    stream_.reset();
  }
  node_.close();
}

bool V4l2Source::fail(SourceStatus status, std::string detail) {
  status_ = status;
  detail_ = std::move(detail);
  return false;
}

/// A call that should not have failed: the card is opened anew at the next attempt.
bool V4l2Source::failCall(const char* step, int error) {
  takeDown();
  return fail(statusOf(error), std::string(step) + ": " + errorText(error));
}

// While the stream runs.

/// Ends the stream when the signal is gone or is another one. A question that fails says nothing
/// about the picture: if the card itself is ill, the next picture tells.
void V4l2Source::checkSignal() {
  next_check_ = calls_.now() + (has_events_ ? kCheckPeriod : kCheckWithoutEvents);
  const SignalState now = querySignal(node_, input_);
  const bool same = !now.has_timings || sameMode(now.timings, signal_.timings);
  if (now.status == SourceStatus::ReadError) return void(next_check_ = calls_.now() + kCheckAgain);
  if (now.status == SourceStatus::Ok && same) return;
  takeDown();
  next_attempt_ = calls_.now();
  if (now.status == SourceStatus::Ok)
    bringUp();  // another mode is no fault
  else
    fail(now.status, now.detail);
}

void V4l2Source::takeEvents() {
  v4l2_event event{};
  int error = 0;
  for (int i = 0; i < kMostEvents && error == 0; ++i) error = node_.ask(VIDIOC_DQEVENT, event);
  if (error != 0 && error != -ENOENT) return void(failCall("DQEVENT", error));
  if (stream_)
    checkSignal();
  else
    next_attempt_ = calls_.now();
}

/// Waits for a picture, an event or `until`, and takes events. False: waiting itself failed.
bool V4l2Source::waitForNews(Time until) {
  hung_up_ = false;
  const auto events = static_cast<short>(stream_ ? POLLIN | POLLPRI : POLLPRI);
  std::array<pollfd, 1> wait{{{node_.valid() ? node_.fd() : -1, events, 0}}};
  const Time due = std::min(until, stream_ ? next_check_ : next_attempt_);
  const int ready = kernel::retryInterrupted([&] { return calls_.poll(wait, due - calls_.now()); });
  if (ready == 0) return true;
  if (ready == -EINTR) return false;
  if (ready < 0) return failCall("poll", ready);
  hung_up_ = wait[0].revents & (POLLERR | POLLHUP | POLLNVAL);
  if (hung_up_ && !stream_)
    failCall("poll", -ENODEV);
  else if (wait[0].revents & POLLPRI && !hung_up_)
    takeEvents();
  return true;
}

/// The newest live picture, whole; empty when there is none yet, or no stream any more.
Frame V4l2Source::takeFrame() {
  const std::uint64_t damaged_before = stream_->counts().damaged;
  V4l2Stream::Taken taken = stream_->take(std::max<nanoseconds>(kLiveAge, frameTimes(2, fps_)));
  if (taken.error == 0 && taken.frame.empty() && hung_up_) taken.error = -EIO;
  if (taken.error != 0) {
    failCall("DQBUF", taken.error);
    return {};
  }
  Frame whole;
  if (!taken.frame.empty()) {
    bool damaged = false;
    whole = restorer_.restore(std::move(taken.frame), taken.bytes, taken.field, damaged);
    if (damaged)
      stream_->countDamaged();
    else if (whole.empty())
      stream_->countSkipped();
  }
  if (stream_->counts().damaged != damaged_before) damaged_since_picture_ = true;
  return whole;
}

ReadResult V4l2Source::handOut(Frame frame) {
  last_picture_ = calls_.now();
  damaged_since_picture_ = false;
  frame.sequence += sequence_base_;
  last_sequence_ = frame.sequence;
  const bool changed = std::exchange(format_, frame.format) != frame.format && handed_out_;
  handed_out_ = true;
  status_ = said_ = SourceStatus::Ok;
  detail_.clear();
  return {SourceStatus::Ok, std::move(frame), changed};
}

/// A card that says nothing at all is opened anew.
void V4l2Source::restartIfStuck() {
  if (calls_.now() - stream_->lastSign() <= milliseconds(settings_.restart_ms)) return;
  takeDown();
  next_attempt_ = calls_.now();
  fail(SourceStatus::NoFrames,
       "not one for " + std::to_string(settings_.restart_ms) + " ms, the card is opened anew");
}

/// What to say as long as there is no picture.
SourceStatus V4l2Source::status() const {
  if (!stream_) return status_;
  if (calls_.now() - last_picture_ < std::max<nanoseconds>(kSilence, frameTimes(2, fps_)))
    return SourceStatus::Timeout;
  return damaged_since_picture_ ? SourceStatus::DamagedFrames : SourceStatus::NoFrames;
}

ReadResult V4l2Source::read(nanoseconds timeout) {
  const Time deadline =
      calls_.now() + std::clamp<nanoseconds>(timeout, nanoseconds(0), kLongestTimeout);
  const auto say = [&] { return ReadResult{said_ = status(), {}, false}; };
  for (;;) {
    if (!stream_ && calls_.now() >= next_attempt_) bringUp();
    if (stream_ && calls_.now() >= next_check_) checkSignal();
    if (!stream_ && status_ != said_) return say();
    if (stream_)
      if (const int error = stream_->queueReturned(); error < 0) failCall("QBUF", error);
    if (!waitForNews(deadline)) return say();
    if (stream_)
      if (Frame frame = takeFrame(); !frame.empty()) return handOut(std::move(frame));
    if (stream_) restartIfStuck();
    if (calls_.now() >= deadline) return say();
  }
}

}  // namespace depthscope::capture
