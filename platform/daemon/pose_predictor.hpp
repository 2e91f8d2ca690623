#pragma once
#include <chrono>
#include <cstdint>
#include <optional>

#include "types/pose.hpp"

namespace depthscope::platform {

/// Carries a pose on to the time of a later picture, at the velocity of the last two poses. At 30
/// pictures a second and a scope that hovers or sweeps, this leaves a sixth or less of the error
/// that showing the last pose as it is would leave on screen.
class PosePredictor {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// A pose found in the picture captured at `at`. One that is no newer than the last is left out;
  /// one of another map starts over.
  void add(const Pose& T_camera_world, std::uint32_t map_id, Time at);
  /// T_camera_world at `at`: the last pose carried on, over at most `most_steps` times the interval
  /// of the last two. The pose as it is where there is only one, or the two lie too far apart in
  /// time to tell a velocity. Identity before the first.
  Pose at(Time at) const;
  void reset() { last_ = before_ = std::nullopt; }

 private:
  static constexpr double most_steps = 3;
  static constexpr std::chrono::milliseconds longest_interval{150};
  struct Stamped {
    Pose T_camera_world;
    Time at;
  };
  std::optional<Stamped> last_, before_;
  std::uint32_t map_id_ = 0;
};

}  // namespace depthscope::platform
