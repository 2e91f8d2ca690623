#include "platform/vocabulary/training_pictures.hpp"

#include "capture/file_source.hpp"
#include "capture/pixel_convert.hpp"
#include "platform/camera_file.hpp"
#include "slam/orb_extractor.hpp"
#include "types/error.hpp"

namespace depthscope::platform {
namespace {

namespace fs = std::filesystem;

/// The clip within a sequence folder; anything else is the clip itself.
fs::path clipOf(const fs::path& input) {
  if (!fs::exists(input))
    throw InputError(input.string() + ": does not exist, expected a sequence, pictures or a video");
  if (!fs::is_directory(input)) return input;
  if (fs::is_directory(input / "frames")) return input / "frames";
  for (const char* name : {"video.mp4", "video.mkv", "video.avi", "video.mov"})
    if (fs::exists(input / name)) return input / name;
  return input;
}

/// The sequence's camera; without one a lens that does not distort, as words need none.
CameraModel cameraOf(const fs::path& input, const capture::FrameFormat& format) {
  if (const fs::path file = input / "camera.yaml"; fs::exists(file)) {
    const CameraModel camera = loadCameraFile(file);
    requireSize(camera, file, format.width, format.height);
    return camera;
  }
  CameraModel camera;
  camera.width = format.width;
  camera.height = format.height;
  camera.fx = camera.fy = format.width;
  camera.cx = (format.width - 1) / 2.0;
  camera.cy = (format.height - 1) / 2.0;
  return camera;
}

}  // namespace

void addTrainingPictures(const fs::path& input, int every,
                         std::vector<std::vector<slam::Descriptor>>& pictures) {
  capture::FileSourceSettings settings;
  settings.path = clipOf(input);
  const auto source = capture::openFileSource(settings);
  const CameraModel camera = cameraOf(input, source->format());
  const slam::ExtractorSettings extraction;
  slam::OrbExtractor extractor(extraction, camera);
  slam::FeatureSet features(extraction.features, camera);
  std::vector<std::uint8_t> gray(static_cast<std::size_t>(camera.width) *
                                 static_cast<std::size_t>(camera.height));
  for (std::int64_t i = 0;; ++i) {
    const capture::ReadResult result = source->read(std::chrono::milliseconds(0));
    if (result.status == capture::SourceStatus::EndOfStream) return;
    if (result.status != capture::SourceStatus::Ok)
      throw InputError(settings.path.string() + ": " + std::string(toString(result.status)) +
                       ", expected a clip that can be read to its end");
    if (i % every != 0) continue;
    const capture::FrameFormat& format = result.frame.format;
    if (format.width != camera.width || format.height != camera.height)
      throw InputError(settings.path.string() + ": changes its size");
    capture::toGray(result.frame, gray);
    extractor.extract({gray.data(), camera.width, camera.height, camera.width}, features);
    if (features.size() > 0) pictures.push_back(features.descriptors);
  }
}

}  // namespace depthscope::platform
