#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "types/color.hpp"

namespace depthscope {

/// A triangle mesh of the tissue surface in the world frame of map `map_id`. Arrays are parallel;
/// normals are unit and point towards the cameras; triangles are counter-clockwise seen from there.
struct SurfaceMesh {
  std::uint32_t map_id = 0;
  std::uint32_t version = 0;  // grows with every reconstruction
  std::vector<Eigen::Vector3f> vertices;
  std::vector<Eigen::Vector3f> normals;  // size of vertices
  std::vector<float> confidence;         // size of vertices, 0..1
  // Depth maps that saw the place or, of a surface from map points, keyframes that saw the nearest
  // of them. Size of vertices; empty: not known.
  std::vector<std::uint16_t> observations;
  std::vector<Rgb> colors;  // as keyframes saw the place, under the scope's light; or empty
  std::vector<std::array<std::uint32_t, 3>> triangles;  // indices into vertices

  bool empty() const { return triangles.empty(); }
  void clear() {
    vertices.clear();
    normals.clear();
    confidence.clear();
    observations.clear();
    colors.clear();
    triangles.clear();
  }
};

}  // namespace depthscope
