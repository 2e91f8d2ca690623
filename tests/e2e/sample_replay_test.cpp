// The main job on the sample clip, against ground truth: the figures of the paper are the least.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>

#include "../platform/temporary_folder.hpp"
#include "capture/file_source.hpp"
#include "platform/camera_file.hpp"
#include "platform/evaluate/evaluation.hpp"
#include "platform/png_reader.hpp"
#include "program.hpp"

namespace depthscope::platform {
namespace {

namespace fs = std::filesystem;

const fs::path sample = fs::path(DEPTHSCOPE_TEST_DATA) / "sample";

ProgramResult replay(const fs::path& out, const std::vector<std::string>& more = {}) {
  std::vector<std::string> words{
      "depthscope",           "replay", "--input", sample / "video.mp4", "--camera",
      sample / "camera.yaml", "--out",  out};
  words.insert(words.end(), more.begin(), more.end());
  return runProgram(words);
}

/// Where a pixel of a frame lies in the world of the truth [mm].
Eigen::Vector3d truthAt(int frame, int x, int y) {
  const std::string digits = std::to_string(frame);
  const Gray16Picture depth =
      readGray16Png(sample / "depth" / (std::string(6 - digits.size(), '0') + digits + ".png"));
  const CameraModel camera = loadCameraFile(sample / "camera.yaml");
  const StampedPose pose =
      readTrajectory(sample / "groundtruth.txt")[static_cast<std::size_t>(frame)];
  return pose.position +
         pose.orientation * (depth.at(x, y) / 100.0 * camera.unproject({x, y}).homogeneous());
}

/// A length of the tissue that is known from the truth, as --scale takes it.
std::vector<std::string> knownLength() {
  constexpr int frame = 360, ax = 220, ay = 200, bx = 420, by = 280;
  const double mm = (truthAt(frame, ax, ay) - truthAt(frame, bx, by)).norm();
  std::ostringstream text;
  text << mm << ' ' << ax << ',' << ay << ' ' << bx << ',' << by;
  return {"--scale", text.str(), "--scale-frame", std::to_string(frame)};
}

/// One replay that all tests look at.
class SampleReplay : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    result_ = replay(folder_->path() / "first", knownLength());
    if (result_.status == 0)
      metrics_ = nlohmann::json::parse(readFile(folder_->path() / "first" / "metrics.json"));
  }
  static void TearDownTestSuite() { folder_.reset(); }
  void SetUp() override { ASSERT_EQ(result_.status, 0) << result_.err; }

  static fs::path run() { return folder_->path() / "first"; }
  static inline std::unique_ptr<TemporaryFolder> folder_;
  static inline ProgramResult result_;
  static inline nlohmann::json metrics_;
};

TEST_F(SampleReplay, LeavesEveryFileOfTheContractAndNothingElse) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(run())) names.insert(entry.path().filename());
  EXPECT_EQ(names,
            (std::set<std::string>{"trajectory.txt", "trajectory_live.txt", "map.ply",
                                   "surface.ply", "overlay.mp4", "snapshot.png", "metrics.json"}));
}

TEST_F(SampleReplay, WarnsOfNothingButJumpsOfTheSurface) {
  std::istringstream lines(result_.err);
  for (std::string line; std::getline(lines, line);)
    EXPECT_TRUE(line.starts_with("surface jumps ")) << line;
}

TEST_F(SampleReplay, TracksAndReconstructsAsWellAsThePaper) {
  const Evaluation e = evaluateRun(sample, run());
  EXPECT_GE(e.trajectory.tracked_percent, 95);
  EXPECT_LE(e.trajectory.ate_rmse, 1.24);
  ASSERT_TRUE(e.surface);
  EXPECT_LE(e.surface->statistics.rms, 4.32);
}

TEST_F(SampleReplay, CountsWhatItDid) {
  EXPECT_EQ(metrics_["frames"], 450);
  EXPECT_GE(metrics_["tracked_frames"], 428);
  EXPECT_EQ(metrics_["track_ms"]["count"], 450);
  EXPECT_EQ(metrics_["composite_ms"]["count"], 450);
  EXPECT_GE(metrics_["reconstruct_ms"]["count"], 4);
  EXPECT_GT(metrics_["surface_triangles"], 1000);
}

TEST_F(SampleReplay, KnowsItsScaleFromAKnownLength) {
  const double truth = evaluateRun(sample, run()).trajectory.T_truth_estimate.scale;
  const double measured = metrics_["mm_per_unit"];
  EXPECT_NEAR(measured, truth, 0.03 * truth);
  EXPECT_LT(std::abs(measured - truth), 3 * metrics_["mm_per_unit_uncertainty"].get<double>());
  const std::string header = readFile(run() / "surface.ply").substr(0, 200);
  EXPECT_NE(header.find("in map units, scale: "), std::string::npos) << header;
}

TEST_F(SampleReplay, TheSurfaceHasTheColoursOfTheVideo) {
  const std::string ply = readFile(run() / "surface.ply");
  const std::size_t body = ply.find("end_header\n") + 11;
  EXPECT_NE(ply.substr(0, body).find("property uchar red\n"), std::string::npos);
  EXPECT_NE(ply.substr(0, body).find("property ushort observations\n"), std::string::npos);
  const std::string element = "element vertex ";
  const int vertices = std::stoi(ply.substr(ply.find(element) + element.size()));
  constexpr std::size_t stride = 33, color_at = 28;
  std::array<double, 3> mean{};
  int black = 0;
  for (int v = 0; v < vertices; ++v) {
    const char* color = ply.data() + body + static_cast<std::size_t>(v) * stride + color_at;
    for (std::size_t c = 0; c < 3; ++c) mean[c] += static_cast<std::uint8_t>(color[c]);
    black += color[0] == 0 && color[1] == 0 && color[2] == 0;
  }
  EXPECT_EQ(black, 0);
  // Liver, fat and bowel under a white light.
  EXPECT_GT(mean[0], 1.2 * mean[1]);
  EXPECT_GT(mean[0], 1.2 * mean[2]);
}

TEST_F(SampleReplay, AllocatesNothingOnceTheMapIsThere) {
  if (metrics_["steady_state_allocations"].is_null())
    GTEST_SKIP() << "sanitizers bring allocators of their own";
  EXPECT_EQ(metrics_["steady_state_allocations"], 0);
}

TEST_F(SampleReplay, TheVideoHasEveryFrameOfTheClip) {
  capture::FileSourceSettings settings;
  settings.path = run() / "overlay.mp4";
  const auto source = capture::openFileSource(settings);
  EXPECT_EQ(source->format().width, 640);
  EXPECT_EQ(source->format().height, 480);
  EXPECT_NEAR(source->fps(), 30, 0.001);
  int frames = 0;
  while (source->read(std::chrono::seconds(5)).status == capture::SourceStatus::Ok) ++frames;
  EXPECT_EQ(frames, 450);
}

TEST_F(SampleReplay, ASecondRunGivesTheSameBytesWhetherOrNotItDraws) {
  const fs::path second = folder_->path() / "second";
  std::vector<std::string> more = knownLength();
  more.push_back("--no-overlay");
  const ProgramResult result = replay(second, more);
  ASSERT_EQ(result.status, 0) << result.err;
  for (const char* name : {"trajectory.txt", "trajectory_live.txt", "surface.ply", "map.ply"})
    EXPECT_TRUE(readFile(run() / name) == readFile(second / name)) << name;
  EXPECT_FALSE(fs::exists(second / "overlay.mp4"));
  EXPECT_FALSE(fs::exists(second / "snapshot.png"));
}

TEST_F(SampleReplay, RealTimeRunsToTheEnd) {
  const fs::path out = folder_->path() / "realtime";
  const ProgramResult result = replay(out, {"--realtime", "--no-surface"});
  ASSERT_EQ(result.status, 0) << result.err;
  const auto metrics = nlohmann::json::parse(readFile(out / "metrics.json"));
  EXPECT_EQ(metrics["frames"], 450);
  // How many a busy machine drops is its own affair; what is tracked must be counted.
  EXPECT_EQ(metrics["track_ms"]["count"].get<int>() + metrics["dropped_frames"].get<int>(), 450);
  EXPECT_FALSE(fs::exists(out / "surface.ply"));
}

}  // namespace
}  // namespace depthscope::platform
