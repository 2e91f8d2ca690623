#include "platform/surface_writer.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <charconv>
#include <ostream>
#include <string>

namespace depthscope::platform {
namespace {

static_assert(std::endian::native == std::endian::little,
              "binary files are written in the machine's own order");

constexpr std::string_view unit = "Depthscope surface, up to scale: in the map's unit of length";

template <class T>
void put(std::ostream& out, const T& value) {
  out.write(reinterpret_cast<const char*>(&value), sizeof value);
}

void put(std::ostream& out, const Eigen::Vector3f& v) {
  out.write(reinterpret_cast<const char*>(v.data()), 3 * sizeof(float));
}

void writePly(std::ostream& out, const SurfaceMesh& mesh) {
  out << "ply\nformat binary_little_endian 1.0\ncomment " << unit << "\nelement vertex "
      << mesh.vertices.size()
      << "\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\nproperty "
         "float ny\n"
         "property float nz\nproperty float confidence\nelement face "
      << mesh.triangles.size() << "\nproperty list uchar int vertex_indices\nend_header\n";
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    put(out, mesh.vertices[i]);
    put(out, mesh.normals[i]);
    put(out, mesh.confidence[i]);
  }
  for (const auto& triangle : mesh.triangles) {
    put(out, std::uint8_t{3});
    for (std::uint32_t index : triangle) put(out, index);
  }
}

/// `key x y z`, with the digits that tell each number from its neighbours, in no locale.
std::string line(std::string_view key, const Eigen::Vector3f& v) {
  std::string text(key);
  for (int i = 0; i < 3; ++i) {
    std::array<char, 32> digits;
    text += ' ';
    text.append(digits.data(), std::to_chars(digits.begin(), digits.end(), v[i]).ptr);
  }
  return text + '\n';
}

void writeObj(std::ostream& out, const SurfaceMesh& mesh) {
  out << "# " << unit << '\n';
  for (const auto& v : mesh.vertices) out << line("v", v);
  for (const auto& n : mesh.normals) out << line("vn", n);
  for (const auto& triangle : mesh.triangles) {
    out << 'f';
    for (std::uint32_t index : triangle) {
      const std::string number = std::to_string(index + 1);  // counted from 1
      out << ' ' << number << "//" << number;
    }
    out << '\n';
  }
}

void writeStl(std::ostream& out, const SurfaceMesh& mesh) {
  std::array<char, 80> header{};
  std::copy(unit.begin(), unit.end(), header.begin());
  out.write(header.data(), header.size());
  put(out, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3f &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]],
                          &c = mesh.vertices[t[2]];
    const Eigen::Vector3f normal = (b - a).cross(c - a).normalized();
    for (const Eigen::Vector3f& v : {normal, a, b, c}) put(out, v);
    put(out, std::uint16_t{0});
  }
}

}  // namespace

std::optional<SurfaceFormat> surfaceFormat(std::string_view extension) {
  std::string lower(extension);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (lower == "ply") return SurfaceFormat::Ply;
  if (lower == "obj") return SurfaceFormat::Obj;
  if (lower == "stl") return SurfaceFormat::Stl;
  return std::nullopt;
}

void writeSurface(std::ostream& out, const SurfaceMesh& mesh, SurfaceFormat format) {
  switch (format) {
    case SurfaceFormat::Ply:
      return writePly(out, mesh);
    case SurfaceFormat::Obj:
      return writeObj(out, mesh);
    case SurfaceFormat::Stl:
      return writeStl(out, mesh);
  }
}

}  // namespace depthscope::platform
