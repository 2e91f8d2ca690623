#include "recon/dense/surface_nets.hpp"

#include <cmath>

namespace depthscope::recon {
namespace {

constexpr int kSide = TsdfVolume::kSide;
constexpr int kReach = kSide + 1;  // a block's cells need one more layer of voxels
constexpr std::int32_t kNoVertex = -1;

using Voxel = TsdfVolume::Voxel;

int voxelNumber(int x, int y, int z) {
  return (z * kSide + y) * kSide + x;
}

class SurfaceNets {
 public:
  SurfaceNets(const TsdfVolume& volume, const DenseSettings& settings, SurfaceMesh& mesh)
      : volume_(volume),
        settings_(settings),
        mesh_(mesh),
        vertex_(static_cast<std::size_t>(volume.blocks()) * TsdfVolume::kVoxels, kNoVertex) {}

  void run() {
    for (int b = 0; b < volume_.blocks(); ++b) makeVertices(b);
    for (int b = 0; b < volume_.blocks(); ++b) makeTriangles(b);
  }

 private:
  /// Voxels of a block and of one layer beyond it; null where there are none.
  using Neighbourhood = std::array<const Voxel*, kReach * kReach * kReach>;

  static std::size_t place(int x, int y, int z) {
    return static_cast<std::size_t>((z * kReach + y) * kReach + x);
  }

  void gather(int block, Neighbourhood& out) const {
    std::array<int, 8> around;
    for (int i = 0; i < 8; ++i)
      around[static_cast<std::size_t>(i)] =
          i == 0 ? block
                 : volume_.find(volume_.key(block) + TsdfVolume::Key(i & 1, i >> 1 & 1, i >> 2));
    for (int z = 0; z < kReach; ++z)
      for (int y = 0; y < kReach; ++y)
        for (int x = 0; x < kReach; ++x) {
          const int b =
              around[static_cast<std::size_t>(x / kSide + 2 * (y / kSide) + 4 * (z / kSide))];
          out[place(x, y, z)] =
              b == TsdfVolume::kNone
                  ? nullptr
                  : &volume_.voxel(b, voxelNumber(x % kSide, y % kSide, z % kSide));
        }
  }

  static bool seen(const Voxel* voxel) {
    return voxel != nullptr && voxel->weight > 0 && voxel->views > 0;
  }

  void makeVertices(int block) {
    Neighbourhood voxels;
    gather(block, voxels);
    for (int z = 0; z < kSide; ++z)
      for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x) makeVertex(block, voxels, x, y, z);
  }

  void makeVertex(int block, const Neighbourhood& voxels, int x, int y, int z) {
    std::array<const Voxel*, 8> corner;
    int inside = 0;
    for (int i = 0; i < 8; ++i) {
      const Voxel* v = voxels[place(x + (i & 1), y + (i >> 1 & 1), z + (i >> 2))];
      if (!seen(v)) return;
      corner[static_cast<std::size_t>(i)] = v;
      inside += v->distance < 0;
    }
    if (inside == 0 || inside == 8) return;
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    int crossings = 0;
    float views = 0, variance = 0;
    for (int i = 0; i < 8; ++i) {
      const Voxel& a = *corner[static_cast<std::size_t>(i)];
      views += a.views / 8;
      variance += (a.squared_distance - a.distance * a.distance) / 8;
      for (int axis = 0; axis < 3; ++axis) {
        const int j = i | 1 << axis;
        if (j == i) continue;
        const Voxel& b = *corner[static_cast<std::size_t>(j)];
        if ((a.distance < 0) == (b.distance < 0)) continue;
        Eigen::Vector3f p(static_cast<float>(i & 1), static_cast<float>(i >> 1 & 1),
                          static_cast<float>(i >> 2));
        p[axis] += a.distance / (a.distance - b.distance);
        sum += p;
        ++crossings;
      }
    }
    const float sure = confidence(views, variance);
    if (sure < static_cast<float>(settings_.min_confidence)) return;
    const Eigen::Vector3f cell =
        (kSide * volume_.key(block) + Eigen::Vector3i(x, y, z)).cast<float>();
    vertex_[static_cast<std::size_t>(block * TsdfVolume::kVoxels + voxelNumber(x, y, z))] =
        static_cast<std::int32_t>(mesh_.vertices.size());
    mesh_.vertices.push_back((cell + sum / static_cast<float>(crossings)) * volume_.voxelSize());
    mesh_.confidence.push_back(sure);
    mesh_.observations.push_back(static_cast<std::uint16_t>(std::lround(views)));
  }

  /// Grows with the views that saw the place, and falls where they disagree: tissue that moved, or
  /// was matched wrongly.
  float confidence(float views, float variance) const {
    const auto full_views = static_cast<float>(settings_.full_views);
    const auto full_scatter = static_cast<float>(settings_.full_scatter);
    // Variance of the mean of the views, against that of `full_views` that scatter by
    // `full_scatter`.
    const float spread =
        std::max(0.f, variance) * full_views / (std::max(views, 1.f) * full_scatter * full_scatter);
    return std::min(1.f, views / full_views) / (1 + spread);
  }

  std::int32_t vertexAt(int block, Eigen::Vector3i cell) const {
    TsdfVolume::Key key = volume_.key(block);
    for (int axis = 0; axis < 3; ++axis)
      if (cell[axis] < 0) {
        --key[axis];
        cell[axis] += kSide;
      }
    const int b = key == volume_.key(block) ? block : volume_.find(key);
    if (b == TsdfVolume::kNone) return kNoVertex;
    return vertex_[static_cast<std::size_t>(b * TsdfVolume::kVoxels +
                                            voxelNumber(cell.x(), cell.y(), cell.z()))];
  }

  void makeTriangles(int block) {
    Neighbourhood voxels;
    gather(block, voxels);
    for (int z = 0; z < kSide; ++z)
      for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x) {
          const Voxel* a = voxels[place(x, y, z)];
          if (!seen(a)) continue;
          const std::array<const Voxel*, 3> next = {
              voxels[place(x + 1, y, z)], voxels[place(x, y + 1, z)], voxels[place(x, y, z + 1)]};
          for (int axis = 0; axis < 3; ++axis) {
            const Voxel* b = next[static_cast<std::size_t>(axis)];
            if (seen(b) && (a->distance < 0) != (b->distance < 0))
              makeQuad(block, {x, y, z}, axis, a->distance < 0);
          }
        }
  }

  /// Joins the vertices of the four cells around the edge that starts at voxel `at`.
  void makeQuad(int block, const Eigen::Vector3i& at, int axis, bool from_inside) {
    const Eigen::Vector3i u = Eigen::Vector3i::Unit((axis + 1) % 3);
    const Eigen::Vector3i v = Eigen::Vector3i::Unit((axis + 2) % 3);
    std::array<std::int32_t, 4> corner = {vertexAt(block, at - u - v), vertexAt(block, at - v),
                                          vertexAt(block, at), vertexAt(block, at - u)};
    for (std::int32_t c : corner)
      if (c == kNoVertex) return;
    // Seen from the end of the edge the corners go round counter-clockwise; the cameras are where
    // distances are positive.
    if (!from_inside) std::swap(corner[1], corner[3]);
    const auto i = [&](int k) {
      return static_cast<std::uint32_t>(corner[static_cast<std::size_t>(k)]);
    };
    const auto p = [&](int k) { return mesh_.vertices[i(k)]; };
    // Along the shorter diagonal: flatter triangles.
    if ((p(0) - p(2)).squaredNorm() <= (p(1) - p(3)).squaredNorm()) {
      mesh_.triangles.push_back({i(0), i(1), i(2)});
      mesh_.triangles.push_back({i(0), i(2), i(3)});
    } else {
      mesh_.triangles.push_back({i(1), i(2), i(3)});
      mesh_.triangles.push_back({i(1), i(3), i(0)});
    }
  }

  const TsdfVolume& volume_;
  const DenseSettings& settings_;
  SurfaceMesh& mesh_;
  std::vector<std::int32_t> vertex_;  // of each voxel's cell
};

}  // namespace

void extractSurface(const TsdfVolume& volume, const DenseSettings& settings, SurfaceMesh& mesh) {
  mesh.clear();
  SurfaceNets(volume, settings, mesh).run();
}

}  // namespace depthscope::recon
