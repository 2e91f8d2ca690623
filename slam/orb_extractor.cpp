#include "slam/orb_extractor.hpp"

#include <algorithm>
#include <cmath>

#include "slam/corner_refinement.hpp"
#include "slam/orientation.hpp"
#include "types/surroundings.hpp"

namespace depthscope::slam {
namespace {

// [px] of each level: the patch lies in the picture, and so does what smoothes it.
constexpr int kMargin = kPatchRadius + 1;
constexpr int kCell = 32;     // [px] of each level: cell of the adaptive threshold
constexpr int kHalvings = 2;  // of the thresholds, at most
// Reach of a corner's own neighbourhood [px of its level]: the circle of FAST and the blur of a
// highlight.
constexpr double kSpecularReach = 5;

int maximaCapacity(const ImageBuffer& image) {
  return (image.width() / 2 + 1) * (image.height() / 2 + 1);
}

}  // namespace

OrbExtractor::OrbExtractor(const ExtractorSettings& settings, const CameraModel& camera,
                           SimdPath path)
    : settings_(settings),
      camera_(camera),
      path_(path),
      pyramid_(camera.width, camera.height, settings.levels, settings.scale_factor),
      highlights_(pyramid_, settings),
      view_(pyramid_),
      detector_(camera.width),
      smoothing_(camera.width),
      distribution_(camera.width, camera.height, maximaCapacity(pyramid_.level(0))),
      undistortion_(camera),
      corners_(settings.levels),
      wanted_(settings.levels) {
  for (int l = 0; l < settings.levels; ++l) {
    const double scale = pyramid_.scale(l);
    scale_factors_.push_back(static_cast<float>(scale));
    corners_[l].reserve(maximaCapacity(pyramid_.level(l)));
    cell_best_.emplace_back((pyramid_.level(l).width() / kCell + 1) *
                            (pyramid_.level(l).height() / kCell + 1));
    smooth_.emplace_back(pyramid_.level(l).width(), pyramid_.level(l).height());
    smooth_before_.emplace_back(pyramid_.level(l).width(), pyramid_.level(l).height());
  }
}

void OrbExtractor::extract(const GrayView& image, int wanted, FeatureSet& out) {
  out.keypoints.clear();
  out.descriptors.clear();
  if (!image.empty() && image.width == camera_.width && image.height == camera_.height) {
    std::swap(smooth_, smooth_before_);
    pyramid_.build(image, path_);
    const int dark =
        surroundingsLimit(pyramid_.level(pyramid_.levels() - 1).view(), settings_.dark_threshold);
    highlights_.update(pyramid_, dark);
    view_.update(pyramid_, dark);
    for (int l = 0; l < settings_.levels; ++l) smoothing_(pyramid_.level(l), smooth_[l], path_);
    detect(wanted);
    shareQuota(wanted);
    for (int l = 0; l < settings_.levels; ++l) describeLevel(l, out);
  }
  out.grid.build(out.keypoints);
}

/// Little texture: what there is of it is worth more than its noise costs, and thresholds are
/// halved until there are enough corners. What higher ones find is among what lower ones find, so
/// that the picture is searched once, as low as the one before had to be.
void OrbExtractor::detect(int wanted) {
  findCorners(halvings_);
  int halved = 0;
  while (halved < kHalvings && cornersAbove(thresholds(halved)) < wanted)
    if (++halved > halvings_) findCorners(halved);
  halvings_ = halved;
  for (int l = 0; l < settings_.levels; ++l) keepAbove(thresholds(halved), l);
}

OrbExtractor::Thresholds OrbExtractor::thresholds(int halved) const {
  return {std::max(1, settings_.fast_threshold >> halved),
          std::max(1, settings_.fast_threshold_min >> halved)};
}

void OrbExtractor::findCorners(int halved) {
  for (int l = 0; l < settings_.levels; ++l) {
    corners_[l].clear();
    detector_.detect(smooth_[l], thresholds(halved).least, searchArea(l), path_, corners_[l]);
    std::erase_if(corners_[l], [&](const Corner& c) { return !isOnTissue(c, l); });
    std::vector<std::uint8_t>& best = cell_best_[l];
    std::fill(best.begin(), best.end(), std::uint8_t{0});
    for (const Corner& c : corners_[l]) best[cellOf(c, l)] = std::max(best[cellOf(c, l)], c.score);
  }
}

int OrbExtractor::cellOf(const Corner& corner, int l) const {
  return corner.y / kCell * (pyramid_.level(l).width() / kCell + 1) + corner.x / kCell;
}

bool OrbExtractor::isAbove(const Thresholds& t, const Corner& corner, int l) const {
  return corner.score > t.first ||
         (corner.score > t.least && cell_best_[l][cellOf(corner, l)] <= t.first);
}

int OrbExtractor::cornersAbove(const Thresholds& t) const {
  std::ptrdiff_t found = 0;
  for (int l = 0; l < settings_.levels; ++l)
    found += std::count_if(corners_[l].begin(), corners_[l].end(),
                           [&](const Corner& c) { return isAbove(t, c, l); });
  return static_cast<int>(found);
}

void OrbExtractor::keepAbove(const Thresholds& t, int l) {
  std::erase_if(corners_[l], [&](const Corner& c) { return !isAbove(t, c, l); });
}

/// Where the patch lies in the picture and its middle in the view.
Area OrbExtractor::searchArea(int l) const {
  const double scale = pyramid_.scale(l);
  const Area& view = view_.bounds();
  const auto toLevel = [&](int x) { return static_cast<int>(x / scale); };
  return {std::max(kMargin, toLevel(view.left)), std::max(kMargin, toLevel(view.top)),
          std::min(smooth_[l].width() - kMargin, toLevel(view.right) + 1),
          std::min(smooth_[l].height() - kMargin, toLevel(view.bottom) + 1)};
}

bool OrbExtractor::isOnTissue(const Corner& corner, int l) const {
  const double scale = pyramid_.scale(l);
  const double x = (corner.x + 0.5) * scale - 0.5, y = (corner.y + 0.5) * scale - 0.5;
  return highlights_.distance(x, y) >= kSpecularReach * scale &&
         view_.distance(x, y) >= kMargin * scale;
}

/// Shares the features among the levels by their length scale, as Mur-Artal et al. do, and hands on
/// what a level cannot use to those that can.
void OrbExtractor::shareQuota(int features) {
  std::fill(wanted_.begin(), wanted_.end(), 0);
  int left = features;
  for (int round = 0; round < settings_.levels && left > 0; ++round) {
    double open = 0;
    for (int l = 0; l < settings_.levels; ++l)
      if (wanted_[l] < static_cast<int>(corners_[l].size())) open += 1 / pyramid_.scale(l);
    if (open == 0) break;
    const int shared = left;
    for (int l = 0; l < settings_.levels; ++l) {
      const int room = static_cast<int>(corners_[l].size()) - wanted_[l];
      const int share = static_cast<int>(std::ceil(shared / (pyramid_.scale(l) * open)));
      const int given = std::min({share, room, left});
      wanted_[l] += given;
      left -= given;
    }
  }
}

void OrbExtractor::describeLevel(int l, FeatureSet& out) {
  if (wanted_[l] == 0) return;
  const ImageBuffer& image = smooth_[l];
  distribution_.reduce(wanted_[l], image.width(), image.height(), corners_[l]);
  for (const Corner& c : corners_[l]) {
    const std::optional<Keypoint> keypoint = keypointAt(c, l);
    if (!keypoint) continue;
    out.keypoints.push_back(*keypoint);
    out.descriptors.push_back(brief_(image.row(c.y) + c.x, image.stride(), keypoint->angle));
  }
}

bool OrbExtractor::describe(const Eigen::Vector2d& captured, int octave, FeatureSet& out,
                            int slot) const {
  const ImageBuffer& image = smooth_[octave];
  const Eigen::Array2i place =
      ((captured.array() + 0.5) / pyramid_.scale(octave) - 0.5).round().cast<int>();
  const Corner corner{static_cast<std::int16_t>(place.x()), static_cast<std::int16_t>(place.y())};
  if (place.x() < kMargin || place.y() < kMargin || place.x() >= image.width() - kMargin ||
      place.y() >= image.height() - kMargin || !isOnTissue(corner, octave))
    return false;
  const std::optional<Keypoint> keypoint = keypointAt(captured, corner, octave);
  if (!keypoint) return false;
  if (slot == out.size()) {
    out.keypoints.emplace_back();
    out.descriptors.emplace_back();
  }
  out.keypoints[slot] = *keypoint;
  out.descriptors[slot] = brief_(image.row(corner.y) + corner.x, image.stride(), keypoint->angle);
  return true;
}

std::optional<Keypoint> OrbExtractor::keypointAt(const Corner& corner, int l) const {
  const ImageBuffer& image = smooth_[l];
  const Eigen::Vector2d place = Eigen::Vector2d(corner.x, corner.y) +
                                refineCorner(image.row(corner.y) + corner.x, image.stride());
  return keypointAt(((place.array() + 0.5) * pyramid_.scale(l) - 0.5).matrix(), corner, l);
}

/// Nothing where the lens model cannot be undone.
std::optional<Keypoint> OrbExtractor::keypointAt(const Eigen::Vector2d& captured,
                                                 const Corner& corner, int l) const {
  const double scale = pyramid_.scale(l);
  const ImageBuffer& image = smooth_[l];
  const std::uint8_t* centre = image.row(corner.y) + corner.x;
  const auto undistorted = undistortion_(captured);
  if (!undistorted) return std::nullopt;
  Keypoint k;
  k.x = static_cast<float>(captured.x());
  k.y = static_cast<float>(captured.y());
  k.ux = static_cast<float>(undistorted->pixel.x());
  k.uy = static_cast<float>(undistorted->pixel.y());
  k.sigma = static_cast<float>(settings_.keypoint_sigma_px * scale * undistorted->magnification);
  k.angle = intensityCentroidAngle(centre, image.stride());
  k.response = corner.score;
  k.octave = static_cast<std::uint8_t>(l);
  return k;
}

}  // namespace depthscope::slam
