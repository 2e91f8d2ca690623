#pragma once
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "platform/calibrate/board_detector.hpp"
#include "types/camera_model.hpp"

namespace depthscope::platform {

struct LensFitSettings {
  CameraModel::Kind model = CameraModel::Kind::Pinhole;
  bool with_k3 = false;        // pinhole: fit k3 too; else it is 0
  std::size_t max_views = 60;  // more only cost time: the most different ones are taken
  double min_difference =
      0.02;  // [picture diagonal] mean shift of the corners below which two views are one
  double outlier_factor = 3;    // a view whose error is this many times the median one is left out,
  double outlier_min_px = 0.5;  // unless it is below this
};

struct LeftOut {
  std::string picture;
  std::string reason;
};

struct LensFit {
  CameraModel camera;               // without fps
  double rms_px = 0;                // reprojection error over all corners of the views used
  std::vector<std::string> used;    // pictures
  std::vector<double> view_rms_px;  // of each used
  std::vector<LeftOut> left_out;
};

/// Fits a lens to views of a board (Zhang 2000; Kannala and Brandt 2006 for fisheye), leaving out
/// views that repeat others or disagree with them. Throws InputError when fewer than three views
/// remain or none can be fitted.
LensFit fitLens(const std::vector<BoardView>& views, cv::Size size,
                const LensFitSettings& settings);

}  // namespace depthscope::platform
