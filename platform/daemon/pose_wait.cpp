#include "platform/daemon/pose_wait.hpp"

namespace depthscope::platform {

bool PoseWait::until(std::int64_t frame, Time deadline) const {
  const kernel::Bell& bell = memory_.block().new_pose;
  for (;;) {
    const std::uint32_t rings = bell.rings();
    WirePose pose;
    // What was written is checked by whoever draws by it; here it costs a wait at most.
    if (memory_.block().pose.read(pose)) {
      if (pose.frame >= frame) return true;
      if (pose.frame < frame - most_behind) return false;
    }
    const auto left = deadline - system_.now();
    if (left.count() <= 0) return false;
    const int waited = system_.waitForRing(bell, rings, left);
    if (waited != 0 && waited != -EINTR) return false;
  }
}

}  // namespace depthscope::platform
