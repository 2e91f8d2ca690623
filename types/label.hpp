#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <string>

namespace depthscope {

/// A text annotation fixed to a point of the tissue.
struct Label {
  std::uint32_t id = 0;
  std::uint32_t map_id = 0;                          // the map whose world frame `anchor` is in
  Eigen::Vector3f anchor = Eigen::Vector3f::Zero();  // world frame
  std::string text;                                  // UTF-8, one line
};

}  // namespace depthscope
