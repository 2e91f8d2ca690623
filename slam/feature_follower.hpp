#pragma once
#include <span>
#include <vector>

#include "slam/orb_extractor.hpp"

namespace depthscope::slam {

/// Follows features of one picture through those after it by optical flow: where noise has made
/// descriptors unlike each other, a patch as a whole still looks like itself (SD-DefSLAM,
/// Gomez-Rodriguez et al. 2021, section III). Each is compared with what it was at first, so that
/// errors do not add up. All storage is allocated by the constructor.
class FeatureFollower {
 public:
  struct Followed {
    int feature;            // of the first picture
    Eigen::Vector2d place;  // [px] in the last one, as captured
    Eigen::Vector2d pixel;  // [px] the same, undistorted
  };

  /// Features of up to `capacity`, in pictures of `extractor`.
  FeatureFollower(const OrbExtractor& extractor, int capacity);

  /// Begins with `features` of the extractor's last picture, those of octave `finest` and coarser:
  /// noise drowns the finest first.
  void begin(const FeatureSet& features, int finest);
  /// Finds them in the extractor's last picture; what is not found is given up. Returns how many
  /// are left.
  int follow();
  /// In the order of their features.
  std::span<const Followed> followed() const { return followed_; }

 private:
  struct Patch {
    Eigen::Vector2d place;  // [px] as captured
    int octave;
  };

  const OrbExtractor& extractor_;
  std::vector<ImageBuffer> first_;  // smoothed pyramid of the first picture
  std::vector<Patch> patches_;      // per feature of the first picture
  std::vector<Followed> followed_;
};

}  // namespace depthscope::slam
