#pragma once
#include <array>
#include <atomic>
#include <cstdint>

namespace depthscope::platform {

/// Hands the newest value of one thread to another without a lock and without a copy: the writer
/// fills one of three values while the reader holds another, and neither ever waits.
template <class T>
class TripleBuffer {
 public:
  /// The writer's value; what was in it before is of no meaning.
  T& back() { return values_[back_]; }
  /// Makes back() the newest value.
  void publish() {
    back_ = middle_.exchange(static_cast<std::uint8_t>(back_ | fresh), std::memory_order_acq_rel) &
            index;
  }

  /// Takes the newest value, if there is one that was not taken yet.
  bool update() {
    if ((middle_.load(std::memory_order_relaxed) & fresh) == 0) return false;
    front_ = middle_.exchange(front_, std::memory_order_acq_rel) & index;
    return true;
  }
  /// The reader's value: the one that update() took last.
  const T& front() const { return values_[front_]; }

 private:
  static constexpr std::uint8_t index = 3, fresh = 4;
  std::array<T, 3> values_{};
  std::atomic<std::uint8_t> middle_{1};
  std::uint8_t back_ = 0;   // the writer's
  std::uint8_t front_ = 2;  // the reader's
};

}  // namespace depthscope::platform
