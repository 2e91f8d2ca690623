#include "platform/daemon/open_source.hpp"

#include "capture/edid.hpp"
#include "capture/file_source.hpp"
#include "capture/v4l2_devices.hpp"
#include "capture/v4l2_format.hpp"
#include "capture/v4l2_source.hpp"
#include "platform/camera_file.hpp"
#include "types/error.hpp"

namespace depthscope::platform {
namespace {

template <typename Check>
void checkKey(const char* key, Check check) {
  try {
    check();
  } catch (const InputError& error) {
    throw InputError(std::string(key) + ": " + error.what());
  }
}

void checkPixelFormat(const std::string& wanted) {
  std::string known;
  for (const auto fourcc : capture::preferredFormats()) {
    if (wanted == "auto" || wanted == capture::fourccText(fourcc)) return;
    known.append(", ").append(capture::fourccText(fourcc));
  }
  throw InputError("\"" + wanted + "\": expected one of auto" + known);
}

std::unique_ptr<capture::FrameSource> openClip(const CaptureSettings& settings,
                                               const CameraModel& camera) {
  capture::FileSourceSettings file;
  file.path = settings.input;
  file.pacing = capture::FileSourceSettings::Pacing::Clip;
  file.loop = settings.loop;
  file.fps = camera.fps;
  file.buffers = settings.buffers;
  if (!settings.faults.empty()) file.faults = capture::loadFaultScript(settings.faults);
  auto source = capture::openFileSource(file);
  requireSize(camera, settings.camera, source->format().width, source->format().height);
  return source;
}

}  // namespace

void checkCapture(const CaptureSettings& settings) {
  const capture::V4l2Settings& card = settings.card;
  if (card.device.empty() && settings.input.empty())
    throw InputError(
        "capture.device: is missing and so is capture.input, expected one of them: a "
        "capture card, or a video file or folder of images");
  if (card.device.empty()) return;
  if (!settings.input.empty())
    throw InputError("capture.device = \"" + card.device +
                     "\": expected without capture.input = \"" + settings.input +
                     "\", for there is one source of pictures");
  checkKey("capture.device", [&] { capture::requireSelection(card.device); });
  checkKey("capture.pixel_format", [&] { checkPixelFormat(card.pixel_format); });
  if (card.edid != "auto" && card.edid != "builtin" && card.edid != "none")
    checkKey("capture.edid", [&] { capture::loadEdid(card.edid); });
  if (!settings.faults.empty())
    throw InputError("capture.faults = \"" + settings.faults +
                     "\": expected only with capture.input, a card has its own");
}

capture::V4l2Settings cardSettings(const CaptureSettings& settings, const CameraModel& camera) {
  capture::V4l2Settings card = settings.card;
  card.fps = settings.fps;
  card.buffers = settings.buffers;
  if (card.width == 0) card.width = camera.width;
  if (card.height == 0) card.height = camera.height;
  return card;
}

std::unique_ptr<capture::FrameSource> openSource(const CaptureSettings& settings,
                                                 const CameraModel& camera) {
  if (settings.card.device.empty()) return openClip(settings, camera);
  return std::make_unique<capture::V4l2Source>(cardSettings(settings, camera),
                                               kernel::realSystemCalls());
}

}  // namespace depthscope::platform
