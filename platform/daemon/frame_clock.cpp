#include "platform/daemon/frame_clock.hpp"

namespace depthscope::platform {
namespace {

double milliseconds(FrameTimes::Time from, FrameTimes::Time to) {
  return std::chrono::duration<double, std::milli>(to - from).count();
}

}  // namespace

DurationSummary summarize(const Histogram& h) {
  return {h.count(), h.percentile(0.5), h.percentile(0.99), h.percentile(0.999), h.max()};
}

void FrameClock::add(const FrameTimes& t) {
  video_delay_.add(milliseconds(t.captured, t.submitted));
  dequeue_.add(milliseconds(t.captured, t.dequeued));
  upload_.add(milliseconds(t.dequeued, t.uploaded));
  overlay_wait_.add(milliseconds(t.uploaded, t.overlaid));
  blend_.add(milliseconds(t.overlaid, t.composited));
  submit_.add(milliseconds(t.composited, t.submitted));
  if (t.overlay_age_ms) overlay_age_.add(*t.overlay_age_ms);
}

void FrameClock::addShown(FrameTimes::Time captured, FrameTimes::Time shown) {
  shown_delay_.add(milliseconds(captured, shown));
}

FrameClockSummary FrameClock::summary() const {
  return {summarize(video_delay_), summarize(shown_delay_), summarize(overlay_age_),
          summarize(dequeue_),     summarize(upload_),      summarize(overlay_wait_),
          summarize(blend_),       summarize(submit_)};
}

}  // namespace depthscope::platform
