#include "recon/dense/rectified_picture.hpp"

#include <vector>

#include "types/surroundings.hpp"

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
  const int width = view.width, height = view.height;
  Luma rows = view;
  for (int y = 0; y < height; ++y)
    for (int i = 1; i <= radius; ++i) {
      const std::uint8_t* from = view.row(y);
      std::uint8_t* to = rows.row(y);
      for (int x = 0; x + i < width; ++x) to[x] &= from[x + i];
      for (int x = i; x < width; ++x) to[x] &= from[x - i];
    }
  view = rows;
  for (int y = 0; y < height; ++y)
    for (int j = std::max(y - radius, 0); j <= std::min(y + radius, height - 1); ++j) {
      const std::uint8_t* from = rows.row(j);
      std::uint8_t* to = view.row(y);
      for (int x = 0; x < width; ++x) to[x] &= from[x];
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
/// The brightness around is worked out once for cells of a few pixels: it changes slowly.
void paintSpeculars(Luma& picture, const DenseSettings& settings) {
  const Integral integral(picture);
  const int reach = picture.width / 10;  // a fifth of the width around each pixel
  std::vector<std::pair<std::size_t, std::uint8_t>> painted;
  const auto brightnessAround = [&](int x, int y) {
    return static_cast<int>(integral.mean(std::max(x - reach, 0), std::max(y - reach, 0),
                                          std::min(x + reach + 1, picture.width),
                                          std::min(y + reach + 1, picture.height)));
  };
  const auto paint = [&](int x, int y, std::uint8_t fill) {
    for (int j = std::max(y - 1, 0); j <= std::min(y + 1, picture.height - 1); ++j)
      for (int i = std::max(x - 1, 0); i <= std::min(x + 1, picture.width - 1); ++i)
        if (picture.at(i, j) != kNothing)
          painted.emplace_back(static_cast<std::size_t>(j * picture.width + i), fill);
  };
  constexpr int kCell = 4;
  for (int top = 0; top < picture.height; top += kCell)
    for (int left = 0; left < picture.width; left += kCell) {
      const int around = brightnessAround(left + kCell / 2, top + kCell / 2);
      const double limit =
          std::min<double>(settings.specular_threshold, settings.specular_contrast * around);
      for (int y = top; y < std::min(top + kCell, picture.height); ++y)
        for (int x = left; x < std::min(left + kCell, picture.width); ++x)
          if (picture.at(x, y) != kNothing && picture.at(x, y) >= limit)
            paint(x, y, static_cast<std::uint8_t>(std::max(around, 1)));
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
  const int dark =
      surroundingsLimit({reduced.cells.data(), reduced.width, reduced.height, reduced.width},
                        settings.dark_threshold);
  markView(finest.luma, dark, finest.usable);
  paintSpeculars(finest.luma, settings);
  for (std::size_t l = 1; l < out.levels.size(); ++l) {
    halve(out.levels[l - 1].luma, out.levels[l].luma);
    halve(out.levels[l - 1].usable, out.levels[l].usable);
  }
  for (RectifiedLevel& level : out.levels) erode(radius, level.usable);
}

}  // namespace depthscope::recon
