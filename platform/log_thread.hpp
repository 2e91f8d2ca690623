#pragma once
#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <semaphore>
#include <string>
#include <thread>

namespace depthscope::platform {

/// A line of the log, ready to be written.
struct LogEntry {
  std::string line;     // for stderr
  std::string journal;  // for the journal, by its native protocol; empty where stderr is not its
};

/// Log entries on their way to the one thread that writes them. Has room for a fixed number; one
/// that finds none is counted and gone.
class LogQueue {
 public:
  /// From any thread. Never waits.
  void put(LogEntry&& entry);
  /// The oldest entry, waited for; false after close() when there is none left. From one thread.
  bool take(LogEntry& entry);
  /// Entries that found no room since this was asked last.
  std::uint64_t takeLost() { return lost_.exchange(0, std::memory_order_relaxed); }
  void close();

 private:
  enum class State : std::uint8_t { Free, Filling, Full };
  struct Slot {
    std::atomic<State> state{State::Free};
    std::uint64_t number = 0;  // in the order in which they came
    LogEntry entry;
  };
  Slot* oldest();

  std::array<Slot, 64> slots_;
  std::atomic<std::uint64_t> count_{0}, lost_{0};
  std::atomic<bool> closed_{false};
  std::counting_semaphore<> filled_{0};
};

/// While one lives, log() hands its lines to a thread, so that no one who logs waits for whoever
/// reads the log: a full pipe, a slow disk, a terminal that is held. One at a time; no thread may
/// log any more when it is made or ends.
class LogThread {
 public:
  LogThread();
  /// What is still under way is written first, as far as that takes no longer than half a second.
  ~LogThread();
  LogThread(const LogThread&) = delete;
  LogThread& operator=(const LogThread&) = delete;

  /// False when there is no such thread: the entry is left to the caller.
  static bool take(LogEntry& entry);

 private:
  struct Shared {
    LogQueue queue;
    std::binary_semaphore ended{0};
  };
  static void write(const std::shared_ptr<Shared>& shared);

  std::shared_ptr<Shared> shared_;  // with the thread, which may be held up for longer than we live
  std::thread thread_;
};

}  // namespace depthscope::platform
