#pragma once
#include <filesystem>
#include <functional>
#include <opencv2/core.hpp>
#include <string>

namespace depthscope::platform {

/// What was read from a folder or video.
struct PictureSummary {
  int count = 0;
  cv::Size size;   // of all of them [px]
  double fps = 0;  // of the video; 0 for a folder
};

/// Calls `take(name, grey picture)` for every picture of a folder (capture::listPictures), or for
/// pictures of a video, `interval_s` apart. The picture is good until `take` returns. Throws
/// InputError naming the file when there is none, one cannot be read or sizes differ.
PictureSummary forEachPicture(const std::filesystem::path& path, double interval_s,
                              const std::function<void(const std::string&, const cv::Mat&)>& take);

}  // namespace depthscope::platform
