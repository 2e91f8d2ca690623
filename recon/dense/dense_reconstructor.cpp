#include "recon/dense/dense_reconstructor.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "recon/dense/surface_nets.hpp"
#include "recon/dense/view_selection.hpp"
#include "recon/mesh_geometry.hpp"
#include "recon/threads.hpp"

namespace depthscope::recon {
namespace {

constexpr std::size_t kMinAnchors = 8;  // map points that tell a depth map's unit of length
constexpr int kMinSeedObservations = 3;
// Before a place can be confirmed several depth maps must see it: the first of a map may be of
// views that lie closer, and less sure of their depths. Of a second of nasal endoscopy, in which
// the scope moved by a fifth of the depth, there was no dense surface otherwise; with it there is
// one, 2.4 % of the depth off in the median. Longer clips' surfaces are as they were.
constexpr int kFewDepthMaps = 8;
constexpr double kCloser = 3, kLessSure = 1.5;
constexpr float kCoarser = 1.25f;  // voxels grow by it where the surface would be too large

/// Pixel of a point of the camera's frame, to be rounded down.
Eigen::Vector2f pixelOf(const Eigen::Vector3d& p, const PinholeLevel& level) {
  return {static_cast<float>(level.f * p.x() / p.z() + level.cx + 0.5),
          static_cast<float>(level.f * p.y() / p.z() + level.cy + 0.5)};
}

bool contains(const PinholeLevel& level, const Eigen::Vector2f& pixel) {
  return pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() < static_cast<float>(level.width) &&
         pixel.y() < static_cast<float>(level.height);
}

}  // namespace

DenseReconstructor::DenseReconstructor(const CameraModel& camera, const DenseSettings& settings,
                                       int threads)
    : settings_(settings),
      threads_(threads),
      view_(camera, reductionFactor(camera.width, settings.picture_width), settings.picture_width),
      store_(settings.pictures, settings.depth_maps),
      volume_(settings.max_blocks),
      scratch_(static_cast<std::size_t>(threads)) {
  for (int i = 0; i < std::min(threads, kAtOnce); ++i) estimators_.emplace_back(view_, settings_);
}

void DenseReconstructor::addPicture(const ViewPicture& picture) {
  StoredView& slot = store_.claim(picture.frame);
  rectify(picture.luma, view_, settings_, DepthEstimator::kRadius, slot.picture);
  slot.frame = picture.frame;
}

ReconStatus DenseReconstructor::reconstruct(const CloudIndex& index, int max_triangles,
                                            SurfaceMesh& mesh, const std::stop_token& stop) {
  store_.update(index);
  stored_ = store_.inOrderOf(index.cloud());
  const float depth = index.medianDepth();
  if (!(depth > 0)) return ReconStatus::TooFewPoints;
  if (makeDepthMaps(index, stop) == ReconStatus::Cancelled) return ReconStatus::Cancelled;

  std::vector<FusedView> views = placeDepthMaps(index);
  if (views.empty()) return ReconStatus::TooFewPoints;
  onThreads(threads_, [&](int thread) {
    for (std::size_t i = static_cast<std::size_t>(thread);
         i < views.size() && !stop.stop_requested(); i += static_cast<std::size_t>(threads_))
      countAgreement(views, i, view_.level(kDepthLevel), settings_);
  });
  if (stop.stop_requested()) return ReconStatus::Cancelled;
  float voxel_size = depth * static_cast<float>(settings_.voxel_size);
  for (;; voxel_size *= kCoarser) {
    const ReconStatus status = fuse(views, voxel_size, stop);
    if (status == ReconStatus::Cancelled) return status;
    if (status != ReconStatus::Ok) continue;  // the volume is full
    extractSurface(volume_, settings_, mesh);
    if (mesh.triangles.size() <= static_cast<std::size_t>(max_triangles)) break;
  }
  dropSmallIslands(mesh, static_cast<float>(settings_.min_island_area) * volume_.voxelSize() *
                             volume_.voxelSize());
  computeNormals(mesh);
  return mesh.empty() ? ReconStatus::TooFewPoints : ReconStatus::Ok;
}

/// Works out depth maps of the views that are farthest from all that have one.
ReconStatus DenseReconstructor::makeDepthMaps(const CloudIndex& index,
                                              const std::stop_token& stop) {
  const auto& poses = index.cloud().views_T_camera_world;
  const double depth = index.medianDepth();
  std::vector<double> apart(stored_.size(), std::numeric_limits<double>::max());
  const auto has = [&](std::vector<double>& from, std::size_t k) {
    for (std::size_t other = 0; other < from.size(); ++other)
      from[other] = std::min(from[other], motionBetween(poses[k], poses[other], depth));
  };
  for (std::size_t k = 0; k < stored_.size(); ++k)
    if (stored_[k] == nullptr)
      apart[k] = 0;
    else if (stored_[k]->depth != nullptr)
      has(apart, k);
  auto maps = std::count_if(stored_.begin(), stored_.end(), [](const StoredView* v) {
    return v != nullptr && v->depth != nullptr;
  });
  for (int made = 0; made < settings_.new_depth_maps;) {
    const bool few = maps < kFewDepthMaps;
    const double min_motion = settings_.min_motion / (few ? kCloser : 1);
    const auto max_error = static_cast<float>(settings_.max_error * (few ? kLessSure : 1) * depth);
    const double worth = std::max(min_motion, store_.worthFrom(stored_, poses, depth));
    std::vector<std::size_t> chosen;
    for (std::vector<double> left = apart;
         static_cast<int>(chosen.size()) < std::min(kAtOnce, settings_.new_depth_maps - made);) {
      const auto farthest = std::max_element(left.begin(), left.end());
      if (farthest == left.end() || *farthest <= worth) break;
      chosen.push_back(static_cast<std::size_t>(farthest - left.begin()));
      has(left, chosen.back());
    }
    if (chosen.empty()) break;
    const std::array<bool, kAtOnce> found = estimateDepths(index, chosen, max_error, stop);
    if (stop.stop_requested()) return ReconStatus::Cancelled;
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      apart[chosen[i]] = 0;
      if (!found[i]) continue;
      std::swap(store_.makeDepth(*stored_[chosen[i]], stored_, poses, depth), estimates_[i]);
      has(apart, chosen[i]);
      ++made;
      ++maps;
    }
  }
  return ReconStatus::Ok;
}

/// Fills `estimates_`, in the order of `views`; which of them could be.
std::array<bool, DenseReconstructor::kAtOnce> DenseReconstructor::estimateDepths(
    const CloudIndex& index, const std::vector<std::size_t>& views, float max_error,
    const std::stop_token& stop) {
  std::array<bool, kAtOnce> found{};
  const std::size_t threads = std::min(estimators_.size(), views.size());
  onThreads(static_cast<int>(threads), [&](int thread) {
    for (auto i = static_cast<std::size_t>(thread); i < views.size(); i += threads)
      found[i] = estimateDepth(index, views[i], estimators_[static_cast<std::size_t>(thread)],
                               max_error, estimates_[i], stop);
  });
  return found;
}

bool DenseReconstructor::estimateDepth(const CloudIndex& index, std::size_t view,
                                       DepthEstimator& estimator, float max_error, DepthMap& out,
                                       const std::stop_token& stop) const {
  const SparseCloud& cloud = index.cloud();
  const Pose& T_reference_world = cloud.views_T_camera_world[view];
  std::vector<DepthSource> sources;
  for (std::size_t s : selectViews(index, view, settings_.views, settings_.best_angle_deg,
                                   [&](std::size_t k) { return stored_[k] != nullptr; }))
    sources.push_back(
        {&stored_[s]->picture, cloud.views_T_camera_world[s] * T_reference_world.inverse()});
  std::vector<DepthSeed> seeds;
  for (std::uint32_t p : index.pointsOf(view)) {
    const Eigen::Vector3d point = T_reference_world * cloud.points[p].position.cast<double>();
    if (point.z() > 0 && cloud.points[p].observations >= kMinSeedObservations)
      seeds.push_back({pixelOf(point, view_.level(0)), static_cast<float>(1 / point.z())});
  }
  return estimator.estimate(stored_[view]->picture, sources, seeds, max_error, out, stop);
}

/// Each depth map at its view's pose, its unit of length taken from the map points it sees.
std::vector<FusedView> DenseReconstructor::placeDepthMaps(const CloudIndex& index) const {
  std::vector<float> scale(stored_.size(), 0.f);
  onRanges(threads_, scale.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      if (stored_[k] != nullptr && stored_[k]->depth != nullptr) scale[k] = inverseScale(index, k);
  });
  std::vector<FusedView> views;
  std::vector<std::size_t> view_of, place(index.views(), index.views());
  for (std::size_t k = 0; k < scale.size(); ++k) {
    if (!(scale[k] > 0)) continue;
    place[k] = views.size();
    view_of.push_back(k);
    views.push_back({stored_[k]->depth, index.cloud().views_T_camera_world[k], scale[k], {}, {}});
  }
  onRanges(threads_, views.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for (std::size_t k :
           selectViews(index, view_of[i], settings_.agreement_views, settings_.best_angle_deg,
                       [&](std::size_t c) { return place[c] < views.size(); }))
        views[i].neighbours.push_back(place[k]);
  });
  return views;
}

/// What makes a depth map's inverse depths those of the map points; 0: too few to tell.
float DenseReconstructor::inverseScale(const CloudIndex& index, std::size_t view) const {
  const SparseCloud& cloud = index.cloud();
  const PinholeLevel& level = view_.level(kDepthLevel);
  const Grid<float>& inverse_depth = stored_[view]->depth->inverse_depth;
  std::vector<float> scale;
  for (std::uint32_t p : index.pointsOf(view)) {
    const Eigen::Vector3d point =
        cloud.views_T_camera_world[view] * cloud.points[p].position.cast<double>();
    const Eigen::Vector2f pixel = pixelOf(point, level);
    if (!(point.z() > 0) || !contains(level, pixel)) continue;
    const float q = inverse_depth.at(static_cast<int>(pixel.x()), static_cast<int>(pixel.y()));
    if (q > 0) scale.push_back(static_cast<float>(1 / (q * point.z())));
  }
  if (scale.size() < kMinAnchors) return 0;
  const auto middle = scale.begin() + static_cast<std::ptrdiff_t>(scale.size() / 2);
  std::nth_element(scale.begin(), middle, scale.end());
  return *middle;
}

/// Failed when the volume is full.
ReconStatus DenseReconstructor::fuse(const std::vector<FusedView>& views, float voxel_size,
                                     const std::stop_token& stop) {
  const PinholeLevel& level = view_.level(kDepthLevel);
  volume_.begin(voxel_size, static_cast<float>(settings_.truncation));
  for (const FusedView& view : views)
    if (!volume_.allocate(view, level)) return ReconStatus::Failed;
  onThreads(threads_, [&](int thread) {
    for (const FusedView& view : views) {
      if (stop.stop_requested()) return;
      volume_.integrate(view, level, scratch_[static_cast<std::size_t>(thread)], thread, threads_);
    }
  });
  if (stop.stop_requested()) return ReconStatus::Cancelled;
  volume_.finish();
  return ReconStatus::Ok;
}

}  // namespace depthscope::recon
