#include "recon/surface_painter.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace depthscope::recon {
namespace {

constexpr int kMaxWidth_px = 400;  // of the view that visibility is worked out in
constexpr std::size_t kMaxViews = 24;
constexpr float kMinGain = 2;    // map points' worth of a better view that a view must bring
constexpr int kCoarse_px = 4;    // side of the cells in which the nearest vertex hides others
constexpr float kHidden = 1.1f;  // times its depth: farther is behind it, not beside it on a slope
constexpr float kMinCos = 0.1f;  // of the angle to the normal: flatter tells no colour
constexpr int kHighlight = 215, kDark = 12;  // [0..255] the brightest channel at, below
constexpr float kDoubtful = 1e-4f;           // weight of such pixels beside others

}  // namespace

SurfacePainter::SurfacePainter(const CameraModel& camera, int pictures)
    : size_(camera.width, camera.height), gallery_(pictures, size_) {
  if (size_.pixels() == 0) return;
  view_.emplace(camera, size_.factor, kMaxWidth_px);
  const PinholeLevel& level = view_->level(0);
  pixel_.reset(level.width, level.height, -1);
  nearest_.reset(level.width / kCoarse_px + 1, level.height / kCoarse_px + 1);
  for (int y = 0; y < level.height; ++y)
    for (int x = 0; x < level.width; ++x) {
      const Eigen::Vector2f& source = view_->source(x, y);
      if (source.x() < 0) continue;
      pixel_.at(x, y) =
          static_cast<int>(source.y() + 0.5f) * size_.width + static_cast<int>(source.x() + 0.5f);
    }
}

void SurfacePainter::addPicture(const ViewPicture& picture) {
  if (picture.color.size() == size_.pixels()) gallery_.add(picture.frame, picture.color);
}

void SurfacePainter::paint(const CloudIndex& index, SurfaceMesh& mesh) {
  const SparseCloud& cloud = index.cloud();
  mesh.colors.clear();
  if (!view_) return;
  gallery_.update(cloud.view_frames);
  const std::vector<std::size_t> views = chooseViews(index);
  if (views.empty()) return;
  sums_.assign(mesh.vertices.size(), {});
  for (std::size_t k : views) {
    findVisible(cloud.views_T_camera_world[k], mesh);
    addView(cloud.views_T_camera_world[k], *gallery_.find(cloud.view_frames[k]), mesh);
  }
  fillGaps(mesh);
  const auto channel = [](float sum, float weight) {
    return static_cast<std::uint8_t>(weight > 0 ? std::lround(sum / weight) : 0);
  };
  mesh.colors.reserve(sums_.size());
  for (const Sum& s : sums_)
    mesh.colors.push_back(
        {channel(s.red, s.weight), channel(s.green, s.weight), channel(s.blue, s.weight)});
}

/// Again and again the view that most map points are seen better from than from those chosen so
/// far: by the light that reaches them there, in shares of the best that any gets.
std::vector<std::size_t> SurfacePainter::chooseViews(const CloudIndex& index) const {
  std::vector<std::size_t> candidates, chosen;
  for (std::size_t k = 0; k < index.views(); ++k)
    if (gallery_.find(index.cloud().view_frames[k]) != nullptr) candidates.push_back(k);
  const auto light = [&](std::uint32_t p, std::size_t k) {
    return 1 / (index.centre(k) - index.cloud().points[p].position).squaredNorm();
  };
  std::vector<float> best(index.cloud().points.size(), 0), reached(best);
  for (std::size_t k : candidates)
    for (std::uint32_t p : index.pointsOf(k)) best[p] = std::max(best[p], light(p, k));
  const auto gain = [&](std::size_t k) {
    float sum = 0;
    for (std::uint32_t p : index.pointsOf(k))
      sum += std::max(0.f, light(p, k) - reached[p]) / best[p];
    return sum;
  };
  while (chosen.size() < kMaxViews && !candidates.empty()) {
    std::size_t next = 0;
    float most = 0;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      const float g = gain(candidates[i]);
      if (g <= most) continue;
      most = g;
      next = i;
    }
    if (most < kMinGain) break;
    const std::size_t k = candidates[next];
    for (std::uint32_t p : index.pointsOf(k)) reached[p] = std::max(reached[p], light(p, k));
    chosen.push_back(k);
    candidates.erase(candidates.begin() + static_cast<std::ptrdiff_t>(next));
  }
  return chosen;
}

/// Fills `seen_` and `nearest_`.
void SurfacePainter::findVisible(const Pose& T_camera_world, const SurfaceMesh& mesh) {
  const PinholeLevel& level = view_->level(0);
  const Eigen::Matrix3f R = T_camera_world.R.cast<float>();
  const Eigen::Vector3f t = T_camera_world.t.cast<float>();
  std::fill(nearest_.cells.begin(), nearest_.cells.end(), std::numeric_limits<float>::max());
  seen_.resize(mesh.vertices.size());
  for (std::size_t v = 0; v < seen_.size(); ++v) {
    seen_[v].cell = -1;
    const Eigen::Vector3f p = R * mesh.vertices[v] + t;
    if (!(p.z() > 0)) continue;
    const float x = level.f * p.x() / p.z() + level.cx + 0.5f;
    const float y = level.f * p.y() / p.z() + level.cy + 0.5f;
    if (!(x >= 0 && y >= 0 && x < static_cast<float>(level.width) &&
          y < static_cast<float>(level.height)))
      continue;
    const int column = static_cast<int>(x), row = static_cast<int>(y);
    seen_[v] = {row * level.width + column, p.z()};
    float& nearest = nearest_.at(column / kCoarse_px, row / kCoarse_px);
    nearest = std::min(nearest, p.z());
  }
}

void SurfacePainter::addView(const Pose& T_camera_world, const Grid<Rgb>& color,
                             const SurfaceMesh& mesh) {
  const Eigen::Vector3f centre = T_camera_world.inverse().t.cast<float>();
  const int width = pixel_.width;
  for (std::size_t v = 0; v < seen_.size(); ++v) {
    const auto [cell, depth] = seen_[v];
    if (cell < 0) continue;
    const std::int32_t pixel = pixel_.cells[static_cast<std::size_t>(cell)];
    if (pixel < 0) continue;
    if (depth > kHidden * nearest_.at(cell % width / kCoarse_px, cell / width / kCoarse_px))
      continue;
    const Eigen::Vector3f ray = centre - mesh.vertices[v];
    const float distance2 = ray.squaredNorm();
    const float cosine = mesh.normals[v].dot(ray) / std::sqrt(distance2);
    if (!(cosine > kMinCos)) continue;
    const auto& [red, green, blue] = color.cells[static_cast<std::size_t>(pixel)];
    const int brightest = std::max({red, green, blue});
    const float light = cosine / distance2;
    const bool doubtful = brightest >= kHighlight || brightest < kDark;
    const float weight = light * light * (doubtful ? kDoubtful : 1);
    Sum& sum = sums_[v];
    sum.red += weight * static_cast<float>(red);
    sum.green += weight * static_cast<float>(green);
    sum.blue += weight * static_cast<float>(blue);
    sum.weight += weight;
  }
}

/// Vertices without a colour take that of their neighbours, from the rims of gaps inwards.
void SurfacePainter::fillGaps(const SurfaceMesh& mesh) {
  const auto missing = [&](std::uint32_t v) { return !(sums_[v].weight > 0); };
  std::vector<std::pair<std::uint32_t, Sum>> found;
  do {
    found.clear();
    for (const auto& t : mesh.triangles)
      for (std::uint32_t v : t) {
        if (!missing(v)) continue;
        for (std::uint32_t n : t)
          if (!missing(n)) found.push_back({v, sums_[n]});
      }
    for (const auto& [v, s] : found) {
      Sum& sum = sums_[v];
      sum.red += s.red / s.weight;
      sum.green += s.green / s.weight;
      sum.blue += s.blue / s.weight;
      sum.weight += 1;
    }
  } while (!found.empty());
}

}  // namespace depthscope::recon
