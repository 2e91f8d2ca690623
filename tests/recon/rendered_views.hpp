#pragma once
#include <cmath>
#include <vector>

#include "recon/cloud_index.hpp"
#include "recon/dense/dense_settings.hpp"
#include "recon/sightings.hpp"
#include "recon/view_picture.hpp"
#include "synthetic_cloud.hpp"
#include "types/camera_model.hpp"

namespace depthscope::recon {

/// Keyframes of a textured surface, and the cloud that tracking would have made of them.
struct RenderedViews {
  CameraModel camera;
  std::vector<ViewPicture> pictures;
  SparseCloud cloud;
};

/// Who sees what of the cloud, which must stay.
inline CloudIndex indexOf(const CameraModel& camera, const SparseCloud& cloud) {
  return {cloud, sightingsOfAllViews(cloud, finestLevel(camera, 1, DenseSettings{}.picture_width))};
}

/// Smooth noise of about 0.05 in size, 0..1.
inline float texture(float x, float y) {
  const auto lattice = [](int i, int j) {
    auto h = static_cast<std::uint32_t>(i) * 73856093u ^ static_cast<std::uint32_t>(j) * 19349669u;
    h = (h ^ h >> 15) * 2246822519u;
    return static_cast<float>((h ^ h >> 13) & 0xffff) / 65535.f;
  };
  const float u = x / 0.05f, v = y / 0.05f;
  const int i = static_cast<int>(std::floor(u)), j = static_cast<int>(std::floor(v));
  const float a = u - static_cast<float>(i), b = v - static_cast<float>(j);
  return (1 - b) * ((1 - a) * lattice(i, j) + a * lattice(i + 1, j)) +
         b * ((1 - a) * lattice(i, j + 1) + a * lattice(i + 1, j + 1));
}

/// `count` keyframes that look from z = 4 down on the surface `height`, in a row `apart`. Where
/// `blank` says so the surface has no texture.
inline RenderedViews renderViews(Height height, int count,
                                 bool (*blank)(float x, float y) = nullptr, double apart = 0.3) {
  RenderedViews out;
  CameraModel& c = out.camera;
  c.width = 320;
  c.height = 240;
  c.fx = c.fy = 300;
  c.cx = 159.5;
  c.cy = 119.5;
  out.cloud = heightCloud(height, 40, 0);
  for (int k = 0; k < count; ++k) {
    const Eigen::Vector3d centre(apart * (k - (count - 1) / 2.0), 0.05 * (k % 2), 4);
    Pose T_camera_world;
    T_camera_world.R = Eigen::Vector3d(1, -1, -1).asDiagonal();  // looks along -z
    T_camera_world.t = -(T_camera_world.R * centre);
    ViewPicture picture;
    picture.frame = 10 * k;
    picture.luma.reset(c.width, c.height);
    const ColorReduction color(c.width, c.height);
    picture.color.reset(color.width, color.height, Rgb{120, 60, 50});
    for (int y = 0; y < c.height; ++y)
      for (int x = 0; x < c.width; ++x) {
        const Eigen::Vector3d ray((x - c.cx) / c.fx, -(y - c.cy) / c.fy, -1);
        Eigen::Vector3d p = centre + 4 * ray;
        for (int i = 0; i < 8; ++i)  // the surface is nearly level: converges
          p = centre + ray * (4 - static_cast<double>(height(static_cast<float>(p.x()),
                                                             static_cast<float>(p.y()))));
        const auto px = static_cast<float>(p.x()), py = static_cast<float>(p.y());
        const bool plain = blank != nullptr && blank(px, py);
        picture.luma.at(x, y) =
            static_cast<std::uint8_t>(60 + (plain ? 50 : 100 * texture(px, py)));
      }
    out.pictures.push_back(picture);
    out.cloud.views_T_camera_world.push_back(T_camera_world);
    out.cloud.view_frames.push_back(picture.frame);
  }
  out.cloud.keyframes = out.cloud.view_frames.size();
  for (std::uint32_t p = 0; p < out.cloud.points.size(); ++p)
    for (std::uint32_t k = 0; k < static_cast<std::uint32_t>(count); ++k)
      out.cloud.sightings.push_back({p, k});
  return out;
}

}  // namespace depthscope::recon
