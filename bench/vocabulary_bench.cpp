// What the vocabulary costs: once at start, and for every picture whose place is looked for.
#include <benchmark/benchmark.h>
#include <unistd.h>

#include <filesystem>
#include <random>
#include <vector>

#include "slam/keyframe_database.hpp"

namespace {

using namespace depthscope;
using namespace depthscope::slam;

std::vector<Descriptor> randomDescriptors(int n, unsigned seed) {
  std::mt19937_64 rng(seed);
  std::vector<Descriptor> descriptors(static_cast<std::size_t>(n));
  for (Descriptor& d : descriptors)
    for (auto& word : d.bits) word = rng();
  return descriptors;
}

/// The one that is part of the program.
void builtIn(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(Vocabulary::builtIn());
  const Vocabulary vocabulary = Vocabulary::builtIn();
  state.counters["words"] = vocabulary.words();
  state.counters["bytes"] = static_cast<double>(vocabulary.bytes());
}

/// From a file, as slam.vocabulary names it.
void load(benchmark::State& state) {
  const auto file = std::filesystem::temp_directory_path() /
                    ("depthscope_vocabulary_bench_" + std::to_string(::getpid()));
  Vocabulary::builtIn().save(file);
  state.counters["bytes"] = static_cast<double>(std::filesystem::file_size(file));
  for (auto _ : state) benchmark::DoNotOptimize(Vocabulary::load(file));
  std::filesystem::remove(file);
}

/// The bag of words of a picture of 1000 features.
void describe(benchmark::State& state) {
  const Vocabulary vocabulary = Vocabulary::builtIn();
  const auto descriptors = randomDescriptors(1000, 1);
  std::vector<WordWeight> bag;
  bag.reserve(descriptors.size());
  for (auto _ : state) {
    vocabulary.describe(descriptors, bag);
    benchmark::DoNotOptimize(bag.data());
  }
}

/// The keyframes of a full map that look like a picture.
void find(benchmark::State& state) {
  const SlamSettings settings;
  CameraModel camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = camera.fy = 500;
  camera.cx = 319.5;
  camera.cy = 239.5;
  Map map(settings, camera);
  KeyframeDatabase database(settings, Vocabulary::builtIn());
  FeatureSet features(settings.extractor.features, camera);
  features.keypoints.resize(static_cast<std::size_t>(settings.extractor.features));
  map.start();
  for (int k = 0; k < settings.capacity.keyframes; ++k) {
    features.descriptors = randomDescriptors(settings.extractor.features, static_cast<unsigned>(k));
    database.add(map, map.addKeyframe(features, Pose{}, k, k));
  }
  PlaceQuery query(settings);
  const auto picture = randomDescriptors(settings.extractor.features, 1000);
  for (auto _ : state) benchmark::DoNotOptimize(database.find(map, picture, query).data());
}

BENCHMARK(builtIn)->Unit(benchmark::kMillisecond);
BENCHMARK(load)->Unit(benchmark::kMillisecond);
BENCHMARK(describe)->Unit(benchmark::kMillisecond);
BENCHMARK(find)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
