#pragma once
#include "overlay/surface_pass.hpp"
#include "overlay/surface_prep.hpp"

namespace depthscope::overlay {

/// The newest surface and the one before it, on their way from one to the other.
class SurfaceStack {
 public:
  struct Surface {
    PreparedSurface prepared;
    SurfaceBuffers buffers;

    Pose inCamera(const Pose& T_camera_world) const {
      return T_camera_world * Pose{Eigen::Matrix3d::Identity(), prepared.origin};
    }
  };
  /// What is to be seen of a map; either may be null.
  struct Shown {
    const Surface* before = nullptr;
    const Surface* newest = nullptr;
    float crossfade = 1;  // 0: `before` alone, 1: `newest` alone

    const Surface* main() const { return newest ? newest : before; }
  };

  void set(const SurfaceMesh& mesh, const OverlaySettings& settings);
  /// At the picture of `time_s` (negative: unknown, the newest replaces the one before at once).
  Shown shown(std::uint32_t map_id, double time_s, float crossfade_s);

 private:
  SurfacePrep prep_;
  Surface surfaces_[2];
  int newest_ = 0;
  bool started_ = true;  // the newest was shown already
  double start_s_ = -1;  // since then
};

}  // namespace depthscope::overlay
