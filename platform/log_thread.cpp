#include "platform/log_thread.hpp"

#include <chrono>

#include "platform/log.hpp"

namespace depthscope::platform {
namespace {

constexpr std::chrono::milliseconds patience{500};
std::atomic<LogQueue*> current{nullptr};

}  // namespace

void LogQueue::put(LogEntry&& entry) {
  for (Slot& slot : slots_) {
    State state = State::Free;
    if (!slot.state.compare_exchange_strong(state, State::Filling, std::memory_order_acquire))
      continue;
    slot.number = count_.fetch_add(1, std::memory_order_relaxed);
    slot.entry = std::move(entry);
    slot.state.store(State::Full, std::memory_order_release);
    filled_.release();
    return;
  }
  lost_.fetch_add(1, std::memory_order_relaxed);
}

LogQueue::Slot* LogQueue::oldest() {
  Slot* found = nullptr;
  for (Slot& slot : slots_)
    if (slot.state.load(std::memory_order_acquire) == State::Full &&
        (found == nullptr || slot.number < found->number))
      found = &slot;
  return found;
}

bool LogQueue::take(LogEntry& entry) {
  for (;;) {
    Slot* const slot = oldest();
    if (slot != nullptr) {
      entry = std::move(slot->entry);
      slot->state.store(State::Free, std::memory_order_release);
      return true;
    }
    if (closed_.load(std::memory_order_acquire)) return false;
    filled_.acquire();
  }
}

void LogQueue::close() {
  closed_.store(true, std::memory_order_release);
  filled_.release();
}

LogThread::LogThread() : shared_(std::make_shared<Shared>()) {
  thread_ = std::thread([shared = shared_] { write(shared); });
  current.store(&shared_->queue, std::memory_order_release);
}

LogThread::~LogThread() {
  current.store(nullptr, std::memory_order_release);
  shared_->queue.close();
  if (shared_->ended.try_acquire_for(patience))
    thread_.join();
  else
    thread_.detach();
}

bool LogThread::take(LogEntry& entry) {
  LogQueue* const queue = current.load(std::memory_order_acquire);
  if (queue == nullptr) return false;
  queue->put(std::move(entry));
  return true;
}

void LogThread::write(const std::shared_ptr<Shared>& shared) {
  for (LogEntry entry; shared->queue.take(entry);) {
    writeLogEntry(entry);
    if (const std::uint64_t lost = shared->queue.takeLost(); lost > 0)
      writeLogEntry(makeLogEntry(
          LogPriority::Warning, "log lines are missing here, nobody took them", {{"lines", lost}}));
  }
  shared->ended.release();
}

}  // namespace depthscope::platform
