#pragma once
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace depthscope::platform {

/// Colours of the plots, BGR.
namespace ink {
inline const cv::Scalar paper{255, 255, 255}, text{40, 40, 40}, grid{225, 225, 225};
inline const cv::Scalar truth{60, 60, 60}, estimate{200, 90, 0}, error{40, 40, 210};
}  // namespace ink

/// A range of values and round places to mark on it.
struct Axis {
  double low = 0, high = 1;
  std::vector<double> ticks;
  std::string label;  // with its unit
};

/// An axis around low..high with about `count` round ticks.
Axis roundAxis(double low, double high, int count, const std::string& label);

/// A number without superfluous digits.
std::string shortNumber(double value);

enum class Align { Left, Centre, Right };
void drawText(cv::Mat& canvas, const std::string& text, cv::Point at, double size,
              Align align = Align::Left, const cv::Scalar& colour = ink::text);

/// A line from colour to name for each curve, side by side from `at`.
void drawLegend(cv::Mat& canvas, cv::Point at,
                const std::vector<std::pair<std::string, cv::Scalar>>& curves);

/// A rectangular plot on a canvas.
class Chart {
 public:
  Chart(cv::Mat& canvas, cv::Rect area, Axis x, Axis y);
  /// Frame, grid, numbers and labels.
  void drawFrame();
  cv::Point toPixel(double x, double y) const;
  void drawCurve(const std::vector<cv::Point2d>& points, const cv::Scalar& colour, int width = 2);
  void drawBar(double x_low, double x_high, double y, const cv::Scalar& colour);

 private:
  cv::Mat& canvas_;
  cv::Rect area_;
  Axis x_, y_;
};

}  // namespace depthscope::platform
