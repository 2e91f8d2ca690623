#include "capture/pixel_convert.hpp"
#include "platform/ar/steady_view.hpp"
#include "platform/label_board.hpp"
#include "platform/replay/replay_clip.hpp"
#include "platform/stopwatch.hpp"
#include "platform/surface_schedule.hpp"
#include "recon/view_picture.hpp"
#include "types/allocation_scope.hpp"

namespace depthscope::platform {
namespace {

class LockstepReplay {
 public:
  LockstepReplay(const ReplayOptions& options, ReplayClip& clip, OverlayRecorder* recorder)
      : options_(options),
        clip_(clip),
        recorder_(recorder),
        slam_(options.camera, slamSettings(options, clip), slam::MappingMode::Lockstep),
        labels_(options.labels),
        gray_(static_cast<std::size_t>(options.camera.width) *
              static_cast<std::size_t>(options.camera.height)),
        schedule_(options.settings.recon.period_s),
        result_{RunRecord(clip.frameCapacity()), {}, {}, {}, {}} {
    if (options.surface) reconstructor_.emplace(options.camera, options.settings.recon);
  }

  ReplayResult run() {
    printCapacity(options_, slam_);
    std::int64_t frames = 0;
    for (capture::Frame frame = nextFrame(options_, clip_); !frame.empty();
         frame = nextFrame(options_, clip_)) {
      const PoseEstimate estimate = track(frame);
      if (reconstructor_ && slam_.wantsPicture()) keepPicture(frame, estimate.frame);
      reconstructWhenDue(estimate);
      show(frame, estimate);
      ++frames;
    }
    finishClip(options_, clip_, frames);
    return finish(frames);
  }

 private:
  PoseEstimate track(const capture::Frame& frame) {
    const AllocationScope counted;
    const GrayView luma = lumaOf(frame);
    const auto index = static_cast<std::int64_t>(frame.sequence);
    const PoseEstimate estimate = slam_.track(luma, index, clip_.time(frame.sequence));
    result_.record.add(estimate, slam_.lastTimes());
    return estimate;
  }

  /// The picture's luma; where it is worked out, good until the next call.
  GrayView lumaOf(const capture::Frame& frame) {
    if (const GrayView luma = frame.luma(); !luma.empty()) return luma;
    capture::toGray(frame, gray_);
    return {gray_.data(), options_.camera.width, options_.camera.height, options_.camera.width};
  }

  void keepPicture(const capture::Frame& frame, std::int64_t number) {
    const GrayView luma = lumaOf(frame);
    const Stopwatch watch;
    picture_.frame = number;
    if (const int factor = reconstructor_->pictureReduction(); factor > 0)
      recon::reducePicture(luma, factor, picture_.luma);
    const ColorReduction color(luma.width, luma.height);
    picture_.color.reset(color.width, color.height);
    capture::toReducedRgb(frame, picture_.color.cells);
    reconstructor_->addPicture(picture_);
    result_.record.metrics().pictures_ms += watch.elapsedMs();
  }

  void reconstructWhenDue(const PoseEstimate& estimate) {
    if (!reconstructor_ || estimate.state != TrackingState::Tracking ||
        !schedule_.due(estimate.timestamp_s))
      return;
    schedule_.surfaceRequested(estimate.timestamp_s);
    slam_.copyCloud(result_.cloud);
    if (!reconstruct(*reconstructor_, result_.cloud, result_.surface, result_.record.metrics()) ||
        recorder_ == nullptr)
      return;
    recorder_->compositor().setSurface(result_.surface);
    if (labels_.anchorWaiting(result_.surface, options_.camera, estimate))
      recorder_->compositor().setLabels(labels_.labels());
  }

  void show(const capture::Frame& frame, const PoseEstimate& estimate) {
    if (recorder_ == nullptr) return;
    if (view_.add(slam_.view(), estimate)) recorder_->compositor().setView(view_.view());
    recorder_->show(frame, overlayState(estimate, estimate.timestamp_s), estimate.frame,
                    VideoQueue::WhenFull::Wait, result_.record.metrics().composite);
  }

  ReplayResult finish(std::int64_t frames) {
    result_.record.close();
    result_.record.metrics().frames = frames;
    takeFinalMap(slam_, reconstructor_ ? &*reconstructor_ : nullptr, result_);
    return std::move(result_);
  }

  const ReplayOptions& options_;
  ReplayClip& clip_;
  OverlayRecorder* recorder_;
  slam::SlamSystem slam_;
  std::optional<recon::Reconstructor> reconstructor_;  // none where no surface is wanted
  SteadyView view_;
  recon::ViewPicture picture_;
  LabelBoard labels_;
  std::vector<std::uint8_t> gray_;
  SurfaceSchedule schedule_;
  ReplayResult result_;
};

}  // namespace

ReplayResult replayLockstep(const ReplayOptions& options, ReplayClip& clip,
                            OverlayRecorder* recorder) {
  return LockstepReplay(options, clip, recorder).run();
}

}  // namespace depthscope::platform
