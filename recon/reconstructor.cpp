#include "recon/reconstructor.hpp"

#include <pcl/console/print.h>

#include <algorithm>
#include <exception>
#include <new>
#include <string>
#include <utility>

#include "recon/cloud_index.hpp"
#include "recon/dense/dense_reconstructor.hpp"
#include "recon/mls_smoothing.hpp"
#include "recon/point_filters.hpp"
#include "recon/poisson_surface.hpp"
#include "recon/sightings.hpp"
#include "recon/surface_painter.hpp"
#include "recon/surface_trimming.hpp"
#include "types/error.hpp"

namespace depthscope::recon {
namespace {

constexpr int kMinDepth = 3;  // of the octree: fewer cells leave no room around the points

void requireRange(const char* key, double value, double low, double high) {
  if (value >= low && value <= high) return;
  throw InputError(std::string("recon.") + key + ": " + std::to_string(value) +
                   " is outside the allowed range " + std::to_string(low) + " to " +
                   std::to_string(high));
}

void check(const ReconSettings& s) {
  requireRange("threads", s.threads, 1, 16);
  requireRange("min_points", s.min_points, 10, 1e6);
  requireRange("max_points", s.max_points, s.min_points, 1e6);
  requireRange("max_triangles", s.max_triangles, 100, 1e7);
  requireRange("max_view_tilt_deg", s.max_view_tilt_deg, 1, 90);
  requireRange("max_distance", s.max_distance, 2, 1e6);
  requireRange("spacing_neighbours", s.spacing_neighbours, 1, 100);
  requireRange("free_space_rays", s.free_space_rays, 0, 1000);
  requireRange("free_space_margin", s.free_space_margin, 0, 1000);
  requireRange("free_space_radius", s.free_space_radius, 0, 100);
  requireRange("free_space_max_rays", s.free_space_max_rays, 1, 1e6);
  requireRange("outlier_radius", s.outlier_radius, 0.1, 100);
  requireRange("outlier_min_neighbours", s.outlier_min_neighbours, 0, 1000);
  requireRange("voxel_size", s.voxel_size, 0.05, 10);
  requireRange("mls_radius", s.mls_radius, 0.5, 50);
  requireRange("mls_max_residual", s.mls_max_residual, 0.5, 100);
  requireRange("poisson_cell", s.poisson_cell, 0.05, 10);
  requireRange("poisson_min_depth", s.poisson_min_depth, kMinDepth, 10);
  requireRange("poisson_max_depth", s.poisson_max_depth, s.poisson_min_depth, 10);
  requireRange("poisson_point_weight", s.poisson_point_weight, 0, 100);
  requireRange("poisson_samples_per_node", s.poisson_samples_per_node, 0.5, 50);
  requireRange("trim_distance", s.trim_distance, 0.1, 20);
  requireRange("trim_max_spacing", s.trim_max_spacing, 1, 20);
  requireRange("min_island_area", s.min_island_area, 0, 1e6);
  requireRange("color_pictures", s.color_pictures, 1, 1000);
  requireRange("full_confidence_support", s.full_confidence_support, 0.1, 1e6);
}

}  // namespace

const char* toString(ReconStatus status) {
  switch (status) {
    case ReconStatus::Ok:
      return "ok";
    case ReconStatus::TooFewPoints:
      return "too few points";
    case ReconStatus::Cancelled:
      return "cancelled";
    case ReconStatus::OutOfMemory:
      return "out of memory";
    case ReconStatus::Failed:
      return "failed";
  }
  return "unknown";
}

Reconstructor::Reconstructor(const CameraModel& camera, const ReconSettings& settings)
    : settings_(settings) {
  const MemoryScope metered(memory_);
  check(settings_);
  const int width = settings_.dense.picture_width;
  if (camera.width > 0 && camera.height > 0)
    seen_ = finestLevel(camera, reductionFactor(camera.width, width), width);
  painter_ = std::make_unique<SurfacePainter>(camera, settings_.color_pictures);
  if (settings_.method == ReconSettings::Method::Dense) {
    reduction_ = reductionFactor(camera.width, settings_.dense.picture_width);
    dense_ = std::make_unique<DenseReconstructor>(camera, settings_.dense, settings_.threads);
  }
  // PCL's complaints about single clouds go to the terminal; ours go through the status.
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
}

Reconstructor::~Reconstructor() = default;

void Reconstructor::addPicture(const ViewPicture& picture) noexcept {
  const MemoryScope metered(memory_);
  try {
    painter_->addPicture(picture);
    if (dense_) dense_->addPicture(picture);
  } catch (const std::exception&) {
    // Out of memory: surfaces go on without this view.
  }
}

ReconStatus Reconstructor::reconstruct(const SparseCloud& cloud, SurfaceMesh& out,
                                       std::stop_token stop) noexcept {
  const MemoryScope metered(memory_);
  try {
    const CloudIndex index(cloud, sightingsOfAllViews(cloud, seen_));
    SurfaceMesh mesh;
    ReconStatus status = ReconStatus::TooFewPoints;
    if (dense_) status = dense_->reconstruct(index, settings_.max_triangles, mesh, stop);
    // At the start, map points bear a surface before depth maps confirm one another.
    if (status == ReconStatus::TooFewPoints) status = sparse(cloud, mesh, stop);
    if (status != ReconStatus::Ok) return status;
    mesh.map_id = cloud.map_id;
    painter_->paint(index, mesh);
    compareWithLast(mesh, index.medianDepth());
    mesh.version = ++version_;
    out = std::move(mesh);
    return ReconStatus::Ok;
  } catch (const std::bad_alloc&) {
    return ReconStatus::OutOfMemory;
  } catch (const std::exception&) {
    return ReconStatus::Failed;
  }
}

void Reconstructor::compareWithLast(const SurfaceMesh& mesh, float depth) {
  constexpr float kReach = 3 * kJump;  // farther apart they are different places
  change_ = {};
  if (last_.map_id == mesh.map_id && depth > 0) {
    change_ = compareSurfaces(last_, mesh, kJump * depth, kReach * depth);
    change_.largest /= depth;
  }
  last_.map_id = mesh.map_id;
  last_.vertices = mesh.vertices;
}

ReconStatus Reconstructor::sparse(const SparseCloud& cloud, SurfaceMesh& mesh,
                                  const std::stop_token& stop) const {
  const auto min_points = static_cast<std::size_t>(settings_.min_points);

  const SupportCloud::ConstPtr usable = usablePoints(cloud, settings_);
  if (usable->size() < min_points) return ReconStatus::TooFewPoints;
  const float spacing =
      median(neighbourDistances(usable, settings_.spacing_neighbours, settings_.threads));
  if (!(spacing > 0)) return ReconStatus::TooFewPoints;
  if (stop.stop_requested()) return ReconStatus::Cancelled;

  // Outlier filters (section 3.1).
  const SupportCloud::ConstPtr opaque = freeSpaceFilter(usable, spacing, settings_);
  const SupportCloud::ConstPtr dense = radiusFilter(opaque, spacing, settings_);
  const SupportCloud::ConstPtr even = voxelGrid(dense, spacing, settings_);
  if (even->size() < min_points) return ReconStatus::TooFewPoints;
  if (stop.stop_requested()) return ReconStatus::Cancelled;

  // Moving Least Squares (section 3.2).
  const SupportCloud::ConstPtr smooth = mlsSmooth(even, spacing, settings_);
  if (smooth->size() < min_points) return ReconStatus::TooFewPoints;

  // Poisson (section 3.3), trimmed; coarser where the result would be too large.
  const auto max_triangles = static_cast<std::size_t>(settings_.max_triangles);
  for (int depth = poissonDepth(*smooth, spacing, settings_); depth >= kMinDepth; --depth) {
    if (stop.stop_requested()) return ReconStatus::Cancelled;
    mesh = poissonSurface(smooth, depth, settings_);
    if (stop.stop_requested()) return ReconStatus::Cancelled;
    trimToSupport(mesh, smooth, spacing, settings_);
    if (mesh.triangles.size() <= max_triangles)
      return mesh.empty() ? ReconStatus::Failed : ReconStatus::Ok;
  }
  return ReconStatus::Failed;
}

}  // namespace depthscope::recon
