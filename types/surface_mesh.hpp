#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace depthscope {

/// A triangle mesh of the tissue surface in the world frame of map `map_id`. Arrays are parallel;
/// normals are unit and point towards the cameras; triangles are counter-clockwise seen from there.
struct SurfaceMesh {
  std::uint32_t map_id = 0;
  std::uint32_t version = 0;                             // grows with every reconstruction
  std::vector<Eigen::Vector3f> vertices;
  std::vector<Eigen::Vector3f> normals;                  // size of vertices
  std::vector<float> confidence;                         // size of vertices, 0..1
  std::vector<std::array<std::uint32_t, 3>> triangles;   // indices into vertices

  bool empty() const { return triangles.empty(); }
  void clear() {
    vertices.clear();
    normals.clear();
    confidence.clear();
    triangles.clear();
  }
};

}  // namespace depthscope
