#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "overlay/overlay_settings.hpp"
#include "overlay/vertex_clusters.hpp"
#include "types/surface_mesh.hpp"

namespace depthscope::overlay {

/// One corner as the graphics card gets it.
struct SurfaceVertex {
  float position[3];  // relative to PreparedSurface::origin
  std::uint8_t
      bary[3];        // barycentric place in the triangle it was cut from, 255 = 1: draws the wires
  std::uint8_t fade;  // 255 fully visible: from confidence and from the distance to the border
};
struct InsetVertex {
  float position[3];
  std::int8_t normal[3];
  std::uint8_t fade;
};

/// A surface made ready to be drawn. Buffers keep their memory from one surface to the next.
struct PreparedSurface {
  std::uint32_t map_id = 0;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  // world frame: centre of the bounding box
  float diagonal = 0;                                // of the bounding box
  std::vector<Eigen::Vector3f> samples;              // some vertices, relative to origin
  std::vector<SurfaceVertex> vertices;
  std::vector<std::uint32_t> indices;
  std::vector<InsetVertex> inset_vertices;  // the same surface, a few thousand triangles
  std::vector<std::uint32_t> inset_indices;

  bool empty() const { return indices.empty(); }
};

/// Turns a mesh into what the shaders want: visibility that falls towards the border and with
/// confidence, wires that need no geometry shader, large triangles cut small so that a lens can
/// bend them, and a coarse copy for the corner picture. A mesh of more triangles than the settings
/// have drawn is made coarser first. Deterministic; linear in the triangles. What is broken in the
/// mesh (indices out of range, non-finite vertices, missing arrays) is left out.
class SurfacePrep {
 public:
  /// No edge stays longer than 1/40 of the bounding box's diagonal.
  void prepare(const SurfaceMesh& mesh, const OverlaySettings& settings, PreparedSurface& out);

 private:
  using Triangle = std::array<std::uint32_t, 3>;
  struct Corner {
    Eigen::Vector3f position;
    Eigen::Vector3f bary;
    float fade;
  };

  bool collect(const SurfaceMesh& mesh, PreparedSurface& out);
  void findBorderDistance(float width);
  void computeFade(const SurfaceMesh& mesh, float border_width);
  void makeCoarser(std::size_t max_triangles, float diagonal);
  void emitShared(const Triangle& t, PreparedSurface& out);
  void emitCut(const Triangle& t, float max_edge, PreparedSurface& out);
  void emitInset(PreparedSurface& out);

  FadingMesh mesh_;                             // the sound triangles
  FadingMesh coarse_;                           // workspace
  std::vector<std::uint32_t> first_, targets_;  // half-edges by their first vertex
  std::vector<float> border_distance_;
  std::vector<std::array<std::uint32_t, 3>> copies_;  // of each vertex, by wire colour
  std::vector<std::array<Corner, 3>> stack_;
  VertexClusters clusters_;
};

}  // namespace depthscope::overlay
