#include "platform/camera_file.hpp"

#include <gtest/gtest.h>

#include "expect_input_error.hpp"
#include "temporary_folder.hpp"

namespace depthscope::platform {
namespace {

using ::testing::HasSubstr;

constexpr const char* pinhole =
    "%YAML:1.0\n---\nimage_width: 640\nimage_height: 480\nfps: 30\ncamera_model: pinhole\n"
    "fx: 457.5\nfy: 458.5\ncx: 319.5\ncy: 239.5\nk1: -0.1\nk2: 0.02\np1: 1e-3\np2: -2.e-03\n";

class CameraFile : public ::testing::Test {
 protected:
  CameraModel load(const std::string& text) {
    return loadCameraFile(folder_.write("camera.yaml", text));
  }
  /// The pinhole file with one line replaced.
  std::string with(const std::string& key, const std::string& line) {
    std::string text = pinhole;
    const std::size_t at = text.find("\n" + key + ":") + 1;
    return text.replace(at, text.find('\n', at) - at + 1, line.empty() ? "" : line + "\n");
  }
  TemporaryFolder folder_;
};

TEST_F(CameraFile, ReadsAPinholeCameraAsOpenCvWritesIt) {
  const CameraModel c = load(pinhole);
  EXPECT_EQ(c.kind, CameraModel::Kind::Pinhole);
  EXPECT_EQ(c.width, 640);
  EXPECT_EQ(c.height, 480);
  EXPECT_EQ(c.fps, 30);
  EXPECT_EQ(c.fx, 457.5);
  EXPECT_EQ(c.fy, 458.5);
  EXPECT_EQ(c.k, (std::array<double, 5>{-0.1, 0.02, 1e-3, -2e-3, 0}));
}

TEST_F(CameraFile, ReadsTheOptionalThirdRadialTerm) {
  EXPECT_EQ(load(std::string(pinhole) + "k3: 0.5\n").k[4], 0.5);
}

TEST_F(CameraFile, ReadsAFisheyeCamera) {
  const CameraModel c = load(
      "image_width: 800\nimage_height: 600\ncamera_model: fisheye\nfx: 300\nfy: 300\ncx: 400\ncy: "
      "300\n"
      "k1: 0.1\nk2: 0.2\nk3: 0.3\nk4: 0.4\n");
  EXPECT_EQ(c.kind, CameraModel::Kind::Fisheye);
  EXPECT_EQ(c.fps, 0);
  EXPECT_EQ(c.k, (std::array<double, 5>{0.1, 0.2, 0.3, 0.4, 0}));
}

TEST_F(CameraFile, NamesEveryMissingKey) {
  for (const char* key : {"image_width", "image_height", "camera_model", "fx", "fy", "cx", "cy",
                          "k1", "k2", "p1", "p2"})
    EXPECT_INPUT_ERROR(load(with(key, "")), HasSubstr("camera.yaml"),
                       HasSubstr(std::string(key) + ": is missing"));
}

TEST_F(CameraFile, RefusesWhatIsNoFiniteNumber) {
  for (const char* value : {"nan", ".nan", "inf", "-.inf", "1e999", "abc", "12px", "", "[1, 2]"})
    EXPECT_INPUT_ERROR(load(with("cx", std::string("cx: ") + value)), HasSubstr("camera.yaml"),
                       HasSubstr("cx: "), HasSubstr("finite"));
}

TEST_F(CameraFile, RefusesSizesAndFocalLengthsThatCannotBe) {
  EXPECT_INPUT_ERROR(load(with("fx", "fx: 0")), HasSubstr("fx: "), HasSubstr("positive"));
  EXPECT_INPUT_ERROR(load(with("fy", "fy: -3")), HasSubstr("fy: "), HasSubstr("positive"));
  EXPECT_INPUT_ERROR(load(with("image_width", "image_width: 640.5")), HasSubstr("image_width: "));
  EXPECT_INPUT_ERROR(load(with("image_height", "image_height: 0")), HasSubstr("image_height: "));
  EXPECT_INPUT_ERROR(load(with("fps", "fps: -1")), HasSubstr("fps: "));
}

TEST_F(CameraFile, RefusesAnUnknownModel) {
  EXPECT_INPUT_ERROR(load(with("camera_model", "camera_model: omni")),
                     HasSubstr("camera_model: omni"), HasSubstr("pinhole or fisheye"));
}

TEST_F(CameraFile, RefusesWhatIsNoCameraFile) {
  EXPECT_INPUT_ERROR(load(""), HasSubstr("camera.yaml"));
  EXPECT_INPUT_ERROR(load("%YAML:1.0"), HasSubstr("camera.yaml"));
  EXPECT_INPUT_ERROR(load("just words"), HasSubstr("camera.yaml"));
  EXPECT_INPUT_ERROR(load("fx: [1, 2\n"), HasSubstr("camera.yaml:"), HasSubstr("not YAML"));
  EXPECT_INPUT_ERROR(load(std::string("\0\1\2\xff", 4)), HasSubstr("camera.yaml"));
  EXPECT_INPUT_ERROR(loadCameraFile(folder_.path() / "none.yaml"), HasSubstr("none.yaml"));
}

TEST_F(CameraFile, ComparesItsSizeWithTheClips) {
  const CameraModel c = load(pinhole);
  EXPECT_NO_THROW(requireSize(c, "camera.yaml", 640, 480));
  EXPECT_INPUT_ERROR(requireSize(c, "camera.yaml", 1024, 480),
                     HasSubstr("camera.yaml: image_width"), HasSubstr("1024"));
  EXPECT_INPUT_ERROR(requireSize(c, "camera.yaml", 640, 768),
                     HasSubstr("camera.yaml: image_height"), HasSubstr("768"));
}

}  // namespace
}  // namespace depthscope::platform
