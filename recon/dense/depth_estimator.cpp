#include "recon/dense/depth_estimator.hpp"

#include <cmath>

#include "recon/dense/speckle_filter.hpp"
#include "types/vector_clones.hpp"

namespace depthscope::recon {
namespace {

constexpr int kCoarsest = kLevels - 1;
constexpr int kCoarseHypotheses = 32;  // planes over the whole range of depth
constexpr int kFineHypotheses = 4;     // around the depth found at the level before
/// Of the surface from the line of sight. Steeper is, where depth jumps, a bridge from near to far;
/// tissue as steep as that is seen less steeply by another view.
constexpr double kMaxTilt_deg = 75;
constexpr int kCoarseRadius = Correlator::kSmall;  // of the windows [px]
/// Tissue lies nearer and farther than the map points by this much, as a share of inverse depth.
constexpr float kBeyondSeeds = 0.35f;
constexpr int kSeedPenalty = 80;        // on hypotheses that a map point speaks against, out of 255
constexpr float kSeedTolerance = 1.5f;  // [hypotheses]
constexpr std::size_t kMinSeeds = 8;

/// Disparity at level `l` in the widest pair per inverse depth [px map unit].
float disparityScale(const std::vector<DepthSource>& sources, const PinholeLevel& level) {
  double widest = 0;
  for (const DepthSource& s : sources)
    widest = std::max(widest, s.T_source_reference.t.head<2>().norm());
  return level.f * static_cast<float>(widest);
}

float percentile(std::vector<float>& values, double share) {
  const auto nth =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

[[gnu::always_inline]] inline void sort(float& a, float& b) {
  const float low = a < b ? a : b;
  b = a < b ? b : a;
  a = low;
}

/// Medians of 3 x 3 along a row (network of Paeth 1990), its first and last pixel left out.
DEPTHSCOPE_CLONES
void medianRow(int width, const float* __restrict above, const float* __restrict here,
               const float* __restrict below, float* __restrict out) {
  for (int x = 1; x + 1 < width; ++x) {
    float a = above[x - 1], b = above[x], c = above[x + 1], d = here[x - 1], e = here[x],
          f = here[x + 1], g = below[x - 1], h = below[x], i = below[x + 1];
    sort(b, c), sort(e, f), sort(h, i), sort(a, b), sort(d, e), sort(g, h);
    sort(b, c), sort(e, f), sort(h, i), sort(a, d), sort(f, i), sort(e, h);
    sort(d, g), sort(b, e), sort(c, f), sort(e, h), sort(e, c), sort(g, e), sort(e, c);
    out[x] = e;
  }
}

/// Median of 3 x 3; the border stays as it is.
void smooth(const Grid<float>& in, Grid<float>& out) {
  out = in;
  for (int y = 1; y + 1 < in.height; ++y)
    medianRow(in.width, in.row(y - 1), in.row(y), in.row(y + 1), out.row(y));
}

/// Fraction of a hypothesis from one to the least of the parabola through its total cost and its
/// neighbours'.
[[gnu::always_inline]] inline float offsetOfLeast(int before, int here, int after) {
  const int curvature = before - 2 * here + after;
  const float offset =
      static_cast<float>(before - after) / static_cast<float>(2 * (curvature > 0 ? curvature : 1));
  return curvature > 0 ? offset : 0;
}

void choose(std::size_t n, const CostVolume& volume, const std::vector<std::uint16_t>& totals,
            Grid<float>& inverse_depth, Grid<std::uint8_t>& cost) {
  const int hypotheses = volume.hypotheses;
  const float middle = static_cast<float>(hypotheses - 1) / 2;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t first = i * static_cast<std::size_t>(hypotheses);
    const std::uint16_t* total = totals.data() + first;
    const auto best = static_cast<int>(std::min_element(total, total + hypotheses) - total);
    auto k = static_cast<float>(best);
    if (best > 0 && best < hypotheses - 1)
      k += offsetOfLeast(total[best - 1], total[best], total[best + 1]);
    inverse_depth.cells[i] = volume.centre.cells[i] + (k - middle) * volume.step;
    cost.cells[i] = volume.cost[first + static_cast<std::size_t>(best)];
  }
}

/// The same of four hypotheses, for vectors.
DEPTHSCOPE_CLONES
void chooseOfFour(std::size_t n, const std::uint16_t* __restrict totals,
                  const std::uint8_t* __restrict costs, const float* __restrict centre, float step,
                  float* __restrict inverse_depth, std::uint8_t* __restrict cost) {
  for (std::size_t i = 0; i < n; ++i) {
    const int a = totals[4 * i], b = totals[4 * i + 1], c = totals[4 * i + 2],
              d = totals[4 * i + 3];
    const bool b_first = b < a, d_first = d < c;
    const int left = b_first ? b : a, right = d_first ? d : c;
    const bool second = right < left;
    const int best = second ? (d_first ? 3 : 2) : (b_first ? 1 : 0);
    const float offset = second ? offsetOfLeast(b, c, d) : offsetOfLeast(a, b, c);
    const float k = static_cast<float>(best) + (best == 1 || best == 2 ? offset : 0.f);
    inverse_depth[i] = centre[i] + (k - 1.5f) * step;
    const int first = costs[4 * i], third = costs[4 * i + 2];
    const int in_left = b_first ? costs[4 * i + 1] : first;
    const int in_right = d_first ? costs[4 * i + 3] : third;
    cost[i] = static_cast<std::uint8_t>(second ? in_right : in_left);
  }
}

}  // namespace

bool DepthEstimator::estimate(const RectifiedPicture& reference,
                              const std::vector<DepthSource>& sources,
                              const std::vector<DepthSeed>& seeds, float max_error, DepthMap& out,
                              const std::stop_token& stop) {
  if (!startCoarse(seeds, sources)) return false;
  for (int l = kCoarsest; l >= 0; --l) {
    if (!level(l, reference, sources, stop)) return false;
    if (l == kCoarsest) favourSeeds(seeds);
    semi_global_.run(volume_, settings_.smoothness_small, settings_.smoothness_large, total_);
    chooseDepths();
    if (l == 0) break;
    const float wanted =
        static_cast<float>(settings_.step_px) / disparityScale(sources, view_.level(l - 1));
    refineCentre(l - 1, std::max(wanted, volume_.step / 4));
  }
  out.precision = 1 / disparityScale(sources, view_.level(kDepthLevel));
  keepReliable(max_error, out);
  removeSpeckles(out, 2 * out.precision);
  measureSlant(out, view_.level(kDepthLevel), kMaxTilt_deg);
  return true;
}

bool DepthEstimator::startCoarse(const std::vector<DepthSeed>& seeds,
                                 const std::vector<DepthSource>& sources) {
  const PinholeLevel& coarsest = view_.level(kCoarsest);
  if (seeds.size() < kMinSeeds || sources.empty() || !(disparityScale(sources, coarsest) > 0))
    return false;
  std::vector<float> q(seeds.size());
  std::transform(seeds.begin(), seeds.end(), q.begin(),
                 [](const DepthSeed& s) { return s.inverse_depth; });
  const float low = percentile(q, 0.02) * (1 - kBeyondSeeds);
  const float high = percentile(q, 0.98) * (1 + kBeyondSeeds);
  volume_.hypotheses = kCoarseHypotheses;
  volume_.step = (high - low) / static_cast<float>(volume_.hypotheses - 1);
  volume_.centre.reset(coarsest.width, coarsest.height, (low + high) / 2);
  return volume_.step > 0;
}

bool DepthEstimator::level(int l, const RectifiedPicture& reference,
                           const std::vector<DepthSource>& sources, const std::stop_token& stop) {
  std::vector<SweepSource> at_level;
  for (const DepthSource& s : sources)
    at_level.push_back({&s.picture->level(l), s.T_source_reference});
  return sweep_.run(reference.level(l), at_level, view_.level(l), l == 0 ? kRadius : kCoarseRadius,
                    static_cast<float>(settings_.noise), volume_,
                    [&] { return stop.stop_requested(); });
}

void DepthEstimator::favourSeeds(const std::vector<DepthSeed>& seeds) {
  const float middle = static_cast<float>(volume_.hypotheses - 1) / 2;
  for (const DepthSeed& seed : seeds) {
    const int x = static_cast<int>(seed.pixel.x()) >> kCoarsest;
    const int y = static_cast<int>(seed.pixel.y()) >> kCoarsest;
    if (x < 0 || y < 0 || x >= volume_.width || y >= volume_.height) continue;
    const float expected = (seed.inverse_depth - volume_.centre.at(x, y)) / volume_.step + middle;
    std::uint8_t* cost = volume_.cost.data() + (y * volume_.width + x) * volume_.hypotheses;
    for (int k = 0; k < volume_.hypotheses; ++k)
      if (std::abs(static_cast<float>(k) - expected) > kSeedTolerance)
        cost[k] = static_cast<std::uint8_t>(std::min(cost[k] + kSeedPenalty, 255));
  }
}

/// The hypothesis of least total cost, refined by a parabola through it and its neighbours.
void DepthEstimator::chooseDepths() {
  inverse_depth_.resize(volume_.width, volume_.height);
  cost_.resize(volume_.width, volume_.height);
  const std::size_t n = inverse_depth_.size();
  if (volume_.hypotheses == kFineHypotheses)
    chooseOfFour(n, total_.data(), volume_.cost.data(), volume_.centre.cells.data(), volume_.step,
                 inverse_depth_.cells.data(), cost_.cells.data());
  else
    choose(n, volume_, total_, inverse_depth_, cost_);
}

/// The depths found become the centres of the hypotheses of the next finer level.
void DepthEstimator::refineCentre(int finer_level, float step) {
  smooth(inverse_depth_, smoothed_);
  const PinholeLevel& finer = view_.level(finer_level);
  volume_.hypotheses = kFineHypotheses;
  volume_.step = step;
  volume_.centre.resize(finer.width, finer.height);
  for (int y = 0; y < finer.height; ++y)
    for (int x = 0; x < finer.width; ++x) {
      // Pixel x of the finer level lies a quarter off the middle of pixel x / 2 of the coarser.
      const int cx = x / 2, cy = y / 2, nx = x % 2 ? cx + 1 : cx - 1, ny = y % 2 ? cy + 1 : cy - 1;
      volume_.centre.at(x, y) = (9 * smoothed_.at(cx, cy) + 3 * smoothed_.clamped(nx, cy) +
                                 3 * smoothed_.clamped(cx, ny) + smoothed_.clamped(nx, ny)) /
                                16;
    }
}

/// Of 2 x 2 depths at the finest level the mean of the well correlated ones, where most are.
void DepthEstimator::keepReliable(float max_error, DepthMap& out) const {
  const PinholeLevel& level = view_.level(kDepthLevel);
  out.inverse_depth.reset(level.width, level.height);
  out.confidence.reset(level.width, level.height);
  // Depth 1 / q changes by 1 / q^2 times the change of q.
  const float least = std::sqrt(out.precision / max_error);
  const int worst = static_cast<int>(255 * (1 - settings_.min_correlation));
  for (int y = 0; y < level.height; ++y)
    for (int x = 0; x < level.width; ++x) {
      int n = 0, cost = 0;
      float sum = 0;
      for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 2; ++i) {
          const int c = cost_.at(2 * x + i, 2 * y + j);
          const float q = inverse_depth_.at(2 * x + i, 2 * y + j);
          if (c > worst || !(q > least)) continue;
          ++n;
          cost += c;
          sum += q;
        }
      if (n < 2) continue;
      out.inverse_depth.at(x, y) = sum / static_cast<float>(n);
      out.confidence.at(x, y) =
          static_cast<std::uint8_t>(std::clamp(255 - 255 * cost / (n * worst + 1), 1, 255));
    }
}

}  // namespace depthscope::recon
