#include "platform/camera_file.hpp"

#include <yaml-cpp/yaml.h>

#include <cmath>
#include <string>

#include "platform/text_file.hpp"
#include "types/error.hpp"

namespace depthscope::platform {
namespace {

constexpr int max_side_px = 16384;

/// The file's text with OpenCV's first line "%YAML:1.0", which YAML itself does not allow, blanked,
/// so that line numbers stay.
std::string readText(const std::filesystem::path& path) {
  std::string all = readTextFile(path, "a camera file (OpenCV YAML)");
  if (all.starts_with("%YAML:")) all.erase(0, std::min(all.find('\n'), all.size()));
  return all;
}

/// Keys of one camera file, each checked as it is asked for.
class CameraReader {
 public:
  CameraReader(std::string file, YAML::Node root)
      : file_(std::move(file)), root_(std::move(root)) {}

  [[noreturn]] void fail(const char* key, const std::string& what) const {
    throw InputError(file_ + ": " + key + ": " + what);
  }
  bool has(const char* key) const { return root_[key].IsDefined(); }

  std::string text(const char* key, const char* expected) const {
    if (!has(key)) fail(key, std::string("is missing, expected ") + expected);
    if (!root_[key].IsScalar()) fail(key, std::string("expected ") + expected);
    return root_[key].Scalar();
  }
  double number(const char* key) const {
    const std::string scalar = text(key, "a finite number");
    std::size_t used = 0;
    double value = NAN;
    try {
      value = std::stod(scalar, &used);
    } catch (const std::exception&) {
    }
    if (used != scalar.size() || !std::isfinite(value))
      fail(key, scalar + " is not a finite number");
    return value;
  }
  double positive(const char* key) const {
    const double value = number(key);
    if (value <= 0) fail(key, text(key, "") + " is out of range, expected a positive number");
    return value;
  }
  int side(const char* key) const {
    const double value = number(key);
    if (value < 1 || value > max_side_px || value != std::floor(value))
      fail(key, text(key, "") + " is out of range, expected an integer from 1 to " +
                    std::to_string(max_side_px));
    return static_cast<int>(value);
  }

 private:
  std::string file_;
  YAML::Node root_;
};

YAML::Node parse(const std::filesystem::path& path) {
  try {
    YAML::Node root = YAML::Load(readText(path));
    if (!root.IsMap())
      throw InputError(path.string() +
                       ": expected a camera file (OpenCV YAML), keys image_width, fx, ...");
    return root;
  } catch (const YAML::Exception& error) {
    throw InputError(path.string() + ":" + std::to_string(error.mark.line + 1) +
                     ": not YAML: " + error.msg);
  }
}

void readDistortion(const CameraReader& in, CameraModel& camera) {
  if (camera.kind == CameraModel::Kind::Fisheye) {
    camera.k = {in.number("k1"), in.number("k2"), in.number("k3"), in.number("k4"), 0};
    return;
  }
  camera.k = {in.number("k1"), in.number("k2"), in.number("p1"), in.number("p2"),
              in.has("k3") ? in.number("k3") : 0};
}

}  // namespace

CameraModel loadCameraFile(const std::filesystem::path& path) {
  const CameraReader in(path.string(), parse(path));
  CameraModel camera;
  const std::string model = in.text("camera_model", "pinhole or fisheye");
  if (model != "pinhole" && model != "fisheye")
    in.fail("camera_model", model + " is unknown, expected pinhole or fisheye");
  camera.kind = model == "pinhole" ? CameraModel::Kind::Pinhole : CameraModel::Kind::Fisheye;
  camera.width = in.side("image_width");
  camera.height = in.side("image_height");
  camera.fps = in.has("fps") ? in.number("fps") : 0;
  if (camera.fps < 0 || camera.fps > 1000)
    in.fail("fps", "is out of range, expected 0 (unknown) to 1000");
  camera.fx = in.positive("fx");
  camera.fy = in.positive("fy");
  camera.cx = in.number("cx");
  camera.cy = in.number("cy");
  readDistortion(in, camera);
  return camera;
}

void requireSize(const CameraModel& camera, const std::filesystem::path& camera_file, int width,
                 int height) {
  const auto check = [&](const char* key, int in_file, int in_clip) {
    if (in_file != in_clip)
      throw InputError(camera_file.string() + ": " + key + ": is " + std::to_string(in_file) +
                       ", expected the clip's " + std::to_string(in_clip));
  };
  check("image_width", camera.width, width);
  check("image_height", camera.height, height);
}

}  // namespace depthscope::platform
