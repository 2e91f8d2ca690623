#include "platform/evaluate/chart.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>

namespace depthscope::platform {
namespace {

constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr int kShift = 4;  // fractional bits of coordinates, for smooth curves

}  // namespace

Axis roundAxis(double low, double high, int count, const std::string& label) {
  if (!(high - low > 1e-12)) {  // one value only: still an axis
    low -= 0.5;
    high += 0.5;
  }
  const double rough = (high - low) / count;
  const double power = std::pow(10., std::floor(std::log10(rough)));
  double step = 10 * power;
  for (double nice : {1., 2., 5.})
    if (nice * power >= rough) {
      step = nice * power;
      break;
    }
  Axis axis;
  axis.label = label;
  const auto first = static_cast<long>(std::floor(low / step + 1e-9));
  const auto last = static_cast<long>(std::ceil(high / step - 1e-9));
  for (long i = first; i <= last; ++i) axis.ticks.push_back(static_cast<double>(i) * step);
  axis.low = axis.ticks.front();
  axis.high = axis.ticks.back();
  return axis;
}

std::string shortNumber(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.4g", std::abs(value) < 1e-9 ? 0. : value);
  return text;
}

void drawText(cv::Mat& canvas, const std::string& text, cv::Point at, double size, Align align,
              const cv::Scalar& colour) {
  const int width = cv::getTextSize(text, kFont, size, 1, nullptr).width;
  if (align == Align::Centre) at.x -= width / 2;
  if (align == Align::Right) at.x -= width;
  cv::putText(canvas, text, at, kFont, size, colour, 1, cv::LINE_AA);
}

void drawLegend(cv::Mat& canvas, cv::Point at,
                const std::vector<std::pair<std::string, cv::Scalar>>& curves) {
  for (const auto& [name, colour] : curves) {
    cv::line(canvas, at, at + cv::Point(28, 0), colour, 3, cv::LINE_AA);
    drawText(canvas, name, at + cv::Point(36, 5), 0.5);
    at.x += 60 + cv::getTextSize(name, kFont, 0.5, 1, nullptr).width;
  }
}

Chart::Chart(cv::Mat& canvas, cv::Rect area, Axis x, Axis y)
    : canvas_(canvas), area_(area), x_(std::move(x)), y_(std::move(y)) {}

cv::Point Chart::toPixel(double x, double y) const {
  const double u = (x - x_.low) / (x_.high - x_.low), v = (y - y_.low) / (y_.high - y_.low);
  return {static_cast<int>(std::lround(area_.x + u * area_.width)),
          static_cast<int>(std::lround(area_.y + (1 - v) * area_.height))};
}

void Chart::drawFrame() {
  for (double t : x_.ticks) {
    const cv::Point p = toPixel(t, y_.low);
    cv::line(canvas_, p, {p.x, area_.y}, ink::grid);
    drawText(canvas_, shortNumber(t), p + cv::Point(0, 20), 0.45, Align::Centre);
  }
  for (double t : y_.ticks) {
    const cv::Point p = toPixel(x_.low, t);
    cv::line(canvas_, p, {area_.x + area_.width, p.y}, ink::grid);
    drawText(canvas_, shortNumber(t), p + cv::Point(-8, 5), 0.45, Align::Right);
  }
  cv::rectangle(canvas_, area_, ink::text);
  drawText(canvas_, x_.label, {area_.x + area_.width / 2, area_.y + area_.height + 42}, 0.5,
           Align::Centre);
  drawText(canvas_, y_.label, {area_.x, area_.y - 8}, 0.5);
}

void Chart::drawCurve(const std::vector<cv::Point2d>& points, const cv::Scalar& colour, int width) {
  std::vector<cv::Point> line;
  constexpr double kScale = 1 << kShift;
  for (const auto& p : points) {
    const double u = (p.x - x_.low) / (x_.high - x_.low), v = (p.y - y_.low) / (y_.high - y_.low);
    line.emplace_back(static_cast<int>(std::lround((area_.x + u * area_.width) * kScale)),
                      static_cast<int>(std::lround((area_.y + (1 - v) * area_.height) * kScale)));
  }
  cv::polylines(canvas_, line, false, colour, width, cv::LINE_AA, kShift);
}

void Chart::drawBar(double x_low, double x_high, double y, const cv::Scalar& colour) {
  cv::rectangle(canvas_, toPixel(x_low, y) + cv::Point(1, 0), toPixel(x_high, y_.low), colour,
                cv::FILLED);
}

}  // namespace depthscope::platform
