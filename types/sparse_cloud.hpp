#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "types/pose.hpp"

namespace depthscope {

/// A map point as reconstruction sees it, in the world frame of its map.
struct SparsePoint {
  Eigen::Vector3f position;
  Eigen::Vector3f
      view_direction;  // unit, from the point towards the mean of the cameras that saw it
  std::int32_t observations = 0;    // keyframes that observe it
  float reprojection_error_px = 0;  // root mean square over its observations
};

/// A view saw a point; both are indices into the arrays of the cloud.
struct Sighting {
  std::uint32_t point;
  std::uint32_t view;
};

/// What the tracker hands to reconstruction: a copy, so that neither waits for the other.
struct SparseCloud {
  std::uint32_t map_id = 0;
  std::vector<SparsePoint> points;
  std::size_t keyframes = 0;  // so many of the views, the first ones; others are frames in between
  std::vector<Pose> views_T_camera_world;
  std::vector<std::int64_t> view_frames;  // number of the frame each view was
  std::vector<Sighting> sightings;        // by keyframes; point by point, in the order of `points`
};

}  // namespace depthscope
