#include "platform/calibrate/lens_fit.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/calib3d.hpp>

#include "types/error.hpp"

namespace depthscope::platform {
namespace {

constexpr std::size_t kMinViews = 3;  // Zhang's method needs three planes

/// How far the corners that both views have moved, on average; views without common corners differ
/// wholly.
double difference(const BoardView& a, const BoardView& b) {
  double sum = 0;
  int common = 0;
  for (std::size_t i = 0; i < a.board.size(); ++i)
    for (std::size_t j = 0; j < b.board.size(); ++j)
      if (a.board[i] == b.board[j]) {
        sum += cv::norm(a.image[i] - b.image[j]);
        ++common;
      }
  return common > 0 ? sum / common : 1e9;
}

/// The views most different from each other: each next one is the farthest from those taken
/// (farthest point sampling), until what is left repeats them or there are enough.
std::vector<BoardView> distinctViews(const std::vector<BoardView>& views, double diagonal,
                                     const LensFitSettings& settings,
                                     std::vector<LeftOut>& left_out) {
  std::vector<double> nearest(views.size(), 1e9);
  std::vector<bool> taken(views.size(), false);
  for (std::size_t n = 0, next = 0; n < std::min(views.size(), settings.max_views); ++n) {
    taken[next] = true;
    std::size_t farthest = views.size();
    for (std::size_t i = 0; i < views.size(); ++i) {
      if (taken[i]) continue;
      nearest[i] = std::min(nearest[i], difference(views[i], views[next]));
      if (farthest == views.size() || nearest[i] > nearest[farthest]) farthest = i;
    }
    if (farthest == views.size() || nearest[farthest] < settings.min_difference * diagonal) break;
    next = farthest;
  }
  std::vector<BoardView> out;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (taken[i])
      out.push_back(views[i]);
    else if (nearest[i] < settings.min_difference * diagonal)
      left_out.push_back({views[i].picture, "repeats another view"});
    else
      left_out.push_back({views[i].picture, "enough views that differ more"});
  }
  return out;
}

struct Solution {
  cv::Matx33d K;
  cv::Mat distortion;
  double rms_px = 0;
  std::vector<double> view_rms_px;
};

double viewError(const BoardView& view, const std::vector<cv::Point2f>& projected) {
  double sum = 0;
  for (std::size_t i = 0; i < projected.size(); ++i) {
    const cv::Point2f d = view.image[i] - projected[i];
    sum += d.dot(d);
  }
  return std::sqrt(sum / static_cast<double>(projected.size()));
}

Solution solve(const std::vector<BoardView>& views, cv::Size size,
               const LensFitSettings& settings) {
  std::vector<std::vector<cv::Point3f>> board;
  std::vector<std::vector<cv::Point2f>> image;
  for (const auto& v : views) {
    board.push_back(v.board);
    image.push_back(v.image);
  }
  Solution s;
  s.K = cv::Matx33d::eye();
  std::vector<cv::Mat> rotation, translation;
  const bool fisheye = settings.model == CameraModel::Kind::Fisheye;
  if (fisheye) {
    s.rms_px =
        cv::fisheye::calibrate(board, image, size, s.K, s.distortion, rotation, translation,
                               cv::fisheye::CALIB_RECOMPUTE_EXTRINSIC | cv::fisheye::CALIB_FIX_SKEW,
                               {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 200, 1e-10});
  } else {
    s.rms_px = cv::calibrateCamera(board, image, size, s.K, s.distortion, rotation, translation,
                                   settings.with_k3 ? 0 : cv::CALIB_FIX_K3,
                                   {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 200, 1e-10});
  }
  std::vector<cv::Point2f> projected;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (fisheye)
      cv::fisheye::projectPoints(board[i], projected, rotation[i], translation[i], s.K,
                                 s.distortion);
    else
      cv::projectPoints(board[i], rotation[i], translation[i], s.K, s.distortion, projected);
    s.view_rms_px.push_back(viewError(views[i], projected));
  }
  return s;
}

/// Removes the worst view if it disagrees with the others. One at a time: a bad view spoils the
/// errors of all.
bool dropWorst(std::vector<BoardView>& views, const Solution& s, const LensFitSettings& settings,
               std::vector<LeftOut>& left_out) {
  std::vector<double> sorted = s.view_rms_px;
  std::sort(sorted.begin(), sorted.end());
  const double limit =
      std::max(settings.outlier_min_px, settings.outlier_factor * sorted[sorted.size() / 2]);
  const auto worst = std::max_element(s.view_rms_px.begin(), s.view_rms_px.end());
  if (!(*worst > limit) || views.size() <= kMinViews) return false;
  char reason[96];
  std::snprintf(reason, sizeof(reason), "reprojection error %.2f px, the others allow %.2f px",
                *worst, limit);
  const auto view = views.begin() + (worst - s.view_rms_px.begin());
  left_out.push_back({view->picture, reason});
  views.erase(view);
  return true;
}

CameraModel toCameraModel(const Solution& s, cv::Size size, CameraModel::Kind kind) {
  CameraModel camera;
  camera.kind = kind;
  camera.width = size.width;
  camera.height = size.height;
  camera.fx = s.K(0, 0);
  camera.fy = s.K(1, 1);
  camera.cx = s.K(0, 2);
  camera.cy = s.K(1, 2);
  const cv::Mat flat = s.distortion.reshape(1, 1);
  for (int i = 0; i < std::min(flat.cols, 5); ++i)
    camera.k[static_cast<std::size_t>(i)] = flat.at<double>(0, i);
  return camera;
}

}  // namespace

LensFit fitLens(const std::vector<BoardView>& views, cv::Size size,
                const LensFitSettings& settings) {
  LensFit fit;
  std::vector<BoardView> used =
      distinctViews(views, std::hypot(size.width, size.height), settings, fit.left_out);
  if (used.size() < kMinViews)
    throw InputError("the board was found in " + std::to_string(views.size()) + " pictures, " +
                     std::to_string(used.size()) +
                     " of them different; at least 3 are needed, 10 or more are better");
  try {
    Solution solution = solve(used, size, settings);
    while (dropWorst(used, solution, settings, fit.left_out))
      solution = solve(used, size, settings);
    fit.camera = toCameraModel(solution, size, settings.model);
    fit.rms_px = solution.rms_px;
    fit.view_rms_px = solution.view_rms_px;
  } catch (const cv::Exception& e) {
    throw InputError("no lens fits these views (are they all seen at the same angle?): " + e.err);
  }
  for (const auto& v : used) fit.used.push_back(v.picture);
  return fit;
}

}  // namespace depthscope::platform
