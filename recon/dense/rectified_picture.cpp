#include "recon/dense/rectified_picture.hpp"

#include <vector>

namespace depthscope::recon {
namespace {

using Luma = Grid<std::uint8_t>;

constexpr std::uint8_t kNothing = 0;

/// Marks the view: 0 for what shows nothing or is dark and connected to the border.
void markView(const Luma& picture, int dark_threshold, Luma& view) {
  view.reset(picture.width, picture.height, 1);
  std::vector<int> open;
  const auto visit = [&](int x, int y) {
    if (x < 0 || y < 0 || x >= picture.width || y >= picture.height) return;
    if (view.at(x, y) == 0 || picture.at(x, y) > dark_threshold) return;
    view.at(x, y) = 0;
    open.push_back(y * picture.width + x);
  };
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const bool border = x == 0 || y == 0 || x == picture.width - 1 || y == picture.height - 1;
      if (border || picture.at(x, y) == kNothing) visit(x, y);
    }
  while (!open.empty()) {
    const int x = open.back() % picture.width, y = open.back() / picture.width;
    open.pop_back();
    visit(x - 1, y);
    visit(x + 1, y);
    visit(x, y - 1);
    visit(x, y + 1);
  }
}

/// Takes from the view what is within `radius` of its edge. The picture's own border is no edge.
void erode(int radius, Luma& view) {
  Luma rows = view;
  for (int y = 0; y < view.height; ++y)
    for (int x = 0; x < view.width; ++x) {
      std::uint8_t least = 1;
      for (int i = -radius; i <= radius; ++i) least = std::min(least, view.clamped(x + i, y));
      rows.at(x, y) = least;
    }
  for (int y = 0; y < view.height; ++y)
    for (int x = 0; x < view.width; ++x) {
      std::uint8_t least = 1;
      for (int j = -radius; j <= radius; ++j) least = std::min(least, rows.clamped(x, y + j));
      view.at(x, y) = least;
    }
}

/// Sums over all pixels left of and above each cell border that show tissue.
struct Integral {
  int stride;
  std::vector<std::uint32_t> sum, count;

  explicit Integral(const Luma& picture) : stride(picture.width + 1) {
    const std::size_t cells =
        static_cast<std::size_t>(stride) * static_cast<std::size_t>(picture.height + 1);
    sum.assign(cells, 0);
    count.assign(cells, 0);
    for (int y = 0; y < picture.height; ++y) {
      std::uint32_t row_sum = 0, row_count = 0;
      for (int x = 0; x < picture.width; ++x) {
        const std::uint8_t value = picture.at(x, y);
        row_sum += value;
        row_count += value != kNothing;
        const auto below = static_cast<std::size_t>((y + 1) * stride + x + 1);
        const auto above = below - static_cast<std::size_t>(stride);
        sum[below] = sum[above] + row_sum;
        count[below] = count[above] + row_count;
      }
    }
  }
  /// Mean over the pixels [x0, x1) x [y0, y1) that show tissue; 0 without any.
  std::uint32_t mean(int x0, int y0, int x1, int y1) const {
    const auto box = [&](const std::vector<std::uint32_t>& v) {
      const auto i = [&](int x, int y) { return static_cast<std::size_t>(y * stride + x); };
      return v[i(x1, y1)] - v[i(x0, y1)] - v[i(x1, y0)] + v[i(x0, y0)];
    };
    const std::uint32_t n = box(count);
    return n > 0 ? box(sum) / n : 0;
  }
};

/// Paints pixels that are saturated or stand out from the tissue around them, and their neighbours.
void paintSpeculars(Luma& picture, const DenseSettings& settings) {
  const Integral integral(picture);
  const int reach = picture.width / 10;  // a fifth of the width around each pixel
  std::vector<std::pair<std::size_t, std::uint8_t>> painted;
  const auto brightnessAround = [&](int x, int y) {
    return integral.mean(std::max(x - reach, 0), std::max(y - reach, 0),
                         std::min(x + reach + 1, picture.width),
                         std::min(y + reach + 1, picture.height));
  };
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const int value = picture.at(x, y);
      if (value == kNothing) continue;
      const auto around = static_cast<int>(brightnessAround(x, y));
      if (value < settings.specular_threshold && value < settings.specular_contrast * around)
        continue;
      const auto fill = static_cast<std::uint8_t>(std::max(around, 1));
      for (int j = std::max(y - 1, 0); j <= std::min(y + 1, picture.height - 1); ++j)
        for (int i = std::max(x - 1, 0); i <= std::min(x + 1, picture.width - 1); ++i)
          if (picture.at(i, j) != kNothing)
            painted.emplace_back(static_cast<std::size_t>(j * picture.width + i), fill);
    }
  for (const auto& [cell, fill] : painted) picture.cells[cell] = fill;
}

/// Means of 2 x 2 pixels.
void halve(const Luma& fine, Luma& coarse) {
  coarse.reset(fine.width / 2, fine.height / 2);
  for (int y = 0; y < coarse.height; ++y) {
    const std::uint8_t* upper = fine.row(2 * y);
    const std::uint8_t* lower = fine.row(2 * y + 1);
    std::uint8_t* to = coarse.row(y);
    for (int x = 0; x < coarse.width; ++x)
      to[x] = static_cast<std::uint8_t>(
          (upper[2 * x] + upper[2 * x + 1] + lower[2 * x] + lower[2 * x + 1] + 2) / 4);
  }
}

}  // namespace

void rectify(const Grid<std::uint8_t>& reduced, const PinholeView& view,
             const DenseSettings& settings, int radius, RectifiedPicture& out) {
  RectifiedLevel& finest = out.levels[0];
  view.rectify(reduced, finest.luma);
  markView(finest.luma, settings.dark_threshold, finest.usable);
  paintSpeculars(finest.luma, settings);
  for (std::size_t l = 1; l < out.levels.size(); ++l) {
    halve(out.levels[l - 1].luma, out.levels[l].luma);
    halve(out.levels[l - 1].usable, out.levels[l].usable);
  }
  for (RectifiedLevel& level : out.levels) erode(radius, level.usable);
}

}  // namespace depthscope::recon
