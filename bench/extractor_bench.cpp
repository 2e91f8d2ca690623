// Time per picture of the ORB extractor, and of its yardstick: OpenCV's ORB with as many features
// and levels on one thread. Usage: extractor_bench [CLIP] [--benchmark_...]; CLIP defaults to the
// sample clip.
#include <benchmark/benchmark.h>

#include <cstdio>
#include <filesystem>
#include <opencv2/core/utility.hpp>
#include <vector>

#include "bench/luma_reader.hpp"
#include "bench/opencv_orb.hpp"
#include "slam/image_buffer.hpp"
#include "slam/orb_extractor.hpp"
#include "types/error.hpp"

namespace {

using depthscope::CameraModel;
using depthscope::slam::ImageBuffer;

constexpr int kPictures = 100;
std::vector<ImageBuffer> pictures;

void readPictures(const std::filesystem::path& clip) {
  depthscope::bench::LumaReader reader(clip);
  while (pictures.size() < kPictures) {
    const depthscope::GrayView picture = reader.next();
    if (picture.empty()) break;
    pictures.emplace_back(picture.width, picture.height).assign(picture);
  }
  if (pictures.empty()) throw depthscope::InputError(clip.string() + ": no pictures in the clip");
}

void ours(benchmark::State& state, depthscope::slam::SimdPath path) {
  if (!isAvailable(path)) return state.SkipWithError("not on this processor");
  CameraModel camera;
  camera.width = pictures.front().width();
  camera.height = pictures.front().height();
  camera.fx = camera.fy = camera.width;
  camera.cx = (camera.width - 1) / 2.0;
  camera.cy = (camera.height - 1) / 2.0;
  camera.k = {-0.2, 0.03, 0, 0, 0};
  const depthscope::slam::ExtractorSettings settings;
  depthscope::slam::OrbExtractor extractor(settings, camera, path);
  depthscope::slam::FeatureSet features(settings.features, camera);
  std::size_t i = 0;
  double found = 0;
  for (auto _ : state) {
    extractor.extract(pictures[i++ % pictures.size()].view(), features);
    found += features.size();
  }
  state.counters["features"] = found / static_cast<double>(i);
}

void yardstick(benchmark::State& state) {
  depthscope::bench::OpenCvOrb orb;
  std::size_t i = 0;
  double found = 0;
  for (auto _ : state) found += orb(pictures[i++ % pictures.size()].view());
  state.counters["features"] = found / static_cast<double>(i);
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  try {
    readPictures(argc > 1 ? argv[1] : DEPTHSCOPE_SAMPLE "/video.mp4");
  } catch (const depthscope::InputError& error) {
    std::fprintf(stderr, "extractor_bench: %s\n", error.what());
    return 2;
  }
  cv::setNumThreads(1);
  const auto unit = benchmark::kMillisecond;
  benchmark::RegisterBenchmark("opencv_orb", yardstick)->Unit(unit);
  benchmark::RegisterBenchmark("ours", ours, depthscope::slam::bestSimdPath())->Unit(unit);
  benchmark::RegisterBenchmark("ours_portable", ours, depthscope::slam::SimdPath::Portable)
      ->Unit(unit);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
