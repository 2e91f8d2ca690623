#include "recon/dense/correlation.hpp"

#include <cmath>

namespace depthscope::recon {
/// Moves sums over the window's rows from row y - 1 to row y, or starts them at row 0. `columns`
/// holds `radius_` cells more on either side. `add(row, columns)` adds a row's terms, `subtract`
/// takes them away.
template <class Add, class Subtract>
void Correlator::columnSums(int y, const Add& add, const Subtract& subtract,
                            std::vector<std::int32_t>& columns) const {
  const int width = reference_.width, last = reference_.height - 1;
  std::int32_t* middle = columns.data() + radius_;
  if (y == 0) {
    std::fill_n(middle, width, 0);
    for (int j = -radius_; j <= radius_; ++j) add(std::clamp(j, 0, last), middle);
  } else {
    add(std::min(y + radius_, last), middle);
    subtract(std::max(y - radius_ - 1, 0), middle);
  }
  for (int i = 0; i < radius_; ++i) {
    columns[static_cast<std::size_t>(i)] = middle[0];
    middle[width + i] = middle[width - 1];
  }
}

void Correlator::sumLuma(const Grid<std::uint8_t>& a, int y,
                         std::vector<std::int32_t>& columns) const {
  const int width = a.width;
  columnSums(
      y,
      [&](int row, std::int32_t* __restrict to) {
        const std::uint8_t* p = a.row(row);
        for (int x = 0; x < width; ++x) to[x] += p[x];
      },
      [&](int row, std::int32_t* __restrict to) {
        const std::uint8_t* p = a.row(row);
        for (int x = 0; x < width; ++x) to[x] -= p[x];
      },
      columns);
}

void Correlator::sumProducts(const Grid<std::uint8_t>& a, const Grid<std::uint8_t>& b, int y,
                             std::vector<std::int32_t>& columns) const {
  const int width = a.width;
  columnSums(
      y,
      [&](int row, std::int32_t* __restrict to) {
        const std::uint8_t* p = a.row(row);
        const std::uint8_t* q = b.row(row);
        for (int x = 0; x < width; ++x) to[x] += p[x] * q[x];
      },
      [&](int row, std::int32_t* __restrict to) {
        const std::uint8_t* p = a.row(row);
        const std::uint8_t* q = b.row(row);
        for (int x = 0; x < width; ++x) to[x] -= p[x] * q[x];
      },
      columns);
}

void Correlator::windowSums(const std::vector<std::int32_t>& columns,
                            std::vector<std::int32_t>& out) const {
  const int width = reference_.width;
  std::int32_t* to = out.data();
  std::copy_n(columns.data(), width, to);
  for (int i = 1; i <= 2 * radius_; ++i) {
    const std::int32_t* from = columns.data() + i;
    for (int x = 0; x < width; ++x) to[x] += from[x];
  }
}

void Correlator::setReference(const Grid<std::uint8_t>& reference, const Grid<std::uint8_t>& usable,
                              int radius, float noise) {
  reference_ = reference;
  usable_ = usable;
  radius_ = radius;
  const int width = reference.width;
  const auto padded = static_cast<std::size_t>(width + 2 * radius);
  for (auto* v : {&column_, &column_squares_, &column_products_}) v->resize(padded);
  for (auto* v : {&window_, &window_squares_, &window_products_})
    v->resize(static_cast<std::size_t>(width));
  sum_.reset(width, reference.height);
  inverse_deviation_.reset(width, reference.height);
  const int n = (2 * radius + 1) * (2 * radius + 1);
  noise_ = noise * noise * static_cast<float>(n * n);
  for (int y = 0; y < reference.height; ++y) {
    sumLuma(reference_, y, column_);
    sumProducts(reference_, reference_, y, column_squares_);
    windowSums(column_, window_);
    windowSums(column_squares_, window_squares_);
    for (int x = 0; x < width; ++x) {
      const auto i = static_cast<std::size_t>(x);
      sum_.at(x, y) = window_[i];
      const std::int32_t variance = n * window_squares_[i] - window_[i] * window_[i];
      inverse_deviation_.at(x, y) = 1 / std::sqrt(static_cast<float>(variance) + noise_);
    }
  }
}

void Correlator::cost(const Grid<std::uint8_t>& warped, const Grid<std::uint8_t>& usable,
                      Grid<std::uint8_t>& out) {
  const int width = reference_.width, height = reference_.height;
  out.width = width;
  out.height = height;
  out.cells.resize(reference_.size());
  const int n = (2 * radius_ + 1) * (2 * radius_ + 1);
  for (int y = 0; y < height; ++y) {
    sumLuma(warped, y, column_);
    sumProducts(warped, warped, y, column_squares_);
    sumProducts(warped, reference_, y, column_products_);
    windowSums(column_, window_);
    windowSums(column_squares_, window_squares_);
    windowSums(column_products_, window_products_);
    const std::int32_t* s = window_.data();
    const std::int32_t* ss = window_squares_.data();
    const std::int32_t* sp = window_products_.data();
    const std::int32_t* sr = sum_.row(y);
    const float* inverse = inverse_deviation_.row(y);
    const std::uint8_t* here = usable_.row(y);
    const std::uint8_t* there = usable.row(y);
    std::uint8_t* to = out.row(y);
    for (int x = 0; x < width; ++x) {
      const auto covariance = static_cast<float>(n * sp[x] - s[x] * sr[x]);
      const auto variance = static_cast<float>(n * ss[x] - s[x] * s[x]);
      const float zncc = covariance * inverse[x] / std::sqrt(variance + noise_);
      const float cost = 255.5f - 255 * std::clamp(zncc, 0.f, 1.f);
      const int whole = static_cast<int>(cost);
      to[x] = static_cast<std::uint8_t>((here[x] & there[x]) != 0 ? whole : 255);
    }
  }
}

}  // namespace depthscope::recon
