#include "platform/calibrate/calibrate_command.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

#include "platform/calibrate/board_detector.hpp"
#include "platform/calibrate/camera_writer.hpp"
#include "platform/calibrate/lens_fit.hpp"
#include "platform/calibrate/picture_source.hpp"
#include "types/error.hpp"

namespace depthscope::platform {
namespace {

constexpr const char* kHelp =
    R"(depthscope calibrate - make the camera file from pictures of a board

USAGE
  depthscope calibrate --pattern chessboard|charuco --size COLSxROWS --square MM --input PATH --out FILE

OPTIONS
  --pattern P      chessboard or charuco
  --size CxR       inner corners of a chessboard, squares of a ChArUco board
  --square MM      side of a square
  --input PATH     a folder of pictures (png, jpg), or a video
  --out FILE       the camera file to write
  --model M        pinhole (default) or fisheye (for lenses wider than about 120 degrees)
  --k3             pinhole: fit the third radial coefficient too
  --fps N          frames per second to write (default: the video's; left out for pictures)
  --interval S     video: take a picture every S seconds (default 0.5)
  --marker MM      charuco: side of a marker (default 0.75 of the square)
  --dictionary D   charuco: 4x4, 5x5 (default), 6x6, 7x7 or original

Fill the picture with the board in ten to thirty views: each corner of the picture covered, the board tilted by up
to 45 degrees this way and that, focus and zoom as in use.
)";

double positiveNumber(const std::string& text, const char* option) {
  try {
    std::size_t used = 0;
    const double value = std::stod(text, &used);
    if (used == text.size() && std::isfinite(value) && value > 0) return value;
  } catch (const std::exception&) {
  }
  throw InputError(std::string(option) + " " + text + ": expected a positive number");
}

cv::Size parseSize(const std::string& text) {
  int columns = 0, rows = 0, used = 0;
  const int fields = std::sscanf(text.c_str(), "%3dx%3d%n", &columns, &rows, &used);
  if (fields != 2 || used != static_cast<int>(text.size()) || columns < 3 || rows < 3)
    throw InputError("--size " + text + ": expected COLSxROWS, at least 3x3, as 9x6");
  return {columns, rows};
}

int parseDictionary(const std::string& text) {
  constexpr std::array<std::pair<const char*, int>, 5> kKnown = {
      {{"4x4", cv::aruco::DICT_4X4_1000},
       {"5x5", cv::aruco::DICT_5X5_1000},
       {"6x6", cv::aruco::DICT_6X6_1000},
       {"7x7", cv::aruco::DICT_7X7_1000},
       {"original", cv::aruco::DICT_ARUCO_ORIGINAL}}};
  for (const auto& [name, id] : kKnown)
    if (text == name) return id;
  throw InputError("--dictionary " + text + ": expected 4x4, 5x5, 6x6, 7x7 or original");
}

BoardDescription parseBoard(Arguments& arguments) {
  BoardDescription board;
  const std::string pattern = arguments.required("--pattern");
  if (pattern == "charuco")
    board.pattern = BoardDescription::Pattern::Charuco;
  else if (pattern != "chessboard")
    throw InputError("--pattern " + pattern + ": expected chessboard or charuco");
  board.size = parseSize(arguments.required("--size"));
  board.square_mm = static_cast<float>(positiveNumber(arguments.required("--square"), "--square"));
  board.marker_mm = 0.75f * board.square_mm;
  if (const auto marker = arguments.value("--marker"))
    board.marker_mm = static_cast<float>(positiveNumber(*marker, "--marker"));
  if (board.marker_mm >= board.square_mm) throw InputError("--marker: expected less than --square");
  if (const auto dictionary = arguments.value("--dictionary"))
    board.dictionary = parseDictionary(*dictionary);
  return board;
}

CameraModel::Kind parseModel(const std::string& text) {
  if (text == "pinhole") return CameraModel::Kind::Pinhole;
  if (text == "fisheye") return CameraModel::Kind::Fisheye;
  throw InputError("--model " + text + ": expected pinhole or fisheye");
}

/// A lens is only known where corners were seen.
void warnOfPoorCoverage(const std::vector<BoardView>& views, cv::Size size) {
  constexpr float kWanted = 0.7f;
  float left = 1e9f, right = 0, top = 1e9f, bottom = 0;
  for (const auto& v : views)
    for (const auto& p : v.image) {
      left = std::min(left, p.x);
      right = std::max(right, p.x);
      top = std::min(top, p.y);
      bottom = std::max(bottom, p.y);
    }
  const float across = (right - left) / static_cast<float>(size.width);
  const float down = (bottom - top) / static_cast<float>(size.height);
  if (across < kWanted || down < kWanted)
    std::printf(
        "warning: corners cover %.0f %% of the width and %.0f %% of the height; the lens is a "
        "guess beyond\n",
        100.0 * across, 100.0 * down);
}

void report(const LensFit& fit, std::size_t pictures, const std::string& out) {
  for (const auto& l : fit.left_out)
    std::printf("left out  %s: %s\n", l.picture.c_str(), l.reason.c_str());
  for (std::size_t i = 0; i < fit.used.size(); ++i)
    std::printf("used      %s: %.3f px\n", fit.used[i].c_str(), fit.view_rms_px[i]);
  const CameraModel& c = fit.camera;
  std::printf("RMS reprojection error %.4f px over %zu of %zu pictures\n", fit.rms_px,
              fit.used.size(), pictures);
  std::printf("fx %.3f  fy %.3f  cx %.3f  cy %.3f  distortion %.5f %.5f %.6f %.6f %.5f\n", c.fx,
              c.fy, c.cx, c.cy, c.k[0], c.k[1], c.k[2], c.k[3], c.k[4]);
  std::printf("wrote %s\n", out.c_str());
}

}  // namespace

int calibrateCommand(Arguments arguments) {
  if (arguments.flag("--help")) return std::fputs(kHelp, stdout), 0;
  const BoardDescription board = parseBoard(arguments);
  const std::string input = arguments.required("--input"), out = arguments.required("--out");
  LensFitSettings settings;
  settings.model = parseModel(arguments.value("--model").value_or("pinhole"));
  settings.with_k3 = arguments.flag("--k3");
  const auto fps = arguments.value("--fps");
  const double interval_s =
      positiveNumber(arguments.value("--interval").value_or("0.5"), "--interval");
  arguments.finish();

  const BoardDetector detector(board);
  std::vector<BoardView> views;
  std::vector<LeftOut> without_board;
  const PictureSummary pictures =
      forEachPicture(input, interval_s, [&](const std::string& name, const cv::Mat& grey) {
        BoardView view;
        view.picture = name;
        std::string reason;
        if (detector.detect(grey, view, reason))
          views.push_back(std::move(view));
        else
          without_board.push_back({name, reason});
      });

  LensFit fit = fitLens(views, pictures.size, settings);
  fit.left_out.insert(fit.left_out.begin(), without_board.begin(), without_board.end());
  fit.camera.fps = fps ? positiveNumber(*fps, "--fps") : pictures.fps;
  saveCameraFile(out, fit.camera);
  report(fit, static_cast<std::size_t>(pictures.count), out);
  warnOfPoorCoverage(views, pictures.size);
  return 0;
}

}  // namespace depthscope::platform
