#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <stop_token>
#include <vector>

#include "recon/dense/depth_consistency.hpp"

namespace depthscope::recon {

/// Truncated signed distances (Curless and Levoy 1996; voxel hashing as Niessner et al. 2013) in
/// blocks of 4 x 4 x 4 voxels around the observed surface. Blocks come out of a store of fixed
/// capacity; nothing grows after construction.
class TsdfVolume {
 public:
  static constexpr int kSide = 4;  // voxels along a block
  static constexpr int kVoxels = kSide * kSide * kSide;
  static constexpr int kNone = -1;
  using Key = Eigen::Vector3i;  // a block's place [blocks]

  struct Voxel {
    float weight = 0;
    // Means once the volume is finished, weighted sums before; in voxels, positive towards the
    // cameras.
    float distance = 0;
    float squared_distance = 0;
    float views = 0;  // that saw a surface within the truncation
  };

  explicit TsdfVolume(int max_blocks);

  /// Empties the volume. `truncation` in voxels.
  void begin(float voxel_size, float truncation);
  /// Makes the blocks around a view's depths. False when the store is full.
  bool allocate(const FusedView& view, const PinholeLevel& level);
  /// What voxels need to know of a view's pixels.
  struct ViewPixels {
    struct Pixel {
      float depth = 0;   // along the optical axis [map unit]
      float slant = 0;   // voxels along the normal by map unit of depth
      float weight = 0;  // 0: unknown
    };
    Grid<Pixel> pixels;
    Grid<float> farthest;      // of each tile: depth within the truncation of a surface
    std::vector<float> reach;  // the same of each pixel of one row
  };
  /// Adds a view's distances to the blocks that are there: to every `step`-th from `first`, so that
  /// threads, each with a scratch of its own, can share them.
  void integrate(const FusedView& view, const PinholeLevel& level, ViewPixels& scratch,
                 int first = 0, int step = 1);
  /// After the last view.
  void finish();

  float voxelSize() const { return voxel_size_; }
  float truncation() const { return truncation_; }
  int blocks() const { return static_cast<int>(keys_.size()); }
  const Key& key(int block) const { return keys_[static_cast<std::size_t>(block)]; }
  /// kNone where there is none.
  int find(const Key& key) const;
  /// Voxel (x, y, z) is number (z * 4 + y) * 4 + x; its centre is at (4 key + (x, y, z)) voxels.
  const Voxel& voxel(int block, int number) const {
    return voxels_[static_cast<std::size_t>(block) * kVoxels + static_cast<std::size_t>(number)];
  }
  std::size_t bytes() const;

 private:
  bool insert(const Key& key);
  std::size_t slotOf(const Key& key) const;
  void prepare(const FusedView& view, const PinholeLevel& level, ViewPixels& out) const;
  void integrateBlock(int block, const ViewPixels& view, const PinholeLevel& level,
                      const Eigen::Matrix3f& R, const Eigen::Vector3f& t);

  float voxel_size_ = 1, truncation_ = 4;
  std::size_t capacity_;
  std::vector<Key> keys_;
  std::array<std::vector<float>, 3> middles_;  // of the blocks, x, y and z [map unit]
  std::vector<Voxel> voxels_;
  std::vector<std::int32_t> slots_;  // open addressing: block, or kNone
};

}  // namespace depthscope::recon
