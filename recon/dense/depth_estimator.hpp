#pragma once
#include <stop_token>
#include <vector>

#include "recon/dense/dense_settings.hpp"
#include "recon/dense/depth_map.hpp"
#include "recon/dense/rectified_picture.hpp"
#include "recon/dense/semi_global.hpp"

namespace depthscope::recon {

/// A map point as seen by the view that is estimated.
struct DepthSeed {
  Eigen::Vector2f pixel;    // in the finest level of the view
  float inverse_depth = 0;  // [1 / map unit]
};

/// A neighbour to match with.
struct DepthSource {
  const RectifiedPicture* picture = nullptr;
  Pose T_source_reference;
};

/// Multi-view stereo of one view, from coarse to fine: at the coarsest level all depths that the
/// map points span are tried, at the finer a few around what was found before. Buffers are kept
/// from call to call.
class DepthEstimator {
 public:
  static constexpr int kRadius = Correlator::kLarge;  // of the largest windows [px]

  DepthEstimator(const PinholeView& view, const DenseSettings& settings)
      : view_(view), settings_(settings) {}

  /// Depths that a pixel of disparity changes by more than `max_error` [map unit] are left out.
  /// False, and `out` undefined, when `stop` is requested or there is nothing to go by.
  bool estimate(const RectifiedPicture& reference, const std::vector<DepthSource>& sources,
                const std::vector<DepthSeed>& seeds, float max_error, DepthMap& out,
                const std::stop_token& stop);

 private:
  bool level(int l, const RectifiedPicture& reference, const std::vector<DepthSource>& sources,
             const std::stop_token& stop);
  bool startCoarse(const std::vector<DepthSeed>& seeds, const std::vector<DepthSource>& sources);
  void favourSeeds(const std::vector<DepthSeed>& seeds);
  void chooseDepths();
  void refineCentre(int finer_level, float step);
  void keepReliable(float max_error, DepthMap& out) const;

  const PinholeView& view_;
  const DenseSettings& settings_;
  PlaneSweep sweep_;
  SemiGlobal semi_global_;
  CostVolume volume_;
  std::vector<std::uint16_t> total_;
  Grid<float> inverse_depth_, smoothed_;
  Grid<std::uint8_t> cost_;  // of the hypothesis chosen
};

}  // namespace depthscope::recon
