#pragma once
#include <atomic>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace depthscope::platform {

/// Copies of data that one process writes and another reads at any time, without a lock: the reader
/// sees when it read across a write. All words are atomics, so that a torn read is a wrong value
/// and never undefined; words are stored with release and loaded with acquire order so that whoever
/// sees a word of a write also sees that the write had begun (Boehm, "Can seqlocks get along with
/// programming language memory models?", 2012).
namespace seqlock {

using Word = std::atomic<std::uint64_t>;
static_assert(Word::is_always_lock_free && sizeof(Word) == 8,
              "the layout is shared between processes");

inline constexpr std::size_t wordsFor(std::size_t bytes) {
  return (bytes + 7) / 8;
}

/// Copies bytes into words.
inline void store(Word* to, const void* from, std::size_t bytes) {
  const auto* in = static_cast<const unsigned char*>(from);
  for (; bytes >= 8; bytes -= 8, in += 8, ++to) {
    std::uint64_t word;
    std::memcpy(&word, in, 8);
    to->store(word, std::memory_order_release);
  }
  if (bytes > 0) {
    std::uint64_t word = 0;
    std::memcpy(&word, in, bytes);
    to->store(word, std::memory_order_release);
  }
}

/// Copies words into bytes.
inline void load(void* to, const Word* from, std::size_t bytes) {
  auto* out = static_cast<unsigned char*>(to);
  for (; bytes >= 8; bytes -= 8, out += 8, ++from) {
    const std::uint64_t word = from->load(std::memory_order_acquire);
    std::memcpy(out, &word, 8);
  }
  if (bytes > 0) {
    const std::uint64_t word = from->load(std::memory_order_acquire);
    std::memcpy(out, &word, bytes);
  }
}

/// Starts a write: the count is odd from now on. One writer at a time; a writer that died within a
/// write leaves it odd, and its successor starts from there.
inline void beginWrite(Word& count) {
  count.store(count.load(std::memory_order_relaxed) | 1, std::memory_order_relaxed);
}
/// Ends a write. The count is never 0 again, which means "nothing written yet".
inline void endWrite(Word& count) {
  std::uint64_t next = count.load(std::memory_order_relaxed) + 1;
  if (next == 0) next = 2;
  count.store(next, std::memory_order_release);
}

/// The count before a read; odd while a write is under way.
inline std::uint64_t beginRead(const Word& count) {
  return count.load(std::memory_order_acquire);
}
/// Whether nothing was written since beginRead() gave `before`.
inline bool endRead(const Word& count, std::uint64_t before) {
  return (before & 1) == 0 && count.load(std::memory_order_relaxed) == before;
}

}  // namespace seqlock

/// One value of a trivially copyable type behind a seqlock; lies in shared memory.
template <class T>
class SeqlockBox {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  void write(const T& value) {
    seqlock::beginWrite(count_);
    seqlock::store(words_, &value, sizeof value);
    seqlock::endWrite(count_);
  }

  /// The value and its count; false when there is none yet or a write was under way at each of a
  /// few tries.
  bool read(T& value, std::uint64_t* count = nullptr) const {
    constexpr int tries = 4;  // a writer that died within a write must not hold the reader up
    for (int i = 0; i < tries; ++i) {
      const std::uint64_t before = seqlock::beginRead(count_);
      if (before == 0) return false;
      seqlock::load(&value, words_, sizeof value);
      if (!seqlock::endRead(count_, before)) continue;
      if (count != nullptr) *count = before;
      return true;
    }
    return false;
  }

 private:
  seqlock::Word count_{0};
  seqlock::Word words_[seqlock::wordsFor(sizeof(T))]{};
};

}  // namespace depthscope::platform
