#pragma once
#include <opencv2/features2d.hpp>

#include "slam/slam_settings.hpp"
#include "types/image_view.hpp"

namespace depthscope::bench {

/// The yardstick for times: OpenCV's ORB with as many features and levels. Use it with
/// cv::setNumThreads(1).
class OpenCvOrb {
 public:
  /// Detects and describes; returns the number of keypoints.
  int operator()(const GrayView& picture) {
    const cv::Mat image(picture.height, picture.width, CV_8U,
                        const_cast<std::uint8_t*>(picture.data), picture.stride);
    orb_->detectAndCompute(image, cv::noArray(), keypoints_, descriptors_);
    return static_cast<int>(keypoints_.size());
  }

 private:
  slam::ExtractorSettings settings_;
  cv::Ptr<cv::ORB> orb_ =
      cv::ORB::create(settings_.features, static_cast<float>(settings_.scale_factor),
                      settings_.levels, 31, 0, 2, cv::ORB::FAST_SCORE, 31, 20);
  std::vector<cv::KeyPoint> keypoints_;
  cv::Mat descriptors_;
};

}  // namespace depthscope::bench
