// Promise 2 of the design: outside the overlay, every pixel is the pixel that came in.
#include <gtest/gtest.h>

#include <filesystem>

#include "capture/file_source.hpp"
#include "capture/pixel_convert.hpp"
#include "overlay/compositor.hpp"
#include "platform/camera_file.hpp"
#include "tests/types/grid_mesh.hpp"
#include "types/surface_mesh.hpp"

namespace depthscope::platform {
namespace {

const std::filesystem::path sample = std::filesystem::path(DEPTHSCOPE_TEST_DATA) / "sample";

/// A dome 60 to 90 mm before the camera, over part of the view.
SurfaceMesh dome() {
  return gridMesh(40, [](float u, float v) {
    const float x = -24 + 48 * u, y = -15 + 40 * v;
    return Eigen::Vector3f(x, y, 60 + 0.02f * (x * x + y * y));
  });
}

struct Count {
  long pictures = 0, covered = 0, outside = 0, changed_outside = 0;
};

/// Composites pictures of the sample clip, and compares all that the layer leaves alone.
Count compare(const overlay::OverlaySettings& settings) {
  capture::FileSourceSettings clip;
  clip.path = sample / "video.mp4";
  const auto source = capture::openFileSource(clip);
  const CameraModel camera = loadCameraFile(sample / "camera.yaml");
  overlay::Compositor compositor(camera, settings), masks(camera, settings);
  const Label label{1, 0, {3, 2, 61}, "vein"};
  for (overlay::Compositor* c : {&compositor, &masks}) {
    c->setSurface(dome());
    c->setLabels(std::span(&label, 1));
  }
  const std::size_t bytes = static_cast<std::size_t>(camera.width * camera.height) * 4;
  std::vector<std::uint8_t> picture(bytes), out(bytes), layer(bytes);
  Count count;
  for (int i = 0;; ++i) {
    const capture::ReadResult result = source->read(std::chrono::seconds(1));
    if (result.status != capture::SourceStatus::Ok) break;
    ++count.pictures;
    capture::toRgba(result.frame, picture);
    overlay::OverlayState state;
    state.status = overlay::Status::Tracking;
    state.confidence = 1;
    state.time_s = i / 30.0;
    state.T_camera_world.t.x() = 0.04 * i;
    EXPECT_TRUE(compositor.composite(
        {picture.data(), camera.width, camera.height, camera.width * 4}, state, out));
    EXPECT_TRUE(masks.drawLayer(camera.width, camera.height, state, layer));
    for (std::size_t p = 0; p < bytes; p += 4) {
      if (layer[p + 3] != 0) {
        ++count.covered;
        continue;
      }
      ++count.outside;
      count.changed_outside += !std::equal(&out[p], &out[p] + 4, &picture[p]);
    }
  }
  return count;
}

class PixelIdentity : public testing::TestWithParam<overlay::CueMode> {};

TEST_P(PixelIdentity, OutsideTheOverlayEveryPixelOfEveryPictureIsAsItCameIn) {
  overlay::OverlaySettings settings;
  settings.cue = GetParam();
  const Count count = compare(settings);
  EXPECT_EQ(count.pictures, 450);
  EXPECT_EQ(count.changed_outside, 0);
  if (settings.cue == overlay::CueMode::Off) {
    EXPECT_EQ(count.covered, 0);
  } else {
    EXPECT_GT(count.covered, 450 * 20000) << "an overlay was drawn";
    EXPECT_GT(count.outside, 450 * 30000) << "and not everywhere";
  }
}

INSTANTIATE_TEST_SUITE_P(EveryMode, PixelIdentity,
                         testing::Values(overlay::CueMode::Off, overlay::CueMode::Chromadepth,
                                         overlay::CueMode::Mesh));

}  // namespace
}  // namespace depthscope::platform
