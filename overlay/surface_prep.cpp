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
constexpr float kInsetCells = 44;              // of the coarse copy, along the diagonal
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
  makeCoarser(static_cast<std::size_t>(std::max(settings.max_triangles, 1)), out.diagonal);

  copies_.assign(mesh_.points.size(), {kNone, kNone, kNone});
  const float max_edge = kMaxEdge * out.diagonal;
  for (const Triangle& t : mesh_.triangles) {
    const auto longer = [&](int a, int b) {
      return (mesh_.points[t[a]] - mesh_.points[t[b]]).squaredNorm() > max_edge * max_edge;
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
  emitInset(out);
}

bool SurfacePrep::collect(const SurfaceMesh& mesh, PreparedSurface& out) {
  const std::size_t n = mesh.vertices.size();
  mesh_.clear();
  Eigen::AlignedBox3f box;
  for (const Triangle& t : mesh.triangles) {
    if (t[0] >= n || t[1] >= n || t[2] >= n || t[0] == t[1] || t[1] == t[2] || t[2] == t[0])
      continue;
    if (!mesh.vertices[t[0]].allFinite() || !mesh.vertices[t[1]].allFinite() ||
        !mesh.vertices[t[2]].allFinite())
      continue;
    mesh_.triangles.push_back(t);
    for (std::uint32_t v : t) box.extend(mesh.vertices[v]);
  }
  if (mesh_.triangles.empty()) return false;
  const Eigen::Vector3f centre = box.center();
  out.origin = centre.cast<double>();
  out.diagonal = box.diagonal().norm();
  mesh_.points.resize(n);
  for (std::size_t i = 0; i < n; ++i) mesh_.points[i] = mesh.vertices[i] - centre;
  mesh_.normals.assign(n, Eigen::Vector3f::Zero());
  if (mesh.normals.size() == n)
    for (std::size_t i = 0; i < n; ++i)
      if (mesh.normals[i].allFinite()) mesh_.normals[i] = mesh.normals[i];
  return out.diagonal > 0;
}

/// Distance along the edges to the nearest border (an edge with a triangle on one side alone), as
/// far as `width`.
void SurfacePrep::findBorderDistance(float width) {
  const std::size_t n = mesh_.points.size();
  first_.assign(n + 1, 0);
  for (const Triangle& t : mesh_.triangles)
    for (std::uint32_t v : t) ++first_[v + 1];
  for (std::size_t i = 0; i < n; ++i) first_[i + 1] += first_[i];
  targets_.resize(3 * mesh_.triangles.size());
  for (const Triangle& t : mesh_.triangles)
    for (int i = 0; i < 3; ++i) targets_[first_[t[i]]++] = t[(i + 1) % 3];
  for (std::size_t i = n; i > 0; --i) first_[i] = first_[i - 1];
  first_[0] = 0;

  const auto hasEdge = [&](std::uint32_t a, std::uint32_t b) {
    return std::find(targets_.begin() + first_[a], targets_.begin() + first_[a + 1], b) !=
           targets_.begin() + first_[a + 1];
  };
  border_distance_.assign(n, width);
  for (const Triangle& t : mesh_.triangles)
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t a = t[i], b = t[(i + 1) % 3];
      if (!hasEdge(b, a)) border_distance_[a] = border_distance_[b] = 0;
    }
  bool changed = true;
  for (int round = 0; changed && round < kBorderRounds; ++round) {
    changed = false;
    for (const Triangle& t : mesh_.triangles)
      for (int i = 0; i < 3; ++i) {
        float &a = border_distance_[t[i]], &b = border_distance_[t[(i + 1) % 3]];
        if (std::max(a, b) <= 0 || std::min(a, b) >= width) continue;
        const float length = (mesh_.points[t[i]] - mesh_.points[t[(i + 1) % 3]]).norm();
        if (a + length < b) b = a + length, changed = true;
        if (b + length < a) a = b + length, changed = true;
      }
  }
}

void SurfacePrep::computeFade(const SurfaceMesh& mesh, float border_width) {
  mesh_.fade.assign(mesh_.points.size(), 1.0f);
  if (border_width > 0) {
    findBorderDistance(border_width);
    for (std::size_t i = 0; i < mesh_.fade.size(); ++i)
      mesh_.fade[i] = smoothStep(0, border_width, border_distance_[i]);
  }
  if (mesh.confidence.size() != mesh.vertices.size()) return;
  for (std::size_t i = 0; i < mesh_.fade.size(); ++i)
    mesh_.fade[i] *= smoothStep(kGoneConfidence, kFullConfidence, mesh.confidence[i]);
}

/// Draws the same with fewer triangles: the cells are as large as the edges of a mesh of so many.
void SurfacePrep::makeCoarser(std::size_t max_triangles, float diagonal) {
  const std::size_t count = mesh_.triangles.size();
  if (count <= max_triangles) return;
  const std::size_t step = count / 1000 + 1;
  double edges = 0, edge_count = 0;
  for (std::size_t i = 0; i < count; i += step, ++edge_count) {
    const Triangle& t = mesh_.triangles[i];
    edges += static_cast<double>((mesh_.points[t[0]] - mesh_.points[t[1]]).norm());
  }
  auto cell = static_cast<float>(
      edges / edge_count *
      std::sqrt(static_cast<double>(count) / static_cast<double>(max_triangles)));
  constexpr int tries = 6;
  for (int i = 0; i < tries; ++i, cell *= 1.25f) {
    if (!clusters_.reduce(mesh_, cell, diagonal, coarse_)) continue;
    if (coarse_.triangles.size() <= max_triangles) return std::swap(mesh_, coarse_);
  }
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
      out.vertices.push_back(
          vertex(mesh_.points[t[i]], Eigen::Vector3f::Unit(color), mesh_.fade[t[i]]));
    }
    out.indices.push_back(index);
  }
}

/// Halves the longest edge until none is longer than `max_edge`. Whether an edge is halved depends
/// on the edge alone, so that neighbours agree and no cracks open.
void SurfacePrep::emitCut(const Triangle& t, float max_edge, PreparedSurface& out) {
  std::array<Corner, 3> whole;
  for (int i = 0; i < 3; ++i)
    whole[i] = {mesh_.points[t[i]], Eigen::Vector3f::Unit(i), mesh_.fade[t[i]]};
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

void SurfacePrep::emitInset(PreparedSurface& out) {
  if (!clusters_.reduce(mesh_, out.diagonal / kInsetCells, out.diagonal, coarse_)) return;
  for (const Triangle& t : coarse_.triangles)
    out.inset_indices.insert(out.inset_indices.end(), t.begin(), t.end());
  const auto toSigned = [](float x) { return static_cast<std::int8_t>(std::lround(127 * x)); };
  for (std::size_t i = 0; i < coarse_.points.size(); ++i) {
    const Eigen::Vector3f &p = coarse_.points[i], &n = coarse_.normals[i];
    out.inset_vertices.push_back({{p.x(), p.y(), p.z()},
                                  {toSigned(n.x()), toSigned(n.y()), toSigned(n.z())},
                                  toByte(coarse_.fade[i])});
  }
}

}  // namespace depthscope::overlay
