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

/// A surface on its way into a file.
struct Exported {
  const SurfaceMesh& mesh;
  float factor;      // from map units to those of the file
  std::string unit;  // what these are: fits into the 80 characters of STL
  std::string from;  // how the scale is known; empty without one

  Eigen::Vector3f vertex(std::size_t i) const { return factor * mesh.vertices[i]; }
};

Exported prepare(const SurfaceMesh& mesh, const std::optional<MapScale>& scale, Lengths lengths) {
  if (!scale) return {mesh, 1, "Depthscope surface, up to scale: in the map's unit of length", {}};
  const bool mm = lengths == Lengths::Millimetres;
  return {mesh, mm ? static_cast<float>(scale->mm_per_unit) : 1,
          std::string("Depthscope surface in ") + (mm ? "mm" : "map units") +
              ", scale: " + toString(*scale),
          "scale from " + toString(scale->from)};
}

template <class T>
void put(std::ostream& out, const T& value) {
  out.write(reinterpret_cast<const char*>(&value), sizeof value);
}

void put(std::ostream& out, const Eigen::Vector3f& v) {
  out.write(reinterpret_cast<const char*>(v.data()), 3 * sizeof(float));
}

void writePly(std::ostream& out, const Exported& surface) {
  const SurfaceMesh& mesh = surface.mesh;
  out << "ply\nformat binary_little_endian 1.0\ncomment " << surface.unit << '\n';
  if (!surface.from.empty()) out << "comment " << surface.from << '\n';
  const bool colors = !mesh.colors.empty(), observations = !mesh.observations.empty();
  out << "element vertex " << mesh.vertices.size()
      << "\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\nproperty "
         "float ny\n"
         "property float nz\nproperty float confidence\n";
  if (colors) out << "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  if (observations) out << "property ushort observations\n";
  out << "element face " << mesh.triangles.size()
      << "\nproperty list uchar int vertex_indices\nend_header\n";
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    put(out, surface.vertex(i));
    put(out, mesh.normals[i]);
    put(out, mesh.confidence[i]);
    if (colors) put(out, mesh.colors[i]);
    if (observations) put(out, mesh.observations[i]);
  }
  for (const auto& triangle : mesh.triangles) {
    put(out, std::uint8_t{3});
    for (std::uint32_t index : triangle) put(out, index);
  }
}

/// ` x y z`, with the digits that tell each number from its neighbours, in no locale.
std::string numbers(const Eigen::Vector3f& v) {
  std::string text;
  for (int i = 0; i < 3; ++i) {
    std::array<char, 32> digits;
    text += ' ';
    text.append(digits.data(), std::to_chars(digits.begin(), digits.end(), v[i]).ptr);
  }
  return text;
}

Eigen::Vector3f unitRange(const Rgb& color) {
  return Eigen::Vector3f(color[0], color[1], color[2]) / 255;
}

void writeObj(std::ostream& out, const Exported& surface) {
  const SurfaceMesh& mesh = surface.mesh;
  out << "# " << surface.unit << '\n';
  if (!surface.from.empty()) out << "# " << surface.from << '\n';
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    out << 'v' << numbers(surface.vertex(i));
    if (!mesh.colors.empty()) out << numbers(unitRange(mesh.colors[i]));
    out << '\n';
  }
  for (const auto& n : mesh.normals) out << "vn" << numbers(n) << '\n';
  for (const auto& triangle : mesh.triangles) {
    out << 'f';
    for (std::uint32_t index : triangle) {
      const std::string number = std::to_string(index + 1);  // counted from 1
      out << ' ' << number << "//" << number;
    }
    out << '\n';
  }
}

void writeStl(std::ostream& out, const Exported& surface) {
  std::array<char, 80> header{};
  std::copy_n(surface.unit.begin(), std::min(surface.unit.size(), header.size()), header.begin());
  out.write(header.data(), header.size());
  put(out, static_cast<std::uint32_t>(surface.mesh.triangles.size()));
  for (const auto& t : surface.mesh.triangles) {
    const Eigen::Vector3f a = surface.vertex(t[0]), b = surface.vertex(t[1]),
                          c = surface.vertex(t[2]);
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

void writeSurface(std::ostream& out, const SurfaceMesh& mesh, SurfaceFormat format,
                  const std::optional<MapScale>& scale, Lengths lengths) {
  const Exported surface = prepare(mesh, scale, lengths);
  switch (format) {
    case SurfaceFormat::Ply:
      return writePly(out, surface);
    case SurfaceFormat::Obj:
      return writeObj(out, surface);
    case SurfaceFormat::Stl:
      return writeStl(out, surface);
  }
}

}  // namespace depthscope::platform
