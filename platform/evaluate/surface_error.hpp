#pragma once
#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "types/surface_mesh.hpp"

namespace depthscope::platform {

/// Points spread evenly over a mesh, each with the unit normal of its triangle.
struct SurfaceSamples {
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;
};

/// Total area of the triangles.
double surfaceArea(const SurfaceMesh& mesh);

/// `count` points on the mesh, by area; the same ones every time.
SurfaceSamples sampleSurface(const SurfaceMesh& mesh, std::size_t count);

/// Nearest-neighbour search among points.
class PointIndex {
 public:
  explicit PointIndex(std::span<const Eigen::Vector3f> points);
  ~PointIndex();
  struct Nearest {
    std::size_t index = 0;
    float distance = 0;
  };
  Nearest nearest(const Eigen::Vector3f& query) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

/// The true surface of a scene [mm], to which distances are measured.
class TrueSurface {
 public:
  explicit TrueSurface(const SurfaceMesh& scene);
  /// Signed distance [mm] of a point to the surface, positive on the side of its normals; the gap
  /// between samples is taken out.
  float distance(const Eigen::Vector3f& point) const;

 private:
  SurfaceSamples samples_;
  PointIndex index_;
};

/// Summary of distances.
struct DistanceStatistics {
  double rms = 0, median = 0, p95 = 0;  // of the absolute values
  double over_5mm_percent = 0;
};
DistanceStatistics summarize(std::span<const float> distances);

}  // namespace depthscope::platform
