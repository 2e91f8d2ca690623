#include "platform/calibrate/camera_writer.hpp"

#include <unistd.h>

#include <charconv>
#include <fstream>
#include <string>

#include "types/error.hpp"

namespace depthscope::platform {
namespace {

/// The shortest text that reads back to the same number, in every locale.
std::string text(double value) {
  char buffer[32];
  const auto end = std::to_chars(buffer, buffer + sizeof(buffer), value).ptr;
  return {buffer, end};
}

std::string contents(const CameraModel& c) {
  const bool fisheye = c.kind == CameraModel::Kind::Fisheye;
  std::string out = "%YAML:1.0\n---\n";
  const auto line = [&](const char* key, const std::string& value) {
    out += std::string(key) + ": " + value + "\n";
  };
  line("image_width", std::to_string(c.width));
  line("image_height", std::to_string(c.height));
  if (c.fps > 0) line("fps", text(c.fps));
  line("camera_model", fisheye ? "fisheye" : "pinhole");
  line("fx", text(c.fx));
  line("fy", text(c.fy));
  line("cx", text(c.cx));
  line("cy", text(c.cy));
  line("k1", text(c.k[0]));
  line("k2", text(c.k[1]));
  line(fisheye ? "k3" : "p1", text(c.k[2]));
  line(fisheye ? "k4" : "p2", text(c.k[3]));
  if (!fisheye && c.k[4] != 0) line("k3", text(c.k[4]));
  return out;
}

}  // namespace

void saveCameraFile(const std::filesystem::path& path, const CameraModel& camera) {
  std::filesystem::path temporary = path;
  temporary += ".tmp" + std::to_string(::getpid());
  std::ofstream out(temporary, std::ios::trunc);
  if (out) out << contents(camera);
  out.close();
  std::error_code ec;
  if (out) std::filesystem::rename(temporary, path, ec);
  if (out && !ec) return;
  std::filesystem::remove(temporary, ec);
  throw InputError(path.string() + ": cannot be written");
}

}  // namespace depthscope::platform
