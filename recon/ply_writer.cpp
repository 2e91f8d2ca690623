#include <unistd.h>

#include <bit>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <string>

#include "recon/mesh_io.hpp"
#include "types/error.hpp"

namespace depthscope::recon {
namespace {

static_assert(std::endian::native == std::endian::little,
              "PLY is written as the machine stores it");

void append(std::string& out, const auto& value) {
  char bytes[sizeof(value)];
  std::memcpy(bytes, &value, sizeof(value));
  out.append(bytes, sizeof(value));
}

void append(std::string& out, const Eigen::Vector3f& v) {
  for (int i = 0; i < 3; ++i) append(out, v[i]);
}

std::string header(const std::string& elements) {
  return "ply\nformat binary_little_endian 1.0\ncomment Depthscope, map units, world frame\n" +
         elements + "end_header\n";
}

/// Writes beside `path` and renames, so that no reader ever finds half a file.
void writeAtomically(const std::filesystem::path& path, const std::string& bytes) {
  std::filesystem::path temporary = path;
  temporary += ".tmp" + std::to_string(::getpid());
  std::ofstream out(temporary, std::ios::binary | std::ios::trunc);
  if (!out)
    throw InputError(path.string() + ": cannot be written (is the folder there and writable?)");
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out.close();
  std::error_code ec;
  if (out) std::filesystem::rename(temporary, path, ec);
  if (out && !ec) return;
  const std::string why = ec ? ec.message() : "the disk is full or failed";
  std::filesystem::remove(temporary, ec);
  throw std::runtime_error(path.string() + ": writing failed: " + why);
}

}  // namespace

void writePly(const std::filesystem::path& path, const SparseCloud& cloud) {
  std::string out =
      header("element vertex " + std::to_string(cloud.points.size()) +
             "\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\n"
             "property float ny\nproperty float nz\nproperty int observations\n"
             "property float reprojection_error\n");
  out.reserve(out.size() + cloud.points.size() * 32);
  for (const SparsePoint& p : cloud.points) {
    append(out, p.position);
    append(out, p.view_direction);
    append(out, p.observations);
    append(out, p.reprojection_error_px);
  }
  writeAtomically(path, out);
}

}  // namespace depthscope::recon
