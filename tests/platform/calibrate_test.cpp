#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "platform/calibrate/board_detector.hpp"
#include "platform/calibrate/calibrate_command.hpp"
#include "platform/calibrate/camera_writer.hpp"
#include "platform/calibrate/lens_fit.hpp"
#include "platform/camera_file.hpp"
#include "types/error.hpp"
#include "types/pose.hpp"

namespace depthscope::platform {
namespace {

namespace fs = std::filesystem;

CameraModel knownCamera(CameraModel::Kind kind = CameraModel::Kind::Pinhole) {
  CameraModel c;
  c.kind = kind;
  c.width = 640;
  c.height = 480;
  c.fx = 520;
  c.fy = 524;
  c.cx = 326;
  c.cy = 233;
  c.k = kind == CameraModel::Kind::Pinhole ? std::array<double, 5>{-0.25, 0.08, 0.001, -0.0005, 0}
                                           : std::array<double, 5>{0.03, -0.01, 0.002, 0, 0};
  return c;
}

/// Camera poses around a board whose middle is `centre_mm`: tilted this way and that, shifted over
/// the picture.
Pose boardPose(int i, const Eigen::Vector3d& centre_mm) {
  const double tilt = 0.2 + 0.1 * (i % 5), direction = 2.4 * i;
  const Eigen::Matrix3d R =
      expSO3(Eigen::Vector3d(std::cos(direction), std::sin(direction), 0.1 * (i % 3 - 1)) * tilt);
  const Eigen::Vector3d at(16 * (i % 4 - 1.5), 18. * (i / 4 % 3 - 1), 150 + 8. * (i % 5));
  return {R, at - R * centre_mm};
}

/// Exact projections of the inner corners of a board.
BoardView projectedView(const CameraModel& camera, int i, cv::Size corners = {9, 6},
                        float square_mm = 10) {
  BoardView view;
  view.picture = "view " + std::to_string(i);
  const Pose T_camera_board = boardPose(
      i, {0.5 * square_mm * (corners.width - 1), 0.5 * square_mm * (corners.height - 1), 0});
  for (int y = 0; y < corners.height; ++y)
    for (int x = 0; x < corners.width; ++x) {
      view.board.emplace_back(static_cast<float>(x) * square_mm, static_cast<float>(y) * square_mm,
                              0.f);
      const Eigen::Vector2d p =
          camera.project(T_camera_board * Eigen::Vector3d(x * square_mm, y * square_mm, 0));
      view.image.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()));
    }
  return view;
}

/// Takes pictures of a flat texture, each pixel the mean of 2 x 2 rays through it.
class Renderer {
 public:
  explicit Renderer(const CameraModel& camera) : camera_(camera) {
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x)
        for (double dy : {-0.25, 0.25})
          for (double dx : {-0.25, 0.25})
            rays_.push_back(camera.unproject({x + dx, y + dy}).homogeneous());
  }
  /// The texture has `per_mm` pixels each mm, its top left corner at the board's origin.
  cv::Mat operator()(const cv::Mat& texture, double per_mm, const Pose& T_camera_board) const {
    const Pose T_board_camera = T_camera_board.inverse();
    cv::Mat picture(camera_.height, camera_.width, CV_8UC1);
    for (std::size_t i = 0; i < rays_.size() / 4; ++i) {
      int sum = 0;
      for (std::size_t k = 0; k < 4; ++k) {
        const Eigen::Vector3d ray = T_board_camera.R * rays_[4 * i + k];
        const Eigen::Vector3d hit = T_board_camera.t - ray * (T_board_camera.t.z() / ray.z());
        const int u = static_cast<int>(std::floor(hit.x() * per_mm));
        const int v = static_cast<int>(std::floor(hit.y() * per_mm));
        const bool on = u >= 0 && v >= 0 && u < texture.cols && v < texture.rows;
        sum += on ? texture.at<std::uint8_t>(v, u) : 200;
      }
      picture.data[i] = static_cast<std::uint8_t>(sum / 4);
    }
    return picture;
  }

 private:
  CameraModel camera_;
  std::vector<Eigen::Vector3d> rays_;  // z = 1, camera frame, four each pixel
};

/// A chessboard of `squares`, 10 px a square, with a white rim of one square.
cv::Mat chessboardTexture(cv::Size squares) {
  constexpr int kSquare = 10;
  cv::Mat texture((squares.height + 2) * kSquare, (squares.width + 2) * kSquare, CV_8UC1,
                  cv::Scalar(230));
  for (int y = 0; y < squares.height; ++y)
    for (int x = 0; x < squares.width; ++x)
      if ((x + y) % 2 == 0)
        texture(cv::Rect((x + 1) * kSquare, (y + 1) * kSquare, kSquare, kSquare)).setTo(25);
  return texture;
}

void expectSameLens(const CameraModel& found, const CameraModel& truth, double tolerance_px) {
  EXPECT_NEAR(found.fx, truth.fx, tolerance_px);
  EXPECT_NEAR(found.fy, truth.fy, tolerance_px);
  EXPECT_NEAR(found.cx, truth.cx, tolerance_px);
  EXPECT_NEAR(found.cy, truth.cy, tolerance_px);
  for (double x : {-0.4, 0.0, 0.35})
    for (double y : {-0.3, 0.25}) {
      const Eigen::Vector3d p(x, y, 1);
      EXPECT_LT((found.project(p) - truth.project(p)).norm(), tolerance_px) << x << ' ' << y;
    }
}

std::vector<BoardView> manyViews(const CameraModel& camera) {
  std::vector<BoardView> views;
  for (int i = 0; i < 12; ++i) views.push_back(projectedView(camera, i));
  return views;
}

TEST(FitLens, FindsAKnownPinholeLens) {
  const LensFit fit = fitLens(manyViews(knownCamera()), {640, 480}, {});
  expectSameLens(fit.camera, knownCamera(), 0.05);
  EXPECT_LT(fit.rms_px, 1e-3);
  EXPECT_EQ(fit.used.size(), 12u);
}

TEST(FitLens, FindsAKnownFisheyeLens) {
  const CameraModel truth = knownCamera(CameraModel::Kind::Fisheye);
  LensFitSettings settings;
  settings.model = CameraModel::Kind::Fisheye;
  const LensFit fit = fitLens(manyViews(truth), {640, 480}, settings);
  EXPECT_EQ(fit.camera.kind, CameraModel::Kind::Fisheye);
  expectSameLens(fit.camera, truth, 0.2);
}

TEST(FitLens, LeavesOutAViewThatDisagreesAndSaysWhy) {
  auto views = manyViews(knownCamera());
  for (std::size_t i = 0; i < views[4].image.size(); ++i) views[4].image[i].x += i % 2 ? 6.f : -6.f;
  const LensFit fit = fitLens(views, {640, 480}, {});
  ASSERT_EQ(fit.left_out.size(), 1u);
  EXPECT_EQ(fit.left_out[0].picture, "view 4");
  EXPECT_THAT(fit.left_out[0].reason, testing::HasSubstr("reprojection error"));
  expectSameLens(fit.camera, knownCamera(), 0.05);
}

TEST(FitLens, LeavesOutViewsThatRepeatOthers) {
  auto views = manyViews(knownCamera());
  for (int i = 0; i < 5; ++i) views.push_back(views[2]);
  const LensFit fit = fitLens(views, {640, 480}, {});
  EXPECT_EQ(fit.used.size(), 12u);
  EXPECT_EQ(fit.left_out.size(), 5u);
}

TEST(FitLens, TakesTheMostDifferentViewsWhenThereAreMany) {
  LensFitSettings settings;
  settings.max_views = 8;
  const LensFit fit = fitLens(manyViews(knownCamera()), {640, 480}, settings);
  EXPECT_EQ(fit.used.size(), 8u);
  expectSameLens(fit.camera, knownCamera(), 0.1);
}

TEST(FitLens, RefusesTooFewViews) {
  auto views = manyViews(knownCamera());
  views.resize(2);
  EXPECT_THROW(fitLens(views, {640, 480}, {}), InputError);
  EXPECT_THROW(fitLens({}, {640, 480}, {}), InputError);
}

TEST(SaveCameraFile, WritesWhatTheLoaderReadsBackExactly) {
  const fs::path file = fs::path(testing::TempDir()) / "depthscope_saved_camera.yaml";
  for (auto kind : {CameraModel::Kind::Pinhole, CameraModel::Kind::Fisheye}) {
    CameraModel camera = knownCamera(kind);
    camera.fx = 520.1234567890123;
    camera.fps = 29.97;
    if (kind == CameraModel::Kind::Pinhole) camera.k[4] = -0.0123;
    saveCameraFile(file, camera);
    std::ifstream in(file);
    std::string first;
    std::getline(in, first);
    EXPECT_EQ(first, "%YAML:1.0");
    const CameraModel read = loadCameraFile(file);
    EXPECT_EQ(read.kind, camera.kind);
    EXPECT_EQ(read.width, camera.width);
    EXPECT_EQ(read.fps, camera.fps);
    EXPECT_EQ(read.fx, camera.fx);
    EXPECT_EQ(read.cy, camera.cy);
    EXPECT_EQ(read.k, camera.k);
  }
  fs::remove(file);
  EXPECT_THROW(
      saveCameraFile(fs::path(testing::TempDir()) / "no_such_folder" / "c.yaml", knownCamera()),
      InputError);
}

/// A folder of rendered pictures.
class Calibrate : public testing::Test {
 protected:
  void SetUp() override {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    dir_ = fs::path(testing::TempDir()) / (std::string("depthscope_calibrate_") + test->name());
    fs::remove_all(dir_);
    fs::create_directories(dir_ / "pictures");
  }
  void TearDown() override { fs::remove_all(dir_); }

  void save(int i, const cv::Mat& picture) const {
    cv::imwrite((dir_ / "pictures" / (std::to_string(100 + i) + ".png")).string(), picture);
  }
  int run(const std::string& pattern, const std::string& size, std::string& output) const {
    testing::internal::CaptureStdout();
    const int status = calibrateCommand(
        Arguments({"--pattern", pattern, "--size", size, "--square", "10", "--input",
                   (dir_ / "pictures").string(), "--out", (dir_ / "camera.yaml").string()}));
    output = testing::internal::GetCapturedStdout();
    return status;
  }

  fs::path dir_;
};

TEST_F(Calibrate, FindsTheLensFromPicturesOfAChessboard) {
  const CameraModel truth = knownCamera();
  const Renderer render(truth);
  const cv::Mat texture = chessboardTexture({10, 7});
  for (int i = 0; i < 12; ++i) save(i, render(texture, 1, boardPose(i, {60, 45, 0})));
  save(20, cv::Mat(480, 640, CV_8UC1, cv::Scalar(128)));
  std::string output;
  ASSERT_EQ(run("chessboard", "9x6", output), 0);
  EXPECT_THAT(output, testing::HasSubstr("left out  120.png: no chessboard of 9x6"));
  EXPECT_THAT(output, testing::HasSubstr("over 12 of 13 pictures"));
  expectSameLens(loadCameraFile(dir_ / "camera.yaml"), truth, 2.5);
}

TEST_F(Calibrate, FindsTheLensFromPicturesOfACharucoBoardPartlyOutside) {
  const CameraModel truth = knownCamera();
  const Renderer render(truth);
  constexpr int kPerMm = 8;
  const auto board = cv::aruco::CharucoBoard::create(
      9, 7, 10, 7.5, cv::aruco::getPredefinedDictionary(cv::aruco::DICT_5X5_1000));
  cv::Mat texture;
  board->draw({9 * 10 * kPerMm, 7 * 10 * kPerMm}, texture, 0, 1);
  cv::blur(texture, texture, {kPerMm / 2, kPerMm / 2});  // the texture is finer than the picture
  for (int i = 0; i < 12; ++i) {
    Pose pose = boardPose(i, {45, 35, 0});
    pose.t.x() += i % 2 ? 45 : -45;  // partly outside of the picture
    pose.t.z() -= 20;
    save(i, render(texture, kPerMm, pose));
  }
  std::string output;
  ASSERT_EQ(run("charuco", "9x7", output), 0);
  expectSameLens(loadCameraFile(dir_ / "camera.yaml"), truth, 3);
}

TEST_F(Calibrate, NamesWhatIsWrongAndWritesNothing) {
  const auto error = [&](std::vector<std::string> words) {
    try {
      calibrateCommand(Arguments(std::move(words)));
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string("no error");
  };
  const std::string out = (dir_ / "camera.yaml").string(), in = (dir_ / "pictures").string();
  using testing::HasSubstr;
  EXPECT_THAT(error({}), HasSubstr("--pattern"));
  EXPECT_THAT(error({"--pattern", "dots"}), HasSubstr("chessboard or charuco"));
  EXPECT_THAT(error({"--pattern", "chessboard", "--size", "9by6"}), HasSubstr("COLSxROWS"));
  EXPECT_THAT(error({"--pattern", "chessboard", "--size", "9x6", "--square", "-1"}),
              HasSubstr("--square"));
  const std::vector<std::string> good = {"--pattern", "chessboard", "--size", "9x6",    "--square",
                                         "10",        "--out",      out,      "--input"};
  const auto with = [&](const std::string& input) {
    auto words = good;
    words.push_back(input);
    return error(words);
  };
  EXPECT_THAT(with((dir_ / "nowhere").string()), HasSubstr("no such file"));
  EXPECT_THAT(with(in), HasSubstr("no pictures"));
  std::ofstream(dir_ / "pictures" / "a.png") << "not a picture";
  EXPECT_THAT(with(in), HasSubstr("a.png"));
  EXPECT_THAT(with((dir_ / "pictures" / "a.png").string()), HasSubstr("a.png"));
  EXPECT_FALSE(fs::exists(out));
}

}  // namespace
}  // namespace depthscope::platform
