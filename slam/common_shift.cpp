#include "slam/common_shift.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace depthscope::slam {
namespace {

constexpr int kTurns = 15;  // of the picture, that are tried
constexpr float kTurn = 2 * std::numbers::pi_v<float> / kTurns;
// By how much of the picture's width shifts of right matches differ: a scope that moved aside by
// half its distance shifts what is a third nearer by that much more. With 1/12 a gap of 1.5 s took
// 38 pictures to be bridged that takes 3 or 4 with this.
constexpr float kReach = 1.f / 6;

float between0And2Pi(float angle) {
  constexpr float kWhole = 2 * std::numbers::pi_v<float>;
  return angle < 0 ? angle + kWhole : angle >= kWhole ? angle - kWhole : angle;
}

}  // namespace

CommonShift::CommonShift(const Intrinsics& camera, int max_features)
    : middle_(static_cast<float>(camera.cx), static_cast<float>(camera.cy)),
      reach_(kReach * 2 * static_cast<float>(camera.cx)) {
  all_.reserve(max_features);
  turned_.reserve(max_features);
  cluster_.reserve(max_features);
}

int CommonShift::keep(const FeatureSet& first, const FeatureSet& second, std::span<int> matches) {
  all_.clear();
  for (int i = 0; i < first.size(); ++i) {
    if (matches[i] < 0) continue;
    const Keypoint &a = first.keypoints[i], &b = second.keypoints[matches[i]];
    all_.push_back({i, between0And2Pi(b.angle - a.angle), Eigen::Vector2f(a.ux, a.uy) - middle_,
                    Eigen::Vector2f(b.ux, b.uy) - middle_, Eigen::Vector2f::Zero()});
  }
  cluster_.clear();
  for (int t = 0; t < kTurns; ++t) {
    takeTurned(static_cast<float>(t) * kTurn);
    if (turned_.size() > cluster_.size()) takeFullest();
  }
  std::size_t next = 0;
  for (int i = 0; i < first.size(); ++i) {
    if (matches[i] < 0) continue;
    while (next < cluster_.size() && cluster_[next].feature < i) ++next;
    if (next == cluster_.size() || cluster_[next].feature != i) matches[i] = -1;
  }
  return static_cast<int>(cluster_.size());
}

/// Matches whose patches turned by about so much.
void CommonShift::takeTurned(float turn) {
  const Eigen::Matrix2f R = Eigen::Rotation2Df(turn).toRotationMatrix();
  turned_.clear();
  for (Match& m : all_) {
    const float off = std::abs(std::remainder(m.turn - turn, 2 * std::numbers::pi_v<float>));
    if (off > kTurn) continue;
    m.shift = m.second - R * m.first;
    turned_.push_back(m);
  }
}

/// Takes the fullest cluster of `turned_` when it is fuller than the one there is.
void CommonShift::takeFullest() {
  const auto near = [&](const Eigen::Vector2f& place, const Match& m) {
    return (m.shift - place).squaredNorm() <= reach_ * reach_;
  };
  std::ptrdiff_t most = static_cast<std::ptrdiff_t>(cluster_.size());
  const Match* middle = nullptr;
  for (const Match& m : turned_) {
    const auto n = std::count_if(turned_.begin(), turned_.end(),
                                 [&](const Match& other) { return near(m.shift, other); });
    if (n <= most) continue;
    most = n;
    middle = &m;
  }
  if (middle == nullptr) return;
  cluster_.clear();
  for (const Match& m : turned_)
    if (near(middle->shift, m)) cluster_.push_back(m);
}

}  // namespace depthscope::slam
