#include "recon/dense/view_selection.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace depthscope::recon {
namespace {

constexpr std::size_t kSampledPoints = 150;  // of those seen, evenly: enough to tell views apart
constexpr float kMinShared = 12;             // points worth of score that a neighbour needs

float angleBetween(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
  const float cosine = a.dot(b) / (a.norm() * b.norm());
  return std::acos(std::clamp(cosine, -1.f, 1.f));
}

/// How well a pair of views suits stereo, 0..1: narrow pairs measure badly, wide ones look too
/// different to be matched.
float angleScore(float angle, float best) {
  const float width = angle < best ? best / 2 : best;
  const float off = (angle - best) / width;
  return std::exp(-off * off / 2);
}

}  // namespace

std::vector<std::size_t> selectViews(const CloudIndex& index, std::size_t reference, int count,
                                     double best_angle_deg,
                                     const std::function<bool(std::size_t)>& usable) {
  const auto best_angle = static_cast<float>(best_angle_deg * std::numbers::pi / 180);
  std::vector<float> score(index.views(), 0.f);
  Eigen::Vector3f middle = Eigen::Vector3f::Zero();
  const auto points = index.pointsOf(reference);
  const std::size_t stride = 1 + points.size() / kSampledPoints;
  std::size_t seen = 0;
  for (std::size_t i = 0; i < points.size(); i += stride, ++seen) {
    const std::uint32_t point = points[i];
    const Eigen::Vector3f& p = index.cloud().points[point].position;
    const Eigen::Vector3f ray = index.centre(reference) - p;
    middle += p;
    for (const Sighting& s : index.sightingsOf(point)) {
      if (s.view == reference) continue;
      const Eigen::Vector3f other = index.centre(s.view) - p;
      const float near = std::min(ray.norm(), other.norm());
      const float ratio = near / std::max(ray.norm(), other.norm());
      score[s.view] += static_cast<float>(stride) *
                       angleScore(angleBetween(ray, other), best_angle) * ratio * ratio;
    }
  }
  if (seen == 0) return {};
  middle /= static_cast<float>(seen);

  std::vector<std::size_t> chosen;
  while (chosen.size() < static_cast<std::size_t>(count)) {
    std::size_t best = 0;
    float best_score = kMinShared;
    for (std::size_t k = 0; k < score.size(); ++k) {
      if (score[k] <= best_score || !usable(k)) continue;
      float apart = 1;  // from those chosen already
      for (std::size_t c : chosen)
        apart = std::min(apart, angleBetween(index.centre(k) - middle, index.centre(c) - middle) /
                                    (best_angle / 2));
      if (score[k] * apart <= best_score) continue;
      best = k;
      best_score = score[k] * apart;
    }
    if (best_score == kMinShared) break;
    chosen.push_back(best);
    score[best] = 0;
  }
  return chosen;
}

}  // namespace depthscope::recon
