#pragma once
#include <atomic>
#include <vector>

#include "capture/frame.hpp"
#include "overlay/compositor.hpp"
#include "platform/daemon/pose_predictor.hpp"
#include "platform/daemon/published_frames.hpp"
#include "platform/ipc/frame_ring.hpp"
#include "platform/ipc/surface_mailbox.hpp"

namespace depthscope::platform {

/// The video process' end of the shared memory: gives pictures to the AR process and turns what
/// comes back, checked, into the overlay's state. Never waits for the AR process. Pictures are
/// given by one thread (the video loop), what comes back is taken by one other (which draws the
/// overlay).
class ArLink {
 public:
  /// `max_age_ms`: an older pose is not drawn with.
  ArLink(const SharedMemory& memory, float max_age_ms);

  /// How to draw over a picture.
  struct View {
    overlay::OverlayState state;
    bool posed = false;                   // drawn by a pose: while Tracking, and while fading
    PublishedFrames::Time pose_captured;  // capture time of the picture that it was found in
  };

  /// From any thread: whether an AR process runs. What one showed fades when it stops; its surface
  /// and labels are forgotten when the next one starts.
  void setAlive(bool alive);

  /// Hands a picture to the AR process, if it has the camera file's size. `gray` is scratch for
  /// formats without a luma plane.
  void publish(const capture::Frame& frame, std::vector<std::uint8_t>& gray);
  /// Brings the compositor's surface, labels and view up to date.
  void update(overlay::Compositor& compositor);
  /// Whether an AR process may find the pose of a picture of this size.
  bool expectsPose(int width, int height) const {
    return starts_seen_ % 2 == 1 && fits(width, height);
  }
  /// For a picture of this size captured at `captured`; the pose is predicted to that time. For
  /// each picture in turn.
  View view(PublishedFrames::Time captured, int width, int height);

  /// From any thread: the newest pose, while the scope is tracked in it and it is of a picture
  /// captured no longer before `now` than the age limit.
  std::optional<PoseEstimate> trackedPose(PublishedFrames::Time now) const;

  /// From any thread: things that the AR process sent and that did not pass the checks.
  std::uint64_t rejected() const { return rejected_.load(std::memory_order_relaxed); }

 private:
  void forget(overlay::Compositor& compositor);
  void updateSurface(overlay::Compositor& compositor);
  void updateLabels(overlay::Compositor& compositor);
  void updateView(overlay::Compositor& compositor);
  void takePose(PublishedFrames::Time captured, overlay::OverlayState& state);
  void reject() { rejected_.fetch_add(1, std::memory_order_relaxed); }
  bool fits(int width, int height) const;

  const SharedMemory& memory_;
  float max_age_ms_;
  FrameRingWriter frames_;
  SurfaceMailboxReader surfaces_;
  PublishedFrames published_;
  PosePredictor predictor_;
  PublishedFrames::Time pose_captured_;  // of the predictor's last pose
  overlay::FadeOut fade_out_;
  std::atomic<std::uint32_t> starts_{0};  // odd: alive
  std::uint32_t starts_seen_ = 0;
  std::atomic<std::uint64_t> rejected_{0};
  std::uint64_t labels_seen_ = 0, view_seen_ = 0;
  WireLabels wire_labels_{};
  WireView wire_view_{};
  ViewOutline view_;
  std::vector<Label> labels_;
  std::vector<Rgb> color_;  // of the picture that is given out
  SurfaceMesh surface_;
};

}  // namespace depthscope::platform
