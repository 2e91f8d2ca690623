#pragma once
#include <Eigen/Core>
#include <cmath>
#include <random>

#include "recon/recon_settings.hpp"
#include "types/sparse_cloud.hpp"

namespace depthscope::recon {

/// The defaults of the paper's path.
inline ReconSettings sparseSettings() {
  ReconSettings settings;
  settings.method = ReconSettings::Method::Sparse;
  return settings;
}

/// Height over the plane z = 0 at (x, y); the camera is on the side of positive z.
using Height = float (*)(float x, float y);

inline float flat(float, float) {
  return 0;
}

/// Cap of a sphere of radius 2 whose top is at z = 0.
inline float cap(float x, float y) {
  return std::sqrt(4 - x * x - y * y) - 2;
}

/// Points over the square [-1, 1]^2, jittered so that no lattice shows, with noise along z.
inline SparseCloud heightCloud(Height height, int side, float noise, unsigned seed = 1) {
  std::mt19937 random(seed);
  // Drawn by hand: the library's distributions differ from one implementation to the next.
  const auto uniform = [&] { return static_cast<float>(random()) * 0x1p-31f - 1.f; };
  const Eigen::Vector3f camera(0, 0, 5);
  SparseCloud cloud;
  cloud.map_id = 7;
  const float step = 2.f / static_cast<float>(side);
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) {
      SparsePoint p;
      const float x = -1 + (static_cast<float>(i) + 0.5f + 0.4f * uniform()) * step;
      const float y = -1 + (static_cast<float>(j) + 0.5f + 0.4f * uniform()) * step;
      p.position = {x, y, height(x, y) + noise * uniform()};
      p.view_direction = (camera - p.position).normalized();
      p.observations = 4;
      p.reprojection_error_px = 0.5f;
      cloud.points.push_back(p);
    }
  return cloud;
}

}  // namespace depthscope::recon
