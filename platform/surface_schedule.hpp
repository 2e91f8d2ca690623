#pragma once
#include <algorithm>

namespace depthscope::platform {

/// When a new surface is due: soon after tracking started, then every period. Times are the frames'
/// own.
class SurfaceSchedule {
 public:
  /// `period_s` 0: never due.
  explicit SurfaceSchedule(double period_s) : period_s_(period_s) {}

  /// To be asked at every tracked frame; true until surfaceRequested().
  bool due(double now_s) {
    if (period_s_ <= 0) return false;
    if (next_s_ < 0) next_s_ = now_s + std::min(first_surface_s, period_s_);
    return now_s >= next_s_;
  }
  void surfaceRequested(double now_s) { next_s_ = now_s + period_s_; }
  /// Tracking starts over, in a new map.
  void restart() { next_s_ = -1; }

 private:
  static constexpr double first_surface_s = 1.0;
  double period_s_;
  double next_s_ = -1;
};

}  // namespace depthscope::platform
