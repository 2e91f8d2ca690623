#pragma once
#include <chrono>
#include <optional>

namespace depthscope::platform {

/// Takes a contact's bouncing out: a level counts once it was steady for a while, as the kernel's
/// own debouncing has it.
class Debouncer {
 public:
  using Time = std::chrono::steady_clock::time_point;

  Debouncer(std::chrono::microseconds period, bool level)
      : period_(period), steady_(level), now_at_(level) {}

  /// The contact has this level from `at` on.
  void feed(bool level, Time at) {
    if (level == now_at_) return;
    now_at_ = level;
    since_ = at;
  }
  /// The level that became steady by `now`, once; none while nothing changed.
  std::optional<bool> settle(Time now) {
    if (now_at_ == steady_ || now < since_ + period_) return std::nullopt;
    steady_ = now_at_;
    return steady_;
  }
  /// When to ask again, while the contact bounces.
  std::optional<Time> settlesAt() const {
    return now_at_ == steady_ ? std::nullopt : std::optional(since_ + period_);
  }
  bool level() const { return now_at_; }

 private:
  std::chrono::microseconds period_;
  bool steady_, now_at_;
  Time since_{};
};

}  // namespace depthscope::platform
