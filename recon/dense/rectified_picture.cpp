#include "recon/dense/rectified_picture.hpp"

#include <cmath>
#include <vector>

#include "recon/view_picture.hpp"
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

/// Brightness of what shows tissue, averaged over boxes of cells: it changes slowly.
class LocalMean {
 public:
  static constexpr int kCell = 4;  // [px]

  explicit LocalMean(const Luma& picture)
      : columns_((picture.width + kCell - 1) / kCell),
        rows_((picture.height + kCell - 1) / kCell),
        integral_(static_cast<std::size_t>((columns_ + 1) * (rows_ + 1))) {
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x) {
        const std::uint8_t value = picture.at(x, y);
        Sum& cell = at(x / kCell + 1, y / kCell + 1);
        cell.luma += value;
        cell.count += value != kNothing;
      }
    for (int row = 1; row <= rows_; ++row)
      for (int column = 1; column <= columns_; ++column) {
        at(column, row) += at(column - 1, row);
        at(column, row) += at(column, row - 1);
        at(column, row) -= at(column - 1, row - 1);
      }
  }

  /// Mean over the cells within `reach` of one; 0 without tissue.
  int around(int column, int row, int reach) const {
    const int left = std::max(column - reach, 0), right = std::min(column + reach + 1, columns_);
    const int top = std::max(row - reach, 0), bottom = std::min(row + reach + 1, rows_);
    Sum sum = at(right, bottom);
    sum -= at(left, bottom);
    sum -= at(right, top);
    sum += at(left, top);
    return sum.count > 0 ? static_cast<int>(sum.luma / sum.count) : 0;
  }

 private:
  struct Sum {
    std::uint32_t luma = 0, count = 0;
    void operator+=(const Sum& s) {
      luma += s.luma;
      count += s.count;
    }
    void operator-=(const Sum& s) {
      luma -= s.luma;
      count -= s.count;
    }
  };
  Sum& at(int column, int row) {
    return integral_[static_cast<std::size_t>(row * (columns_ + 1) + column)];
  }
  const Sum& at(int column, int row) const {
    return integral_[static_cast<std::size_t>(row * (columns_ + 1) + column)];
  }

  int columns_, rows_;
  std::vector<Sum> integral_;  // over all cells left of and above each cell border
};

/// Paints pixels that are saturated or stand out from the tissue around them, and their neighbours.
void paintSpeculars(Luma& picture, const DenseSettings& settings) {
  constexpr int kCell = LocalMean::kCell;
  const LocalMean mean(picture);
  const int reach = picture.width / 10 / kCell;  // a fifth of the width around each cell
  Luma fill(picture.width, picture.height, kNothing);
  const auto paint = [&](int x, int y, std::uint8_t with) {
    for (int j = std::max(y - 1, 0); j <= std::min(y + 1, picture.height - 1); ++j)
      for (int i = std::max(x - 1, 0); i <= std::min(x + 1, picture.width - 1); ++i)
        fill.at(i, j) = with;
  };
  for (int top = 0; top < picture.height; top += kCell)
    for (int left = 0; left < picture.width; left += kCell) {
      const int around = mean.around(left / kCell, top / kCell, reach);
      const int limit = static_cast<int>(std::ceil(
          std::min<double>(settings.specular_threshold, settings.specular_contrast * around)));
      for (int y = top; y < std::min(top + kCell, picture.height); ++y)
        for (int x = left; x < std::min(left + kCell, picture.width); ++x)
          if (picture.at(x, y) != kNothing && picture.at(x, y) >= limit)
            paint(x, y, static_cast<std::uint8_t>(std::max(around, 1)));
    }
  for (std::size_t i = 0; i < picture.size(); ++i)
    if (picture.cells[i] != kNothing && fill.cells[i] != kNothing) picture.cells[i] = fill.cells[i];
}

/// Means of 2 x 2 pixels.
void halve(const Luma& fine, Luma& coarse) {
  reducePicture({fine.cells.data(), fine.width, fine.height, fine.width}, 2, coarse);
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
