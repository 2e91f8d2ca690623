#include "platform/calibrate/picture_source.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <vector>

#include "types/error.hpp"

namespace depthscope::platform {
namespace {

namespace fs = std::filesystem;
using Take = std::function<void(const std::string&, const cv::Mat&)>;

bool isPicture(const fs::path& file) {
  std::string extension = file.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  constexpr std::array<const char*, 7> kKnown = {".png", ".jpg",  ".jpeg", ".bmp",
                                                 ".tif", ".tiff", ".pgm"};
  return std::find(kKnown.begin(), kKnown.end(), extension) != kKnown.end();
}

PictureSummary fromFolder(const fs::path& folder, const Take& take) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (isPicture(entry.path())) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  if (files.empty())
    throw InputError(folder.string() + ": holds no pictures (png, jpg, bmp, tif, pgm)");
  PictureSummary summary;
  for (const auto& file : files) {
    const cv::Mat grey = cv::imread(file.string(), cv::IMREAD_GRAYSCALE);
    if (grey.empty()) throw InputError(file.string() + ": is not a readable picture");
    if (summary.count++ == 0) summary.size = grey.size();
    if (grey.size() != summary.size)
      throw InputError(file.string() + ": has another size than the pictures before it");
    take(file.filename().string(), grey);
  }
  return summary;
}

PictureSummary fromVideo(const fs::path& file, double interval_s, const Take& take) {
  cv::VideoCapture video(file.string());
  if (!video.isOpened())
    throw InputError(file.string() + ": is neither a folder nor a readable video");
  PictureSummary summary;
  summary.fps = video.get(cv::CAP_PROP_FPS);
  const int every = std::max(1, static_cast<int>(std::lround(interval_s * summary.fps)));
  cv::Mat frame, grey;
  for (int i = 0; video.grab(); ++i) {
    if (i % every != 0 || !video.retrieve(frame) || frame.empty()) continue;
    cv::cvtColor(frame, grey, cv::COLOR_BGR2GRAY);
    if (summary.count++ == 0) summary.size = grey.size();
    if (grey.size() != summary.size) throw InputError(file.string() + ": changes its size");
    take("frame " + std::to_string(i), grey);
  }
  if (summary.count == 0) throw InputError(file.string() + ": has no readable frames");
  return summary;
}

}  // namespace

PictureSummary forEachPicture(const fs::path& path, double interval_s, const Take& take) {
  if (!fs::exists(path))
    throw InputError(path.string() + ": does not exist, expected a folder or a video");
  return fs::is_directory(path) ? fromFolder(path, take) : fromVideo(path, interval_s, take);
}

}  // namespace depthscope::platform
