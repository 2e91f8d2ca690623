#include "recon/dense/correlation.hpp"

#include <cmath>

#include "types/vector_clones.hpp"

namespace depthscope::recon {
namespace {

/// Adds a row of a picture and of the reference to the sums of columns, and takes another away.
DEPTHSCOPE_CLONES
void moveSums(int width, const std::uint8_t* __restrict in, const std::uint8_t* __restrict in_ref,
              const std::uint8_t* __restrict out, const std::uint8_t* __restrict out_ref,
              std::int32_t* __restrict luma, std::int32_t* __restrict squares,
              std::int32_t* __restrict products) {
  for (int x = 0; x < width; ++x) {
    const std::int16_t a = in[x], b = out[x], r = in_ref[x], s = out_ref[x];
    luma[x] += a - b;
    squares[x] += a * a - b * b;
    products[x] += a * r - b * s;
  }
}

/// Goes on with the outermost sums.
void pad(std::vector<std::int32_t>& columns, int radius) {
  std::fill_n(columns.begin(), radius, columns[static_cast<std::size_t>(radius)]);
  std::fill_n(columns.end() - radius, radius, *(columns.end() - radius - 1));
}

template <int kRadius>
[[gnu::always_inline]] inline std::int32_t windowSum(const std::int32_t* columns) {
  std::int32_t sum = 0;
  for (int i = 0; i <= 2 * kRadius; ++i) sum += columns[i];
  return sum;
}

/// One row of what is worked out once: of each window of the reference its sum and 1 / its standard
/// deviation, and whether reference and warped picture may be used.
struct Row {
  const std::int32_t* sum;
  const float* inverse_deviation;
  const std::uint8_t *here, *there;
};

template <int kRadius>
[[gnu::always_inline]] inline void costs(int width, const std::int32_t* __restrict luma,
                                         const std::int32_t* __restrict squares,
                                         const std::int32_t* __restrict products, Row row,
                                         float noise, std::uint8_t* __restrict to) {
  constexpr int n = (2 * kRadius + 1) * (2 * kRadius + 1);
  const std::int32_t* __restrict sum = row.sum;
  const float* __restrict inverse_deviation = row.inverse_deviation;
  const std::uint8_t* __restrict here = row.here;
  const std::uint8_t* __restrict there = row.there;
  for (int x = 0; x < width; ++x) {
    const std::int32_t s = windowSum<kRadius>(luma + x);
    const auto covariance = static_cast<float>(n * windowSum<kRadius>(products + x) - s * sum[x]);
    const auto variance = static_cast<float>(n * windowSum<kRadius>(squares + x) - s * s);
    const float zncc = covariance * inverse_deviation[x] / std::sqrt(variance + noise);
    // By value: through references, as std::clamp's, the compiler finds no vectors.
    const float positive = zncc > 0 ? zncc : 0, correlation = positive < 1 ? positive : 1;
    const int whole = static_cast<int>(255.5f - 255 * correlation);
    to[x] = static_cast<std::uint8_t>((here[x] & there[x]) != 0 ? whole : 255);
  }
}

DEPTHSCOPE_CLONES
void rowCosts(int radius, int width, const std::int32_t* luma, const std::int32_t* squares,
              const std::int32_t* products, Row row, float noise, std::uint8_t* to) {
  if (radius == Correlator::kSmall)
    costs<Correlator::kSmall>(width, luma, squares, products, row, noise, to);
  else
    costs<Correlator::kLarge>(width, luma, squares, products, row, noise, to);
}

}  // namespace

/// Moves the sums over the window's rows from row y - 1 to row y, or starts them at row 0.
void Correlator::columnSums(const Grid<std::uint8_t>& picture, int y) {
  const int last = picture.height - 1;
  const auto move = [&](const std::uint8_t* in, const std::uint8_t* in_ref, const std::uint8_t* out,
                        const std::uint8_t* out_ref) {
    moveSums(picture.width, in, in_ref, out, out_ref, luma_.data() + radius_,
             squares_.data() + radius_, products_.data() + radius_);
  };
  if (y == 0) {
    for (auto* v : {&luma_, &squares_, &products_}) std::fill(v->begin(), v->end(), 0);
    for (int j = -radius_; j <= radius_; ++j) {
      const int row = std::clamp(j, 0, last);
      move(picture.row(row), reference_.row(row), nothing_.data(), nothing_.data());
    }
  } else {
    const int in = std::min(y + radius_, last), out = std::max(y - radius_ - 1, 0);
    move(picture.row(in), reference_.row(in), picture.row(out), reference_.row(out));
  }
  for (auto* v : {&luma_, &squares_, &products_}) pad(*v, radius_);
}

void Correlator::setReference(const Grid<std::uint8_t>& reference, const Grid<std::uint8_t>& usable,
                              int radius, float noise) {
  reference_ = reference;
  usable_ = usable;
  radius_ = radius <= kSmall ? kSmall : kLarge;
  const int width = reference.width;
  for (auto* v : {&luma_, &squares_, &products_})
    v->resize(static_cast<std::size_t>(width + 2 * radius_));
  nothing_.assign(static_cast<std::size_t>(width), 0);
  sum_.resize(width, reference.height);
  inverse_deviation_.resize(width, reference.height);
  const int n = (2 * radius_ + 1) * (2 * radius_ + 1);
  noise_ = noise * noise * static_cast<float>(n * n);
  for (int y = 0; y < reference.height; ++y) {
    columnSums(reference_, y);
    for (int x = 0; x < width; ++x) {
      std::int32_t sum = 0, squares = 0;
      for (int i = x; i <= x + 2 * radius_; ++i) {
        sum += luma_[static_cast<std::size_t>(i)];
        squares += squares_[static_cast<std::size_t>(i)];
      }
      sum_.at(x, y) = sum;
      inverse_deviation_.at(x, y) =
          1 / std::sqrt(static_cast<float>(n * squares - sum * sum) + noise_);
    }
  }
}

void Correlator::cost(const Grid<std::uint8_t>& warped, const Grid<std::uint8_t>& usable,
                      Grid<std::uint8_t>& out) {
  const int width = reference_.width, height = reference_.height;
  out.resize(width, height);
  for (int y = 0; y < height; ++y) {
    columnSums(warped, y);
    rowCosts(radius_, width, luma_.data(), squares_.data(), products_.data(),
             {sum_.row(y), inverse_deviation_.row(y), usable_.row(y), usable.row(y)}, noise_,
             out.row(y));
  }
}

}  // namespace depthscope::recon
