#include "platform/calibrate/picture_source.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "capture/file_source.hpp"
#include "capture/pixel_convert.hpp"
#include "types/error.hpp"

namespace depthscope::platform {
namespace {

namespace fs = std::filesystem;

/// What to call the pictures of a folder; those of a video have no name.
std::vector<fs::path> namesOf(const fs::path& path) {
  return fs::is_directory(path) ? capture::listPictures(path) : std::vector<fs::path>{};
}

}  // namespace

PictureSummary forEachPicture(const fs::path& path, double interval_s,
                              const std::function<void(const std::string&, const cv::Mat&)>& take) {
  capture::FileSourceSettings settings;
  settings.path = path;
  const auto source = capture::openFileSource(settings);
  const std::vector<fs::path> names = namesOf(path);
  PictureSummary summary;
  summary.fps = names.empty() ? source->fps() : 0;
  summary.size = {source->format().width, source->format().height};
  const int every = std::max(1, static_cast<int>(std::lround(interval_s * summary.fps)));
  cv::Mat grey(summary.size, CV_8UC1);
  for (std::size_t i = 0;; ++i) {
    const capture::ReadResult result = source->read(std::chrono::milliseconds(0));
    if (result.status == capture::SourceStatus::EndOfStream) return summary;
    const std::string name =
        i < names.size() ? names[i].filename().string() : "frame " + std::to_string(i);
    if (result.status != capture::SourceStatus::Ok)
      throw InputError(path.string() + ": " + name + ": " + std::string(toString(result.status)) +
                       ", expected a picture of the size of the first");
    if (i % static_cast<std::size_t>(every) != 0) continue;
    capture::toGray(result.frame, {grey.data, grey.total()});
    ++summary.count;
    take(name, grey);
  }
}

}  // namespace depthscope::platform
