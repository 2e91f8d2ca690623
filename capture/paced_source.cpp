#include "capture/paced_source.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace depthscope::capture {

namespace {

constexpr std::chrono::nanoseconds kLongestTimeout = std::chrono::hours(1);  // keeps sums in range

std::chrono::nanoseconds nanoseconds(double seconds) {
  return std::chrono::nanoseconds(std::llround(seconds * 1e9));
}

}  // namespace

PacedSource::PacedSource(const FileSourceSettings& settings, PacingClock& clock)
    : path_(settings.path), clock_(clock), player_(settings), format_(player_.format()) {
  queue_.reserve(static_cast<std::size_t>(settings.buffers));
  decoder_ = std::thread([this] { decodeAhead(); });
}

PacedSource::~PacedSource() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  decoder_.join();
}

std::uint64_t PacedSource::skipped() const {
  const std::lock_guard lock(mutex_);
  return skipped_;
}

std::string PacedSource::damage() const {
  const std::lock_guard lock(mutex_);
  return describe(damage_, path_);
}

/// Below zero, before every arrival, until the first read().
PacedSource::Nanoseconds PacedSource::elapsed() const {
  return started_ ? clock_.now() - start_ : Nanoseconds(-1);
}

/// Waits for the other thread, at most until `since_start`; false when that time has come.
bool PacedSource::waitUntil(std::unique_lock<std::mutex>& lock, Nanoseconds since_start) {
  if (started_) return clock_.waitForWork(changed_, lock, start_ + since_start);
  changed_.wait(lock);
  return true;
}

void PacedSource::dropFront() {
  if (queue_.front().status == SourceStatus::Ok) ++skipped_;
  queue_.erase(queue_.begin());
}

// The decoding thread.

void PacedSource::decodeAhead() {
  for (;;) {
    const bool more = player_.advance();
    std::unique_lock lock(mutex_);
    damage_ = player_.damage();
    if (!more) break;
    Entry entry = arrivalOf(player_.position());
    next_arrival_ = entry.arrival;
    changed_.notify_all();
    const bool has_room = makeRoom(lock, entry);
    if (stop_) return;
    if (has_room && entry.status == SourceStatus::Ok) {
      lock.unlock();
      render(entry);
      lock.lock();
    }
    if (has_room) queue_.push_back(std::move(entry));
    next_arrival_ =
        std::max(last_arrival_, nanoseconds((player_.position().sequence + 1) / player_.fps()));
    changed_.notify_all();
  }
  finish();
}

void PacedSource::finish() {
  const std::lock_guard lock(mutex_);
  ended_ = true;
  changed_.notify_all();
}

PacedSource::Entry PacedSource::arrivalOf(const ClipPosition& position) {
  const Nanoseconds due = nanoseconds(position.media_time_s);
  // A late picture holds up those behind it, as it would in a camera's queue.
  last_arrival_ = std::max(last_arrival_, due + nanoseconds(position.delay_ms / 1000));
  return {last_arrival_, position.status, {}};
}

/// Waits for a place in the queue and, for a picture, a buffer. What a newer arrival has outdated
/// is dropped from the queue's front. False when `entry` itself has to be skipped, or to stop.
bool PacedSource::makeRoom(std::unique_lock<std::mutex>& lock, Entry& entry) {
  while (!stop_) {
    const bool has_place = queue_.size() < queue_.capacity();
    if (has_place && entry.status == SourceStatus::Ok) entry.frame = player_.acquire();
    if (has_place && (entry.status != SourceStatus::Ok || !entry.frame.empty())) return true;
    const Nanoseconds outdated = queue_.size() >= 2 ? queue_[1].arrival : entry.arrival;
    if (elapsed() < outdated) {
      waitUntil(lock, outdated);
    } else if (!queue_.empty()) {
      dropFront();
    } else {  // the reader holds every buffer
      ++skipped_;
      return false;
    }
  }
  return false;
}

void PacedSource::render(Entry& entry) {
  if (!player_.render(entry.frame)) {
    entry.frame = {};
    entry.status = SourceStatus::ReadError;
  }
}

// The reading thread.

ReadResult PacedSource::read(std::chrono::nanoseconds timeout) {
  std::unique_lock lock(mutex_);
  if (!std::exchange(started_, true)) start_ = clock_.now();
  const Nanoseconds deadline = elapsed() + std::clamp(timeout, Nanoseconds(0), kLongestTimeout);
  for (bool decoder_lags = false;;) {
    changed_.notify_all();  // time has passed, and the decoder may be waiting for it
    const Nanoseconds now = elapsed();
    while (queue_.size() >= 2 && queue_[1].arrival <= now) dropFront();
    const bool has_arrived = !queue_.empty() && queue_.front().arrival <= now;
    const bool is_newest = ended_ || next_arrival_ > now;
    if (has_arrived && (is_newest || decoder_lags)) return takeFront();
    if (!is_newest) {
      // A decoder that cannot keep up is not waited for while there is something to show.
      if (waitUntil(lock, has_arrived ? now : deadline)) continue;
      if (!has_arrived && elapsed() >= deadline) return {SourceStatus::Timeout, {}, false};
      decoder_lags = true;
      continue;
    }
    if (ended_ && queue_.empty()) return {SourceStatus::EndOfStream, {}, false};
    const Nanoseconds next = queue_.empty() ? next_arrival_ : queue_.front().arrival;
    lock.unlock();
    clock_.sleepUntil(start_ + std::min(next, deadline));
    lock.lock();
    if (next > deadline) return {SourceStatus::Timeout, {}, false};
  }
}

ReadResult PacedSource::takeFront() {
  Entry entry = std::move(queue_.front());
  queue_.erase(queue_.begin());
  changed_.notify_all();
  if (entry.status != SourceStatus::Ok) return {entry.status, {}, false};
  const auto media_time = nanoseconds(entry.frame.media_time_s);
  entry.frame.capture_time = start_ + media_time;
  const bool format_changed = std::exchange(format_, entry.frame.format) != entry.frame.format;
  return {SourceStatus::Ok, std::move(entry.frame), format_changed};
}

}  // namespace depthscope::capture
