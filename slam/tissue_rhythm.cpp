#include "slam/tissue_rhythm.hpp"

#include <algorithm>

namespace depthscope::slam {
namespace {

// Breaths a second, of a ventilated patient and of one who breathes by himself.
constexpr double kSlowest_hz = 0.1, kFastest_hz = 0.6;
constexpr double kMinPeriods = 2.5;  // fewer cannot be told from a drift
constexpr int kMinViewsAPeriod = 4;
constexpr int kStepsAPeriodogram = 8;  // to 1 / duration, the width of its peaks
// By how much a rhythm must lessen the errors' cost for each number that it takes, in units of what
// chance does, and how far it must stand out from the median of all frequencies, which models that
// do not quite fit lift as well. Seen: breathing 88 to 128, 2.3 to 4.6 times the median; still
// tissue 7 to 16; a hand-held camera 56. Breathing seen for little more than two breaths, or from
// few places, 97 to 220, but 1.3 to 1.5 times the median, and the rhythm may be wrong. Where it was
// taken all the same, and over still tissue, paths were off by 5 % more or less.
constexpr double kMinGain = 70, kMinProminence = 1.8;

/// Frequencies that views of some number and duration can tell; none where slowest >= fastest.
struct Band {
  double slowest_hz = 0, fastest_hz = 0, step_hz = 0;
};

Band bandOf(std::span<const TimedView> views) {
  if (views.empty()) return {};
  const auto [first, last] = std::minmax_element(
      views.begin(), views.end(),
      [](const TimedView& a, const TimedView& b) { return a.timestamp_s < b.timestamp_s; });
  const double duration_s = last->timestamp_s - first->timestamp_s;
  if (!(duration_s > 0)) return {};
  const auto seen = static_cast<double>(views.size());
  return {std::max(kSlowest_hz, kMinPeriods / duration_s),
          std::min(kFastest_hz, seen / (kMinViewsAPeriod * duration_s)),
          1 / (kStepsAPeriodogram * duration_s)};
}

}  // namespace

std::optional<TissueRhythm> TissueRhythm::find(const Intrinsics& camera,
                                               std::span<const TimedView> views,
                                               std::span<const Eigen::Vector3d> points,
                                               std::span<const BaObservation> observations) {
  const Band band = bandOf(views);
  if (views.size() < 2 * kMinPeriods * kMinViewsAPeriod || !(band.slowest_hz < band.fastest_hz))
    return std::nullopt;
  ShapeProblem problem(camera, views, points, observations);
  if (!problem.eliminatePoses()) return std::nullopt;
  std::vector<double> gains;
  ShapeRhythm best;
  double most = 0;
  bool rose = false;  // at the last frequency: what is highest there is the flank of a peak
  for (double f = band.slowest_hz; f <= band.fastest_hz; f += band.step_hz) {
    const ShapeRhythm tried = problem.fit(f, gains.emplace_back());
    rose = gains.back() > most;
    if (!rose) continue;
    most = gains.back();
    best = tried;
  }
  const bool flank = rose || best.frequency_hz == band.slowest_hz;
  const auto median = gains.begin() + static_cast<std::ptrdiff_t>(gains.size() / 2);
  std::nth_element(gains.begin(), median, gains.end());
  if (flank || most < kMinGain || most < kMinProminence * *median) return std::nullopt;
  return TissueRhythm(best, problem.responses(best));
}

}  // namespace depthscope::slam
