#include "capture/file_source.hpp"

#include "capture/clip_reader.hpp"
#include "capture/image_folder.hpp"
#include "capture/lockstep_source.hpp"
#include "capture/paced_source.hpp"
#include "capture/video_decoder.hpp"
#include "types/error.hpp"

namespace depthscope::capture {

std::unique_ptr<ClipReader> openClip(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status))
    throw InputError(path.string() + ": no such file, expected a video or a folder of images");
  if (std::filesystem::is_directory(status)) return std::make_unique<ImageFolder>(path);
  // A pipe or a device would block, and could be read only once.
  if (!std::filesystem::is_regular_file(status))
    throw InputError(path.string() + ": neither a file nor a folder, expected a video or images");
  if (std::filesystem::file_size(path, error) == 0)
    throw InputError(path.string() + ": is empty, expected a video");
  return std::make_unique<VideoDecoder>(path);
}

std::unique_ptr<FrameSource> openFileSource(const FileSourceSettings& settings,
                                            PacingClock& clock) {
  if (settings.pacing == FileSourceSettings::Pacing::Clip)
    return std::make_unique<PacedSource>(settings, clock);
  return std::make_unique<LockstepSource>(settings, clock);
}

std::int64_t countFrames(const std::filesystem::path& path) {
  return openClip(path)->frameCount();
}

}  // namespace depthscope::capture
