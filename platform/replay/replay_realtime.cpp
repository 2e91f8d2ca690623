#include "capture/pixel_convert.hpp"
#include "platform/label_board.hpp"
#include "platform/replay/replay_clip.hpp"
#include "platform/replay/tracking_thread.hpp"

namespace depthscope::platform {
namespace {

class RealtimeReplay {
 public:
  RealtimeReplay(const ReplayOptions& options, ReplayClip& clip, OverlayRecorder* recorder)
      : options_(options),
        clip_(clip),
        recorder_(recorder),
        labels_(options.labels),
        gray_(static_cast<std::size_t>(options.camera.width) *
              static_cast<std::size_t>(options.camera.height)),
        color_size_(options.camera.width, options.camera.height),
        color_(color_size_.pixels()),
        tracking_(options.camera, slamSettings(options, clip),
                  options.surface ? &options.settings.recon : nullptr, clip.frameCapacity()) {}

  ReplayResult run() {
    printCapacity(options_, tracking_.live().slam());
    std::int64_t frames = 0;
    for (capture::Frame frame = nextFrame(options_, clip_); !frame.empty();
         frame = nextFrame(options_, clip_)) {
      frames = static_cast<std::int64_t>(frame.sequence) + 1;
      offer(frame);
      if (recorder_ != nullptr) show(frame);
    }
    finishClip(options_, clip_, frames);
    return finish(frames);
  }

 private:
  void offer(const capture::Frame& frame) {
    GrayView luma = frame.luma();
    if (luma.empty()) {
      capture::toGray(frame, gray_);
      luma = {gray_.data(), options_.camera.width, options_.camera.height, options_.camera.width};
    }
    capture::toReducedRgb(frame, color_);
    tracking_.offer(luma, {color_.data(), color_size_.width, color_size_.height},
                    static_cast<std::int64_t>(frame.sequence), clip_.time(frame.sequence));
  }

  void show(const capture::Frame& frame) {
    const PoseEstimate estimate = tracking_.newest();
    if (tracking_.takeView(view_)) recorder_->compositor().setView(view_);
    if (tracking_.takeSurface(surface_)) {
      recorder_->compositor().setSurface(surface_);
      if (labels_.anchorWaiting(surface_, options_.camera, estimate))
        recorder_->compositor().setLabels(labels_.labels());
    }
    recorder_->show(frame, overlayState(estimate, clip_.time(frame.sequence)),
                    static_cast<std::int64_t>(frame.sequence), VideoQueue::WhenFull::GiveUp,
                    composite_ms_);
  }

  ReplayResult finish(std::int64_t frames) {
    tracking_.stop();
    tracking_.takeSurface(surface_);
    ReplayResult result{std::move(tracking_.record()), {}, std::move(surface_), {}, {}};
    result.record.close();
    RunMetrics& metrics = result.record.metrics();
    metrics.frames = frames;
    metrics.dropped_frames = frames - static_cast<std::int64_t>(metrics.track.count());
    metrics.reconstruct = tracking_.live().reconstructTimes();
    metrics.surfaces = static_cast<std::int64_t>(metrics.reconstruct.count());
    metrics.composite = composite_ms_;
    takeFinalMap(tracking_.live().slam(), tracking_.live().finishReconstruction(), result);
    return result;
  }

  const ReplayOptions& options_;
  ReplayClip& clip_;
  OverlayRecorder* recorder_;
  LabelBoard labels_;
  std::vector<std::uint8_t> gray_;
  ColorReduction color_size_;
  std::vector<Rgb> color_;
  SurfaceMesh surface_;
  ViewOutline view_;
  Histogram composite_ms_;
  TrackingThread tracking_;  // last: its thread ends first
};

}  // namespace

ReplayResult replayRealtime(const ReplayOptions& options, ReplayClip& clip,
                            OverlayRecorder* recorder) {
  return RealtimeReplay(options, clip, recorder).run();
}

}  // namespace depthscope::platform
