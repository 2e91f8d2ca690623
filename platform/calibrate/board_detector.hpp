#pragma once
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace depthscope::platform {

/// The board that was filmed.
struct BoardDescription {
  enum class Pattern { Chessboard, Charuco };
  Pattern pattern = Pattern::Chessboard;
  cv::Size size;                              // chessboard: inner corners; ChArUco: squares
  float square_mm = 0;                        // side of a square
  float marker_mm = 0;                        // ChArUco: side of a marker
  int dictionary = cv::aruco::DICT_5X5_1000;  // ChArUco
};

/// Corners found in one picture.
struct BoardView {
  std::string picture;             // its name, for messages
  std::vector<cv::Point2f> image;  // [px]
  std::vector<cv::Point3f> board;  // the same corners on the board [mm], z = 0
};

/// Finds a board in pictures.
class BoardDetector {
 public:
  explicit BoardDetector(const BoardDescription& board);
  /// Finds the corners to a fraction of a pixel in an 8-bit grey picture. On failure returns false
  /// and says why in `reason`.
  bool detect(const cv::Mat& grey, BoardView& view, std::string& reason) const;

 private:
  bool detectChessboard(const cv::Mat& grey, BoardView& view, std::string& reason) const;
  bool detectCharuco(const cv::Mat& grey, BoardView& view, std::string& reason) const;

  BoardDescription board_;
  cv::Ptr<cv::aruco::CharucoBoard> charuco_;
};

}  // namespace depthscope::platform
