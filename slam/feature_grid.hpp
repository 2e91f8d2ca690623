#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "slam/keypoint.hpp"
#include "types/camera_model.hpp"

namespace depthscope::slam {

/// Keypoints of one picture in square cells over the undistorted coordinates, for search by place.
/// All storage is allocated by the constructor.
class FeatureGrid {
 public:
  FeatureGrid() = default;
  /// Covers the undistorted picture of `camera`; holds up to `capacity` keypoints.
  FeatureGrid(int capacity, const CameraModel& camera);

  /// Sorts the keypoints (at most `capacity`) into the cells; forgets the ones before.
  void build(std::span<const Keypoint> keypoints);

  /// Writes to `out` the indices of the keypoints nearer than `radius` [px] to (ux, uy) with
  /// min_octave <= octave <= max_octave, and returns their number. What does not fit into `out` is
  /// left out. The order is by cell, then by index: the same for the same keypoints.
  int query(float ux, float uy, float radius, int min_octave, int max_octave,
            std::span<std::uint32_t> out) const;

 private:
  struct Entry {
    float ux, uy;
    std::uint32_t index;
    std::int32_t octave;
  };
  int column(float ux) const;
  int row(float uy) const;

  float min_x_ = 0, min_y_ = 0;  // [px] corner of the first cell
  int columns_ = 0, rows_ = 0;
  std::vector<std::uint32_t> cell_begin_;  // columns * rows + 1 positions in entries_
  std::vector<Entry> entries_;             // in the order of the cells
};

}  // namespace depthscope::slam
