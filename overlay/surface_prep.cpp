#include "overlay/surface_prep.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

namespace depthscope::overlay {
namespace {

constexpr std::uint32_t kNone = 0xffffffffu;
constexpr float kMaxEdge = 1.0f / 40;          // of the diagonal
constexpr std::size_t kMaxTriangles = 400000;  // cutting stops here
constexpr std::size_t kSamples = 2048;         // for the range of depths
constexpr int kBorderRounds = 24;              // rings of triangles the border's fade may reach
constexpr float kGoneConfidence = 0.05f, kFullConfidence = 0.5f;  // of a vertex

float smoothStep(float low, float high, float x) {
  const float t = std::clamp((x - low) / (high - low), 0.0f, 1.0f);
  return t * t * (3 - 2 * t);
}

std::uint8_t toByte(float x) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(x, 0.0f, 1.0f) * 255));
}

SurfaceVertex vertex(const Eigen::Vector3f& p, const Eigen::Vector3f& bary, float fade) {
  return {
      {p.x(), p.y(), p.z()}, {toByte(bary.x()), toByte(bary.y()), toByte(bary.z())}, toByte(fade)};
}

}  // namespace

void SurfacePrep::prepare(const SurfaceMesh& mesh, const OverlaySettings& settings,
                          PreparedSurface& out) {
  out.map_id = mesh.map_id;
  out.vertices.clear();
  out.indices.clear();
  out.samples.clear();
  out.inset_vertices.clear();
  out.inset_indices.clear();
  if (!collect(mesh, out)) return;
  computeFade(mesh, settings.border_fade * out.diagonal);

  copies_.assign(points_.size(), {kNone, kNone, kNone});
  const float max_edge = kMaxEdge * out.diagonal;
  for (const Triangle& t : triangles_) {
    const auto longer = [&](int a, int b) {
      return (points_[t[a]] - points_[t[b]]).squaredNorm() > max_edge * max_edge;
    };
    if (longer(0, 1) || longer(1, 2) || longer(2, 0)) {
      emitCut(t, max_edge, out);
    } else {
      emitShared(t, out);
    }
  }
  const std::size_t step =
      std::max<std::size_t>(1, (out.vertices.size() + kSamples - 1) / kSamples);
  for (std::size_t i = 0; i < out.vertices.size(); i += step) {
    const float* p = out.vertices[i].position;
    out.samples.emplace_back(p[0], p[1], p[2]);
  }
  cluster(mesh, out);
}

bool SurfacePrep::collect(const SurfaceMesh& mesh, PreparedSurface& out) {
  const std::size_t n = mesh.vertices.size();
  triangles_.clear();
  Eigen::AlignedBox3f box;
  for (const Triangle& t : mesh.triangles) {
    if (t[0] >= n || t[1] >= n || t[2] >= n || t[0] == t[1] || t[1] == t[2] || t[2] == t[0])
      continue;
    if (!mesh.vertices[t[0]].allFinite() || !mesh.vertices[t[1]].allFinite() ||
        !mesh.vertices[t[2]].allFinite())
      continue;
    triangles_.push_back(t);
    for (std::uint32_t v : t) box.extend(mesh.vertices[v]);
  }
  if (triangles_.empty()) return false;
  const Eigen::Vector3f centre = box.center();
  out.origin = centre.cast<double>();
  out.diagonal = box.diagonal().norm();
  points_.resize(n);
  for (std::size_t i = 0; i < n; ++i) points_[i] = mesh.vertices[i] - centre;
  return out.diagonal > 0;
}

/// Distance along the edges to the nearest border (an edge with a triangle on one side alone), as
/// far as `width`.
void SurfacePrep::findBorderDistance(float width) {
  const std::size_t n = points_.size();
  first_.assign(n + 1, 0);
  for (const Triangle& t : triangles_)
    for (std::uint32_t v : t) ++first_[v + 1];
  for (std::size_t i = 0; i < n; ++i) first_[i + 1] += first_[i];
  targets_.resize(3 * triangles_.size());
  for (const Triangle& t : triangles_)
    for (int i = 0; i < 3; ++i) targets_[first_[t[i]]++] = t[(i + 1) % 3];
  for (std::size_t i = n; i > 0; --i) first_[i] = first_[i - 1];
  first_[0] = 0;

  const auto hasEdge = [&](std::uint32_t a, std::uint32_t b) {
    return std::find(targets_.begin() + first_[a], targets_.begin() + first_[a + 1], b) !=
           targets_.begin() + first_[a + 1];
  };
  border_distance_.assign(n, width);
  for (const Triangle& t : triangles_)
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t a = t[i], b = t[(i + 1) % 3];
      if (!hasEdge(b, a)) border_distance_[a] = border_distance_[b] = 0;
    }
  bool changed = true;
  for (int round = 0; changed && round < kBorderRounds; ++round) {
    changed = false;
    for (const Triangle& t : triangles_)
      for (int i = 0; i < 3; ++i) {
        float &a = border_distance_[t[i]], &b = border_distance_[t[(i + 1) % 3]];
        if (std::max(a, b) <= 0 || std::min(a, b) >= width) continue;
        const float length = (points_[t[i]] - points_[t[(i + 1) % 3]]).norm();
        if (a + length < b) b = a + length, changed = true;
        if (b + length < a) a = b + length, changed = true;
      }
  }
}

void SurfacePrep::computeFade(const SurfaceMesh& mesh, float border_width) {
  fade_.assign(points_.size(), 1.0f);
  if (border_width > 0) {
    findBorderDistance(border_width);
    for (std::size_t i = 0; i < fade_.size(); ++i)
      fade_[i] = smoothStep(0, border_width, border_distance_[i]);
  }
  if (mesh.confidence.size() != mesh.vertices.size()) return;
  for (std::size_t i = 0; i < fade_.size(); ++i)
    fade_[i] *= smoothStep(kGoneConfidence, kFullConfidence, mesh.confidence[i]);
}

/// The corners of a triangle need three different wire colours (unit barycentric coordinates). A
/// vertex exists once for every colour its triangles make it take, and a triangle takes the
/// assignment that needs the fewest new ones.
void SurfacePrep::emitShared(const Triangle& t, PreparedSurface& out) {
  static constexpr int kOrders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1},
                                        {0, 2, 1}, {1, 0, 2}, {2, 1, 0}};
  int best = 0, best_missing = 4;
  for (int o = 0; o < 6; ++o) {
    int missing = 0;
    for (int i = 0; i < 3; ++i) missing += copies_[t[i]][kOrders[o][i]] == kNone;
    if (missing < best_missing) best = o, best_missing = missing;
  }
  for (int i = 0; i < 3; ++i) {
    const int color = kOrders[best][i];
    std::uint32_t& index = copies_[t[i]][color];
    if (index == kNone) {
      index = static_cast<std::uint32_t>(out.vertices.size());
      out.vertices.push_back(vertex(points_[t[i]], Eigen::Vector3f::Unit(color), fade_[t[i]]));
    }
    out.indices.push_back(index);
  }
}

/// Halves the longest edge until none is longer than `max_edge`. Whether an edge is halved depends
/// on the edge alone, so that neighbours agree and no cracks open.
void SurfacePrep::emitCut(const Triangle& t, float max_edge, PreparedSurface& out) {
  std::array<Corner, 3> whole;
  for (int i = 0; i < 3; ++i) whole[i] = {points_[t[i]], Eigen::Vector3f::Unit(i), fade_[t[i]]};
  stack_.assign(1, whole);
  while (!stack_.empty()) {
    const std::array<Corner, 3> c = stack_.back();
    stack_.pop_back();
    int longest = 0;
    float length2 = 0;
    for (int i = 0; i < 3; ++i) {
      const float l2 = (c[i].position - c[(i + 1) % 3].position).squaredNorm();
      if (l2 > length2) longest = i, length2 = l2;
    }
    if (length2 <= max_edge * max_edge || out.indices.size() / 3 + stack_.size() >= kMaxTriangles) {
      for (const Corner& corner : c) {
        out.indices.push_back(static_cast<std::uint32_t>(out.vertices.size()));
        out.vertices.push_back(vertex(corner.position, corner.bary, corner.fade));
      }
      continue;
    }
    const Corner &a = c[longest], &b = c[(longest + 1) % 3], &opposite = c[(longest + 2) % 3];
    const Corner middle{0.5f * (a.position + b.position), 0.5f * (a.bary + b.bary),
                        0.5f * (a.fade + b.fade)};
    stack_.push_back({a, middle, opposite});
    stack_.push_back({middle, b, opposite});
  }
}

}  // namespace depthscope::overlay
