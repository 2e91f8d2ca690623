#pragma once
#include <opencv2/core.hpp>
#include <random>
#include <span>

namespace depthscope::bench {

/// What may go wrong with a tower's picture, done to its luma in place. `frame` counts at 30
/// pictures a second; `random` is the clip's own.
struct PictureFault {
  const char* name;
  void (*apply)(cv::Mat& picture, int frame, std::mt19937& random);
};

std::span<const PictureFault> pictureFaults();

}  // namespace depthscope::bench
