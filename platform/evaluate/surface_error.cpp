#include "platform/evaluate/surface_error.hpp"

#include <pcl/kdtree/kdtree_flann.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>

namespace depthscope::platform {
namespace {

constexpr double kTruthSamplesPerMm2 = 40;
constexpr double kMaxTruthSamples = 2500000;  // still about 0.3 mm apart on a scene of a few organs
constexpr float kSampleGap_mm =
    0.7f;  // lateral distance to a sample that is no distance to the surface
constexpr double kLargeError_mm = 5;

Eigen::Vector3f areaNormal(const SurfaceMesh& mesh, const std::array<std::uint32_t, 3>& t) {
  const Eigen::Vector3f& a = mesh.vertices[t[0]];
  return (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a);
}

/// As numpy: linear between the two nearest ranks. `sorted` is not empty.
double percentile(const std::vector<float>& sorted, double percent) {
  const double rank = percent / 100 * static_cast<double>(sorted.size() - 1);
  const auto low = static_cast<std::size_t>(rank);
  const std::size_t high = std::min(low + 1, sorted.size() - 1);
  return sorted[low] + (rank - static_cast<double>(low)) * (sorted[high] - sorted[low]);
}

}  // namespace

double surfaceArea(const SurfaceMesh& mesh) {
  double area = 0;
  for (const auto& t : mesh.triangles) area += 0.5 * areaNormal(mesh, t).norm();
  return area;
}

SurfaceSamples sampleSurface(const SurfaceMesh& mesh, std::size_t count) {
  SurfaceSamples out;
  const double area = surfaceArea(mesh);
  if (!(area > 0) || count == 0) return out;
  std::mt19937_64 random(1);
  const auto uniform = [&] { return static_cast<float>(random() >> 40) * 0x1p-24f; };
  out.points.reserve(count);
  out.normals.reserve(count);
  // Systematic sampling: one sample for every area / count of surface, at a random place of its
  // triangle.
  const double step = area / static_cast<double>(count);
  double next = 0.5 * step, passed = 0;
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3f n = areaNormal(mesh, t);
    passed += 0.5 * n.norm();
    const Eigen::Vector3f &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]],
                          &c = mesh.vertices[t[2]];
    for (; next < passed; next += step) {
      const float r = std::sqrt(uniform()), s = uniform();
      out.points.push_back((1 - r) * a + r * (1 - s) * b + r * s * c);
      out.normals.push_back(n.normalized());
    }
  }
  return out;
}

struct PointIndex::Tree {
  pcl::KdTreeFLANN<pcl::PointXYZ> search;
};

PointIndex::PointIndex(std::span<const Eigen::Vector3f> points) : tree_(std::make_unique<Tree>()) {
  auto cloud = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  cloud->reserve(points.size());
  for (const auto& p : points) cloud->emplace_back(p.x(), p.y(), p.z());
  tree_->search.setInputCloud(cloud);
}

PointIndex::~PointIndex() = default;

PointIndex::Nearest PointIndex::nearest(const Eigen::Vector3f& query) const {
  pcl::Indices index(1);
  std::vector<float> squared(1);
  tree_->search.nearestKSearch(pcl::PointXYZ(query.x(), query.y(), query.z()), 1, index, squared);
  return {static_cast<std::size_t>(index[0]), std::sqrt(squared[0])};
}

TrueSurface::TrueSurface(const SurfaceMesh& scene)
    : samples_(sampleSurface(
          scene, static_cast<std::size_t>(std::min(
                     kMaxTruthSamples, std::ceil(kTruthSamplesPerMm2 * surfaceArea(scene)))))),
      index_(samples_.points) {}

float TrueSurface::distance(const Eigen::Vector3f& point) const {
  const PointIndex::Nearest n = index_.nearest(point);
  const Eigen::Vector3f v = point - samples_.points[n.index];
  const float height = v.dot(samples_.normals[n.index]);
  const float lateral = std::sqrt(std::max(0.f, n.distance * n.distance - height * height));
  const float beyond = std::max(0.f, lateral - kSampleGap_mm);
  return std::copysign(std::min(n.distance, std::hypot(height, beyond)), height);
}

DistanceStatistics summarize(std::span<const float> distances) {
  DistanceStatistics out;
  if (distances.empty()) return out;
  std::vector<float> sorted(distances.begin(), distances.end());
  for (float& d : sorted) d = std::abs(d);
  std::sort(sorted.begin(), sorted.end());
  double square = 0;
  std::size_t large = 0;
  for (float d : sorted) {
    square += static_cast<double>(d) * d;
    large += d > kLargeError_mm;
  }
  const auto n = static_cast<double>(sorted.size());
  out.rms = std::sqrt(square / n);
  out.median = percentile(sorted, 50);
  out.p95 = percentile(sorted, 95);
  out.over_5mm_percent = 100 * static_cast<double>(large) / n;
  return out;
}

}  // namespace depthscope::platform
