#include "platform/evaluate/evaluation_plots.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <opencv2/imgproc.hpp>

#include "platform/evaluate/chart.hpp"
#include "platform/png_writer.hpp"
#include "types/error.hpp"

namespace depthscope::platform {
namespace {

constexpr double kMapLimit_mm = 4;  // distances beyond take the end colours

cv::Mat blank(int width, int height, const std::string& title) {
  cv::Mat canvas(height, width, CV_8UC3, ink::paper);
  drawText(canvas, title, {width / 2, 32}, 0.7, Align::Centre);
  return canvas;
}

void save(const std::filesystem::path& file, const cv::Mat& canvas) {
  cv::Mat rgba;
  cv::cvtColor(canvas, rgba, cv::COLOR_BGR2RGBA);
  try {
    writePng(file, {rgba.data, rgba.cols, rgba.rows, static_cast<std::ptrdiff_t>(rgba.step)});
  } catch (const std::runtime_error& e) {
    throw InputError(e.what());
  }
}

std::string titled(const char* format, double value) {
  char text[128];
  std::snprintf(text, sizeof(text), format, value);
  return text;
}

/// Orthographic view of a box from above one of its corners, fitted into an area of the canvas.
class CornerView {
 public:
  CornerView(const Eigen::AlignedBox3d& box, cv::Rect area) {
    view_ = (Eigen::AngleAxisd(-1.1, Eigen::Vector3d::UnitX()) *
             Eigen::AngleAxisd(0.6, Eigen::Vector3d::UnitZ()))
                .toRotationMatrix();
    Eigen::AlignedBox2d seen;
    for (int c = 0; c < 8; ++c)
      seen.extend(Eigen::Vector2d(
          (view_ * box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(c))).head<2>()));
    centre_ = seen.center();
    scale_ = std::min(area.width / seen.sizes().x(), area.height / seen.sizes().y());
    middle_ = {area.x + area.width / 2., area.y + area.height / 2.};
  }
  cv::Point operator()(const Eigen::Vector3d& p) const {
    const Eigen::Vector2d v = (view_ * p).head<2>() - centre_;
    return {static_cast<int>(std::lround(middle_.x + scale_ * v.x())),
            static_cast<int>(std::lround(middle_.y - scale_ * v.y()))};
  }

 private:
  Eigen::Matrix3d view_;
  Eigen::Vector2d centre_;
  double scale_ = 1;
  cv::Point2d middle_;
};

/// The three edges of the box that meet in its lowest corner, with numbers, and a grid on the walls
/// between them.
void drawBox(cv::Mat& canvas, const std::array<Axis, 3>& axes, const CornerView& view) {
  const Eigen::Vector3d low(axes[0].low, axes[1].low, axes[2].low);
  const Eigen::Vector3d high(axes[0].high, axes[1].high, axes[2].high);
  const auto on = [&](Eigen::Vector3d p, int axis, double value) {
    p[axis] = value;
    return p;
  };
  for (int a = 0; a < 3; ++a)
    for (double t : axes[static_cast<std::size_t>(a)].ticks)
      for (int other = 1; other < 3; ++other) {
        const int b = (a + other) % 3;
        const Eigen::Vector3d from = on(low, a, t);
        cv::line(canvas, view(from), view(on(from, b, high[b])), ink::grid, 1, cv::LINE_AA);
      }
  const std::array<cv::Point, 3> number_offset = {cv::Point(14, 18), {-14, 18}, {-10, 4}};
  const std::array<cv::Point, 3> label_offset = {cv::Point(60, 52), {-60, 52}, {0, -18}};
  for (int a = 0; a < 3; ++a) {
    const auto i = static_cast<std::size_t>(a);
    cv::line(canvas, view(low), view(on(low, a, high[a])), ink::text, 1, cv::LINE_AA);
    for (double t : axes[i].ticks)
      drawText(canvas, shortNumber(t), view(on(low, a, t)) + number_offset[i], 0.42,
               a == 0 ? Align::Left : Align::Right);
    const double place = a == 2 ? high[a] : 0.5 * (low[a] + high[a]);
    drawText(canvas, axes[i].label, view(on(low, a, place)) + label_offset[i], 0.5, Align::Centre);
  }
}

void drawTrajectory3d(const Evaluation& e, const std::filesystem::path& file) {
  constexpr int kSide = 900, kHeight = 760;
  cv::Mat canvas =
      blank(kSide, kHeight, titled("Camera trajectory, ATE RMSE %.3f mm", e.trajectory.ate_rmse));
  drawLegend(canvas, {kSide / 2 - 130, 60}, {{"truth", ink::truth}, {"estimate", ink::estimate}});
  Eigen::AlignedBox3d tight;
  for (const auto& p : e.truth) tight.extend(p.position);
  for (const auto& p : e.trajectory.aligned) tight.extend(p);
  std::array<Axis, 3> axes;
  constexpr const char* kNames[] = {"x [mm]", "y [mm]", "z [mm]"};
  Eigen::AlignedBox3d box;
  for (int a = 0; a < 3; ++a)
    axes[static_cast<std::size_t>(a)] = roundAxis(tight.min()[a], tight.max()[a], 4, kNames[a]);
  box.extend(Eigen::Vector3d(axes[0].low, axes[1].low, axes[2].low));
  box.extend(Eigen::Vector3d(axes[0].high, axes[1].high, axes[2].high));
  const CornerView view(box, {70, 110, kSide - 140, kHeight - 190});
  drawBox(canvas, axes, view);
  std::vector<cv::Point> truth;
  for (const auto& p : e.truth) truth.push_back(view(p.position));
  cv::polylines(canvas, truth, false, ink::truth, 5, cv::LINE_AA);
  std::vector<cv::Point> estimate;
  for (const auto& p : e.trajectory.aligned) estimate.push_back(view(p));
  cv::polylines(canvas, estimate, false, ink::estimate, 1, cv::LINE_AA);
  save(file, canvas);
}

void drawTrajectoryAxes(const Evaluation& e, const std::filesystem::path& file) {
  constexpr int kWidth = 1000, kPanel = 170, kStep = 240, kTop = 100, kLeft = 80;
  cv::Mat canvas = blank(kWidth, kTop + 4 * kStep, "Camera position over time");
  drawLegend(canvas, {kWidth / 2 - 190, 58},
             {{"truth", ink::truth}, {"estimate", ink::estimate}, {"distance", ink::error}});
  const Axis time =
      roundAxis(e.truth.front().timestamp_s, e.truth.back().timestamp_s, 8, "time [s]");
  constexpr const char* kLabels[] = {"x [mm]", "y [mm]", "z [mm]", "distance to truth [mm]"};
  for (int row = 0; row < 4; ++row) {
    std::vector<cv::Point2d> truth, estimate;
    if (row < 3)
      for (const auto& p : e.truth) truth.emplace_back(p.timestamp_s, p.position[row]);
    for (std::size_t i = 0; i < e.trajectory.aligned.size(); ++i)
      estimate.emplace_back(e.truth[e.trajectory.truth_index[i]].timestamp_s,
                            row < 3 ? e.trajectory.aligned[i][row] : e.trajectory.error[i]);
    double low = row < 3 ? truth.front().y : 0, high = low;
    for (const auto* curve : {&truth, &estimate})
      for (const auto& p : *curve) {
        low = std::min(low, p.y);
        high = std::max(high, p.y);
      }
    Chart chart(canvas, {kLeft, kTop + row * kStep, kWidth - kLeft - 30, kPanel}, time,
                roundAxis(low, high, 4, kLabels[row]));
    chart.drawFrame();
    if (row < 3) chart.drawCurve(truth, ink::truth, 5);
    chart.drawCurve(estimate, row < 3 ? ink::estimate : ink::error, row < 3 ? 1 : 2);
  }
  save(file, canvas);
}

/// Blue: behind the truth; white: on it; red: in front of it. Differs in lightness from white on
/// both sides.
cv::Scalar distanceColour(double distance_mm) {
  const double v = std::clamp(distance_mm / kMapLimit_mm, -1., 1.), rest = 255 * (1 - std::abs(v));
  return v >= 0 ? cv::Scalar(rest, rest, 120 + 0.53 * rest + 90 * v * (1 - v))
                : cv::Scalar(140 + 0.45 * rest, 80 * -v * (1 + v) + rest, rest);
}

void drawColourBar(cv::Mat& canvas, cv::Rect area) {
  for (int y = 0; y < area.height; ++y) {
    const double d = kMapLimit_mm * (1 - 2. * y / (area.height - 1));
    cv::line(canvas, {area.x, area.y + y}, {area.x + area.width, area.y + y}, distanceColour(d));
  }
  cv::rectangle(canvas, area, ink::text);
  for (int d = -4; d <= 4; d += 2) {
    const int y =
        area.y + static_cast<int>(std::lround((1 - d / kMapLimit_mm) / 2 * (area.height - 1)));
    drawText(canvas, titled(d == 0 ? "%.0f" : "%+.0f", d), {area.x + area.width + 10, y + 5}, 0.5);
  }
  drawText(canvas, "distance [mm]", {area.x - 30, area.y - 14}, 0.5);
  drawText(canvas, "+ in front", {area.x - 30, area.y + area.height + 24}, 0.45);
  drawText(canvas, "- behind", {area.x - 30, area.y + area.height + 44}, 0.45);
}

void drawDistanceMap(const Evaluation& e, const std::filesystem::path& file) {
  constexpr int kWidth = 1000, kHeight = 800;
  const SurfaceError& s = *e.surface;
  cv::Mat canvas =
      blank(kWidth, kHeight,
            titled("Distance of the surface to the truth, RMSD %.3f mm", s.statistics.rms));
  // Seen as the camera saw it in the middle of the run.
  const Eigen::Matrix3d R_camera_world =
      e.truth[e.trajectory.truth_index[e.trajectory.truth_index.size() / 2]]
          .orientation.conjugate()
          .toRotationMatrix();
  std::vector<Eigen::Vector3d> seen;
  Eigen::AlignedBox3d box;
  for (const auto& v : s.mesh.vertices) {
    seen.push_back(R_camera_world * v.cast<double>());
    box.extend(seen.back());
  }
  const cv::Rect area(40, 70, kWidth - 220, kHeight - 130);
  const Eigen::Vector3d size = box.sizes().cwiseMax(1e-9);
  const double scale = std::min(area.width / size.x(), area.height / size.y());
  const auto toPixel = [&](const Eigen::Vector3d& p) {
    const Eigen::Vector3d v = (p - box.center()) * scale;
    return cv::Point(area.x + area.width / 2 + static_cast<int>(std::lround(v.x())),
                     area.y + area.height / 2 + static_cast<int>(std::lround(v.y())));
  };
  std::vector<std::size_t> order(s.mesh.triangles.size());  // painter's: far ones first
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto depth = [&](std::size_t i) {
    const auto& t = s.mesh.triangles[i];
    return seen[t[0]].z() + seen[t[1]].z() + seen[t[2]].z();
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return depth(a) > depth(b); });
  for (std::size_t i : order) {
    const auto& t = s.mesh.triangles[i];
    const cv::Point corners[] = {toPixel(seen[t[0]]), toPixel(seen[t[1]]), toPixel(seen[t[2]])};
    const double mean =
        (s.vertex_distance[t[0]] + s.vertex_distance[t[1]] + s.vertex_distance[t[2]]) / 3.;
    const Eigen::Vector3d normal =
        (seen[t[1]] - seen[t[0]]).cross(seen[t[2]] - seen[t[0]]).normalized();
    const double light = 0.65 + 0.35 * std::abs(normal.z());  // enough to see the shape
    cv::fillConvexPoly(canvas, corners, 3, distanceColour(mean) * light, cv::LINE_8);
  }
  // A scale: the view is orthographic, so one bar holds everywhere.
  const int bar = static_cast<int>(std::lround(20 * scale));
  cv::line(canvas, {60, kHeight - 40}, {60 + bar, kHeight - 40}, ink::text, 3);
  drawText(canvas, "20 mm", {60 + bar + 10, kHeight - 35}, 0.5);
  drawColourBar(canvas, {kWidth - 120, 140, 30, 480});
  save(file, canvas);
}

void drawHistogram(const Evaluation& e, const std::filesystem::path& file) {
  constexpr int kWidth = 1000, kHeight = 600, kBins = 80;
  constexpr double kRange_mm = 8;
  const SurfaceError& s = *e.surface;
  std::vector<double> percent(kBins, 0.);
  for (float d : s.distance) {
    const double place =
        (std::clamp<double>(d, -kRange_mm, kRange_mm) + kRange_mm) / (2 * kRange_mm);
    percent[static_cast<std::size_t>(std::min(kBins - 1., place * kBins))] +=
        100. / static_cast<double>(s.distance.size());
  }
  char title[128];
  std::snprintf(title, sizeof(title),
                "Distance of the surface to the truth: RMSD %.3f, median %.3f, p95 %.3f mm",
                s.statistics.rms, s.statistics.median, s.statistics.p95);
  cv::Mat canvas = blank(kWidth, kHeight, title);
  Chart chart(
      canvas, {80, 80, kWidth - 120, kHeight - 150},
      roundAxis(
          -kRange_mm, kRange_mm, 8,
          "signed distance [mm], + in front of the truth; the outer bars hold what is beyond"),
      roundAxis(0, *std::max_element(percent.begin(), percent.end()), 6,
                "share of the surface [%]"));
  chart.drawFrame();
  constexpr double kBin = 2 * kRange_mm / kBins;
  for (int i = 0; i < kBins; ++i) {
    const double left = -kRange_mm + i * kBin;
    chart.drawBar(left, left + kBin, percent[static_cast<std::size_t>(i)], ink::estimate);
  }
  save(file, canvas);
}

}  // namespace

void drawPlots(const Evaluation& evaluation, const std::filesystem::path& folder) {
  std::error_code ec;
  std::filesystem::create_directories(folder, ec);
  if (ec) throw InputError(folder.string() + ": cannot be made: " + ec.message());
  if (evaluation.trajectory.empty()) return;
  drawTrajectory3d(evaluation, folder / "trajectory_3d.png");
  drawTrajectoryAxes(evaluation, folder / "trajectory_axes.png");
  if (!evaluation.surface) return;
  drawDistanceMap(evaluation, folder / "surface_distance.png");
  drawHistogram(evaluation, folder / "surface_histogram.png");
}

}  // namespace depthscope::platform
