#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "platform/evaluate/evaluate_command.hpp"
#include "platform/evaluate/evaluation.hpp"
#include "platform/surface_writer.hpp"
#include "recon/mesh_geometry.hpp"
#include "recon/mesh_io.hpp"
#include "types/error.hpp"

namespace depthscope::platform {
namespace {

namespace fs = std::filesystem;

/// A camera that flies an arc over a plane of 130 x 130 mm at z = 100, looking along +z.
std::vector<StampedPose> arc(std::size_t frames) {
  std::vector<StampedPose> out;
  for (std::size_t i = 0; i < frames; ++i) {
    const double a = 0.05 * static_cast<double>(i);
    out.push_back({static_cast<double>(i) / 30,
                   {30 * std::cos(a), 30 * std::sin(a), 5 * std::sin(2 * a)},
                   Eigen::Quaterniond(Eigen::AngleAxisd(0.1 * a, Eigen::Vector3d::UnitX()))});
  }
  return out;
}

/// A similarity of the kind a monocular map differs by.
Similarity someSimilarity() {
  Similarity s;
  s.scale = 0.02;
  s.R = Eigen::AngleAxisd(2.1, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
  s.t = {1, 2, -3};
  return s;
}

std::vector<StampedPose> transformed(std::vector<StampedPose> poses, const Similarity& s) {
  for (auto& p : poses) {
    p.position = s * p.position;
    p.orientation = Eigen::Quaterniond(s.R) * p.orientation;
  }
  return poses;
}

SurfaceMesh plane(float half_mm, float z, int cells) {
  SurfaceMesh mesh;
  const auto n = static_cast<std::uint32_t>(cells);
  const float step = 2 * half_mm / static_cast<float>(cells);
  for (std::uint32_t i = 0; i <= n; ++i)
    for (std::uint32_t j = 0; j <= n; ++j)
      mesh.vertices.emplace_back(-half_mm + step * static_cast<float>(i),
                                 -half_mm + step * static_cast<float>(j), z);
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < n; ++j) {
      const std::uint32_t a = i * (n + 1) + j, b = a + n + 1;
      mesh.triangles.push_back({a, b + 1, b});  // faces the camera, towards -z
      mesh.triangles.push_back({a, a + 1, b + 1});
    }
  mesh.confidence.assign(mesh.vertices.size(), 1.f);
  recon::computeNormals(mesh);
  return mesh;
}

void write(const fs::path& path, const std::vector<StampedPose>& poses) {
  std::ofstream out(path);
  out.precision(12);
  for (const auto& p : poses)
    out << p.timestamp_s << ' ' << p.position.x() << ' ' << p.position.y() << ' ' << p.position.z()
        << ' ' << p.orientation.x() << ' ' << p.orientation.y() << ' ' << p.orientation.z() << ' '
        << p.orientation.w() << '\n';
}

TEST(AlignSimilarity, FindsTheSimilarityAgain) {
  const Similarity truth = someSimilarity();
  std::vector<Eigen::Vector3d> from, to;
  for (const auto& p : arc(40)) {
    from.push_back(p.position);
    to.push_back(truth * p.position);
  }
  const Similarity found = alignSimilarity(from, to);
  EXPECT_NEAR(found.scale, truth.scale, 1e-12);
  EXPECT_TRUE(found.R.isApprox(truth.R, 1e-9));
  EXPECT_TRUE(found.t.isApprox(truth.t, 1e-9));
}

TEST(AlignSimilarity, NeverMirrors) {
  std::vector<Eigen::Vector3d> from, to;
  for (const auto& p : arc(40)) {
    from.push_back(p.position);
    to.emplace_back(p.position.x(), p.position.y(), -p.position.z());
  }
  EXPECT_NEAR(alignSimilarity(from, to).R.determinant(), 1, 1e-9);
}

TEST(CompareTrajectories, IsZeroForTheTruthInAnotherFrameAndScale) {
  const auto truth = arc(60);
  const TrajectoryError e = compareTrajectories(truth, transformed(truth, someSimilarity()));
  EXPECT_NEAR(e.ate_rmse, 0, 1e-9);
  EXPECT_NEAR(e.rotation_rmse_deg, 0, 1e-5);
  EXPECT_EQ(e.tracked_percent, 100);
}

TEST(CompareTrajectories, MeasuresAKnownError) {
  const auto truth = arc(126);  // once around
  auto estimate = truth;
  for (std::size_t i = 0; i < estimate.size(); ++i)
    estimate[i].position.z() += i % 2 ? 0.5 : -0.5;  // no similarity takes that away
  EXPECT_NEAR(compareTrajectories(truth, estimate).ate_rmse, 0.5, 0.01);
}

TEST(CompareTrajectories, CountsFramesThatWereNotTracked) {
  const auto truth = arc(100);
  auto estimate = truth;
  estimate.erase(estimate.begin(), estimate.begin() + 20);
  estimate[3].position.x() = std::nan("");
  estimate[4].timestamp_s += 0.015;  // half way between two frames
  const TrajectoryError e = compareTrajectories(truth, estimate);
  EXPECT_NEAR(e.tracked_percent, 78, 1e-9);
  EXPECT_EQ(e.truth_index.front(), 20u);
}

TEST(CompareTrajectories, SaysWhenThereIsTooLittleToAlign) {
  const auto truth = arc(100);
  EXPECT_TRUE(compareTrajectories(truth, std::vector(truth.begin(), truth.begin() + 9)).empty());
  EXPECT_TRUE(compareTrajectories(truth, {}).empty());
}

TEST(SampleSurface, SpreadsPointsByArea) {
  const SurfaceSamples s = sampleSurface(plane(100, 0, 3), 9000);
  EXPECT_NEAR(static_cast<double>(s.points.size()), 9000, 1);
  int quadrant = 0;
  for (const auto& p : s.points) quadrant += p.x() > 0 && p.y() > 0;
  EXPECT_NEAR(quadrant, 2250, 100);
}

TEST(TrueSurfaceDistance, IsSignedAndExactOverAPlane) {
  const TrueSurface surface(plane(50, 100, 10));
  EXPECT_NEAR(surface.distance({3, 4, 98}), 2, 1e-4);              // in front, where the camera is
  EXPECT_NEAR(surface.distance({3, 4, 103}), -3, 1e-4);            // behind
  EXPECT_NEAR(std::abs(surface.distance({60, 0, 100})), 10, 0.8);  // beside the edge
}

TEST(Summarize, TakesPercentilesOfTheAbsoluteValues) {
  std::vector<float> d;
  for (int i = 0; i <= 100; ++i) d.push_back(static_cast<float>(i % 2 ? -i : i) * 0.1f);
  const DistanceStatistics s = summarize(d);
  EXPECT_NEAR(s.median, 5, 1e-5);
  EXPECT_NEAR(s.p95, 9.5, 1e-5);
  EXPECT_NEAR(s.over_5mm_percent, 100. * 50 / 101, 1e-9);
}

void writePly(const fs::path& path, const SurfaceMesh& mesh) {
  std::ofstream out(path, std::ios::binary);
  writeSurface(out, mesh, SurfaceFormat::Ply);
}

/// A sequence and a run of it on disk.
class EvaluateRun : public testing::Test {
 protected:
  void SetUp() override {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    dir_ = fs::path(testing::TempDir()) / (std::string("depthscope_evaluate_") + test->name());
    fs::remove_all(dir_);
    fs::create_directories(dir_ / "sequence" / "depth");
    fs::create_directories(dir_ / "run");
    const auto truth = arc(60);
    write(dir_ / "sequence" / "groundtruth.txt", truth);
    writePly(dir_ / "sequence" / "scene.ply", plane(65, 100, 16));
    std::ofstream(dir_ / "sequence" / "camera.yaml")
        << "%YAML:1.0\n---\nimage_width: 160\nimage_height: 120\nfps: 30\ncamera_model: "
           "pinhole\nfx: 300\n"
           "fy: 300\ncx: 79.5\ncy: 59.5\nk1: 0\nk2: 0\np1: 0\np2: 0\n";
    // Frame 0 looks straight at the plane from z = 0.
    cv::imwrite((dir_ / "sequence" / "depth" / "000000.png").string(),
                cv::Mat(120, 160, CV_16UC1, cv::Scalar(10000)));
    const Similarity s = someSimilarity();
    write(dir_ / "run" / "trajectory.txt", transformed(truth, s));
    SurfaceMesh surface = plane(60, 101.5f, 12);  // 1.5 mm behind the truth
    for (auto& v : surface.vertices) v = (s * v.cast<double>()).cast<float>();
    writePly(dir_ / "run" / "surface.ply", surface);
  }
  void TearDown() override { fs::remove_all(dir_); }

  fs::path dir_;
};

TEST_F(EvaluateRun, MeasuresAKnownSurfaceErrorInMillimetres) {
  const Evaluation e = evaluateRun(dir_ / "sequence", dir_ / "run");
  ASSERT_TRUE(e.surface.has_value());
  EXPECT_NEAR(e.surface->statistics.rms, 1.5, 0.01);
  EXPECT_NEAR(e.surface->statistics.median, 1.5, 0.01);
  EXPECT_LT(e.surface->distance[0], 0);  // behind
  EXPECT_NEAR(e.surface->area_mm2, 120 * 120, 5);
  ASSERT_TRUE(e.surface->has_completeness);
  EXPECT_GT(e.surface->complete_percent[0], 99);  // 1.5 mm away: within 2 mm
}

TEST_F(EvaluateRun, ReadsASurfaceAsItWasWritten) {
  const SurfaceMesh mesh = plane(60, 100, 5);
  writePly(dir_ / "plane.ply", mesh);
  const SurfaceMesh back = recon::readPly(dir_ / "plane.ply");
  EXPECT_EQ(back.vertices, mesh.vertices);
  EXPECT_EQ(back.normals, mesh.normals);
  EXPECT_EQ(back.confidence, mesh.confidence);
  EXPECT_EQ(back.triangles, mesh.triangles);
}

TEST_F(EvaluateRun, DoesWithoutASurface) {
  fs::remove(dir_ / "run" / "surface.ply");
  const Evaluation e = evaluateRun(dir_ / "sequence", dir_ / "run");
  EXPECT_FALSE(e.surface.has_value());
  EXPECT_NEAR(e.trajectory.ate_rmse, 0, 1e-6);
}

TEST_F(EvaluateRun, JudgesThePosesAsTheyWereShownToo) {
  EXPECT_FALSE(evaluateRun(dir_ / "sequence", dir_ / "run").live.has_value());
  fs::copy(dir_ / "run" / "trajectory.txt", dir_ / "run" / "trajectory_live.txt");
  const Evaluation e = evaluateRun(dir_ / "sequence", dir_ / "run");
  ASSERT_TRUE(e.live.has_value());
  EXPECT_NEAR(e.live->ate_rmse, 0, 1e-6);
}

TEST_F(EvaluateRun, DrawsFourPictures) {
  testing::internal::CaptureStdout();
  EXPECT_EQ(evaluateCommand(Arguments({(dir_ / "sequence").string(), (dir_ / "run").string(),
                                       "--json", "--plots", (dir_ / "plots").string()})),
            0);
  EXPECT_THAT(testing::internal::GetCapturedStdout(), testing::HasSubstr("\"surface_rms_mm\""));
  for (const char* name :
       {"trajectory_3d", "trajectory_axes", "surface_distance", "surface_histogram"}) {
    const cv::Mat picture = cv::imread((dir_ / "plots" / (std::string(name) + ".png")).string());
    ASSERT_FALSE(picture.empty()) << name;
    EXPECT_GT(
        cv::norm(picture, cv::Mat(picture.size(), CV_8UC3, cv::Scalar::all(255)), cv::NORM_L1), 0)
        << name;
  }
}

TEST_F(EvaluateRun, NamesTheFileThatIsMissingOrDamaged) {
  const auto error = [&] {
    try {
      evaluateRun(dir_ / "sequence", dir_ / "run");
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string("no error");
  };
  std::ofstream(dir_ / "run" / "trajectory.txt") << "# comment\n0.1 1 2 3\n";
  EXPECT_THAT(error(), testing::HasSubstr("trajectory.txt:2"));
  fs::remove(dir_ / "run" / "trajectory.txt");
  EXPECT_THAT(error(), testing::HasSubstr("trajectory.txt"));
  fs::remove(dir_ / "sequence" / "groundtruth.txt");
  EXPECT_THAT(error(), testing::HasSubstr("groundtruth.txt"));
}

}  // namespace
}  // namespace depthscope::platform
