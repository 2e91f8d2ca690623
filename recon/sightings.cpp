#include "recon/sightings.hpp"

#include <cmath>
#include <numbers>
#include <span>

namespace depthscope::recon {
namespace {

const float kMinCosine = std::cos(20 * std::numbers::pi_v<float> / 180);  // between lines of sight
constexpr float kMaxRatio = 1.5f;                                         // of distances

struct Projector {
  Eigen::Matrix3f R;
  Eigen::Vector3f t;
  const PinholeLevel& level;

  Projector(const Pose& T_camera_world, const PinholeLevel& pinhole)
      : R(T_camera_world.R.cast<float>()), t(T_camera_world.t.cast<float>()), level(pinhole) {}

  bool shows(const Eigen::Vector3f& world) const {
    const Eigen::Vector3f p = R * world + t;
    if (!(p.z() > 0)) return false;
    const float u = level.f * p.x() / p.z() + level.cx, v = level.f * p.y() / p.z() + level.cy;
    return u >= 0 && v >= 0 && u < static_cast<float>(level.width) &&
           v < static_cast<float>(level.height);
  }
};

bool seenAlike(const Eigen::Vector3f& point, const Eigen::Vector3f& centre,
               std::span<const Sighting> sightings, const std::vector<Eigen::Vector3f>& centres) {
  const Eigen::Vector3f ray = centre - point;
  const float distance = ray.norm();
  for (const Sighting& s : sightings) {
    const Eigen::Vector3f other = centres[s.view] - point;
    const float other_distance = other.norm();
    if (distance < kMaxRatio * other_distance && other_distance < kMaxRatio * distance &&
        ray.dot(other) > kMinCosine * distance * other_distance)
      return true;
  }
  return false;
}

}  // namespace

std::vector<Sighting> sightingsOfAllViews(const SparseCloud& cloud, const PinholeLevel& level) {
  std::vector<Eigen::Vector3f> centres;
  std::vector<Projector> projectors;
  for (const Pose& T_camera_world : cloud.views_T_camera_world) {
    centres.push_back(T_camera_world.inverse().t.cast<float>());
    projectors.emplace_back(T_camera_world, level);
  }
  std::vector<Sighting> out;
  out.reserve(cloud.sightings.size());
  auto next = cloud.sightings.begin();
  for (std::uint32_t p = 0; p < cloud.points.size(); ++p) {
    const auto first = next;
    while (next != cloud.sightings.end() && next->point == p) out.push_back(*next++);
    const Eigen::Vector3f& position = cloud.points[p].position;
    for (std::size_t v = cloud.keyframes; v < centres.size(); ++v)
      if (projectors[v].shows(position) && seenAlike(position, centres[v], {first, next}, centres))
        out.push_back({p, static_cast<std::uint32_t>(v)});
  }
  return out;
}

}  // namespace depthscope::recon
