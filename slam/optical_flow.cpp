#include "slam/optical_flow.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace depthscope::slam {
namespace {

constexpr int kSide = 16;      // [px of the level] of the patch
constexpr int kLevelStep = 3;  // 1.2^3: each level's result lies well within the next's reach
constexpr int kIterations = 10;
constexpr float kConverged = 0.03F;  // [px of the level]
constexpr float kReach = kSide / 2;  // [px of the level] farther from where it began: gone astray
constexpr float kLeastCorrelation = 0.8F;
// Grey levels: noise of a pixel that is smoothed, and how well a patch must be placed in the worse
// of its directions for that [px].
constexpr float kNoise = 2, kPlaceSigma = 0.3F;

using Patch = Eigen::Array<float, kSide, kSide, Eigen::RowMajor>;

/// Bilinear samples around `centre`; false where the patch does not lie in the picture.
template <int Side>
bool sample(const ImageBuffer& image, const Eigen::Vector2f& centre,
            Eigen::Array<float, Side, Side, Eigen::RowMajor>& out) {
  const Eigen::Vector2f first = centre.array() - (Side - 1) / 2.0F;
  const float fx = std::floor(first.x()), fy = std::floor(first.y());
  if (!(fx >= 0 && fy >= 0 && fx + Side < static_cast<float>(image.width()) &&
        fy + Side < static_cast<float>(image.height())))
    return false;
  const int x0 = static_cast<int>(fx), y0 = static_cast<int>(fy);
  const float u = first.x() - fx, v = first.y() - fy;
  const float w00 = (1 - u) * (1 - v), w01 = u * (1 - v), w10 = (1 - u) * v, w11 = u * v;
  for (int y = 0; y < Side; ++y) {
    const std::uint8_t* a = image.row(y0 + y) + x0;
    const std::uint8_t* b = image.row(y0 + y + 1) + x0;
    float* to = out.data() + y * Side;
    for (int x = 0; x < Side; ++x)
      to[x] = w00 * a[x] + w01 * a[x + 1] + w10 * b[x] + w11 * b[x + 1];
  }
  return true;
}

/// What a patch looked like, light aside.
struct Template {
  Patch grey, dx, dy;  // about their means
  float energy = 0;    // of grey
  Eigen::Matrix2f H_inv;

  /// False without texture in both directions.
  bool take(const ImageBuffer& image, const Eigen::Vector2f& centre) {
    Eigen::Array<float, kSide + 2, kSide + 2, Eigen::RowMajor> around;
    if (!sample(image, centre, around)) return false;
    grey = around.block<kSide, kSide>(1, 1);
    dx = (around.block<kSide, kSide>(1, 2) - around.block<kSide, kSide>(1, 0)) / 2;
    dy = (around.block<kSide, kSide>(2, 1) - around.block<kSide, kSide>(0, 1)) / 2;
    for (Patch* p : {&grey, &dx, &dy}) *p -= p->mean();
    energy = grey.square().sum();
    Eigen::Matrix2f H;
    H(0, 0) = dx.square().sum();
    H(0, 1) = H(1, 0) = (dx * dy).sum();
    H(1, 1) = dy.square().sum();
    const float half_trace = H.trace() / 2;
    const float least =
        half_trace - std::sqrt(std::max(0.0F, half_trace * half_trace - H.determinant()));
    constexpr float kEnough = kNoise * kNoise / (kPlaceSigma * kPlaceSigma);
    if (!(least > kEnough)) return false;
    H_inv = H.inverse();
    return true;
  }
};

/// Moves `place` to where the template is in `image`; returns their correlation there, negative
/// where it was not found.
float align(const Template& wanted, const ImageBuffer& image, Eigen::Vector2f& place) {
  const Eigen::Vector2f begun = place;
  Patch seen;
  for (int i = 0;; ++i) {
    if (!sample(image, place, seen)) return -1;
    seen -= seen.mean();
    const float common = (seen * wanted.grey).sum();
    const float gain = common / wanted.energy;
    if (!(gain > 0)) return -1;
    if (i == kIterations) return common / std::sqrt(seen.square().sum() * wanted.energy);
    const Patch error = seen / gain - wanted.grey;
    const Eigen::Vector2f step =
        wanted.H_inv * Eigen::Vector2f((wanted.dx * error).sum(), (wanted.dy * error).sum());
    if (!step.allFinite()) return -1;
    if (step.norm() < kConverged) return common / std::sqrt(seen.square().sum() * wanted.energy);
    place -= step;
    if ((place - begun).norm() > kReach) return -1;
  }
}

Eigen::Vector2f toLevel(const Eigen::Vector2d& place, float scale) {
  return ((place.array() + 0.5) / scale - 0.5).matrix().cast<float>();
}

Eigen::Vector2d fromLevel(const Eigen::Vector2f& place, float scale) {
  return ((place.cast<double>().array() + 0.5) * scale - 0.5).matrix();
}

}  // namespace

std::optional<Eigen::Vector2d> followPatch(const SmoothedPyramid& first,
                                           const SmoothedPyramid& second,
                                           const Eigen::Vector2d& from, int octave,
                                           const Eigen::Vector2d& guess) {
  Eigen::Vector2d place = guess;
  Template wanted;
  for (int l = static_cast<int>(first.levels.size()) - 1;; l = std::max(octave, l - kLevelStep)) {
    const float scale = first.scales[l];
    Eigen::Vector2f there = toLevel(place, scale);
    const float correlation = wanted.take(first.levels[l], toLevel(from, scale))
                                  ? align(wanted, second.levels[l], there)
                                  : -1;
    // Coarse levels only bring it nearer: they may see too little, or too much around it.
    if (correlation >= kLeastCorrelation)
      place = fromLevel(there, scale);
    else if (l == octave)
      return std::nullopt;
    if (l == octave) return place;
  }
}

}  // namespace depthscope::slam
