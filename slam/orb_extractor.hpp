#pragma once
#include <optional>
#include <span>
#include <vector>

#include "slam/binomial_smoothing.hpp"
#include "slam/brief_descriptor.hpp"
#include "slam/corner_distribution.hpp"
#include "slam/fast_detector.hpp"
#include "slam/features.hpp"
#include "slam/field_of_view.hpp"
#include "slam/highlight_mask.hpp"
#include "slam/image_pyramid.hpp"
#include "slam/optical_flow.hpp"
#include "slam/simd_dispatch.hpp"
#include "slam/slam_settings.hpp"
#include "slam/undistortion_map.hpp"
#include "types/camera_model.hpp"
#include "types/image_view.hpp"

namespace depthscope::slam {

/// ORB features (Rublee et al. 2011) spread evenly over picture and scale (after Mur-Artal et al.
/// 2015, section V.A), away from highlights and from the edge of the round field of view. All
/// storage is allocated by the constructor; the same picture gives the same features on every
/// processor.
class OrbExtractor {
 public:
  OrbExtractor(const ExtractorSettings& settings, const CameraModel& camera,
               SimdPath path = bestSimdPath());

  /// Fills `out` (its capacity: settings.capacity()) with up to `wanted` features of a picture of
  /// the camera's size; a picture of another size gives none. Does not allocate.
  void extract(const GrayView& image, int wanted, FeatureSet& out);
  /// As many as the settings have for a picture with texture.
  void extract(const GrayView& image, FeatureSet& out) { extract(image, settings_.features, out); }

  /// Describes the place `captured` [px of full resolution] of the last picture as a feature of
  /// `octave`, corner or not, in place of feature `slot` of `out`, whose grid is not built anew; in
  /// place of none when `slot` is its size. False where it is not on tissue or too near to a
  /// border.
  bool describe(const Eigen::Vector2d& captured, int octave, FeatureSet& out, int slot) const;

  /// Where the lens would have put what it shows at `captured` without its distortion [px]; nothing
  /// where its model cannot be undone.
  std::optional<Eigen::Vector2d> undistort(const Eigen::Vector2d& captured) const {
    const auto undistorted = undistortion_(captured);
    return undistorted ? std::optional<Eigen::Vector2d>(undistorted->pixel) : std::nullopt;
  }

  /// The last picture, and the one before it.
  SmoothedPyramid lastPicture() const { return {smooth_, scale_factors_}; }
  SmoothedPyramid pictureBefore() const { return {smooth_before_, scale_factors_}; }

  /// Pixels of full resolution per pixel of octave l.
  std::span<const float> scaleFactors() const { return scale_factors_; }
  const ImagePyramid& pyramid() const { return pyramid_; }
  const HighlightMask& highlights() const { return highlights_; }
  const FieldOfView& fieldOfView() const { return view_; }

 private:
  /// FAST's, adaptive: in a cell with corners above `first` [grey levels] only those count, in
  /// others those above `least`.
  struct Thresholds {
    int first = 0, least = 0;
  };
  Thresholds thresholds(int halved) const;  // the settings', halved so many times
  void detect(int wanted);
  void findCorners(int halved);
  int cellOf(const Corner& corner, int l) const;
  bool isAbove(const Thresholds& t, const Corner& corner, int l) const;
  int cornersAbove(const Thresholds& t) const;
  void keepAbove(const Thresholds& t, int l);
  Area searchArea(int l) const;
  bool isOnTissue(const Corner& corner, int l) const;
  void shareQuota(int features);
  void describeLevel(int l, FeatureSet& out);
  std::optional<Keypoint> keypointAt(const Corner& corner, int l) const;
  std::optional<Keypoint> keypointAt(const Eigen::Vector2d& captured, const Corner& corner,
                                     int l) const;

  ExtractorSettings settings_;
  CameraModel camera_;
  SimdPath path_;
  std::vector<float> scale_factors_;

  ImagePyramid pyramid_;
  HighlightMask highlights_;
  FieldOfView view_;
  FastDetector detector_;
  BinomialSmoothing smoothing_;
  CornerDistribution distribution_;
  BriefDescriptor brief_;
  UndistortionMap undistortion_;

  std::vector<std::vector<Corner>> corners_;          // of each level
  std::vector<int> wanted_;                           // corners to keep of each level
  std::vector<std::vector<std::uint8_t>> cell_best_;  // best score in each cell, of each level
  int halvings_ = 0;                        // of the thresholds, that the last picture needed
  std::vector<ImageBuffer> smooth_;         // each level smoothed once
  std::vector<ImageBuffer> smooth_before_;  // of the picture before
};

}  // namespace depthscope::slam
