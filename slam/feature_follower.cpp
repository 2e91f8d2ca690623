#include "slam/feature_follower.hpp"

#include <algorithm>

namespace depthscope::slam {

FeatureFollower::FeatureFollower(const OrbExtractor& extractor, int capacity)
    : extractor_(extractor) {
  const auto levels = extractor.lastPicture().levels;
  first_.assign(levels.begin(), levels.end());
  patches_.reserve(static_cast<std::size_t>(capacity));
  followed_.reserve(static_cast<std::size_t>(capacity));
}

void FeatureFollower::begin(const FeatureSet& features, int finest) {
  const auto levels = extractor_.lastPicture().levels;
  std::copy(levels.begin(), levels.end(), first_.begin());  // of equal sizes: not allocated anew
  patches_.clear();
  followed_.clear();
  for (int f = 0; f < features.size(); ++f) {
    const Keypoint& k = features.keypoints[f];
    patches_.push_back({{k.x, k.y}, k.octave});
    if (k.octave >= finest) followed_.push_back({f, {k.x, k.y}, {k.ux, k.uy}});
  }
}

int FeatureFollower::follow() {
  const SmoothedPyramid first{first_, extractor_.scaleFactors()};
  std::erase_if(followed_, [&](Followed& f) {
    const Patch& patch = patches_[static_cast<std::size_t>(f.feature)];
    const auto place =
        followPatch(first, extractor_.lastPicture(), patch.place, patch.octave, f.place);
    const auto pixel = place ? extractor_.undistort(*place) : std::nullopt;
    if (!pixel) return true;
    f.place = *place;
    f.pixel = *pixel;
    return false;
  });
  return static_cast<int>(followed_.size());
}

}  // namespace depthscope::slam
