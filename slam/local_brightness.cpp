#include "slam/local_brightness.hpp"

#include <algorithm>
#include <cmath>

namespace depthscope::slam {
namespace {

// Highlights may fill up to a third of a neighbourhood, shadow may fill half of it: of the
// percentiles between, this told moving highlights from texture best on the project's sequences.
constexpr int kPercentile = 60;

}  // namespace

LocalBrightness::LocalBrightness(const ImageBuffer& coarse)
    : rows_(std::max(1, kColumns * coarse.height() / std::max(1, coarse.width()))),
      histograms_(static_cast<std::size_t>(kColumns) * rows_),
      brightness_(histograms_.size()) {}

void LocalBrightness::update(const ImageBuffer& coarse, int dark_threshold) {
  countBlocks(coarse, dark_threshold);
  for (int r = 0; r < rows_; ++r)
    for (int c = 0; c < kColumns; ++c) brightness_[r * kColumns + c] = percentileAround(c, r);
}

void LocalBrightness::countBlocks(const ImageBuffer& coarse, int dark_threshold) {
  for (Histogram& h : histograms_) h.fill(0);
  for (int y = 0; y < coarse.height(); ++y) {
    Histogram* block = histograms_.data() + y * rows_ / coarse.height() * kColumns;
    const std::uint8_t* row = coarse.row(y);
    for (int c = 0; c < kColumns; ++c) {
      const int begin = c * coarse.width() / kColumns, end = (c + 1) * coarse.width() / kColumns;
      for (int x = begin; x < end; ++x)
        if (row[x] > dark_threshold) ++block[c][row[x] * kBins / 256];
    }
  }
}

std::uint16_t LocalBrightness::percentileAround(int column, int row) const {
  std::array<std::uint32_t, kBins> sum{};
  std::uint32_t total = 0;
  for (int r = std::max(row - 1, 0); r <= std::min(row + 1, rows_ - 1); ++r)
    for (int c = std::max(column - 1, 0); c <= std::min(column + 1, kColumns - 1); ++c)
      for (int b = 0; b < kBins; ++b) sum[b] += histograms_[r * kColumns + c][b];
  for (const std::uint32_t s : sum) total += s;
  if (total == 0) return 255 * 256;
  std::uint32_t below = 0;
  int bin = 0;
  while ((below += sum[bin]) * 100 < total * kPercentile) ++bin;
  // Where in the bin: as if its pixels were spread evenly over it.
  const double part = 1 - (below - total * (kPercentile / 100.0)) / sum[bin];
  return static_cast<std::uint16_t>((bin + part) * (256.0 / kBins) * 256);
}

void LocalBrightness::sampleRow(double v, std::vector<std::uint16_t>& out) const {
  const double y = std::clamp(v * rows_ - 0.5, 0.0, rows_ - 1.0);
  const int r0 = static_cast<int>(y), r1 = std::min(r0 + 1, rows_ - 1);
  std::array<int, kColumns> blocks;
  for (int c = 0; c < kColumns; ++c)
    blocks[c] = static_cast<int>(brightness_[r0 * kColumns + c] * (1 - (y - r0)) +
                                 brightness_[r1 * kColumns + c] * (y - r0));
  const auto n = static_cast<int>(out.size());
  const int step = kColumns * 65536 / n;  // [1/65536 of a block] from one piece to the next
  for (int i = 0; i < n; ++i) {
    // Position along the row in 1/256 of a block, from the first block's middle.
    const int x = std::clamp((i * step + step / 2) / 256 - 128, 0, (kColumns - 1) * 256);
    const int c = std::min(x / 256, kColumns - 2), part = x - c * 256;
    out[i] = static_cast<std::uint16_t>((blocks[c] * (256 - part) + blocks[c + 1] * part) / 256);
  }
}

}  // namespace depthscope::slam
