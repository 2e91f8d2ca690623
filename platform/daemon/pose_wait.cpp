#include "platform/daemon/pose_wait.hpp"

#include <array>

namespace depthscope::platform {

bool PoseWait::until(std::int64_t frame, Time deadline) const {
  for (;;) {
    WirePose pose;
    // What was written is checked by whoever draws by it; here it costs a wait at most.
    if (memory_.block().pose.read(pose)) {
      if (pose.frame >= frame) return true;
      if (pose.frame < frame - most_behind) return false;
    }
    const auto left = deadline - system_.now();
    if (left.count() <= 0) return false;
    std::array<pollfd, 1> event{{{pose_event_, POLLIN, 0}}};
    if (system_.poll(event, left) <= 0 || (event[0].revents & POLLIN) == 0) return false;
    std::array<std::byte, 8> count{};
    system_.read(pose_event_, count);
  }
}

}  // namespace depthscope::platform
