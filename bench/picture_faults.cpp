#include "bench/picture_faults.hpp"

#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

namespace depthscope::bench {
namespace {

using Random = std::mt19937;

constexpr double kFps = 30;

/// Sensor noise of `sigma` grey levels, after a gain and an offset.
void expose(cv::Mat& picture, double gain, double offset, double sigma, Random& random) {
  std::normal_distribution<double> noise(0, sigma);
  for (int y = 0; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x) {
      std::uint8_t& p = picture.at<std::uint8_t>(y, x);
      const double n = sigma > 0 ? noise(random) : 0;
      p = cv::saturate_cast<std::uint8_t>(gain * p + offset + n);
    }
}

double wave(int frame, double period_s) {
  return std::sin(2 * std::numbers::pi * frame / (kFps * period_s));
}

/// A third of the light.
void dark(cv::Mat& picture, int, Random& random) {
  expose(picture, 0.3, 0, 3, random);
}

void noise(cv::Mat& picture, int, Random& random) {
  expose(picture, 1, 0, 10, random);
}

/// A third of the contrast, as of a fogged lens.
void fog(cv::Mat& picture, int, Random& random) {
  expose(picture, 0.35, 72, 0, random);
}

/// Automatic exposure that hunts.
void exposure(cv::Mat& picture, int frame, Random& random) {
  expose(picture, 1 + 0.35 * wave(frame, 0.77), 0, 0, random);
}

/// A third of a second of glare, every ten seconds.
void flash(cv::Mat& picture, int frame, Random& random) {
  if (frame % 300 >= 200 && frame % 300 < 210) expose(picture, 4, 40, 0, random);
}

/// What an electrosurgical generator does to an analogue signal: 40 pictures of noise in lines, of
/// every 300.
void electrosurgery(cv::Mat& picture, int frame, Random& random) {
  if (frame % 300 < 200 || frame % 300 >= 240) return;
  std::normal_distribution<double> strength(0, 60);
  std::bernoulli_distribution hit(0.3);
  for (int y = 0; y < picture.rows; ++y) {
    cv::Mat row = picture.row(y);
    expose(row, 1, hit(random) ? strength(random) : 0, 12, random);
  }
}

/// Smoke in drifting clouds, that comes and goes.
void smoke(cv::Mat& picture, int frame, Random&) {
  const double amount = 0.65 * std::max(0.0, wave(frame, 6));
  for (int y = 0; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x) {
      const double cloud = std::sin(9.0 * x / picture.cols + 2 * wave(frame, 7)) *
                           std::sin(7.0 * y / picture.rows + 2 * wave(frame, 5));
      const double share = amount * (1 + 0.4 * cloud);
      std::uint8_t& p = picture.at<std::uint8_t>(y, x);
      p = cv::saturate_cast<std::uint8_t>(p * (1 - share) + 210 * share);
    }
}

/// The shaft of a textured instrument that moves over a quarter of the picture.
void instrument(cv::Mat& picture, int frame, Random&) {
  const double w = picture.cols, h = picture.rows;
  const cv::Point2d tip(w * (0.55 + 0.2 * wave(frame, 5)), h * (0.5 + 0.2 * wave(frame, 3.3)));
  const cv::Point2d end(1.2 * w, 0.6 * h);
  const int width = static_cast<int>(0.22 * w);
  cv::line(picture, tip, end, 70, width);
  cv::line(picture, tip, end, 150, width / 2);
  cv::line(picture, tip, end, 235, width / 8);
  const cv::Point2d along = (end - tip) / cv::norm(end - tip), across(-along.y, along.x);
  Random marks(9);  // the same in every picture
  std::uniform_real_distribution<double> anywhere(-0.5, 0.5);
  for (double s = 0; s < w; s += 0.03 * w) {
    const cv::Point2d middle = tip + s * along, side = 0.5 * width * across;
    cv::line(picture, middle - side, middle + side, 30, 2);
    cv::circle(picture, middle + 20 * anywhere(marks) * along + width * anywhere(marks) * across, 5,
               200, -1);
  }
}

void none(cv::Mat&, int, Random&) {}

constexpr PictureFault kFaults[] = {{"none", none},
                                    {"dark", dark},
                                    {"noise", noise},
                                    {"fog", fog},
                                    {"exposure", exposure},
                                    {"flash", flash},
                                    {"electrosurgery", electrosurgery},
                                    {"smoke", smoke},
                                    {"instrument", instrument}};

}  // namespace

std::span<const PictureFault> pictureFaults() {
  return kFaults;
}

}  // namespace depthscope::bench
