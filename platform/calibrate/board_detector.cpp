#include "platform/calibrate/board_detector.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

namespace depthscope::platform {
namespace {

constexpr int kMinCharucoCorners = 8;  // fewer say too little about a view
constexpr float kMaxRefineWindow_px = 11;
constexpr float kWindowShareOfSquare = 0.3f;  // a larger window would reach the neighbouring corner

/// The smallest distance between neighbouring corners of a full grid.
float smallestStep(const std::vector<cv::Point2f>& corners, cv::Size size) {
  float smallest = 1e9f;
  const auto at = [&](int x, int y) {
    return corners[static_cast<std::size_t>(y * size.width + x)];
  };
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      if (x > 0)
        smallest = std::min(smallest, static_cast<float>(cv::norm(at(x, y) - at(x - 1, y))));
      if (y > 0)
        smallest = std::min(smallest, static_cast<float>(cv::norm(at(x, y) - at(x, y - 1))));
    }
  return smallest;
}

}  // namespace

BoardDetector::BoardDetector(const BoardDescription& board) : board_(board) {
  if (board.pattern == BoardDescription::Pattern::Charuco)
    charuco_ = cv::aruco::CharucoBoard::create(
        board.size.width, board.size.height, board.square_mm, board.marker_mm,
        cv::aruco::getPredefinedDictionary(board.dictionary));
}

bool BoardDetector::detect(const cv::Mat& grey, BoardView& view, std::string& reason) const {
  view.image.clear();
  view.board.clear();
  return charuco_ ? detectCharuco(grey, view, reason) : detectChessboard(grey, view, reason);
}

bool BoardDetector::detectChessboard(const cv::Mat& grey, BoardView& view,
                                     std::string& reason) const {
  constexpr int kFlags = cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE;
  if (cv::findChessboardCorners(grey, board_.size, view.image, kFlags | cv::CALIB_CB_FAST_CHECK) ||
      cv::findChessboardCorners(grey, board_.size, view.image, kFlags)) {
    const int window = static_cast<int>(std::clamp(
        kWindowShareOfSquare * smallestStep(view.image, board_.size), 2.f, kMaxRefineWindow_px));
    cv::cornerSubPix(grey, view.image, {window, window}, {-1, -1},
                     {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 50, 1e-3});
  } else if (!cv::findChessboardCornersSB(grey, board_.size, view.image, cv::CALIB_CB_ACCURACY)) {
    // The second finder is slower, takes blur and noise better, and is as fine by itself.
    reason = "no chessboard of " + std::to_string(board_.size.width) + "x" +
             std::to_string(board_.size.height) + " inner corners found";
    return false;
  }
  for (int y = 0; y < board_.size.height; ++y)
    for (int x = 0; x < board_.size.width; ++x)
      view.board.emplace_back(static_cast<float>(x) * board_.square_mm,
                              static_cast<float>(y) * board_.square_mm, 0.f);
  return true;
}

bool BoardDetector::detectCharuco(const cv::Mat& grey, BoardView& view, std::string& reason) const {
  std::vector<int> marker_ids, corner_ids;
  std::vector<std::vector<cv::Point2f>> markers;
  cv::aruco::detectMarkers(grey, charuco_->dictionary, markers, marker_ids);
  if (marker_ids.empty()) {
    reason = "no marker of the board's dictionary found";
    return false;
  }
  cv::aruco::interpolateCornersCharuco(markers, marker_ids, grey, charuco_, view.image, corner_ids);
  if (static_cast<int>(corner_ids.size()) < kMinCharucoCorners) {
    reason = "only " + std::to_string(corner_ids.size()) +
             " corners of the board found, at least " + std::to_string(kMinCharucoCorners) +
             " are needed";
    return false;
  }
  for (int id : corner_ids)
    view.board.push_back(charuco_->chessboardCorners[static_cast<std::size_t>(id)]);
  if (cv::aruco::testCharucoCornersCollinear(charuco_, corner_ids)) {
    reason = "the corners found lie on one line";
    return false;
  }
  return true;
}

}  // namespace depthscope::platform
