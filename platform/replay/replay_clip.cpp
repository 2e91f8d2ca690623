#include "platform/replay/replay_clip.hpp"

#include <stdexcept>

#include "platform/camera_file.hpp"
#include "platform/interrupt.hpp"
#include "platform/log.hpp"
#include "types/error.hpp"

namespace depthscope::platform {

ReplayClip openReplayClip(const ReplayOptions& options) {
  capture::FileSourceSettings settings;
  settings.path = options.input;
  settings.pacing = options.realtime ? capture::FileSourceSettings::Pacing::Clip
                                     : capture::FileSourceSettings::Pacing::Lockstep;
  settings.fps = options.camera.fps;
  ReplayClip clip;
  clip.source = capture::openFileSource(settings);
  const capture::FrameFormat format = clip.source->format();
  requireSize(options.camera, options.camera_file, format.width, format.height);
  clip.fps = options.camera.fps > 0 ? options.camera.fps : clip.source->fps();
  if (clip.fps <= 0)
    throw InputError(options.camera_file.string() + ": fps: is missing, expected as " +
                     options.input.string() + " does not tell");
  clip.frames = capture::countFrames(options.input);
  return clip;
}

slam::SlamSettings slamSettings(const ReplayOptions& options, const ReplayClip& clip) {
  slam::SlamSettings settings = options.settings.slam;
  settings.trajectory_frames = clip.frameCapacity();
  return settings;
}

capture::Frame nextFrame(const ReplayOptions& options, ReplayClip& clip) {
  using capture::SourceStatus;
  for (;;) {
    if (interrupted()) throw std::runtime_error("interrupted");
    capture::ReadResult result = clip.source->read(std::chrono::milliseconds(200));
    if (result.status == SourceStatus::EndOfStream) return {};
    if (result.status == SourceStatus::Timeout) continue;
    if (result.status != SourceStatus::Ok)
      throw InputError(options.input.string() + ": " + std::string(toString(result.status)) +
                       ", expected a clip that can be read to its end");
    const capture::FrameFormat& format = result.frame.format;
    if (format.width != options.camera.width || format.height != options.camera.height)
      throw InputError(options.input.string() + ": frame " + std::to_string(result.frame.sequence) +
                       " is " + std::to_string(format.width) + "x" + std::to_string(format.height) +
                       ", expected the size of the first");
    return std::move(result.frame);
  }
}

void finishClip(const ReplayOptions& options, ReplayClip& clip, std::int64_t frames) {
  const std::string damage = clip.source->damage();
  if (frames < clip.frames)
    throw InputError(
        damage.empty() ? options.input.string() + ": ends after " + std::to_string(frames) +
                             " of " + std::to_string(clip.frames) + " frames, expected a whole clip"
                       : damage + ", expected a whole clip");
  if (!damage.empty()) log(LogPriority::Warning, "the clip is damaged", {{"what", damage}});
  clip.source.reset();
}

}  // namespace depthscope::platform
