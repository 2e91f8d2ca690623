#include "platform/ply_writer.hpp"

#include <bit>
#include <ostream>

namespace depthscope::platform {
namespace {

static_assert(std::endian::native == std::endian::little,
              "PLY files are written in the machine's own order");

template <class T>
void put(std::ostream& out, const T& value) {
  out.write(reinterpret_cast<const char*>(&value), sizeof value);
}

void put(std::ostream& out, const Eigen::Vector3f& v) {
  out.write(reinterpret_cast<const char*>(v.data()), 3 * sizeof(float));
}

}  // namespace

void writePly(std::ostream& out, const SurfaceMesh& mesh) {
  out << "ply\nformat binary_little_endian 1.0\nelement vertex " << mesh.vertices.size()
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

}  // namespace depthscope::platform
