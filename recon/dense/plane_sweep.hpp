#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "recon/dense/correlation.hpp"
#include "recon/dense/rectified_picture.hpp"
#include "types/pose.hpp"

namespace depthscope::recon {

/// A picture to match against, and where its camera stands.
struct SweepSource {
  const RectifiedLevel* picture = nullptr;
  Pose T_source_reference;
};

/// Matching costs of every pixel and hypothesis: `cost[pixel * hypotheses + k]`, 255 is the worst.
/// Hypothesis k of a pixel is inverse depth `centre + (k - (hypotheses - 1) / 2) * step`; there are
/// 4, 8, 16, 32 or 64.
struct CostVolume {
  int width = 0, height = 0, hypotheses = 0;
  float step = 0;      // [1 / map unit]
  Grid<float> centre;  // [1 / map unit]
  std::vector<std::uint8_t> cost;
};

/// Plane sweep (Collins 1996): warps each source onto the reference at each hypothesis and compares
/// windows. Of the sources the two best count at each pixel and hypothesis, so that one which does
/// not see the place does no harm.
class PlaneSweep {
 public:
  /// Fills `volume.cost` from the rest of `volume`. False when `cancelled()` between two planes.
  template <class Cancelled>
  bool run(const RectifiedLevel& reference, const std::vector<SweepSource>& sources,
           const PinholeLevel& level, int radius, float noise, CostVolume& volume,
           const Cancelled& cancelled) {
    begin(reference, sources, radius, noise, volume);
    for (int k = 0; k < volume.hypotheses; ++k) {
      if (cancelled()) return false;
      plane(sources, level, k, volume);
    }
    return true;
  }

 private:
  static constexpr int kWoven = 4;  // hypotheses whose costs are put side by side at once

  void begin(const RectifiedLevel& reference, const std::vector<SweepSource>& sources, int radius,
             float noise, CostVolume& volume);
  void plane(const std::vector<SweepSource>& sources, const PinholeLevel& level, int k,
             CostVolume& volume);
  void warp(const Pose& T_source_reference, const Grid<std::uint32_t>& quads,
            const PinholeLevel& level, const CostVolume& volume, float offset);

  Correlator correlator_;
  // Of each source's pixels, from the lowest byte up: the pixel, 0 where it may not be used, its
  // right, lower, and lower right neighbour.
  std::vector<Grid<std::uint32_t>> packed_;
  Grid<std::uint8_t> warped_, usable_, cost_, best_, second_;
  std::array<std::vector<std::uint8_t>, kWoven> planes_;  // costs at the last hypotheses
  // Of one row: the pixel's place in the source, the weights of its quad [1/1024], and the quad.
  std::vector<std::int32_t> place_;
  std::vector<std::uint32_t> weights_, row_quads_;
};

}  // namespace depthscope::recon
